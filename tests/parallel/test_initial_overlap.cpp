// Parts that overlap at the start are found however deep they lie and wherever their cells live, with the same bits on
// any number of ranks.
#include <gtest/gtest.h>

#include <cmath>

#include "model/setup.hpp"
#include "parallel/scene.hpp"
#include "review/initial_overlap.hpp"

namespace {

using namespace kerf;
using namespace kerf::test;

std::string two_parts(const std::string& first, const std::string& second, const std::string& rest = "") {
  return R"(
time: {end: 1e-6}
materials:
  steel:
    density: 7850
    strength: {type: elastic, shear_modulus: 80e9}
    eos: {type: linear, bulk_modulus: 160e9}
parts:
  first: {material: steel, )" +
         first + "}\n  second: {material: steel, " + second + "}\n" + rest;
}

std::string block(const std::string& low, const std::string& size, const std::string& cells) {
  return "mesh: {type: block, origin: [" + low + "], size: [" + size + "], cells: [" + cells + "]}";
}

std::vector<Overlap> overlaps_of(const std::string& text) {
  const auto input = scene(text);
  Model model;
  generate(model, *input);
  return find_overlaps(model);
}

const std::string plate = block("0, 0, 0", "20e-3, 20e-3, 6e-3", "20, 20, 6");

TEST(InitialOverlap, of_a_rod_deep_in_a_plate) {
  const auto found = overlaps_of(two_parts(plate, block("8e-3, 8e-3, 2e-3", "4e-3, 4e-3, 20e-3", "6, 6, 30")));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].first, 0);
  EXPECT_EQ(found[0].second, 1);
  EXPECT_NEAR(found[0].volume, 64e-9, 64e-14 * 10.0);  // 4 mm cubed, less the tolerance at each face of each cell
  EXPECT_NEAR(found[0].low.z, 2e-3, 1e-8);
  EXPECT_NEAR(found[0].high.z, 6e-3, 1e-8);
  EXPECT_NEAR(found[0].high.x, 12e-3, 1e-8);
}

TEST(InitialOverlap, of_parts_that_are_the_same) {
  const auto found = overlaps_of(two_parts(plate, plate));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].volume, 2.4e-6, 2.4e-11);
}

TEST(InitialOverlap, of_a_small_body_inside_one_cell) {
  const auto found = overlaps_of(
      two_parts(block("0, 0, 0", "1, 1, 1", "2, 2, 2"), block("0.1, 0.1, 0.1", "0.1, 0.1, 0.1", "2, 2, 2")));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].volume, 1e-3, 1e-8);
}

/// No node of one lies in the other.
TEST(InitialOverlap, of_bars_that_cross) {
  const auto found = overlaps_of(two_parts(block("0, 4e-3, 0", "9e-3, 1e-3, 1e-3", "3, 1, 1"),
                                           block("4e-3, 0, 0.5e-3", "1e-3, 9e-3, 1e-3", "1, 3, 1")));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].volume, 0.5e-9, 1e-14);
}

TEST(InitialOverlap, is_none_where_parts_share_a_face) {
  EXPECT_TRUE(overlaps_of(two_parts(plate, block("3e-3, 3e-3, 6e-3", "4e-3, 4e-3, 9e-3", "7, 7, 9"))).empty());
  // Far from the origin, turned, where positions are rounded.
  const std::string placed = ", placement: [{angle: 0.7, axis: [1, 2, 3]}, {translate: [1000, 500, 300]}]";
  EXPECT_TRUE(overlaps_of(two_parts(plate + placed, block("3e-3, 3e-3, 6e-3", "4e-3, 4e-3, 9e-3", "7, 7, 9") + placed))
                  .empty());
}

TEST(InitialOverlap, is_none_where_boxes_overlap_and_bodies_do_not) {
  const std::string turned = ", placement: [{angle: 0.785398163}]";
  EXPECT_TRUE(
      overlaps_of(two_parts(plate + turned, block("0, 15e-3, 0", "20e-3, 20e-3, 6e-3", "20, 20, 6") +
                                                ", placement: [{angle: 0.785398163}, {translate: [-4e-3, 4e-3, 0]}]"))
          .empty());
}

/// The numbers of one rank, which every number of ranks has to meet exactly.
TEST(InitialOverlap, is_the_same_on_any_number_of_ranks) {
  const std::string text =
      two_parts(plate + ", placement: [{angle: 0.3, axis: [1, 1, 0]}]",
                "mesh: {type: cylinder, radius: 3e-3, length: 20e-3, cell_size: 1e-3, nose: {type: "
                "hemispherical}}, placement: [{translate: [9e-3, 9e-3, -4e-3]}]");
  const auto input = scene(text);
  Model whole, share;
  create_parts(whole, MPI_COMM_SELF, *input);
  generate_mesh(whole);
  generate(share, *input);
  const auto alone = find_overlaps(whole), together = find_overlaps(share);
  ASSERT_EQ(alone.size(), 1u);
  ASSERT_EQ(together.size(), 1u);
  EXPECT_EQ(alone[0].volume, together[0].volume);
  EXPECT_EQ(alone[0].sentence(whole), together[0].sentence(share));
  // The rod is 28.3 mm2 wide and goes through the plate, whose thickness along it is 6 mm / cos(0.3); its section is a
  // polygon of 32 corners or so.
  EXPECT_NEAR(alone[0].volume, 28.27e-6 * 6e-3 / std::cos(0.3), 0.03 * 170e-9);
}

TEST(InitialOverlap, is_asked_of_the_contact_that_covers_the_parts) {
  const std::string third = "  third: {material: steel, " + block("0, 0, 1", "1, 1, 1", "1, 1, 1") +
                            "}\nsets: {top: {parts: first, face: z_max}}\ncontacts:\n";
  const auto input = scene(two_parts(plate, plate,
                                     third + "  - {type: slide_surface, slave: second, master: third}\n"
                                             "  - {type: slide_surface, slave: second, master: top}\n"));
  Model model;
  generate(model, *input);
  const ContactCover cover(model);
  EXPECT_EQ(cover.between(1, 2), 0);
  EXPECT_EQ(cover.between(2, 1), 0);
  EXPECT_EQ(cover.between(0, 1), 1);
  EXPECT_EQ(cover.between(0, 2), -1);
}

}  // namespace
