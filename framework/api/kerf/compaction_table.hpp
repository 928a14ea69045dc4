// Pressure of materials that are compacted for good: a table of the first compression, with memory of the greatest.
//
// For soils, foams and powders. Source of the form: R.D. Krieg, "A simple constitutive description for cellular
// concrete", Sandia National Laboratories SC-DR-72-0883 (1972).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "kerf/math.hpp"
#include "kerf/schema.hpp"

namespace kerf {

/// While the compaction x grows beyond all it has been, the pressure follows the table, and its last slope beyond the
/// table. Else it is p(x_max) - K (x_max - x), a straight line with the unloading modulus K of the greatest compaction
/// x_max (linear in the table, constant beyond), or, where so chosen, the table's again. x is -ln V or mu = 1/V - 1, V
/// the volume over the undeformed one.
///
/// A law derives from it, declares its parameters with describe_table, and keeps x_max as a state variable.
struct CompactionTable {
  std::vector<double> compactions;  // x, first 0, ascending [-]
  std::vector<double> pressures;  // p, first 0, never falling [Pa]
  std::vector<double> unloading_moduli;  // dp/dx; one for all, or one per point [Pa]
  std::string measure = "logarithmic", unloading = "by_modulus";

  /// Declares compaction_measure, compactions, pressures, unloading and unloading_moduli. `T` derives from
  /// CompactionTable.
  template <class T>
  static void describe_table(Schema<T>& s) {
    using Table = CompactionTable;
    s.choice(&Table::measure, "compaction_measure", {"logarithmic", "mu"},
             "what `compactions` are: -ln V, or mu = 1/V - 1, V the volume over the undeformed volume")
        .by_default("logarithmic");
    s.reals(&Table::compactions, "compactions", "-", non_negative, "abscissae of the table, ascending from 0");
    s.reals(&Table::pressures, "pressures", "Pa", non_negative,
            "pressure in the first compression at each of `compactions`, from 0, never falling");
    s.choice(&Table::unloading, "unloading", {"by_modulus", "along_table"},
             "by unloading_moduli, so that compaction lasts, or along the table, so that none does")
        .by_default("by_modulus");
    s.reals(&Table::unloading_moduli, "unloading_moduli", "Pa", positive,
            "slope of the pressure over the compaction where it is less than it has been: one for all, or one for each "
            "of `compactions` as the greatest one")
        .optional();
    s.rule("compactions", "compactions must be two or more values that ascend from 0",
           [](const Table& t) { return t.ascends(); });
    s.rule("pressures", "pressures must be as many values as compactions, start with 0 and never fall",
           [](const Table& t) { return t.never_falls(); });
    s.rule("unloading_moduli", "unloading_moduli must be one value, or as many as compactions", [](const Table& t) {
      return t.unloading_moduli.size() == 1 || t.unloading_moduli.size() == t.compactions.size();
    });
    s.rule("unloading_moduli",
           "unloading_moduli must be above the slope of the pressures that leads up to each point, else a cycle of "
           "unloading and loading would gain energy",
           [](const Table& t) { return t.dissipates(); });
  }

  /// x of a volume over the undeformed volume; negative in expansion.
  double compaction_of(double volume_ratio) const {
    return select(is_mu(), 1.0 / volume_ratio - 1.0, -positive_log(volume_ratio));
  }

  /// Pressure at the compactions `x` of a block, and its greater slope rho dp/drho, that of unloading where it is the
  /// greater [Pa]. `greatest` is raised to x where that is more. There is no limit of tension: below x = 0 the line of
  /// unloading goes on, or the first slope of the table.
  void evaluate(const double (&x)[lane_width], double (&greatest)[lane_width], double (&pressure)[lane_width],
                double (&modulus)[lane_width]) const {
    alignas(64) double most[lane_width], first[lane_width], slope[lane_width], back[lane_width];
    const bool lasts = is_lasting(), mu = is_mu();
    for (int l = 0; l < lane_width; ++l) {
      greatest[l] = max_of(greatest[l], x[l]);
      most[l] = select(lasts, greatest[l], x[l]);
    }
    look_up(pressures, most, first, slope);
    for (int l = 0; l < lane_width; ++l) back[l] = 0.0;
    if (lasts) look_up(unloading_moduli, most, back);
#pragma omp simd
    for (int l = 0; l < lane_width; ++l) {
      pressure[l] = first[l] - back[l] * (most[l] - x[l]);
      modulus[l] = max_of(slope[l], back[l]) * select(mu, 1.0 + x[l], 1.0);
    }
  }

  /// Values at abscissae `x` >= 0 and their slopes, linear between points; beyond the last point the last slope goes
  /// on. Pre: as many values as abscissae.
  void look_up(const std::vector<double>& values, const double (&x)[lane_width], double (&value)[lane_width],
               double (&slope)[lane_width]) const {
    const std::size_t n_segments = compactions.size() - 1;
    for (int l = 0; l < lane_width; ++l) value[l] = values[0];
    for (std::size_t i = 0; i < n_segments; ++i) {
      const double begin = compactions[i], at_begin = values[i];
      const double rise = (values[i + 1] - at_begin) / (compactions[i + 1] - begin);
#pragma omp simd
      for (int l = 0; l < lane_width; ++l) {
        const bool here = (x[l] >= begin) | (i == 0);
        value[l] = select(here, at_begin + rise * (x[l] - begin), value[l]);
        slope[l] = select(here, rise, slope[l]);
      }
    }
  }
  /// The same without slopes, and constant beyond the last point. One value stands for all abscissae.
  void look_up(const std::vector<double>& values, const double (&x)[lane_width], double (&value)[lane_width]) const {
    for (int l = 0; l < lane_width; ++l) value[l] = values.back();
    if (values.size() == 1) return;
    alignas(64) double inside[lane_width], slope[lane_width];
    for (int l = 0; l < lane_width; ++l) inside[l] = min_of(x[l], compactions.back());
    look_up(values, inside, value, slope);
  }

 private:
  bool is_mu() const { return measure.front() == 'm'; }
  bool is_lasting() const { return unloading.front() == 'b'; }
  bool has_right_moduli() const {
    const std::size_t n = unloading_moduli.size();
    return is_lasting() ? n == 1 || n == compactions.size() : n == 0;
  }
  bool ascends() const {
    if (compactions.size() < 2 || compactions[0] != 0.0) return false;
    for (std::size_t i = 1; i < compactions.size(); ++i)
      if (!(compactions[i] > compactions[i - 1])) return false;
    return true;
  }
  bool never_falls() const {
    if (pressures.size() != compactions.size() || pressures.empty() || pressures[0] != 0.0) return false;
    for (std::size_t i = 1; i < pressures.size(); ++i)
      if (pressures[i] < pressures[i - 1]) return false;
    return true;
  }
  /// Lines of unloading from the table's points lie below the curve. Pre, else true: the other rules hold.
  bool dissipates() const {
    if (!ascends() || !never_falls() || !has_right_moduli() || !is_lasting()) return true;
    for (std::size_t i = 1; i < compactions.size(); ++i) {
      const double slope = (pressures[i] - pressures[i - 1]) / (compactions[i] - compactions[i - 1]);
      const double modulus = unloading_moduli.size() == 1  ? unloading_moduli[0]
                             : i < unloading_moduli.size() ? unloading_moduli[i]
                                                           : slope + 1.0;
      if (!(modulus > slope)) return false;
    }
    return true;
  }
};

}  // namespace kerf
