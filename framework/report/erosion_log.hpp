// erosion.csv: one row per eroded element. Rows are kept in memory until the run writes something, or some cycles.
#pragma once

#include <mpi.h>

#include <cstdint>
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
  /// Keeps the elements that died on this rank until write(). Local: most steps of a run that erodes write no row.
  void keep(const std::vector<ErosionRecord>& local);
  /// Adds what all ranks have kept to the file, sorted by (cycle, element), so that the file does not depend on the
  /// decomposition. Collective.
  void write();
  /// Waits until the rows that were written are on the disk. Collective.
  void sync() { file_.sync(); }
  /// As sync(), and closes the file. Collective.
  void close() { file_.close(); }

 private:
  ErosionLog(MPI_Comm comm, CsvFile file) : comm_(comm), file_(std::move(file)) {}
  MPI_Comm comm_;
  CsvFile file_;
  // Rows of this rank that are not in the file yet: their text, and of each its cycle, element and length.
  std::string text_;
  std::vector<std::int64_t> keys_;
};

}  // namespace kerf
