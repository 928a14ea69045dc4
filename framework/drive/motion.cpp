// Straight lines between the strains of a path, and between the rows of a history.
#include "drive/motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "input/csv_table.hpp"

namespace kerf {

std::vector<double> Motion::moments() const {
  return path_.strain_rates.empty() ? times_ : std::vector<double>{0.0, times_.back()};
}

double Deformation::determinant() const {
  return f[0][0] * (f[1][1] * f[2][2] - f[1][2] * f[2][1]) - f[0][1] * (f[1][0] * f[2][2] - f[1][2] * f[2][0]) +
         f[0][2] * (f[1][0] * f[2][1] - f[1][1] * f[2][0]);
}

Motion::Motion(const PathInput& path, const std::string& file_text, const std::string& file_name) : path_(path) {
  if (path.type == "history") {
    read_history(file_text, file_name);
    return;
  }
  times_ = path.times;
  if (!times_.empty()) return;
  times_.push_back(0.0);
  for (std::size_t i = 1; i < path.strains.size(); ++i)
    times_.push_back(times_.back() + std::fabs(path.strains[i] - path.strains[i - 1]) / path.rate);
}

void Motion::read_history(const std::string& text, const std::string& name) {
  Diagnostics diagnostics;
  const CsvTable table = read_csv_table(text, name, diagnostics);
  diagnostics.throw_if_errors();
  const auto refuse = [&](const std::string& what) { throw InputError({fmt::format("{}: error: {}", name, what)}); };
  const auto time = table.columns.find("time_s");
  if (time == table.columns.end()) refuse("there is no column of numbers \"time_s\"; expected one");
  times_ = time->second;
  bool any = false;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const std::string heading = fmt::format("F_{}{}", "xyz"[i], "xyz"[j]);
      const auto column = table.columns.find(heading);
      if (column != table.columns.end()) {
        components_[3 * i + j] = column->second;
        any = true;
      } else if (std::find(table.headings.begin(), table.headings.end(), heading) != table.headings.end()) {
        refuse(fmt::format("the column \"{}\" holds something that is no number", heading));
      }
    }
  if (!any) refuse("there is no column of the deformation gradient; expected F_xx, F_xy ... F_zz, some of them");
  for (std::size_t r = 1; r < times_.size(); ++r)
    if (!(times_[r] > times_[r - 1])) refuse(fmt::format("times have to ascend, but row {} does not", r + 1));
  if (times_.size() < 2) refuse("there is one row; expected at least two");
  if (times_.front() != 0.0) refuse(fmt::format("the first time is {}; expected 0", times_.front()));
  for (const double t : times_)
    if (!(at(t).determinant() > 0.0))
      refuse(fmt::format("the determinant of the deformation gradient at {} s is {:.6g}; expected more than 0", t,
                         at(t).determinant()));
  const Deformation first = at(0.0), none;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (first.f[i][j] != none.f[i][j]) refuse("the first row has to be that of the undeformed element, F = 1");
}

double Motion::way(const std::vector<double>& rates, double time) const {
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < times_.size() && time > times_[i]; ++i) {
    const double end = std::min(time, times_[i + 1]), share = (end - times_[i]) / (times_[i + 1] - times_[i]);
    sum += (end - times_[i]) * (rates[i] + 0.5 * share * (rates[i + 1] - rates[i]));
  }
  return sum;
}

double Motion::along(const std::vector<double>& values, double time) const {
  const auto after = std::upper_bound(times_.begin(), times_.end(), time);
  if (after == times_.begin()) return values.front();
  if (after == times_.end()) return values.back();
  const auto i = static_cast<std::size_t>(after - times_.begin());
  const double share = (time - times_[i - 1]) / (times_[i] - times_[i - 1]);
  return values[i - 1] + share * (values[i] - values[i - 1]);
}

Deformation Motion::at(double time, double lateral_stretch) const {
  Deformation d;
  const double t = time - time_before_;
  if (path_.type == "history") {
    for (int k = 0; k < 9; ++k)
      if (!components_[k].empty()) d.f[k / 3][k % 3] = along(components_[k], t);
    return d;
  }
  const bool by_rates = !path_.strain_rates.empty();
  const double strain = strain_before_ + (by_rates ? way(path_.strain_rates, t) : along(path_.strains, t));
  if (path_.type == "simple_shear") {
    d.f[0][1] = strain;
    return d;
  }
  double lateral = 1.0;
  if (!path_.lateral_strains.empty()) lateral += along(path_.lateral_strains, t);
  if (!path_.lateral_strain_rates.empty()) lateral += way(path_.lateral_strain_rates, t);
  if (path_.type == "volumetric") lateral = 1.0 + strain;
  if (path_.keeps_lateral_stress()) lateral = lateral_stretch;
  d.f[0][0] = 1.0 + strain;
  d.f[1][1] = d.f[2][2] = lateral;
  return d;
}

}  // namespace kerf
