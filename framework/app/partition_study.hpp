// What `kerf partition` finds: for each state of the model, method and number of parts one partition with its measures.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "kerf/partitioner.hpp"
#include "partition/quality.hpp"

namespace kerf {

/// A partitioner under the name that the user gave it.
struct PartitionMethod {
  std::string name, type;
  std::string block;  // as in an input: "{type: zoltan_rcb}"
};

/// A state of the model that is partitioned.
struct PartitionedState {
  std::string name;  // initial, frame_12
  std::int64_t frame = -1;  // of results; -1 for the initial state
  double time = 0.0;  // [s]
  std::int64_t n_elements = 0;  // that are alive
};

/// One partition, and what it is worth.
struct FoundPartition {
  PartitionedState state;
  PartitionMethod method;
  int n_parts = 0;
  double seconds = 0.0;  // that the slowest rank took
  std::int64_t moved = -1;  // elements whose part is another one than in the state before; -1 where there is none
  PartitionQuality quality;
};

/// The figures of a row of the table, made from the measures of the parts.
struct PartitionFigures {
  std::int64_t least_elements = 0, most_elements = 0, empty_parts = 0;
  double element_balance = 0.0, work_balance = 0.0;  // largest over mean
  double contact_balance = -1.0;  // -1 where the model has no contact
  std::int64_t most_interface_nodes = 0, most_neighbours = 0;
  double mean_neighbours = 0.0;
  double surface_index = 0.0, largest_surface_index = 0.0;
};

PartitionFigures figures_of(const PartitionQuality& quality);

/// Where the model came from and who computed, for the head of the tables.
struct PartitionStudy {
  std::string input;
  std::int64_t n_elements = 0, n_nodes = 0;
  int n_ranks = 1;
  std::vector<FoundPartition> found;
  std::vector<std::string> failures;  // a sentence for each partition that no method could make
};

/// Line of the table on the screen; with a heading for the first.
std::string screen_heading();
std::string screen_line(const FoundPartition& found);

/// Writes partitions.csv, partitions.json and partitions.md into a folder. Throws std::runtime_error.
void write_tables(const PartitionStudy& study, const std::string& folder);

}  // namespace kerf
