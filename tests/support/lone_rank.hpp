// A model made by hand on one rank, for tests of measures: the model, its undeformed elements, and sums.
#pragma once

#include <algorithm>
#include <map>
#include <vector>

#include "kerf/measure.hpp"

namespace kerf::test {

/// A measured model with what has eroded of it.
struct HandMade : MeasureModel {
  std::vector<Element> eroded;
};

/// The only rank there is. Terms are added in ascending order.
class LoneRank final : public MeasureRanks {
 public:
  explicit LoneRank(const HandMade& model) : model_(model) {}

  bool is_root() const override { return true; }
  std::vector<double> sums(const std::vector<std::span<const double>>& lists) override {
    std::vector<double> all;
    for (const std::span<const double> list : lists) {
      std::vector<double> terms(list.begin(), list.end());
      std::sort(terms.begin(), terms.end());
      double sum = 0.0;
      for (const double t : terms) sum += t;
      all.push_back(sum);
    }
    return all;
  }
  std::vector<double> greatest(std::vector<double> values) override { return values; }
  std::vector<double> least(std::vector<double> values) override { return values; }
  std::vector<std::int64_t> least_by_key(const std::vector<Key>& keys,
                                         const std::vector<std::int64_t>& values) override {
    std::map<Key, std::int64_t> found;
    for (std::size_t i = 0; i < keys.size(); ++i) {
      const auto at = found.try_emplace(keys[i], values[i]).first;
      at->second = std::min(at->second, values[i]);
    }
    return of_keys(keys, found);
  }
  std::vector<std::int64_t> sums_by_key(const std::vector<Key>& keys,
                                        const std::vector<std::int64_t>& values) override {
    std::map<Key, std::int64_t> found;
    for (std::size_t i = 0; i < keys.size(); ++i) found[keys[i]] += values[i];
    return of_keys(keys, found);
  }
  std::vector<char> bytes_on_root(const std::vector<char>& bytes) override { return bytes; }
  std::vector<Vec3> undeformed_nodes(int part) override {
    std::vector<Vec3> places;
    for (const MeasureModel::Node& n : model_.nodes)
      if (model_.belongs_to(n, part)) places.push_back(n.reference);
    return places;
  }
  const Shape& shape(int part) const override {
    for (const auto* elements : {&model_.elements, &model_.eroded})
      for (const MeasureModel::Element& e : *elements)
        if (e.part == part) return *e.shape;
    return hexahedron;
  }
  void visit_undeformed(int part, const std::function<void(const UndeformedElement&)>& visit) override {
    for (const auto* elements : {&model_.elements, &model_.eroded})
      for (const MeasureModel::Element& e : *elements) {
        if (e.part != part) continue;
        UndeformedElement u;
        u.id = e.id;
        for (std::size_t k = 0; k < static_cast<std::size_t>(e.shape->n_nodes); ++k) {
          u.nodes[k] = model_.node(e.nodes[k]).id;
          u.places[k] = model_.node(e.nodes[k]).reference;
        }
        visit(u);
      }
  }

 private:
  static std::vector<std::int64_t> of_keys(const std::vector<Key>& keys, const std::map<Key, std::int64_t>& found) {
    std::vector<std::int64_t> values;
    for (const Key& key : keys) values.push_back(found.at(key));
    return values;
  }
  const HandMade& model_;
};

}  // namespace kerf::test
