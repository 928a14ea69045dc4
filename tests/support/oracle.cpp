// Reading of curves, and their paths as the driver takes them.
#include "support/oracle.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace kerf::test {

namespace {

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells;
  std::stringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
  return cells;
}

/// The path of a file, as a drive file has it.
PathInput path_of(const nlohmann::json& path) {
  static const std::map<std::string, std::string> types = {
      {"stress", "uniaxial_stress"}, {"strain", "uniaxial_strain"}, {"shear", "simple_shear"}, {"hydro", "volumetric"}};
  PathInput p;
  p.type = types.at(path.at("kind"));
  const double edge = path.at("edge_m").get<double>();
  p.times = path.at("velocity_times_s").get<std::vector<double>>();
  for (const double v : path.at("velocities_m_per_s").get<std::vector<double>>()) p.strain_rates.push_back(v / edge);
  p.lateral_stress = path.value("lateral_stress_Pa", 0.0);
  return p;
}

}  // namespace

double Oracle::number(const nlohmann::json& value) {
  return value.is_string() ? std::stod(value.get<std::string>()) : value.get<double>();
}

void Oracle::read_comment(const std::string& line) {
  comments.push_back(line);
  // The word before ": {" says what the JSON is about.
  for (const auto& [key, target] : {std::pair{"failure parameters: {", &failure},
                                    {"parameters: {", &parameters},
                                    {"path: {", &path},
                                    {"material: {", &material}}) {
    const std::size_t at = line.find(key);
    if (at == std::string::npos) continue;
    const std::size_t begin = line.find('{', at), end = line.rfind('}');
    *target = nlohmann::json::parse(line.substr(begin, end - begin + 1));
    return;
  }
}

Oracle::Oracle(const std::string& file) : name(file) {
  const std::string own = std::string(KERF_SOURCE_DIR) + "/tests/data/laws/" + file + ".csv";
  std::ifstream in(std::ifstream(own) ? own : file);
  if (!in) throw std::runtime_error("there is no oracle " + file);
  if (const std::size_t slash = name.rfind('/'); slash != std::string::npos) name.erase(0, slash + 1);
  if (name.ends_with(".csv")) name.erase(name.size() - 4);
  std::vector<std::string> header;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("#")) {
      read_comment(line);
      continue;
    }
    const std::vector<std::string> cells = split(line);
    if (header.empty()) {
      header = cells;
      continue;
    }
    if (cells.empty()) continue;
    ++n_rows_;
    for (std::size_t c = 0; c < header.size(); ++c) {
      char* end = nullptr;
      const double value = std::strtod(cells.at(c).c_str(), &end);
      if (end == cells[c].c_str())
        words[header[c]].push_back(cells[c]);
      else
        columns[header[c]].push_back(value);
    }
  }
  if (n_rows_ == 0) throw std::runtime_error("the oracle " + file + " is empty");
}

std::string key_and_number(const std::string& key, double value) {
  char number[40];
  std::snprintf(number, sizeof number, "%.17g", value);
  return key + ": " + number;
}

std::string Oracle::text(const std::vector<std::pair<std::string, std::string>>& names) const {
  std::string all;
  for (const auto& [ours, theirs] : names)
    if (parameters.contains(theirs)) all += (all.empty() ? "" : ", ") + key_and_number(ours, parameter(theirs));
  return all;
}

void drive(const Oracle& oracle, const PartLaws& laws, int steps_per_row,
           const std::function<void(const CellPart<double>&, std::size_t)>& at_row) {
  DriveInput input;
  input.size = oracle.path.at("edge_m").get<double>();
  const OwnLaws own(laws, nullptr);
  const PathInput path = path_of(oracle.path);
  Motion motion(path, "", "");
  DrivenCell cell(input, own.material(), own.element(), path, motion);
  const std::vector<double>& time = oracle.column("time_s");
  for (std::size_t row = 1; row < time.size(); ++row) {
    const double dt = (time[row] - time[row - 1]) / steps_per_row;
    for (int i = 1; i <= steps_per_row; ++i) cell.advance(i == steps_per_row ? time[row] : time[row - 1] + i * dt);
    at_row(cell.part(), row);
  }
}

}  // namespace kerf::test
