// recording.h5: the work of a run, moment by moment, for `kerf predict`.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace kerf {

/// A mesh, and what one cycle on it costs. Nodes are numbered within the moment.
struct RecordedMoment {
  std::int64_t cycle = 0, n_cycles = 0;  // the first that it stands for, and how many
  double time = 0.0;  // at the first [s]
  std::size_t n_corners = 8;  // nodes of an element
  std::vector<std::int64_t> element;  // ids
  std::vector<std::int64_t> cells;  // n_corners nodes per element
  std::vector<double> points;  // three per node [m]
  std::vector<double> element_seconds, load_seconds, erosion_seconds;  // per element; the last of a cycle with erosion
  // Contact: nodes, facets with four nodes each, and pairs that are looked at, by places in the two.
  std::vector<std::int64_t> slaves, facets, pair_slave, pair_facet;
  std::vector<std::uint8_t> pair_touches;
  std::vector<double> search_seconds, force_seconds;  // per slave: its share of a search, and of one cycle's forces
  double rounds = 0.0, agreements = 0.0, n_searches = 0.0, n_eroding = 0.0;
  std::vector<std::int64_t> eroded;  // places of the elements that die in one of the cycles with erosion
};

/// Numbers of the whole run.
struct RecordedRun {
  double node_seconds = 0.0;  // kick and drift of one node [s]
  std::int64_t record_bytes = 0;  // of an element that moves to another rank
  std::string source;
};

/// Begins a file without moments. Throws std::runtime_error, as does append().
void begin_recording(const std::string& path);
/// Adds moment number `place`, and sets the numbers of the run.
void append_recording(const std::string& path, std::size_t place, const RecordedMoment& moment, const RecordedRun& run);

}  // namespace kerf
