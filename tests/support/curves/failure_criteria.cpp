// Files about criteria of failure: sums along a path without feedback, softening, and what
// becomes of a point that has failed.
#include <algorithm>
#include <cmath>

#include "erosion/neighbourhood.hpp"
#include "support/curves.hpp"
#include "support/points.hpp"

namespace kerf::test {

namespace {

/// The greatest error of a column, over its greatest value.
class ColumnError {
 public:
  ColumnError(const Oracle& oracle, std::string column, double tolerance, double most = 1e300)
      : wanted_(oracle.column(column)), most_(most), result_{std::move(column), 0.0, tolerance, 0} {
    for (const double v : wanted_) scale_ = std::max(scale_, std::fabs(std::min(v, most)));
  }
  /// Values above `most` count as that: a criterion has nothing to say about what has failed.
  void see(std::size_t row, double value) {
    const double error = std::fabs(std::min(value, most_) - std::min(wanted_[row], most_)) / std::max(scale_, 1e-300);
    if (error <= result_.error) return;
    result_.error = error;
    result_.row = row;
  }
  const CurveResult& result() const { return result_; }

 private:
  const std::vector<double>& wanted_;
  double most_, scale_ = 0.0;
  CurveResult result_;
};

std::string list(const nlohmann::json& numbers, const std::vector<const char*>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i > 0 ? ", " : "") + key_and_number(names[i], numbers.at(i).get<double>());
  return text;
}

// ---- sums along a path, without feedback ----------------------------------------------------------------------------

bool is_path_of_failure(const Oracle& o) { return o.failure.is_object() && o.path.is_object(); }

PartLaws laws_of_failure(const Oracle& o) {
  PartLaws laws;
  Oracle material = o;
  material.parameters = o.material;
  set_eos(material, laws);
  laws.element = "{linear_viscosity: 0, quadratic_viscosity: 0}";
  laws.strength = "johnson_cook";
  laws.strength_parameters = "{" +
                             material.text({{"shear_modulus", "G"},
                                            {"A", "A"},
                                            {"B", "B"},
                                            {"n", "n"},
                                            {"C", "C"},
                                            {"m", "m"},
                                            {"reference_rate", "reference_rate"},
                                            {"reference_temperature", "reference_temperature"},
                                            {"melting_temperature", "melting_temperature"},
                                            {"initial_temperature", "initial_temperature"},
                                            {"specific_heat", "specific_heat"},
                                            {"taylor_quinney", "taylor_quinney"}}) +
                             "}";
  const auto number = [&](const char* ours, const char* theirs) {
    return key_and_number(ours, o.failure.at(theirs).get<double>());
  };
  laws.rule = "all";  // with one that never fails, so that the path goes on
  laws.criteria = {
      {"johnson_cook_damage", "{" + list(o.failure.at("D"), {"D1", "D2", "D3", "D4", "D5"}) + ", " +
                                  number("reference_rate", "rate0") + ", " + number("reference_temperature", "Tr") +
                                  ", " + number("melting_temperature", "Tm") + "}"},
      {"cockcroft_latham", "{limit: 1e30}"},
      {"rice_tracey", "{limit: 1e30}"},
      {"hancock_mackenzie", "{" + list(o.failure.at("hm"), {"nucleation_strain", "growth_strain"}) + "}"},
      {"tuler_butcher", "{" + list(o.failure.at("tb"), {"threshold_stress", "exponent"}) + ", limit: 1e300}"},
      {"maximum_shear", "{limit: 1e30, measure: tensor}"}};
  return laws;
}

std::vector<CurveResult> check_path_of_failure(const Oracle& o) {
  const double tolerance = 2e-3;  // physics.md, section 10: failure integrals
  struct Shown {
    ColumnError error;
    std::string variable;
  };
  std::vector<Shown> shown;
  const auto show = [&](const char* column, const char* variable, double most = 1e300) {
    if (o.has(column)) shown.push_back({ColumnError(o, column, tolerance, most), variable});
  };
  show("johnson_cook_damage", "damage", 1.0);
  show("cockcroft_latham_Pa", "cockcroft_latham_work");
  show("rice_tracey_ln_R", "void_growth");
  show("hancock_mackenzie_damage", "hancock_mackenzie_damage", 1.0);
  for (const auto& [column, values] : o.columns)
    if (column.starts_with("tuler_butcher")) show(column.c_str(), "tuler_butcher_impulse");
  show("max_tensor_shear_strain", "maximum_shear_strain");
  std::vector<ColumnError> volumetric;
  if (o.has("volumetric_strain")) volumetric.emplace_back(o, "volumetric_strain", tolerance);
  ErosionPoint by_volume(make_law<ErosionCriterion>("erosion", "volumetric_strain", "{tension_limit: 100}"));

  const PartLaws laws = laws_of_failure(o);
  const int rows = static_cast<int>(o.n_rows()) - 1;
  drive(o, laws, std::max(4000 / rows, 1), [&](const CellPart<double>& part, std::size_t row) {
    for (Shown& s : shown) s.error.see(row, part.variable(s.variable, 0));
    ErosionInputPoint in;
    in.volume_ratio = part.get(PartStore::volume, 0) * laws.density / part.element_mass(0);
    for (ColumnError& v : volumetric) v.see(row, by_volume.judge(in).value);
  });
  std::vector<CurveResult> results;
  for (const Shown& s : shown) results.push_back(s.error.result());
  for (const ColumnError& v : volumetric) results.push_back(v.result());
  return results;
}

// ---- closed forms ---------------------------------------------------------------------------------------------------

/// The number that follows a word in the comments of a file.
double number_after(const Oracle& o, const std::string& word) {
  for (const std::string& line : o.comments)
    if (const std::size_t at = line.find(word); at != std::string::npos)
      return std::stod(line.substr(at + word.size()));
  throw std::runtime_error(o.name + " does not say: " + word);
}

bool is_gissmo(const Oracle& o) { return o.has("instability") && o.has("stress_factor"); }

std::vector<CurveResult> check_gissmo(const Oracle& o) {
  const double tolerance = 1e-6;  // physics.md, section 10: closed forms
  const double n = number_after(o, "DMGEXP n = "), failure = number_after(o, "failure strain "),
               critical = number_after(o, "ECRIT "), fading = number_after(o, "FADEXP ");
  std::string table;
  for (const std::string& line : o.comments)
    if (const std::size_t at = line.find("[["); at != std::string::npos)
      table = line.substr(at, line.find("]]") + 2 - at);
  std::string lengths, factors;
  for (const auto& pair : nlohmann::json::parse(table)) {
    lengths += (lengths.empty() ? "" : ", ") + pair.at(0).dump();
    factors += (factors.empty() ? "" : ", ") + pair.at(1).dump();
  }
  const std::string law = "{" + key_and_number("failure_strain", failure) + ", " +
                          key_and_number("critical_strain", critical) + ", " + key_and_number("damage_exponent", n) +
                          ", softening: stress, " + key_and_number("softening_exponent", fading) +
                          ", element_lengths: [" + lengths + "], length_factors: [" + factors + "]}";
  ColumnError damage(o, "damage", tolerance), instability(o, "instability", tolerance),
      factor(o, "stress_factor", tolerance);
  std::unique_ptr<ErosionPoint> point;
  const auto& strain = o.column("effective_plastic_strain");
  const auto& length = o.column("element_length_m");
  for (std::size_t row = 0; row < o.n_rows(); ++row) {
    const bool starts = row == 0 || length[row] != length[row - 1];
    if (starts)
      point = std::make_unique<ErosionPoint>(make_law<ErosionCriterion>("erosion", "ductile_damage", law), length[row]);
    ErosionInputPoint in;
    in.dt = 1e-6;
    in.stress = {0.0, 0.0, 0.0, 1e6, 0.0, 0.0};
    Verdict v;
    const double from = starts ? 0.0 : strain[row - 1];
    for (int i = starts ? 0 : 1; i <= 7; ++i) v = point->judge(in, from + (strain[row] - from) * i / 7.0);
    damage.see(row, point->state("damage"));
    instability.see(row, point->state("instability"));
    factor.see(row, v.strength);
  }
  return {damage.result(), instability.result(), factor.result()};
}

bool is_fracture_energy(const Oracle& o) { return o.has("damage_linear") && o.has("damage_exponential"); }

std::vector<CurveResult> check_fracture_energy(const Oracle& o) {
  const double tolerance = 1e-6;  // physics.md, section 10: closed forms
  const double stress = number_after(o, "flow stress "), onset = number_after(o, "softening starts at plastic strain "),
               energy = number_after(o, "Gf = ");
  std::vector<CurveResult> results;
  for (const std::string form : {"linear", "exponential"}) {
    const std::string law = "{" + key_and_number("failure_strain", onset) + ", softening: " + form + ", " +
                            key_and_number("fracture_energy", energy) + "}";
    ColumnError damage(o, "damage_" + form, tolerance), left(o, "stress_" + form + "_Pa", tolerance),
        taken(o, "energy_per_area_" + form + "_J_m2", tolerance);
    const auto& strain = o.column("effective_plastic_strain");
    const auto& length = o.column("element_length_m");
    std::unique_ptr<ErosionPoint> point;
    double work = 0.0, share = 1.0;
    const int steps = 300;  // per row: the work is summed by the rule of the trapezium
    for (std::size_t row = 0; row < o.n_rows(); ++row) {
      const bool starts = row == 0 || length[row] != length[row - 1];
      if (starts)
        point =
            std::make_unique<ErosionPoint>(make_law<ErosionCriterion>("erosion", "ductile_damage", law), length[row]);
      ErosionInputPoint in;
      in.dt = 1e-6;
      in.stress = {0.0, 0.0, 0.0, stress / std::sqrt(3.0), 0.0, 0.0};
      const double from = starts ? 0.0 : strain[row - 1], step = (strain[row] - from) / steps;
      if (starts) work = 0.0, share = point->judge(in, 0.0).strength;
      for (int i = 1; i <= steps; ++i) {
        const double now = point->judge(in, from + i * step).strength;
        if (!starts) work += length[row] * stress * step * 0.5 * (share + now);
        share = now;
      }
      damage.see(row, 1.0 - share);
      left.see(row, stress * share);
      taken.see(row, work);
    }
    for (const ColumnError* e : {&damage, &left, &taken}) results.push_back(e->result());
  }
  return results;
}

// ---- what becomes of a point that has failed ------------------------------------------------------------------------

bool is_spall(const Oracle& o) { return o.has("p_option_1_Pa"); }

/// One element that is given the pressures of a file by its volume, with a deviator that is the file's sigma_1 + p.
class SpalledElement {
 public:
  SpalledElement(const Oracle& o, PartLaws laws)
      : oracle_(o), mesh_(distorted_block(1, 1, 1, 1e-3, 0.0, 1)), part_(mesh_, laws) {
    part_.initialise();
    s_ = o.column("sigma_1_Pa")[0] + o.column("eos_pressure_Pa")[0];
    part_.set_deviator(0, {s_, -0.5 * s_, -0.5 * s_, 0.0, 0.0, 0.0});
  }
  /// Two steps, the second at rest: what a criterion says acts from the next step on.
  void go_to(std::size_t row) {
    const double edge = std::cbrt(1.0 / (1.0 + oracle_.column("eos_pressure_Pa")[row] / bulk_modulus));
    std::vector<Vec3> to;
    for (const Vec3 x : mesh_.x) to.push_back(x * edge);
    part_.move_to(to, 1e-6);
    part_.move_to(to, 1e-6);
  }
  double pressure() const { return part_.pressure(0); }
  double deviator_factor() const { return part_.deviator(0).xx / s_; }

  static constexpr double bulk_modulus = 160e9;  // [Pa]

 private:
  const Oracle& oracle_;
  CellMesh mesh_;
  OnePart part_;
  double s_ = 0.0;  // [Pa]
};

std::vector<CurveResult> check_spall(const Oracle& o) {
  const double limit = number_after(o, "p_min = ");
  const double tolerance = 1e-6;  // physics.md, section 10: closed forms
  PartLaws clipped, by_stress, by_pressure;
  for (PartLaws* laws : {&clipped, &by_stress, &by_pressure}) {
    laws->element = "{linear_viscosity: 0, quadratic_viscosity: 0}";
    laws->eos_parameters = "{bulk_modulus: 160 GPa}";
  }
  clipped.eos_parameters = "{bulk_modulus: 160 GPa, " + key_and_number("tension_limit", -limit) + "}";
  // Some rows lie at the limit; round-off of the volume must not decide what they are.
  const double stress_limit = -limit * (1.0 - 1e-9), pressure_limit = limit * (1.0 + 1e-9);
  by_stress.criteria = {{"tensile_stress", "{then: no_tension, " + key_and_number("limit", stress_limit) + "}"}};
  by_pressure.criteria = {{"minimum_pressure", "{then: no_tension, " + key_and_number("limit", pressure_limit) + "}"}};
  std::vector<CurveResult> results;
  const auto run = [&](const PartLaws& laws, const char* pressure, const char* factor) {
    SpalledElement element(o, laws);
    ColumnError p(o, pressure, tolerance), f(o, factor != nullptr ? factor : pressure, tolerance);
    for (std::size_t row = 0; row < o.n_rows(); ++row) {
      element.go_to(row);
      p.see(row, element.pressure());
      if (factor != nullptr) f.see(row, element.deviator_factor());
    }
    results.push_back(p.result());
    if (factor != nullptr) results.push_back(f.result());
  };
  run(clipped, "p_option_1_Pa", nullptr);
  run(by_stress, "p_option_2_Pa", "deviator_factor_2");
  run(by_pressure, "p_option_3_Pa", "deviator_factor_3");
  return results;
}

// ---- averages over a neighbourhood ----------------------------------------------------------------------------------

bool is_nonlocal(const Oracle& o) { return o.has("average_bell"); }

std::vector<CurveResult> check_nonlocal(const Oracle& o) {
  const double tolerance = 1e-6;  // physics.md, section 10: closed forms
  const auto& x = o.column("x_m");
  // Whether points at just the radius count is decided by round-off: theirs are at (i + 1/2) h.
  const double h = std::round((x[1] - x[0]) * 1e12) * 1e-12, spacing = std::stod(std::to_string(h * 1e9)) / 1e9;
  std::vector<Neighbourhood::Point> points;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double place = (static_cast<double>(i) + 0.5) * spacing;
    points.push_back({static_cast<std::int64_t>(i),
                      {std::fabs(place - x[i]) < 1e-12 ? place : x[i], 0.0, 0.0},
                      o.column("volume_m3")[i]});
  }
  NonLocalAverage law;
  law.radius = number_after(o, "L = ");
  law.p = number_after(o, "p = ");
  law.q = number_after(o, "q = ");
  std::vector<CurveResult> results;
  for (const char* column : {"average_lsdyna", "average_bell"}) {
    law.bell = column == std::string("average_bell");
    const Neighbourhood neighbours(points, points.size(), law);
    ColumnError error(o, column, tolerance);
    for (std::size_t i = 0; i < x.size(); ++i) error.see(i, neighbours.average(i, o.column("local_value")));
    results.push_back(error.result());
  }
  return results;
}

const RegisterCurves nonlocal({"non-local average", is_nonlocal, check_nonlocal});
const RegisterCurves failure({"failure criteria", is_path_of_failure, check_path_of_failure});
const RegisterCurves gissmo({"ductile_damage", is_gissmo, check_gissmo});
const RegisterCurves fracture_energy({"softening by fracture energy", is_fracture_energy, check_fracture_energy});
const RegisterCurves spall({"no_tension", is_spall, check_spall});

}  // namespace

}  // namespace kerf::test
