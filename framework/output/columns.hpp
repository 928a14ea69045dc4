// history.h5: columns of numbers over time, a group for each observer that fills some, each with times of its own.
//
// Rows are kept in memory for a second at most, then they join the file in one step (hdf5_file.hpp): whenever a run is
// killed, the file can be read, and lacks the rows of the last second. All rows up to a restart file are in the file
// before that is written.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace kerf {

struct ColumnInfo {
  std::string name, unit, doc;
};

/// A group of columns that grow together. The file has a further column in front, `time`.
struct ColumnTable {
  std::string name, type;  // type of what fills it
  std::vector<ColumnInfo> columns;
};

/// The file, open on rank 0 and on no other. All functions are collective. Failures throw OutputError on all ranks and
/// leave the rows that were there.
class ColumnFile {
 public:
  /// Starts a new file, in place of one that is there.
  ColumnFile(MPI_Comm comm, const std::string& path, const std::vector<ColumnTable>& tables);
  /// Goes on with the file of an earlier run, keeping rows up to and including `time`. Throws where it has other
  /// columns.
  static ColumnFile resume(MPI_Comm comm, const std::string& path, const std::vector<ColumnTable>& tables, double time);
  ColumnFile(ColumnFile&&) noexcept;
  ColumnFile& operator=(ColumnFile&&) noexcept;
  ~ColumnFile();

  /// Time of the last row that resume() kept; -1 without any. The same on all ranks.
  double last_time(std::size_t table) const { return last_times_[table]; }
  /// Adds a row to a table, that of rank 0. Pre: one value per column.
  void add_row(std::size_t table, double time, std::span<const double> values);
  /// Waits until all rows are on the disk.
  void sync();
  /// As sync(), and closes the file.
  void close();

 private:
  class Impl;
  explicit ColumnFile(MPI_Comm comm);
  MPI_Comm comm_;
  std::vector<double> last_times_;
  std::unique_ptr<Impl> impl_;  // on rank 0
};

}  // namespace kerf
