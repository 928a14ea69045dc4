// erosion.csv: one row per eroded element.
#pragma once

#include <mpi.h>

#include <string>
#include <utility>
#include <vector>

#include "erosion/record.hpp"
#include "output/history.hpp"

namespace kerf {

/// erosion.csv.
class ErosionLog {
 public:
  /// Collective.
  ErosionLog(MPI_Comm comm, const std::string& path);
  /// Goes on with the file of an earlier run, keeping the rows up to and including `time`. Collective.
  static ErosionLog resume(MPI_Comm comm, const std::string& path, double time);
  /// Adds the elements that died on all ranks, sorted by (cycle, element), so that the file does not depend on
  /// the decomposition. Collective.
  void append(MPI_Comm comm, const std::vector<ErosionRecord>& local);
  /// Waits until the rows are on the disk. Collective.
  void sync() { file_.sync(); }
  /// As sync(), and closes the file. Collective.
  void close() { file_.close(); }

 private:
  explicit ErosionLog(CsvFile file) : file_(std::move(file)) {}
  CsvFile file_;
};

}  // namespace kerf
