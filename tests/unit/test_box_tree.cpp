// A tree of boxes against a look at every box, as boxes come, move and go.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "contact/box_tree.hpp"

namespace {

using namespace kerf;

class Boxes {
 public:
  explicit Boxes(unsigned seed) : random_(seed) {}

  Box some_box() {
    Box box;
    for (int d = 0; d < 3; ++d) {
      box.low[d] = static_cast<float>(random_() % 100);
      box.high[d] = box.low[d] + static_cast<float>(random_() % 6);
    }
    return box;
  }
  /// Three rows of places fill up sixteen by sixteen, with gaps.
  std::size_t next_place() {
    Row& row = rows_[random_() % 3];
    if (row.left == 0) {
      row = {n_places_, 16};
      n_places_ += 16;
    }
    --row.left;
    return row.first++;
  }
  void set(std::size_t place, const Box& box) { tree.set(place, remember(place, box)); }
  void put(std::size_t place, const Box& box) { tree.put(place, remember(place, box)); }
  std::size_t known_place() { return known_[random_() % known_.size()]; }
  bool any() const { return !known_.empty(); }
  unsigned dice(unsigned n) { return static_cast<unsigned>(random_() % n); }

  void expect_all_found(const Box& box) const {
    std::vector<std::size_t> wanted, found, with_boxes;
    for (const std::size_t place : known_)
      if (boxes_[place].meets(box)) wanted.push_back(place);
    std::sort(wanted.begin(), wanted.end());
    tree.each(box, [&](std::size_t n) { found.push_back(n); });
    tree.each(box, [&](std::size_t n, const Box& its_own) {
      with_boxes.push_back(n);
      EXPECT_TRUE(its_own == boxes_[n]);
    });
    std::sort(found.begin(), found.end());
    std::sort(with_boxes.begin(), with_boxes.end());
    EXPECT_EQ(found, wanted);
    EXPECT_EQ(with_boxes, wanted);
    EXPECT_EQ(tree.meets(box), !wanted.empty());
  }

  BoxTree tree;

 private:
  struct Row {
    std::size_t first = 0;
    int left = 0;
  };
  const Box& remember(std::size_t place, const Box& box) {
    if (place >= boxes_.size()) boxes_.resize(place + 1);
    if (std::find(known_.begin(), known_.end(), place) == known_.end()) known_.push_back(place);
    return boxes_[place] = box;
  }
  std::mt19937 random_;
  Row rows_[3];
  std::size_t n_places_ = 0;
  std::vector<Box> boxes_;
  std::vector<std::size_t> known_;
};

TEST(BoxTree, finds_what_a_look_at_every_box_finds) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    Boxes boxes(seed);
    const unsigned n_first = seed % 3 == 0 ? 0 : boxes.dice(700);
    for (unsigned k = 0; k < n_first; ++k) boxes.set(boxes.next_place(), boxes.some_box());
    boxes.tree.finish();
    for (int step = 0; step < 300; ++step) {
      const unsigned event = boxes.dice(10);
      if (event < 5 || !boxes.any()) {
        boxes.put(boxes.next_place(), boxes.some_box());
      } else if (event < 8) {  // moved, or emptied
        boxes.put(boxes.known_place(), boxes.dice(4) == 0 ? Box{} : boxes.some_box());
      } else if (event == 8) {  // emptied without a finish, which leaves hulls too large
        boxes.set(boxes.known_place(), {});
      } else if (boxes.dice(10) == 0) {
        for (int k = 0; k < 5; ++k) boxes.set(boxes.known_place(), boxes.some_box());
        boxes.tree.finish();
      }
      if (step % 5 == 0) boxes.expect_all_found(boxes.some_box());
    }
  }
}

TEST(BoxTree, takes_a_place_far_beyond_the_others) {
  Boxes boxes(1);
  for (const std::size_t place : {std::size_t{3}, std::size_t{5000}, std::size_t{70}}) {
    const Box box = boxes.some_box();
    boxes.put(place, box);
    boxes.expect_all_found(box);
  }
}

}  // namespace
