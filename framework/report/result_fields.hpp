// Turns the stores into the fields that results.vtkhdf holds.
#pragma once

#include <string>

#include "model/model.hpp"
#include "output/results.hpp"

namespace kerf {

/// Global connectivity of the undeformed mesh: this rank's even share of all elements. Collective.
void write_topology(const Model& model, ResultsWriter& results);

/// Writes frames with the fields that the input names.
class FrameWriter {
 public:
  FrameWriter(const Model& model, const OutputInput& output) : model_(model), output_(output) {}
  /// Collective.
  void write(double time, ResultsWriter& results);

 private:
  static int components_of(const std::string& element_field);
  bool list_entities();
  void release();
  double* room_for(std::size_t n);
  HeldValues<double> nodal(const std::string& name);
  HeldValues<double> elemental(const std::string& name);

  const Model& model_;
  const OutputInput& output_;
  std::vector<std::int64_t> arrangement_;  // of nodes and parts, at the last frame
  std::vector<std::int64_t> owned_, live_;  // ids
  std::vector<std::int32_t> local_;  // numbers of the owned nodes
  std::vector<double> values_;  // room for a field; kept because touching fresh memory costs as much as writing it
};

}  // namespace kerf
