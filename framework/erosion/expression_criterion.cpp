// Erosion where a condition holds that the user writes, of variables of the laws and of the stress.
#include <algorithm>
#include <array>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "core/diagnostics.hpp"
#include "core/dimensions.hpp"
#include "kerf/erosion.hpp"

namespace {

using namespace kerf;

/// What every point knows without a law that keeps it.
struct Known {
  const char* name;
  const char* unit;
};
constexpr std::array known = {
    Known{"pressure", "Pa"},           Known{"von_mises", "Pa"},          Known{"triaxiality", "-"},
    Known{"principal_stress_1", "Pa"}, Known{"principal_stress_2", "Pa"}, Known{"principal_stress_3", "Pa"},
    Known{"stress_xx", "Pa"},          Known{"stress_yy", "Pa"},          Known{"stress_zz", "Pa"},
    Known{"stress_xy", "Pa"},          Known{"stress_yz", "Pa"},          Known{"stress_zx", "Pa"},
    Known{"density_ratio", "-"},       Known{"volume_ratio", "-"},        Known{"time", "s"},
    Known{"stable_step", "s"}};

int place_of(const std::string& name) {
  const auto* found = std::find_if(known.begin(), known.end(), [&](const Known& k) { return name == k.name; });
  return found == known.end() ? -1 : static_cast<int>(found - known.begin());
}

/// Rows of what every point knows, in the order of `known`.
struct KnownRows {
  alignas(64) double rows[known.size()][lane_width];

  explicit KnownRows(const ErosionBatch& b) {
    for (int l = 0; l < lane_width; ++l) {
      const SymTensor stress = detail::tensor_at(b.stress, l);
      const double q = von_mises(deviator(stress)), p = b.pressure[l];
      const double first = largest_principal(stress), third = -largest_principal(-1.0 * stress);
      const double values[] = {p,
                               q,
                               clamp_to(-p / (q + tiny<double>), -100.0, 100.0),
                               first,
                               stress.trace() - first - third,
                               third,
                               stress.xx,
                               stress.yy,
                               stress.zz,
                               stress.xy,
                               stress.yz,
                               stress.zx,
                               b.density_ratio[l],
                               b.volume_ratio[l],
                               b.time,
                               b.time_step[l]};
      static_assert(std::size(values) == known.size());
      for (std::size_t k = 0; k < known.size(); ++k) rows[k][l] = values[k];
    }
  }
};

/// Fails a point where the condition holds.
struct ExpressionCriterion final : ErosionCriterion {
  Expression condition;

  static void describe(Schema<ExpressionCriterion>& s) {
    s.expression(&ExpressionCriterion::condition, "expression", "-", {},
                 "condition at which a point fails, such as \"damage > 0.9 and pressure < -1.2 GPa\"; of the state "
                 "variables of all laws of the material, and of pressure, von_mises, triaxiality, principal_stress_1 "
                 "to principal_stress_3, stress_xx to stress_zx, density_ratio, volume_ratio, time and stable_step");
    describe_interval(s);
  }

  /// Variables of laws, in the order of the expression. What no law declares is told by complaints().
  std::vector<ReadVariable> reads() const override {
    std::vector<ReadVariable> all;
    for (const std::string& name : condition.variables()) {
      if (place_of(name) >= 0) continue;
      ReadVariable r;
      r.name = name;
      r.doc = "named in the expression";
      r.index = static_cast<int>(all.size());
      r.is_optional = true;
      r.name_of = [name](const Plugin&) { return name; };
      all.push_back(std::move(r));
    }
    return all;
  }

  std::vector<ReadComplaint> complaints(const std::map<std::string, std::string>& units) const override {
    std::vector<ReadComplaint> all;
    if (condition.variables().empty())
      all.push_back(
          {"expression", 0, "the condition names no variable, so that it holds always or never; expected one"});
    if (condition.variables().size() > most_variables)
      all.push_back({"expression", 0, fmt::format("expected at most {} different variables", most_variables)});
    complain_of_variables(units, all);
    const auto unit_of = [&](const std::string& name) -> std::optional<std::string> {
      if (const int k = place_of(name); k >= 0) return known[static_cast<std::size_t>(k)].unit;
      const auto found = units.find(name);
      return found == units.end() ? std::nullopt : std::optional(found->second);
    };
    for (const DimensionFault& f : faults_of_condition(condition, unit_of))
      all.push_back({"expression", f.offset, f.sentence});
    return all;
  }

  /// A condition that is unknown, NaN, is told by who asks.
  void judge(const ErosionBatch& b) const override {
    const KnownRows at_point(b);
    std::array<const double*, most_variables> rows{};
    std::size_t n = 0, n_read = 0;
    for (const std::string& name : condition.variables()) {
      const int k = place_of(name);
      rows[n++] = k >= 0 ? at_point.rows[k] : b.reads[n_read++];
    }
    condition.values(rows.data(), b.failed);
    std::copy_n(rows[0], lane_width, b.value);
  }

 private:
  static constexpr std::size_t most_variables = 64;

  /// Where a variable first stands in the text.
  int offset_of(std::size_t variable) const {
    for (const Expression::Instruction& i : condition.program())
      if (i.op == Expression::Op::variable && i.index == static_cast<int>(variable)) return i.offset;
    return 0;
  }
  void complain_of_variables(const std::map<std::string, std::string>& units, std::vector<ReadComplaint>& all) const {
    std::vector<std::string> names;
    for (const Known& k : known) names.emplace_back(k.name);
    for (const auto& [name, unit] : units)
      if (place_of(name) < 0) names.push_back(name);
    for (std::size_t i = 0; i < condition.variables().size(); ++i) {
      const std::string& name = condition.variables()[i];
      if (place_of(name) >= 0 && name != "pressure" && units.contains(name))
        all.push_back({"expression", offset_of(i),
                       fmt::format("a law of the material keeps a variable \"{}\" too, and nobody could know which is "
                                   "meant; expected another variable",
                                   name)});
      if (place_of(name) >= 0 || units.contains(name)) continue;
      const std::string near = nearest_name(name, names);
      all.push_back({"expression", offset_of(i),
                     fmt::format("there is no variable \"{}\"{}; the variables are {}", name,
                                 near.empty() ? "" : fmt::format("; did you mean {}?", near), fmt::join(names, ", "))});
    }
  }
};

}  // namespace

KERF_EROSION(ExpressionCriterion, "expression", "a condition holds that the user writes")
