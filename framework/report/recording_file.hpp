// recording.h5: the work of a run, moment by moment, for `kerf predict`.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "output/hdf5_file.hpp"

namespace kerf {

/// A mesh, and what one cycle on it costs. Nodes are numbered within the moment.
struct RecordedMoment {
  std::int64_t cycle = 0, n_cycles = 0;  // the first that it stands for, and how many
  double time = 0.0;  // at the first [s]
  std::size_t n_corners = 8;  // nodes of an element
  std::vector<std::int64_t> element;  // ids
  std::vector<std::int64_t> cells;  // n_corners nodes per element
  std::vector<std::int64_t> node;  // ids
  std::vector<double> points;  // three per node [m]
  std::vector<double> element_seconds, load_seconds, erosion_seconds;  // per element; the last of a cycle with erosion
  // Contact: nodes, facets with four nodes each, and pairs that are looked at, by places in the two.
  std::vector<std::int64_t> slaves, facets, pair_slave, pair_facet;
  std::vector<std::uint8_t> pair_touches;
  std::vector<double> search_seconds, force_seconds;  // per slave: its share of a search, and of one cycle's forces
  // Of a cycle, the mean: rounds of impacts, reductions of contact besides that of the step, and the share of contact
  // definitions with friction.
  double rounds = 0.0, agreements = 0.0, friction = 0.0;
  double renewed = 0.0;  // share of slaves whose boxes are new at a renewal
  std::int64_t n_loads = 0;  // faces of elements that loads act on
  double slave_reach = 0.0, facet_reach = 0.0;  // of boxes of contact, beyond slaves and beyond corners of facets [m]
  // In all cycles: complete searches, renewals of all boxes, refreshes of some, and cycles in which elements erode.
  double n_searches = 0.0, n_renewals = 0.0, n_refreshes = 0.0, n_eroding = 0.0;
  std::vector<std::int64_t> eroded;  // places of the elements that die in one of the cycles with erosion
};

/// Numbers of the whole run.
struct RecordedRun {
  double node_seconds = 0.0;  // kick and drift of one node [s]
  std::int64_t record_bytes = 0;  // of an element that moves to another rank
  std::string source;
};

/// The file, which one rank writes: complete at every moment of a run, as all files of Kerf's. All functions throw
/// std::runtime_error with a sentence.
class RecordingFile {
 public:
  /// Begins a file without moments.
  static RecordingFile create(const std::string& path);
  /// Goes on with the file of an earlier start, without the moments that reach beyond a cycle. Begins a file where
  /// there is none.
  static RecordingFile resume(const std::string& path, std::int64_t cycle);

  std::size_t n_moments() const { return file_.root.groups.at("moments").groups.size(); }
  /// Whether there was a file to go on with.
  bool goes_on() const { return goes_on_; }
  /// The first cycle that no moment stands for.
  std::int64_t next_cycle() const;
  /// Of all moments: the time of kick and drift [s], and copies of nodes added up over cycles.
  double node_seconds() const;
  double node_cycles() const;
  /// Adds a moment, and sets the numbers of the run.
  void append(const RecordedMoment& moment, const RecordedRun& run);

 private:
  template <class T>
  void put(hdf5::Group& group, const char* name, const std::vector<T>& values, std::size_t width = 0);
  void put_arrays(hdf5::Group& group, const RecordedMoment& moment);

  hdf5::Hdf5File file_;
  bool goes_on_ = false;
};

}  // namespace kerf
