// Curves from tables and files.
#include "input/curve_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>

#include "core/units.hpp"
#include "input/csv_table.hpp"

namespace kerf {

namespace {

std::vector<double> scaled(std::vector<double> values, double factor) {
  for (double& v : values) v *= factor;
  return values;
}

}  // namespace

namespace {

std::string names_of_yaml_files(const std::string& folder, std::string& failure) {
  std::error_code trouble;
  std::vector<std::string> names;
  for (const auto& file : std::filesystem::directory_iterator(folder, trouble))
    if (file.path().extension() == ".yaml") names.push_back(file.path().filename().string());
  if (trouble) failure = trouble.message();
  std::sort(names.begin(), names.end());
  std::string text;
  for (const std::string& name : names) text += name + "\n";
  return text;
}

}  // namespace

std::string read_text_file(const std::string& path, std::string& failure) {
  if (path.ends_with('/')) return names_of_yaml_files(path, failure);
  std::error_code none;
  // A device may have no end.
  if (std::filesystem::exists(path, none) && !std::filesystem::is_regular_file(path, none)) {
    failure = "this is no file";
    return {};
  }
  std::ifstream stream(path, std::ios::binary);
  if (!stream) {
    failure = std::strerror(errno);
    return {};
  }
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

CurveTable::CurveTable(const Inputs& inputs, std::string folder, FileReader read, const OriginMap& origins,
                       Diagnostics& diagnostics)
    : inputs_(inputs),
      folder_(std::move(folder)),
      read_(std::move(read)),
      origins_(origins),
      diagnostics_(diagnostics) {}

std::vector<std::string> CurveTable::names() const {
  std::vector<std::string> all;
  for (const auto& input : inputs_) all.push_back(input->name);
  return all;
}

CurveTable::Made& CurveTable::state_of(std::size_t i) {
  if (made_.size() <= i) made_.resize(i + 1);
  return made_[i];
}

const Curve* CurveTable::find(const std::string& name) {
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    if (inputs_[i]->name != name) continue;
    make(i);
    state_of(i).used = true;
    return &inputs_[i]->curve;
  }
  return nullptr;
}

void CurveTable::make(std::size_t i) {
  Made& made = state_of(i);
  if (made.done) return;
  made.done = true;
  CurveInput& input = *inputs_[i];
  if (!input.file.empty()) return make_from_file(input, made);
  // What the rules of the block refuse has been reported.
  if (!input.has_points() || !input.ascends() || !input.fits_period()) return;
  input.curve = Curve(scaled(input.times, input.time_scale), scaled(input.values, input.value_scale), input.period);
}

void CurveTable::make_from_file(CurveInput& input, Made& made) {
  if (input.columns.size() != 2) return;
  const Origin where = origins_.find("curves." + input.name + ".file");
  const std::string path = (std::filesystem::path(folder_) / input.file).lexically_normal().string();
  std::string failure;
  made.text = read_(path, failure);
  if (!failure.empty()) {
    diagnostics_.error(where, fmt::format("the file \"{}\" cannot be read: {}; expected a CSV file, named relative to "
                                          "the input file",
                                          path, failure));
    return;
  }
  const std::size_t errors_before = diagnostics_.errors().size();
  const CsvColumns csv = read_csv_columns(made.text, path, input.columns, diagnostics_);
  if (diagnostics_.errors().size() != errors_before) return;
  for (std::size_t k = 1; k < csv.first.size(); ++k)
    if (!(csv.first[k] > csv.first[k - 1])) {
      diagnostics_.error(Origin{std::make_shared<const std::string>(path), csv.line[k], csv.column[k]},
                         fmt::format("the time {} follows {}; expected times that ascend strictly",
                                     quantity_text(csv.first[k], "-"), quantity_text(csv.first[k - 1], "-")));
      return;
    }
  input.times = csv.first;
  input.values = csv.second;
  if (!input.fits_period()) {
    diagnostics_.error(origins_.find("curves." + input.name + ".period"),
                       fmt::format("`period` = {} is less than the {} from the first to the last time of the file",
                                   quantity_text(input.period, "s"),
                                   quantity_text(input.time_scale * (input.times.back() - input.times.front()), "s")));
    return;
  }
  input.curve = Curve(scaled(input.times, input.time_scale), scaled(input.values, input.value_scale), input.period);
}

void CurveTable::finish() {
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    make(i);
    if (!state_of(i).used)
      diagnostics_.warning(origins_.find("curves." + inputs_[i]->name),
                           fmt::format("nothing uses the curve `{}`; name it where it is meant to act, or leave it out",
                                       inputs_[i]->name));
  }
}

std::vector<std::string> CurveTable::file_texts() const {
  std::vector<std::string> all;
  for (const Made& made : made_) all.push_back(made.text);
  return all;
}

}  // namespace kerf
