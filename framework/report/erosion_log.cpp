// Formatting and gathering of erosion.csv.
#include "report/erosion_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace kerf {

namespace {

const char* const erosion_header = "time [s],cycle,element,part,criterion,value,mass [kg],energy [J],element_id";

}  // namespace

ErosionLog::ErosionLog(MPI_Comm comm, const std::string& path) : comm_(comm), file_(comm, path, erosion_header) {}

ErosionLog ErosionLog::resume(MPI_Comm comm, const std::string& path, double time) {
  return {comm, CsvFile::resume(comm, path, erosion_header, time)};
}

void ErosionLog::keep(const std::vector<ErosionRecord>& local) {
  for (const ErosionRecord& r : local) {
    const std::string row = fmt::format("{},{},{},{},{},{},{},{},{}\n", r.time, r.cycle, r.element, csv_field(r.part),
                                        csv_field(r.criterion), r.value, r.mass, r.energy, r.label);
    keys_.insert(keys_.end(), {r.cycle, r.element, static_cast<std::int64_t>(row.size())});
    text_ += row;
  }
}

void ErosionLog::write() {
  int rank = 0, n_ranks = 1;
  MPI_Comm_rank(comm_, &rank);
  MPI_Comm_size(comm_, &n_ranks);
  const auto gather = [&]<class T>(const T* data, std::size_t n, MPI_Datatype type) {
    const int count = static_cast<int>(n);
    std::vector<int> counts(static_cast<std::size_t>(n_ranks)), starts(counts.size());
    MPI_Gather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, comm_);
    std::exclusive_scan(counts.begin(), counts.end(), starts.begin(), 0);
    std::vector<T> all(rank == 0 ? static_cast<std::size_t>(starts.back() + counts.back()) : 0);
    MPI_Gatherv(data, count, type, all.data(), counts.data(), starts.data(), type, 0, comm_);
    return all;
  };
  const std::vector<std::int64_t> all_keys = gather(keys_.data(), keys_.size(), MPI_INT64_T);
  const std::vector<char> all_text = gather(text_.data(), text_.size(), MPI_CHAR);
  keys_.clear();
  text_.clear();

  struct Row {
    std::int64_t cycle, element, start, length;
  };
  std::vector<Row> rows;
  for (std::size_t i = 0; i < all_keys.size(); i += 3)
    rows.push_back(
        {all_keys[i], all_keys[i + 1], rows.empty() ? 0 : rows.back().start + rows.back().length, all_keys[i + 2]});
  std::ranges::sort(
      rows, [](const Row& a, const Row& b) { return a.cycle != b.cycle ? a.cycle < b.cycle : a.element < b.element; });
  std::string lines;
  for (const Row& row : rows) lines.append(all_text.data() + row.start, static_cast<std::size_t>(row.length));
  file_.append(lines);
}

}  // namespace kerf
