// Tables that grow with a run: history.csv (one row per sample), and what other such tables need.
//
// They are plain CSV with the unit in the column's title, written by rank 0 row by row, each by one system call, and
// both can be cut back to an earlier time when a run resumes. Numbers are written with the fewest digits that read back
// to the same bits.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "output/file.hpp"

namespace kerf {

/// A CSV file open for appending on rank 0 and on no other. All functions are collective. Failures throw OutputError on
/// all ranks and leave the lines that were there.
class CsvFile {
 public:
  /// Starts a new file with this header line, in place of one that is there.
  CsvFile(MPI_Comm comm, const std::string& path, const std::string& header);
  /// Opens a file of an earlier run and drops the rows whose first column is greater than `time`, and a last row
  /// that was not finished. The kept rows keep their bytes. Throws where the header differs.
  static CsvFile resume(MPI_Comm comm, const std::string& path, const std::string& header, double time);

  /// First column of the last row that resume() kept; -1 without any.
  double last_time() const { return last_time_; }
  /// Adds the finished lines of rank 0.
  void append(const std::string& lines);
  /// Waits until the lines are on the disk.
  void sync();
  void close();

 private:
  CsvFile(MPI_Comm comm, const std::string& path);
  void open(const std::string& path);
  void remove_unfinished_line();
  MPI_Comm comm_;
  File file_;
  std::uint64_t size_ = 0;  // of the finished lines
  double last_time_ = -1.0;
};

/// A text as a CSV field; quoted only where it has to be.
std::string csv_field(const std::string& text);

struct HistoryColumn {
  std::string name;
  std::string unit;  // "-" where there is none
};

/// history.csv; the first column is the time.
class HistoryWriter {
 public:
  /// Collective.
  HistoryWriter(MPI_Comm comm, const std::string& path, const std::vector<HistoryColumn>& columns);
  /// Goes on with the file of an earlier run, keeping the rows up to and including `time`. Collective.
  static HistoryWriter resume(MPI_Comm comm, const std::string& path, const std::vector<HistoryColumn>& columns,
                              double time);
  /// Time of the last row that resume() kept; -1 without any. The same on all ranks.
  double last_time() const { return file_.last_time(); }
  /// Adds one row, that of rank 0. Pre: one value per column. Collective.
  void write(std::span<const double> row);
  /// Waits until the rows are on the disk. Collective.
  void sync() { file_.sync(); }
  /// As sync(), and closes the file. Collective.
  void close() { file_.close(); }

 private:
  HistoryWriter(CsvFile file, std::size_t n_columns) : file_(std::move(file)), n_columns_(n_columns) {}
  CsvFile file_;
  std::size_t n_columns_;
};

}  // namespace kerf
