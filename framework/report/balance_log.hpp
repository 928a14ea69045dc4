// balance.csv: one row per decision about re-balancing, with the numbers that it was made from.
#pragma once

#include <mpi.h>

#include <string>
#include <utility>
#include <vector>

#include "dynamics/balance.hpp"
#include "output/history.hpp"

namespace kerf {

class BalanceLog {
 public:
  /// Collective.
  BalanceLog(MPI_Comm comm, const std::string& path);
  /// Goes on with the file of an earlier run, keeping the rows up to and including `time`; begins one where a run of an
  /// older Kerf has left none. Collective.
  static BalanceLog resume(MPI_Comm comm, const std::string& path, double time);
  /// Adds the decisions that are not in the file yet. Pre: as many on all ranks. Collective.
  void write(const std::vector<BalanceDecision>& decisions);
  /// Waits until the rows that were written are on the disk. Collective.
  void sync() { file_.sync(); }
  /// As sync(), and closes the file. Collective.
  void close() { file_.close(); }

 private:
  explicit BalanceLog(CsvFile file) : file_(std::move(file)) {}
  CsvFile file_;
  std::size_t n_written_ = 0;
};

}  // namespace kerf
