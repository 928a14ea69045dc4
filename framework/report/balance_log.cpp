// Formatting of balance.csv.
#include "report/balance_log.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "parallel/communicator.hpp"

namespace kerf {

namespace {

const char* const header =
    "time [s],cycle,imbalance,mean_imbalance,predicted_saving [element cycles],predicted_cost [element cycles],"
    "decision,reason,elements_moved,seconds [s],imbalance_after";

/// Empty where there is no number.
std::string field(double value) { return std::isfinite(value) ? fmt::format("{}", value) : ""; }

std::string row_of(const BalanceDecision& d) {
  const bool moved = d.decision != BalanceDecision::stay;
  return fmt::format(
      "{},{},{},{},{},{},{},{},{}\n", d.time, d.cycle, d.imbalance, field(d.reasons.mean_imbalance),
      field(d.reasons.saving), field(d.reasons.cost), d.decision, csv_field(d.reasons.reason),
      moved ? fmt::format("{},{},{}", d.move.elements_moved, d.move.seconds, d.move.imbalance_after) : ",,");
}

}  // namespace

BalanceLog::BalanceLog(MPI_Comm comm, const std::string& path) : file_(comm, path, header) {}

BalanceLog BalanceLog::resume(MPI_Comm comm, const std::string& path, double time) {
  const double is_there = rank_of(comm) == 0 && std::filesystem::exists(path) ? 1.0 : 0.0;
  if (greatest(comm, is_there) == 0.0) return {comm, path};
  return BalanceLog(CsvFile::resume(comm, path, header, time));
}

void BalanceLog::write(const std::vector<BalanceDecision>& decisions) {
  if (n_written_ == decisions.size()) return;
  std::string lines;
  for (; n_written_ < decisions.size(); ++n_written_) lines += row_of(decisions[n_written_]);
  file_.append(lines);
}

}  // namespace kerf
