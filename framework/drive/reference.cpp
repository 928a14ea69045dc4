// Headings of references, and errors over the greatest value of a column.
#include "drive/reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "core/units.hpp"
#include "input/csv_table.hpp"
#include "input/curve_table.hpp"
#include "input/parameter_text.hpp"

namespace kerf {

namespace {

/// "stress_xx_Pa" for the column stress_xx, in Pa.
std::string with_unit(const DrivenColumn& c) {
  std::string unit = c.unit == "s-1" ? "1_s" : c.unit;
  std::replace(unit.begin(), unit.end(), '/', '_');
  return c.name + "_" + unit;
}

[[noreturn]] void refuse(const std::string& where, const std::string& what) {
  throw InputError({fmt::format("{}: error: {}", where, what)});
}

double number_of(const std::string& text, const std::string& what, const std::string& where) {
  double value = 0.0;
  if (!parse_number(text, value) || value < 0.0)
    refuse(where, fmt::format("{} is \"{}\"; expected a number that is not negative", what, text));
  return value;
}

bool contains(const std::vector<std::int64_t>& rows, std::size_t row) {
  return std::find(rows.begin(), rows.end(), static_cast<std::int64_t>(row)) != rows.end();
}

}  // namespace

Reference::Reference(const ReferenceInput& input, const std::string& folder, const std::string& where,
                     const std::vector<DrivenColumn>& columns, double end)
    : input_(input), where_(where), same_time_(1e-12 * end) {
  const std::string path = (std::filesystem::path(folder) / input.file).string();
  std::string failure;
  const std::string text = read_text_file(path, failure);
  if (!failure.empty()) refuse(where, fmt::format("the file {} cannot be read: {}", input.file, failure));
  Diagnostics diagnostics;
  const CsvTable table = read_csv_table(text, path, diagnostics);
  diagnostics.throw_if_errors();
  const auto numbers = [&](const std::string& heading) -> const std::vector<double>& {
    const auto found = table.columns.find(heading);
    if (found == table.columns.end())
      refuse(where, fmt::format("{} has no column \"{}\" of numbers{}", path, heading,
                                suggestion(heading, table.headings, "its headings")));
    return found->second;
  };
  times_ = numbers(input.time);
  for (std::size_t r = 1; r < times_.size(); ++r)
    if (!(times_[r] > times_[r - 1]))
      refuse(where, fmt::format("{}: times have to ascend, but row {} does not", path, r));
  if (times_.front() < 0.0 || times_.back() > end * (1.0 + 1e-9))
    refuse(where, fmt::format("{} goes from {} to {} s; expected times of the path, from 0 to {:.9g} s", path,
                              times_.front(), times_.back(), end));
  std::vector<std::string> names;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const std::string& name = columns[c].name;
    names.push_back(name);
    if (name == "time") continue;
    std::string heading;
    if (const auto given = input.columns.find(name); given != input.columns.end())
      heading = given->second;
    else
      for (const std::string& usual : {name, with_unit(columns[c])})
        if (table.columns.contains(usual)) heading = usual;
    if (heading.empty()) continue;
    Compared compared;
    compared.name = name;
    compared.index = c;
    compared.wanted = numbers(heading);
    for (std::size_t r = 0; r < compared.wanted.size(); ++r)
      if (times_[r] > 0.0) compared.greatest = std::max(compared.greatest, std::fabs(compared.wanted[r]));
    columns_.push_back(std::move(compared));
  }
  for (const auto* map : {&input.columns, &input.tolerances, &input.rms})
    for (const auto& [name, value] : *map)
      if (std::none_of(columns_.begin(), columns_.end(), [&](const Compared& c) { return c.name == name; }))
        refuse(where, fmt::format("no column \"{}\" can be compared with {}{}", name, path,
                                  suggestion(name, names, "the columns of the driver")));
  for (const Compared& c : columns_) tolerance_of(c.name);  // what is no number is refused before the run
  if (columns_.empty()) refuse(where, fmt::format("no heading of {} names a column of the driver", path));
}

double Reference::tolerance_of(const std::string& column) const {
  const auto own = input_.tolerances.find(column);
  return own == input_.tolerances.end() ? input_.tolerance : number_of(own->second, "tolerances." + column, where_);
}

void Reference::see(double time, const std::vector<double>& row) {
  if (next_ >= times_.size() || std::fabs(times_[next_] - time) > same_time_) return;
  const std::size_t r = next_++;
  if (contains(input_.skip, r)) return;
  const bool is_loose = contains(input_.loose, r);
  for (Compared& c : columns_) {
    const double error = std::fabs(row[c.index] - c.wanted[r]);
    if (!(error <= c.loose)) c.loose = error, c.loose_row = r;  // also where it is no number
    if (is_loose) continue;
    ++c.n;
    c.sum_of_squares += error * error;
    if (!(error <= c.most)) c.most = error, c.row = r;
  }
}

std::vector<DriveCheck> Reference::checks() const {
  std::vector<DriveCheck> all;
  const bool ended_early = next_ < times_.size();
  for (const Compared& c : columns_) {
    const double scale = c.greatest > 0.0 ? c.greatest : 1.0, tolerance = tolerance_of(c.name);
    if (tolerance < 0.0) continue;
    // A path that ended early, and rows that are all skipped, have compared nothing.
    const double lost = ended_early || c.n == 0 ? std::numeric_limits<double>::quiet_NaN() : 0.0;
    all.push_back({c.name, input_.file, c.most / scale + lost, tolerance, c.row});
    if (const auto rms = input_.rms.find(c.name); rms != input_.rms.end())
      all.push_back({"rms of " + c.name, input_.file,
                     std::sqrt(c.sum_of_squares / static_cast<double>(std::max<std::size_t>(c.n, 1))) / scale + lost,
                     number_of(rms->second, "rms." + c.name, where_), c.row});
    if (!input_.loose.empty())
      all.push_back(
          {c.name + " with loose rows", input_.file, c.loose / scale + lost, input_.loose_tolerance, c.loose_row});
  }
  return all;
}

}  // namespace kerf
