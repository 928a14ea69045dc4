// Writes results.vtkhdf: all frames of a run in one file that ParaView opens as a time series.
//
// Layout: a temporal VTKHDF 2.0 UnstructuredGrid with one partition. Elements and nodes stand in their original
// global order whatever the owners are, topology is stored once, and every frame appends the node positions and
// the fields. Eroded elements stay in the grid; `alive` is 0 for them and `vtkGhostType` hides them.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kerf/shape.hpp"
#include "output/slab.hpp"

namespace kerf {

/// One file of results of all ranks. All functions are collective; ranks that hold nothing pass empty lists and values.
///
/// Calls per file: write_topology once, then per frame begin_frame, the add_* calls in the same order on all
/// ranks, end_frame. The set of fields is fixed by the first frame. Misuse throws std::logic_error. Failures of the
/// file throw OutputError on all ranks, not later than in end_frame; the frames before stay as they are.
class ResultsWriter {
 public:
  /// Begins "<path>.part"; the end of the first frame gives the file its name, in place of one that is there. With
  /// `double_precision` positions and fields are stored as double, otherwise as float.
  ResultsWriter(MPI_Comm comm, const std::string& path, std::int64_t n_nodes, std::int64_t n_elements,
                bool double_precision);
  /// Opens a file of an earlier run to append to it, keeping its first `keep_frames` frames and no other.
  static ResultsWriter reopen(MPI_Comm comm, const std::string& path, int keep_frames);

  ResultsWriter(ResultsWriter&&) noexcept;
  ResultsWriter& operator=(ResultsWriter&&) noexcept;
  ~ResultsWriter();
  /// Closes the file and reports where that fails.
  void close();

  /// All elements of one part are of one shape; parts follow one another in the order of their elements' ids.
  struct PartTopology {
    std::string name;
    std::int64_t n_elements = 0;
    const Shape* shape = &hexahedron;
  };
  /// Pre: the ranks' elements together are all elements of the model, each once. `nodes` has the global node ids of
  /// each element in the order of VTK's cell type, `part_of` one index into `parts` per element.
  void write_topology(std::span<const std::int64_t> elements, std::span<const ElementNodeIds> nodes,
                      std::span<const std::int32_t> part_of, const std::vector<PartTopology>& parts);

  /// The number that the user knows an element or a node by, from its id.
  using LabelOf = std::function<std::int64_t(std::int64_t)>;
  /// Stores these numbers as `element_id` and `node_id`. Once, between the topology and the first frame.
  void write_labels(const LabelOf& of_element, const LabelOf& of_node);

  /// Stores the units of fields, by name, for whoever draws them. Once, before the first frame.
  void note_units(const std::vector<std::pair<std::string, std::string>>& units);

  /// With `same_entities`, all ids of this rank will be the same as in the frame before.
  void begin_frame(double time, bool same_entities = false);
  /// Positions [m], three per node. Nodes that nobody holds any more keep their last written position.
  void add_points(std::span<const std::int64_t> owned_nodes, const HeldValues<double>& positions);
  /// `components` values per entity of the list of ids; 0 is stored where nobody holds the entity.
  void add_node_field(const std::string& name, int components, std::span<const std::int64_t> owned_nodes,
                      const HeldValues<double>& values);
  void add_element_field(const std::string& name, int components, std::span<const std::int64_t> live_elements,
                         const HeldValues<double>& values);
  /// Stores `alive` and `vtkGhostType`.
  void add_alive(std::span<const std::int64_t> live_elements);
  /// Completes the frame. Post: the file on disk is complete up to and including this frame. Whenever the run is
  /// killed, a reader finds the file with this frame or without it.
  void end_frame();

  bool double_precision() const;
  /// Names of the fields in a file that has frames.
  std::vector<std::string> node_fields() const;
  std::vector<std::string> element_fields() const;
  /// Complete frames in the file.
  int n_frames() const;
  /// Time of the last of them; -1 without any.
  double last_time() const;

 private:
  class Impl;
  explicit ResultsWriter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace kerf
