// Reading of curves, and the motion of a cube along their paths.
#include "support/oracle.hpp"

#include <algorithm>
#include <cmath>
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

/// Integral from 0 to t of a velocity that is linear between times and constant outside.
double way(const std::vector<double>& times, const std::vector<double>& velocities, double t) {
  double sum = velocities.front() * std::min(t, times.front());
  for (std::size_t i = 0; i + 1 < times.size() && t > times[i]; ++i) {
    const double end = std::min(t, times[i + 1]), share = (end - times[i]) / (times[i + 1] - times[i]);
    sum += (end - times[i]) * (velocities[i] + 0.5 * share * (velocities[i + 1] - velocities[i]));
  }
  return sum + velocities.back() * std::max(t - times.back(), 0.0);
}

/// Place at time `t` of the corner that starts at `x`, along the path of an oracle.
Vec3 placed(const nlohmann::json& path, Vec3 x, double t) {
  const auto list = [&](const char* key) { return path.at(key).get<std::vector<double>>(); };
  const double edge = path.at("edge_m").get<double>();
  const double u = way(list("velocity_times_s"), list("velocities_m_per_s"), t) / edge;
  const std::string kind = path.at("kind");
  if (kind == "shear") return {x.x + u * x.y, x.y, x.z};
  double lateral = kind == "hydro" ? u : 0.0;
  if (path.contains("lateral_velocity_times_s"))
    lateral = way(list("lateral_velocity_times_s"), list("lateral_velocities_m_per_s"), t) / edge;
  return {x.x * (1.0 + u), x.y * (1.0 + lateral), x.z * (1.0 + lateral)};
}

double seen(const OnePart& part, const std::string& column, const std::map<std::string, std::string>& names) {
  const SymTensor s = part.stress(0);
  if (column == "pressure_Pa") return part.pressure(0);
  if (column == "stress_xx_Pa") return s.xx;
  if (column == "stress_yy_Pa") return s.yy;
  if (column == "stress_zz_Pa") return s.zz;
  if (column == "stress_xy_Pa") return s.xy;
  if (column == "von_mises_Pa") return von_mises(part.deviator(0));
  if (column == "specific_energy_J_kg") return part.get(PartStore::internal_energy, 0) / part.element_mass(0);
  if (column == "density_kg_m3") return part.element_mass(0) / part.get(PartStore::volume, 0);
  return part.variable(names.at(column), 0);
}

}  // namespace

Oracle::Oracle(const std::string& name) {
  std::ifstream in(std::string(KERF_SOURCE_DIR) + "/tests/data/laws/" + name + ".csv");
  if (!in) throw std::runtime_error("there is no oracle " + name);
  std::vector<std::string> header;
  for (std::string line; std::getline(in, line);) {
    const auto json_after = [&](const std::string& key) {
      const std::size_t at = line.find(key + ": {");
      if (at == std::string::npos) return nlohmann::json();
      const std::size_t begin = line.find('{', at), end = line.rfind('}');
      return nlohmann::json::parse(line.substr(begin, end - begin + 1));
    };
    if (line.starts_with("#")) {
      if (auto found = json_after("parameters"); !found.is_null()) parameters = found;
      if (auto found = json_after("path"); !found.is_null()) path = found;
      continue;
    }
    const std::vector<std::string> cells = split(line);
    if (header.empty()) {
      header = cells;
      continue;
    }
    for (std::size_t c = 0; c < header.size(); ++c) columns[header[c]].push_back(std::stod(cells.at(c)));
  }
  if (columns.empty()) throw std::runtime_error("the oracle " + name + " is empty");
}

std::string Oracle::text(const std::vector<std::pair<std::string, std::string>>& names) const {
  std::string all;
  for (const auto& [ours, theirs] : names) {
    char number[40];
    std::snprintf(number, sizeof number, "%.17g", parameter(theirs));
    all += (all.empty() ? "" : ", ") + ours + ": " + number;
  }
  return all;
}

std::map<std::string, CurveError> follow(const Oracle& oracle, const PartLaws& laws, int steps,
                                         const std::map<std::string, std::string>& names,
                                         const std::vector<std::size_t>& skipped) {
  const double edge = oracle.path.at("edge_m").get<double>();
  CellMesh mesh = distorted_block(1, 1, 1, edge, 0.0, 1);
  OnePart part(mesh, laws);
  part.initialise();
  std::vector<std::string> compared;
  for (const auto& [column, values] : oracle.columns)
    if (names.contains(column) || column == "pressure_Pa" || column.starts_with("stress_") ||
        column == "von_mises_Pa" || column == "specific_energy_J_kg")
      compared.push_back(column);
  std::map<std::string, CurveError> errors;
  std::map<std::string, double> greatest;
  const std::vector<double>& time = oracle.column("time_s");
  std::size_t n = 0;
  for (std::size_t row = 1; row < time.size(); ++row) {
    for (int i = 1; i <= steps; ++i) {
      const double dt = (time[row] - time[row - 1]) / steps, now = time[row - 1] + i * dt;
      std::vector<Vec3> target;
      for (const Vec3 x : mesh.x) target.push_back(placed(oracle.path, x, now));
      part.move_to(target, dt);
    }
    const bool counts = std::find(skipped.begin(), skipped.end(), row) == skipped.end();
    n += counts ? 1 : 0;
    for (const std::string& column : compared) {
      const double wanted = oracle.column(column)[row], error = std::fabs(seen(part, column, names) - wanted);
      greatest[column] = std::max(greatest[column], std::fabs(wanted));
      if (!counts) continue;
      errors[column].rms += error * error;
      if (error > errors[column].most) {
        errors[column].most = error;
        errors[column].row = row;
      }
    }
  }
  for (auto& [column, error] : errors) {
    const double scale = greatest[column] + 1e-300;
    error.most /= scale;
    error.rms = std::sqrt(error.rms / static_cast<double>(n)) / scale;
  }
  return errors;
}

}  // namespace kerf::test
