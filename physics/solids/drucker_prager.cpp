// Soils, sands, weak rocks and crushable foams: strength that depends on pressure, and compaction that lasts.
//
// Sources: D.C. Drucker & W. Prager, "Soil mechanics and plastic analysis or limit design", Q. Appl. Math. 10 (1952)
// 157-165; R.D. Krieg, "A simple constitutive description for cellular concrete", Sandia National Laboratories
// SC-DR-72-0883 (1972).
#include <kerf/compaction_table.hpp>
#include <kerf/law_use.hpp>
#include <kerf/solid.hpp>

#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

namespace {

using namespace kerf;

constexpr double absent = std::numeric_limits<double>::quiet_NaN();

/// The deviator is scaled back, at constant pressure, to q <= c + p tan b or J2 <= a0 + a1 p + a2 p^2; no dilatancy.
/// The pressure is that of a table of compaction with memory, not below a limit of tension.
///
/// A law for blocks rather than points: the table is looked up segment by segment for all points of a block.
struct DruckerPrager final : Solid, CompactionTable, WarningLaw {
  double G = 0.0, tension_limit = 0.0, zero_strength_pressure = absent;  // [Pa]
  double most_strength = std::numeric_limits<double>::infinity();  // [Pa]
  std::string yield = "linear";
  double c = absent, tan_b = absent;  // [Pa], [-]
  double a0 = absent, a1 = absent, a2 = absent;  // [Pa2], [Pa], [-]
  double cohesion = absent, friction_angle = absent;  // [Pa], [rad]

  struct State {
    double effective_plastic_strain, greatest_compaction;
  };

  static void describe(Schema<DruckerPrager>& s) {
    using D = DruckerPrager;
    s.real(&D::G, "shear_modulus", "Pa", positive, "elastic shear modulus");
    s.choice(&D::yield, "yield", {"linear", "quadratic", "mohr_coulomb"},
             "q <= strength_at_no_pressure + slope p, J2 <= a0 + a1 p + a2 p^2, or `linear` by cohesion and angle")
        .by_default("linear");
    s.real(&D::c, "strength_at_no_pressure", "Pa", non_negative, "von Mises stress of the linear cone at p = 0")
        .optional();
    s.real(&D::tan_b, "slope", "-", non_negative, "slope tan b of the linear cone, von Mises stress over pressure")
        .optional();
    s.real(&D::a0, "a0", "Pa2", non_negative, "J2 of the quadratic form at p = 0").optional();
    s.real(&D::a1, "a1", "Pa", non_negative, "slope of J2 over pressure of the quadratic form at p = 0").optional();
    s.real(&D::a2, "a2", "-", non_negative, "coefficient of the pressure squared in the quadratic form").optional();
    s.real(&D::cohesion, "cohesion", "Pa", non_negative, "of Mohr and Coulomb").optional();
    s.real(&D::friction_angle, "friction_angle", "rad", Range{0.0, 1.5, false, true},
           "of Mohr and Coulomb; the cone goes through the edges of compression")
        .optional();
    s.real(&D::most_strength, "most_strength", "Pa", positive,
           "the von Mises stress is never more; no limit where absent")
        .optional();
    s.real(&D::tension_limit, "tension_limit", "Pa", non_negative, "the pressure is never below minus this")
        .by_default("0 Pa");
    s.real(&D::zero_strength_pressure, "zero_strength_pressure", "Pa", any_value,
           "there is no strength at or below this pressure; by default minus tension_limit")
        .optional();
    describe_table(s);
    s.rule("yield", "yield: linear takes strength_at_no_pressure and slope, and nothing of the other forms",
           [](const D& d) { return d.yield != "linear" || (d.has_linear() && d.n_given() == 2); });
    s.rule("yield", "yield: quadratic takes a0, a1 and a2, and nothing of the other forms",
           [](const D& d) { return d.yield != "quadratic" || (d.has_quadratic() && d.n_given() == 3); });
    s.rule("yield", "yield: mohr_coulomb takes cohesion and friction_angle, and nothing of the other forms",
           [](const D& d) { return d.yield != "mohr_coulomb" || (d.has_mohr_coulomb() && d.n_given() == 2); });
    s.state(&State::effective_plastic_strain, "effective_plastic_strain", "-", 0.0,
            "equivalent plastic strain of the change of shape")
        .within(non_negative);
    s.state(&State::greatest_compaction, "greatest_compaction", "-", 0.0,
            "greatest compaction so far, by compaction_measure")
        .within(non_negative);
  }

  double cost() const override { return 6.0; }

  /// Limits that contradict the yield surface.
  std::vector<std::string> warnings(LawUse&) const override {
    const YieldSurface y = yield_surface();
    std::vector<std::string> lines;
    // At the apex a cone leaves round-off of its s0.
    const double apex = y.lowest, at_rest = std::sqrt(y.s0);
    const bool ends_at_apex = y.s2 > 0.0 && y.s0 + 0.5 * y.s1 * apex <= 1e-9 * y.s0;
    if (y.zero >= 0.0 && at_rest > 0.0)
      lines.push_back(
          text("there is no strength at a pressure of %.3g Pa and below, which takes the strength of %.3g Pa at no "
               "pressure away: what is not pressed flows freely; give a zero_strength_pressure or a tension_limit",
               y.zero, at_rest));
    if (ends_at_apex && -tension_limit < apex * (1.0 + 1e-9) && tension_limit > 0.0 && at_rest > 0.0)
      lines.push_back(
          text("tension_limit of %.3g Pa lies beyond the apex of the yield surface at %.3g Pa, where there "
               "is no strength; check both",
               tension_limit, apex));
    if (most_strength <= at_rest)
      lines.push_back(
          text("most_strength of %.3g Pa is not above the strength of %.3g Pa at no pressure, so that "
               "pressure adds none; check both",
               most_strength, at_rest));
    return lines;
  }

  void update(const SolidBatch& b) const override {
    alignas(64) double x[lane_width], pressure[lane_width], bulk[lane_width], out[6][lane_width];
    detail::LaneVariables<State> state;
    state.read(b.state);
    const double reference_density = b.reference_density;
#pragma omp simd
    for (int l = 0; l < lane_width; ++l) x[l] = compaction_of(reference_density / b.density[l]);
    evaluate(x, state.values[compaction_row], pressure, bulk);
    const YieldSurface surface = yield_surface();
#pragma omp simd
    for (int l = 0; l < lane_width; ++l) {
      const double p = max_of(pressure[l], -tension_limit);
      const SymTensor trial =
          detail::tensor_at(b.deviator, l) + (2.0 * G) * deviator(detail::tensor_at(b.strain_increment, l));
      const double q = von_mises(trial), now = min_of(q, surface.strength(p));
      detail::set_tensor(out, l, (now / (q + tiny<double>)) * trial);
      state.values[strain_row][l] += (q - now) / (3.0 * G);
      pressure[l] = p;
    }
    for (int l = 0; l < lane_width; ++l) {
      for (int i = 0; i < 6; ++i) b.deviator[i][l] = out[i][l];
      b.pressure[l] = pressure[l];
      b.shear_modulus[l] = G;
      b.bulk_modulus[l] = bulk[l];
    }
    state.write(b.state);
  }

 private:
  static std::string text(const char* format, double first, double second) {
    char line[256];
    std::snprintf(line, sizeof line, format, first, second);
    return line;
  }

  enum : int { strain_row, compaction_row, n_rows };  // as in State
  static_assert(n_doubles<State> == n_rows);

  /// All forms as one: q <= sqrt(s0 + s1 p + s2 p^2), at p not below the parabola's lowest point, and not above `most`.
  struct YieldSurface {
    double s0, s1, s2, lowest, zero, most;

    double strength(double pressure) const {
      const double p = max_of(pressure, lowest);
      const double q = min_of(std::sqrt(max_of(s0 + (s1 + s2 * p) * p, 0.0)), most);
      return select(pressure <= zero, 0.0, q);
    }
  };
  /// With d the strength and t the slope of a cone, q^2 <= (d + t p)^2 for p above its apex. The compression cone of
  /// Mohr and Coulomb: t = 6 sin f / (3 - sin f), d = 6 C cos f / (3 - sin f) with cohesion C and angle f.
  YieldSurface yield_surface() const {
    const bool by_angle = yield == "mohr_coulomb", by_j2 = yield == "quadratic";
    const double below = by_angle ? 3.0 - kerf::sin(friction_angle) : 1.0;
    const double t = by_angle ? 6.0 * kerf::sin(friction_angle) / below : tan_b;
    const double d = by_angle ? 6.0 * cohesion * kerf::cos(friction_angle) / below : c;
    YieldSurface y;
    y.s0 = by_j2 ? 3.0 * a0 : d * d;
    y.s1 = by_j2 ? 3.0 * a1 : 2.0 * d * t;
    y.s2 = by_j2 ? 3.0 * a2 : t * t;
    y.lowest = y.s2 > 0.0 ? -0.5 * y.s1 / y.s2 : -std::numeric_limits<double>::infinity();
    y.zero = std::isnan(zero_strength_pressure) ? -tension_limit : zero_strength_pressure;
    y.most = most_strength;
    return y;
  }

  bool has_linear() const { return !std::isnan(c) && !std::isnan(tan_b); }
  bool has_quadratic() const { return !std::isnan(a0) && !std::isnan(a1) && !std::isnan(a2); }
  bool has_mohr_coulomb() const { return !std::isnan(cohesion) && !std::isnan(friction_angle); }
  int n_given() const {
    int n = 0;
    for (const double v : {c, tan_b, a0, a1, a2, cohesion, friction_angle}) n += std::isnan(v) ? 0 : 1;
    return n;
  }
};

}  // namespace

KERF_SOLID(DruckerPrager, "drucker_prager",
           "soil, sand, weak rock and foam: strength over pressure, lasting compaction")
