// Formatting, gathering and cutting back of history.csv.
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

std::string header_of(const std::vector<HistoryColumn>& columns) {
  if (columns.empty()) throw std::invalid_argument("a history needs at least one column, the time");
  std::string header;
  for (const HistoryColumn& column : columns) {
    if (!header.empty()) header += ',';
    header += csv_field(column.name + " [" + column.unit + "]");
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

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

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

}  // namespace kerf
