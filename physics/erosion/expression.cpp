// Erosion where a condition holds that the user writes, of variables of the laws and of the stress.
#include <algorithm>
#include <array>
#include <iterator>
#include <string>
#include <vector>

#include <kerf/erosion.hpp>
#include <kerf/law_use.hpp>

namespace {

using namespace kerf;

/// What every point knows without a law that keeps it.
constexpr std::array known = {KnownVariable{"pressure", "Pa"},
                              KnownVariable{"von_mises", "Pa"},
                              KnownVariable{"triaxiality", "-"},
                              KnownVariable{"principal_stress_1", "Pa"},
                              KnownVariable{"principal_stress_2", "Pa"},
                              KnownVariable{"principal_stress_3", "Pa"},
                              KnownVariable{"stress_xx", "Pa"},
                              KnownVariable{"stress_yy", "Pa"},
                              KnownVariable{"stress_zz", "Pa"},
                              KnownVariable{"stress_xy", "Pa"},
                              KnownVariable{"stress_yz", "Pa"},
                              KnownVariable{"stress_zx", "Pa"},
                              KnownVariable{"density_ratio", "-"},
                              KnownVariable{"volume_ratio", "-"},
                              KnownVariable{"time", "s"},
                              KnownVariable{"stable_step", "s"}};

int place_of(const std::string& name) {
  const auto* found = std::find_if(known.begin(), known.end(), [&](const KnownVariable& k) { return name == k.name; });
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
struct ExpressionCriterion final : ErosionCriterion, ConditionalLaw {
  Expression condition;

  static void describe(Schema<ExpressionCriterion>& s) {
    s.expression(&ExpressionCriterion::condition, "expression", "-", {},
                 "condition at which a point fails, such as \"damage > 0.9 and pressure < -1.2 GPa\"; of the state "
                 "variables of all laws of the material, and of pressure, von_mises, triaxiality, principal_stress_1 "
                 "to principal_stress_3, stress_xx to stress_zx, density_ratio, volume_ratio, time and stable_step");
    describe_interval(s);
  }

  /// Variables of laws, in the order of the expression. What no law declares is told of conditions().
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

  std::vector<VariableCondition> conditions() const override {
    return {{"expression", &condition, {known.begin(), known.end()}}};
  }

  std::vector<ReadComplaint> complaints(const std::map<std::string, std::string>&) const override {
    if (condition.variables().size() <= most_variables) return {};
    return {{"expression", 0, "expected at most " + std::to_string(most_variables) + " different variables"}};
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
};

}  // namespace

KERF_EROSION(ExpressionCriterion, "expression", "a condition holds that the user writes")
