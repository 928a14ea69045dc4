// Reading of curves, and the motion of a cube along their paths.
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

/// Integral from 0 to t of a velocity that is linear between times and constant outside.
double way(const std::vector<double>& times, const std::vector<double>& velocities, double t) {
  double sum = velocities.front() * std::min(t, times.front());
  for (std::size_t i = 0; i + 1 < times.size() && t > times[i]; ++i) {
    const double end = std::min(t, times[i + 1]), share = (end - times[i]) / (times[i + 1] - times[i]);
    sum += (end - times[i]) * (velocities[i] + 0.5 * share * (velocities[i + 1] - velocities[i]));
  }
  return sum + velocities.back() * std::max(t - times.back(), 0.0);
}

/// A cube whose faces move as the path of an oracle says.
class DrivenCube {
 public:
  DrivenCube(const nlohmann::json& path, const PartLaws& laws)
      : path_(path),
        kind_(path.at("kind")),
        edge_(path.at("edge_m").get<double>()),
        mesh_(distorted_block(1, 1, 1, edge_, 0.0, 1)),
        part_(mesh_, laws) {
    part_.initialise();
    if (kind_ == "stress") target_ = path.at("lateral_stress_Pa").get<double>();
  }
  const OnePart& part() const { return part_; }

  void step_to(double time, double dt) {
    const double axial = stretch("velocity_times_s", "velocities_m_per_s", time);
    if (kind_ == "shear") return move(axial, 1.0, dt);
    if (kind_ == "hydro") return move(axial, axial, dt);
    if (kind_ == "strain") {
      const bool has_lateral = path_.contains("lateral_velocity_times_s");
      return move(axial, has_lateral ? stretch("lateral_velocity_times_s", "lateral_velocities_m_per_s", time) : 1.0,
                  dt);
    }
    if (kind_ != "stress" && kind_ != "triax") throw std::runtime_error("there is no path " + kind_);
    // The confining stress is that at the end of the isotropic compression, and the switch is at a step's end.
    if (kind_ == "triax" && time <= path_.at("isotropic_until_s").get<double>() * (1.0 + 1e-9)) {
      move(axial, axial, dt);
      target_ = part_.stress(0).yy;
      return;
    }
    solve_lateral(axial, dt);
  }

 private:
  double stretch(const char* times, const char* velocities, double t) const {
    return 1.0 +
           way(path_.at(times).get<std::vector<double>>(), path_.at(velocities).get<std::vector<double>>(), t) / edge_;
  }
  void move(double axial, double lateral, double dt) {
    std::vector<Vec3> to;
    for (const Vec3 x : mesh_.x)
      to.push_back(kind_ == "shear" ? Vec3{x.x + (axial - 1.0) * x.y, x.y, x.z}
                                    : Vec3{x.x * axial, x.y * lateral, x.z * lateral});
    part_.move_to(to, dt);
    axial_ = axial;
    change_ = lateral - lateral_;
    lateral_ = lateral;
  }
  /// The lateral stretch with which the step ends at the lateral stress of the path: bracketed, then by the method of
  /// Illinois, until the stress or the stretch is met to round-off.
  void solve_lateral(double axial, double dt) {
    const OnePart::Snapshot before = part_.save();
    const double start = lateral_, guess = change_;
    const auto excess = [&](double change) {
      part_.restore(before);
      lateral_ = start;
      move(axial, start + change, dt);
      return part_.stress(0).yy - target_;
    };
    const double least = 1e-12;
    double low = guess, high = guess, f_low = excess(guess), f_high = f_low;
    double reach = std::max(0.05 * std::fabs(axial - axial_before(before)), least);
    for (int i = 0; f_low > 0.0 && i < 60; ++i, reach *= 2.0) {
      high = low, f_high = f_low;
      f_low = excess(low = guess - reach);
    }
    for (int i = 0; f_high < 0.0 && i < 60; ++i, reach *= 2.0) {
      low = high, f_low = f_high;
      f_high = excess(high = guess + reach);
    }
    if (f_low > 0.0 || f_high < 0.0) throw std::runtime_error("no lateral strain gives the lateral stress of the path");
    double last = high;
    for (int i = 0, side = 0; i < 100 && high - low > 1e-16 && f_high != f_low; ++i) {
      const double middle = (low * f_high - high * f_low) / (f_high - f_low), f = excess(last = middle);
      if (std::fabs(f) < 1e-6) break;  // [Pa]
      if (f > 0.0) {
        high = middle, f_high = f;
        if (side == 1) f_low *= 0.5;
        side = 1;
      } else {
        low = middle, f_low = f;
        if (side == -1) f_high *= 0.5;
        side = -1;
      }
    }
    excess(last);
    change_ = last;
  }
  double axial_before(const OnePart::Snapshot& before) const {
    double most = 0.0;
    for (const Vec3 x : before.x) most = std::max(most, x.x);
    return most / edge_;
  }

  nlohmann::json path_;
  std::string kind_;
  double edge_, target_ = 0.0, axial_ = 1.0, lateral_ = 1.0, change_ = 0.0;
  CellMesh mesh_;
  OnePart part_;
};

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
           const std::function<void(const OnePart&, double)>& after_step,
           const std::function<void(const OnePart&, std::size_t)>& at_row) {
  DrivenCube cube(oracle.path, laws);
  const std::vector<double>& time = oracle.column("time_s");
  for (std::size_t row = 1; row < time.size(); ++row) {
    const double dt = (time[row] - time[row - 1]) / steps_per_row;
    for (int i = 1; i <= steps_per_row; ++i) {
      cube.step_to(time[row - 1] + i * dt, dt);
      if (after_step) after_step(cube.part(), dt);
    }
    at_row(cube.part(), row);
  }
}

std::map<std::string, CurveError> follow(const Oracle& oracle, const PartLaws& laws, int steps,
                                         const std::map<std::string, std::string>& names,
                                         const std::vector<std::size_t>& skipped) {
  std::vector<std::string> compared;
  for (const auto& [column, values] : oracle.columns)
    if (names.contains(column) || column == "pressure_Pa" || column.starts_with("stress_") ||
        column == "von_mises_Pa" || column == "specific_energy_J_kg")
      compared.push_back(column);
  std::map<std::string, CurveError> errors;
  std::map<std::string, double> greatest;
  for (const std::string& column : compared) errors[column];
  std::size_t n = 0;
  drive(oracle, laws, steps, {}, [&](const OnePart& part, std::size_t row) {
    const bool jumps = oracle.has("near_jump") && oracle.column("near_jump")[row] != 0.0;
    const bool counts = !jumps && std::find(skipped.begin(), skipped.end(), row) == skipped.end();
    n += counts ? 1 : 0;
    for (const std::string& column : compared) {
      const double wanted = oracle.column(column)[row], error = std::fabs(seen(part, column, names) - wanted);
      greatest[column] = std::max(greatest[column], std::fabs(wanted));
      if (!counts) continue;
      errors[column].rms += error * error;
      if (!(error <= errors[column].most)) {  // also where it is no number
        errors[column].most = error;
        errors[column].row = row;
      }
    }
  });
  for (auto& [column, error] : errors) {
    const double scale = greatest[column] > 0.0 ? greatest[column] : 1.0;
    error.most /= scale;
    error.rms = std::sqrt(error.rms / static_cast<double>(n)) / scale;
  }
  return errors;
}

}  // namespace kerf::test
