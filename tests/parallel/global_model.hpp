// The whole model on rank 0, by global ids, for checks that know nothing of decompositions.
#pragma once

#include <array>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "model/model.hpp"

namespace kerf::test {

struct GlobalElement {
  std::int64_t id = 0;
  int part = 0;
  std::array<std::int64_t, 8> nodes{};  // ids
  std::vector<double> record;  // everything that its part stores of it
};

struct GlobalFacet {
  std::int64_t element = 0;
  int face = 0;
  auto operator<=>(const GlobalFacet&) const = default;
};

struct GlobalModel {
  std::vector<GlobalElement> elements;  // live, by id
  std::vector<NodeRecord> nodes;  // by id; one copy each
  std::string trouble;  // what is inconsistent between ranks; empty where nothing is

  const NodeRecord& node(std::int64_t id) const;
  bool has_node(std::int64_t id) const;
  const GlobalElement& element(std::int64_t id) const;
  Vec3 x(std::int64_t node_id) const;
  /// Exterior faces of live elements: those whose four nodes no other live element has as a face.
  std::set<GlobalFacet> exterior() const;
};

/// Everything on rank 0, empty elsewhere. All copies of a node are compared; differences, nodes that are owned by
/// none or several ranks, and elements that several ranks hold are `trouble`. Collective.
GlobalModel gather_globally(const Model& model);

/// The exterior faces that the ranks' surfaces know, on rank 0; `n_listed` counts repetitions too. Collective.
std::set<GlobalFacet> gather_exterior(Model& model, std::int64_t& n_listed);

}  // namespace kerf::test
