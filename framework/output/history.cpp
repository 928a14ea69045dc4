// Formatting, gathering and cutting back of history.csv and erosion.csv.
#include "output/history.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <numeric>
#include <stdexcept>

#include "output/collective.hpp"

namespace kerf {

namespace {

const char* const erosion_header = "time [s],cycle,element,part,criterion,value,mass [kg],energy [J]";

/// A text as a CSV field; quoted only where it has to be.
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

std::string header_of(const std::vector<HistoryColumn>& columns) {
  if (columns.empty()) throw std::invalid_argument("a history needs at least one column, the time");
  std::string header;
  for (const HistoryColumn& column : columns) {
    if (!header.empty()) header += ',';
    header += field(column.name + " [" + column.unit + "]");
  }
  return header;
}

/// Copies header and rows up to `time` to a new file that then takes the place of the old one, so that an
/// interruption leaves one of the two.
double cut_back(const std::string& path, const std::string& header, double time) {
  std::ifstream in(path);
  if (!in) throw std::runtime_error("cannot open \"" + path + "\" to continue it: " + std::strerror(errno));
  std::string line;
  if (!std::getline(in, line) || line != header)
    throw std::runtime_error("\"" + path + "\" has other columns than this run writes, so it cannot be continued");
  std::string kept = header + '\n';
  double last_time = -1.0;
  while (std::getline(in, line)) {
    if (in.eof()) break;  // no end of line: the row was cut off in the middle
    char* end = nullptr;
    const double row_time = std::strtod(line.c_str(), &end);
    if (end == line.c_str() || row_time > time) continue;
    kept += line + '\n';
    last_time = row_time;
  }
  if (in.bad()) throw std::runtime_error("cannot read \"" + path + "\": " + std::strerror(errno));
  replace_file(path, kept);
  return last_time;
}

}  // namespace

CsvFile::CsvFile(MPI_Comm comm, const std::string& path) : comm_(comm) {
  on_root(comm, [&] { open(path); });
}

CsvFile::CsvFile(MPI_Comm comm, const std::string& path, const std::string& header) : comm_(comm) {
  on_root(comm, [&] {
    replace_file(path, header + '\n');
    open(path);
  });
}

void CsvFile::open(const std::string& path) {
  file_ = File(path, File::Mode::append);
  size_ = file_.size();
}

CsvFile CsvFile::resume(MPI_Comm comm, const std::string& path, const std::string& header, double time) {
  double last_time = -1.0;
  on_root(comm, [&] { last_time = cut_back(path, header, time); });
  MPI_Bcast(&last_time, 1, MPI_DOUBLE, 0, comm);
  CsvFile file(comm, path);
  file.last_time_ = last_time;
  return file;
}

void CsvFile::append(const std::string& lines) {
  on_root(comm_, [&] {
    try {
      file_.append(lines);
      size_ += lines.size();
    } catch (const std::exception&) {
      remove_unfinished_line();
      throw;
    }
  });
}

/// Part of a row may have found room. The reason of the failure is on its way already, so this one does not matter.
void CsvFile::remove_unfinished_line() {
  try {
    file_.cut(size_);
  } catch (const std::exception&) {
  }
}

void CsvFile::sync() {
  on_root(comm_, [&] { file_.sync(); });
}

void CsvFile::close() {
  on_root(comm_, [&] {
    file_.sync();
    file_.close();
  });
}

HistoryWriter::HistoryWriter(MPI_Comm comm, const std::string& path, const std::vector<HistoryColumn>& columns)
    : file_(comm, path, header_of(columns)), n_columns_(columns.size()) {}

HistoryWriter HistoryWriter::resume(MPI_Comm comm, const std::string& path, const std::vector<HistoryColumn>& columns,
                                    double time) {
  return {CsvFile::resume(comm, path, header_of(columns), time), columns.size()};
}

void HistoryWriter::write(std::span<const double> row) {
  if (row.size() != n_columns_)
    throw std::logic_error(fmt::format("a history row has {} values for {} columns", row.size(), n_columns_));
  file_.append(fmt::format("{}\n", fmt::join(row, ",")));
}

ErosionLog::ErosionLog(MPI_Comm comm, const std::string& path) : file_(comm, path, erosion_header) {}

ErosionLog ErosionLog::resume(MPI_Comm comm, const std::string& path, double time) {
  return ErosionLog(CsvFile::resume(comm, path, erosion_header, time));
}

void ErosionLog::append(MPI_Comm comm, const std::vector<ErosionRecord>& local) {
  // Each rank formats its own rows; what travels is text and, per row, three numbers to sort and cut it by.
  std::string text;
  std::vector<std::int64_t> keys;  // cycle, element, length of the row
  for (const ErosionRecord& r : local) {
    const std::string row = fmt::format("{},{},{},{},{},{},{},{}\n", r.time, r.cycle, r.element, field(r.part),
                                        field(r.criterion), r.value, r.mass, r.energy);
    keys.insert(keys.end(), {r.cycle, r.element, static_cast<std::int64_t>(row.size())});
    text += row;
  }

  int rank = 0, n_ranks = 1;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &n_ranks);
  const auto gather = [&]<class T>(const T* data, std::size_t n, MPI_Datatype type) {
    const int count = static_cast<int>(n);
    std::vector<int> counts(static_cast<std::size_t>(n_ranks)), starts(counts.size());
    MPI_Gather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, comm);
    std::exclusive_scan(counts.begin(), counts.end(), starts.begin(), 0);
    std::vector<T> all(rank == 0 ? static_cast<std::size_t>(starts.back() + counts.back()) : 0);
    MPI_Gatherv(data, count, type, all.data(), counts.data(), starts.data(), type, 0, comm);
    return all;
  };
  const std::vector<std::int64_t> all_keys = gather(keys.data(), keys.size(), MPI_INT64_T);
  const std::vector<char> all_text = gather(text.data(), text.size(), MPI_CHAR);

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
