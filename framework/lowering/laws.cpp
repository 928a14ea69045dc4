// Laws of strength, one for each keyword *MAT_.
#include <fmt/format.h>

#include <algorithm>

#include "kerf/functions.hpp"
#include "lowering/material_parts.hpp"

namespace kerf::lowering {
namespace {

using decks::Block;
using decks::IdKind;

void elastic(Lowering& low, const Row& row, Material& made) {
  const Elastic constants = elastic_constants(low, row);
  add(made.node, "strength", strength(low, "elastic", constants));
  add(made.node, "eos", logarithmic(low, constants));
}

/// E Et / (E - Et), the slope over the plastic strain.
double hardening_modulus(Lowering& low, const Row& row, double young) {
  const double tangent = row.value("etan", pressure);
  if (tangent < young) return tangent * young / (young - tangent);
  low.error(row.origin("etan"), fmt::format("ETAN = {}; expected a tangent modulus below E = {}", tangent, young));
  return 0.0;
}

/// The rate of a law that depends on one.
void warn_of_rate(Lowering& low, const Row& row) {
  if (row.value("vp") != 1.0)
    low.differ(row.origin("vp"), fmt::format("*{} VP = {}: the rate is always that of the plastic strain",
                                             row.block().written, row.value("vp")));
}

/// By the constants of Cowper and Symonds, of which the first may be 0 for no rate.
bool is_rate_dependent(Lowering& low, const Row& row, const char* c, const char* p) {
  if (row.value(c, rate) == 0.0) return false;
  if (row.value(p) != 0.0) return true;
  low.error(row.origin(p), "the exponent of Cowper and Symonds is missing; expected a number above 0");
  return false;
}

void plastic_kinematic(Lowering& low, const Row& row, Material& made) {
  const Elastic constants = elastic_constants(low, row);
  const bool rates = is_rate_dependent(low, row, "src", "srp");
  const double beta = row.value("beta");
  Node law = strength(low, rates ? "cowper_symonds" : beta == 1.0 ? "elastic_plastic" : "mixed_hardening", constants);
  add(law, "yield_stress", row.quantity("sigy", pressure));
  add(law, "hardening_modulus",
      scalar(low.text(hardening_modulus(low, row, constants.young), pressure), row.origin("etan")));
  if (rates || beta != 1.0) add(law, "isotropic_share", row.quantity("beta"));
  if (rates) {
    add(law, "C", row.quantity("src", rate));
    add(law, "P", row.quantity("srp"));
    add(law, "strain_rate", scalar(row.value("vp") == 1.0 ? "plastic" : "total", row.origin("vp")));
  }
  add(made.node, "strength", std::move(law));
  add(made.node, "eos", logarithmic(low, constants));
  if (row.value("fs") > 0.0) made.criteria.push_back(plastic_strain_limit(row, "fs"));
}

void isotropic_elastic_plastic(Lowering& low, const Row& row, Material& made) {
  Elastic constants{row.value("g", pressure), row.value("bulk", pressure), 0.0, row.origin("g")};
  Node law = strength(low, "elastic_plastic", constants);
  add(law, "yield_stress", row.quantity("sigy", pressure));
  add(law, "hardening_modulus", row.quantity("etan", pressure));
  constants.origin = row.origin("bulk");
  add(made.node, "strength", std::move(law));
  add(made.node, "eos", logarithmic(low, constants));
}

void high_explosive(Lowering& low, const Row& row, Material& made) {
  add(made.node, "strength", typed("hydrodynamic", row.origin()));
  if (!made.eos || made.eos->base() != "EOS_JWL") {
    if (made.eos)
      low.refuse(low.deck.origin(low.deck.place_of(*made.eos)),
                 fmt::format("*MAT_HIGH_EXPLOSIVE_BURN with *{}; expected *EOS_JWL", made.eos->base()));
    return;
  }
  made.detonation_velocity = row.quantity("d", velocity);
  made.cj_pressure = row.quantity("pcj", pressure);
  const double beta = row.value("beta");
  made.burn = scalar(beta == 1.0 ? "compression" : beta == 2.0 ? "time" : "both", row.origin("beta"));
}

/// A cut-off of the pressure, written as a negative pressure, as a tension.
Node tension(Lowering& low, const Row& row, const char* field) {
  const double cut = row.value(field, pressure);
  if (cut > 0.0)
    low.error(row.origin(field), fmt::format("a pressure cut-off of {} is a compression; expected 0 or less", cut));
  return scalar(low.text(std::abs(cut), pressure), row.origin(field));
}

void null_material(Lowering& low, const Row& row, Material& made) {
  const double mu = row.value("mu", viscosity);
  Node law = typed(mu > 0.0 ? "newtonian_fluid" : "hydrodynamic", row.origin());
  if (mu > 0.0) add(law, "viscosity", row.quantity("mu", viscosity));
  add(made.node, "strength", std::move(law));
  made.tension_limit = tension(low, row, "pc");
  for (const auto& [field, sign] : {std::pair{"terod", '>'}, std::pair{"cerod", '<'}}) {
    if (row.value(field) <= 0.0) continue;
    made.criteria.push_back(
        erosion_where(row, field, fmt::format("volume_ratio {} {}", sign, number_text(row.value(field)))));
  }
}

/// Points that stand on the cards of a material; those after the last rise are unused.
HardeningCurve points_on_cards(const Row& row, int n) {
  HardeningCurve curve;
  for (int k = 1; k <= n; ++k) {
    const double strain = row.value(fmt::format("eps{}", k)), stress = row.value(fmt::format("es{}", k), pressure);
    if (k > 1 && strain <= curve.strain.back() && stress == 0.0) break;
    curve.strain.push_back(strain);
    curve.stress.push_back(stress);
  }
  return curve;
}

bool has_points(const Row& row, int n) {
  for (int k = 1; k <= n; ++k)
    if (row.value(fmt::format("eps{}", k)) != 0.0 || row.value(fmt::format("es{}", k)) != 0.0) return true;
  return false;
}

void elastic_plastic_hydro(Lowering& low, const Row& row, Material& made) {
  const Elastic constants{row.value("g", pressure), 0.0, 0.0, row.origin("g")};
  const bool points = has_points(row, 16);
  Node law = strength(low, points ? "tabulated_hardening" : "elastic_plastic", constants);
  if (points) {
    add(law, "curves", hardening_curves(low, {points_on_cards(row, 16)}, row.origin("es1")));
    add(law, "beyond", scalar("last_slope", row.origin("es1")));
  } else {
    add(law, "yield_stress", row.quantity("sigy", pressure));
    add(law, "hardening_modulus", row.quantity("eh", pressure));
  }
  add(made.node, "strength", std::move(law));
  if (row.value("pc", pressure) != 0.0) made.tension_limit = tension(low, row, "pc");
  if (row.value("fs") > 0.0) made.criteria.push_back(plastic_strain_limit(row, "fs"));
}

/// What SPALL makes of the pressure cut-off PC.
void spall(Lowering& low, const Row& row, Material& made) {
  const double kind = row.value("spall"), cut = row.value("pc", pressure);
  if (cut == 0.0) return;  // no limit
  if (kind == 1.0) {
    made.tension_limit = tension(low, row, "pc");
  } else if (kind == 0.0 || kind == 2.0) {
    Node criterion = typed("tensile_stress", row.origin("pc"));
    add(criterion, "limit", tension(low, row, "pc"));
    add(criterion, "then", scalar("no_tension", row.origin("spall")));
    made.criteria.push_back(std::move(criterion));
  } else if (kind == 3.0) {
    Node criterion = typed("minimum_pressure", row.origin("pc"));
    add(criterion, "limit", row.quantity("pc", pressure));
    add(criterion, "then", scalar("no_tension", row.origin("spall")));
    made.criteria.push_back(std::move(criterion));
  } else {
    low.refuse(row.origin("spall"), fmt::format("*MAT_JOHNSON_COOK SPALL = {}; expected 0, 1, 2 or 3", kind));
  }
}

/// The logarithm of a rate needs a rate to divide by, which no unit system gives by itself.
void require_reference_rate(Lowering& low, const Row& row, const char* field) {
  if (!(row.value(field, rate) > 0.0))
    low.error(row.origin(field),
              fmt::format("*{} has a rate factor without its reference rate; expected a rate above 0, "
                          "in the units of the deck",
                          row.block().written));
}

Node johnson_cook_law(Lowering& low, const Row& row, Node law) {
  add(law, "A", row.quantity("a", pressure));
  add(law, "B", row.quantity("b", pressure));
  add(law, "n", row.quantity("n"));
  add(law, "C", row.quantity("c"));
  if (row.value("c") != 0.0) {
    warn_of_rate(low, row);
    require_reference_rate(low, row, "epso");
  }
  if (row.value("epso", rate) > 0.0) add(law, "reference_rate", row.quantity("epso", rate));
  return law;
}

void johnson_cook_damage(Lowering& low, const Row& row, Material& made) {
  bool any = false;
  for (const char* field : {"d1", "d2", "d3", "d4", "d5"}) any = any || row.value(field) != 0.0;
  if (!any) return;
  if (row.value("d4") != 0.0 && row.value("c") == 0.0) require_reference_rate(low, row, "epso");
  Node damage = typed("johnson_cook_damage", row.origin("d1"));
  add(damage, "D1", row.quantity("d1"));
  add(damage, "D2", row.quantity("d2"));
  add(damage, "D3", row.quantity("d3"));
  add(damage, "D4", row.quantity("d4"));
  add(damage, "D5", row.quantity("d5"));
  if (row.value("epso", rate) > 0.0) add(damage, "reference_rate", row.quantity("epso", rate));
  add(damage, "reference_temperature", row.quantity("tr", temperature));
  if (row.value("d5") != 0.0) add(damage, "melting_temperature", row.quantity("tm", temperature));
  if (row.value("efmin") > 0.0) add(damage, "least_failure_strain", row.quantity("efmin"));
  if (row.value("d3") > 0.0)
    low.warning(row.origin("d3"), "D3 is positive: failure strains grow with the tension; most metals have D3 below 0");
  made.criteria.push_back(std::move(damage));
}

void johnson_cook(Lowering& low, const Row& row, Material& made) {
  const Elastic constants{row.value("g", pressure), 0.0, 0.0, row.origin("g")};
  Node law = johnson_cook_law(low, row, strength(low, "johnson_cook", constants));
  add(law, "m", row.quantity("m"));
  add(law, "melting_temperature", row.quantity("tm", temperature));
  add(law, "reference_temperature", row.quantity("tr", temperature));
  add(law, "specific_heat", row.quantity("cp", specific_heat));
  add(law, "taylor_quinney", scalar("1", row.origin("cp")));
  add(made.node, "strength", std::move(law));
  spall(low, row, made);
  johnson_cook_damage(low, row, made);
}

void simplified_johnson_cook(Lowering& low, const Row& row, Material& made) {
  const Elastic constants = elastic_constants(low, row);
  Node law = johnson_cook_law(low, row, strength(low, "johnson_cook", constants));
  const Origin here = row.origin();
  // Without heating the temperature stays where it does not soften, whatever the constants of temperature are.
  for (const auto& [key, value] :
       {std::pair{"m", "1"}, std::pair{"melting_temperature", "1000 K"}, std::pair{"reference_temperature", "293.15 K"},
        std::pair{"specific_heat", "1000 J/(kg K)"}, std::pair{"taylor_quinney", "0"}})
    add(law, key, scalar(value, here));
  add(made.node, "strength", std::move(law));
  add(made.node, "eos", logarithmic(low, constants));
  if (row.given("psfail") && row.value("psfail") > 0.0 && row.value("psfail") < 1e16)
    made.criteria.push_back(plastic_strain_limit(row, "psfail"));
}

void power_law(Lowering& low, const Row& row, Material& made) {
  const Elastic constants = elastic_constants(low, row);
  Node law = strength(low, "power_law", constants);
  add(law, "k", row.quantity("k", pressure));
  add(law, "n", row.quantity("n"));
  // Up to 0.02 it is the strain at which the material yields.
  const double sigy = row.value("sigy");
  if (sigy == 0.0) add(law, "youngs_modulus", scalar(low.text(constants.young, pressure), constants.origin));
  if (sigy > 0.02) add(law, "yield_stress", row.quantity("sigy", pressure));
  if (sigy > 0.0 && sigy <= 0.02)
    add(law, "yield_stress",
        scalar(low.text(row.value("k", pressure) * kerf::pow(sigy, row.value("n")), pressure), row.origin("sigy")));
  if (is_rate_dependent(low, row, "src", "srp")) {
    add(law, "C", row.quantity("src", rate));
    add(law, "P", row.quantity("srp"));
    warn_of_rate(low, row);
  }
  add(made.node, "strength", std::move(law));
  add(made.node, "eos", logarithmic(low, constants));
  if (row.value("epsf") > 0.0) made.criteria.push_back(plastic_strain_limit(row, "epsf"));
}

/// The curves that a table has, with their rates.
std::vector<HardeningCurve> curves_of_table(Lowering& low, const Block& table, const Origin& where) {
  std::vector<HardeningCurve> curves;
  const std::vector<Block>& blocks = low.deck.blocks();
  auto next = static_cast<std::size_t>(&table - blocks.data());
  for (std::size_t r = 0; r < low.deck.n_repeats(table); ++r) {
    const Row value = low.row(table, r);
    if (++next >= blocks.size() || blocks[next].base() != "DEFINE_CURVE") {
      low.error(value.origin("value"), fmt::format("the table has {} rates, but {} *DEFINE_CURVE follow it at once; "
                                                   "expected one for each",
                                                   low.deck.n_repeats(table), r));
      break;
    }
    const std::int64_t id = low.row(blocks[next]).id("lcid", IdKind::function).value;
    const Lowering::Points points = low.curve_points(id, where);
    curves.push_back({value.value("value"), points.x, points.y});
  }
  if (!curves.empty() && curves.front().rate < 0.0)
    low.refuse(where, "a table whose first rate is negative, that is a logarithm, is not taken");
  return curves;
}

std::vector<HardeningCurve> stress_curves(Lowering& low, const Row& row) {
  const Origin where = row.origin("lcss");
  const std::int64_t id = row.id("lcss", IdKind::function).value;
  if (const Block* table = low.defined("DEFINE_TABLE", "tbid", id, IdKind::function)) {
    if (table->base() != "DEFINE_TABLE") {
      low.refuse(where, fmt::format("*{} is not taken as a table of rates; expected *DEFINE_TABLE", table->written));
      return {};
    }
    return curves_of_table(low, *table, where);
  }
  const Lowering::Points points = low.curve_points(id, where);
  return {{0.0, points.x, points.y}};
}

void piecewise_linear(Lowering& low, const Row& row, Material& made) {
  const Elastic constants = elastic_constants(low, row);
  const bool by_curve = row.integer("lcss").value > 0, by_points = !by_curve && has_points(row, 8);
  if (row.integer("lcss").value < 0)
    low.refuse(row.origin("lcss"), "LCSS < 0: curves of temperature are not taken; expected a curve or a table");
  bool rates = is_rate_dependent(low, row, "c", "p");
  if (rates && low.defined("DEFINE_TABLE", "tbid", row.id("lcss", IdKind::function).value, IdKind::function)) {
    low.warning(row.origin("c"), "C and P have no effect beside the rates of a table");
    rates = false;
  }
  if (rates) warn_of_rate(low, row);
  Node law;
  if (by_curve || by_points || rates) {
    const Origin where = row.origin(by_curve ? "lcss" : by_points ? "es1" : "sigy");
    law = strength(low, "tabulated_hardening", constants);
    const double yield = row.value("sigy", pressure), slope = hardening_modulus(low, row, constants.young);
    const std::vector<HardeningCurve> curves =
        by_curve    ? stress_curves(low, row)
        : by_points ? std::vector<HardeningCurve>{points_on_cards(row, 8)}
                    : std::vector<HardeningCurve>{{0.0, {0.0, 1.0}, {yield, yield + slope}}};
    add(law, "curves", hardening_curves(low, curves, where));
    add(law, "beyond", scalar("last_slope", where));
    if (rates) {
      add(law, "C", row.quantity("c", rate));
      add(law, "P", row.quantity("p"));
    }
  } else {
    law = strength(low, "elastic_plastic", constants);
    add(law, "yield_stress", row.quantity("sigy", pressure));
    add(law, "hardening_modulus",
        scalar(low.text(hardening_modulus(low, row, constants.young), pressure), row.origin("etan")));
  }
  add(made.node, "strength", std::move(law));
  add(made.node, "eos", logarithmic(low, constants));
  const double fail = row.value("fail");
  if (fail < 0.0) low.refuse(row.origin("fail"), "FAIL < 0: a failure routine of the user's own is not taken");
  if (fail > 0.0 && fail < 1e20) made.criteria.push_back(plastic_strain_limit(row, "fail"));
  if (row.value("tdel", time) > 0.0) {
    Node criterion = typed("minimum_time_step", row.origin("tdel"));
    add(criterion, "limit", row.quantity("tdel", time));
    made.criteria.push_back(std::move(criterion));
  }
}

void mooney_rivlin(Lowering& low, const Row& row, Material& made) {
  const double a = row.value("a", pressure), b = row.value("b", pressure), nu = row.value("pr");
  Node law = typed("mooney_rivlin", row.origin());
  add(law, "C10", row.quantity("a", pressure));
  add(law, "C01", row.quantity("b", pressure));
  if (!(nu > 0.0 && nu < 0.5))
    low.error(row.origin("pr"), fmt::format("PR = {}; expected Poisson's ratio above 0 and below 0.5", nu));
  const double shear = 2.0 * (a + b);
  const Elastic constants{shear, 2.0 * shear * (1.0 + nu) / (3.0 * (1.0 - 2.0 * nu)), 0.0, row.origin("pr")};
  add(made.node, "strength", std::move(law));
  add(made.node, "eos", logarithmic(low, constants));
  low.differ(row.origin(),
             "*MAT_MOONEY-RIVLIN_RUBBER: the pressure is the one of a bulk modulus, which is that of PR "
             "at small strains; the deck's own function of the volume is another at large ones");
}

/// A key of the law and the field that it is taken from.
struct Taken {
  const char *key, *field;
  Dimension dimension;
  bool zero_is_absent = false;
};

void add_all(Node& law, const Row& row, std::initializer_list<Taken> all) {
  for (const Taken& taken : all)
    if (!taken.zero_is_absent || row.value(taken.field) != 0.0)
      add(law, taken.key, row.quantity(taken.field, taken.dimension));
}

void ceramics(Lowering& low, const Row& row, Material& made) {
  Node law = typed("johnson_holmquist_2", row.origin());
  if (row.value("c") != 0.0) require_reference_rate(low, row, "epsi");
  add_all(law, row,
          {{"shear_modulus", "g", pressure},
           {"A", "a", number},
           {"N", "n", number},
           {"B", "b", number},
           {"M", "m", number},
           {"C", "c", number},
           {"reference_rate", "epsi", rate, true},
           {"most_fractured_strength", "sfmax", number, true},
           {"tensile_strength", "t", pressure},
           {"hugoniot_elastic_limit", "hel", pressure},
           {"hugoniot_elastic_pressure", "phel", pressure},
           {"D1", "d1", number},
           {"D2", "d2", number},
           {"K1", "k1", pressure},
           {"K2", "k2", pressure},
           {"K3", "k3", pressure},
           {"bulking_share", "beta", number}});
  add(made.node, "solid", std::move(law));
  if (row.value("fs") > 0.0) made.criteria.push_back(plastic_strain_limit(row, "fs"));
  if (row.value("fs") < 0.0) {
    // Damage takes the tension away at once, so that the pressure itself does not tell that the limit was passed.
    const double strain = row.value("t", pressure) / row.value("k1", pressure);
    if (strain < 1.0)
      made.criteria.push_back(
          erosion_where(row, "fs", fmt::format("volume_ratio > {}", number_text(1.0 / (1.0 - strain)))));
  }
}

void concrete(Lowering& low, const Row& row, Material& made) {
  Node law = typed("holmquist_johnson_cook", row.origin());
  if (row.value("c") != 0.0) require_reference_rate(low, row, "eps0");
  add_all(law, row,
          {{"shear_modulus", "g", pressure},
           {"compressive_strength", "fc", pressure},
           {"A", "a", number},
           {"B", "b", number},
           {"N", "n", number},
           {"C", "c", number},
           {"reference_rate", "eps0", rate, true},
           {"most_strength", "sfmax", number, true},
           {"tensile_strength", "t", pressure},
           {"crush_pressure", "pc", pressure},
           {"crush_mu", "uc", number},
           {"lock_pressure", "pl", pressure},
           {"lock_mu", "ul", number},
           {"K1", "k1", pressure},
           {"K2", "k2", pressure},
           {"K3", "k3", pressure},
           {"D1", "d1", number},
           {"D2", "d2", number},
           {"least_failure_strain", "efmin", number}});
  add(made.node, "solid", std::move(law));
  const double fs = row.value("fs");
  if (fs > 0.0) return made.criteria.push_back(plastic_strain_limit(row, "fs"));
  const std::string bears_no_more = fmt::format("pressure <= -0.999 * {} Pa * (1 - damage)",
                                                number_text(row.value("t", pressure) * low.units.in_si(pressure)));
  made.criteria.push_back(erosion_where(row, "fs", fs < 0.0 ? "damage >= 1" : bears_no_more));
}

constexpr MaterialLaw laws[] = {
    {"MAT_ELASTIC", false, elastic},
    {"MAT_PLASTIC_KINEMATIC", false, plastic_kinematic},
    {"MAT_HIGH_EXPLOSIVE_BURN", true, high_explosive},
    {"MAT_NULL", true, null_material},
    {"MAT_ELASTIC_PLASTIC_HYDRO", true, elastic_plastic_hydro},
    {"MAT_ISOTROPIC_ELASTIC_PLASTIC", false, isotropic_elastic_plastic},
    {"MAT_JOHNSON_COOK", true, johnson_cook},
    {"MAT_SIMPLIFIED_JOHNSON_COOK", false, simplified_johnson_cook},
    {"MAT_POWER_LAW_PLASTICITY", false, power_law},
    {"MAT_PIECEWISE_LINEAR_PLASTICITY", false, piecewise_linear},
    {"MAT_MOONEY-RIVLIN_RUBBER", false, mooney_rivlin},
    {"MAT_JOHNSON_HOLMQUIST_CERAMICS", false, ceramics},
    {"MAT_JOHNSON_HOLMQUIST_CONCRETE", false, concrete},
};

}  // namespace

const MaterialLaw* law_of(std::string_view keyword) {
  const auto* found =
      std::find_if(std::begin(laws), std::end(laws), [&](const MaterialLaw& law) { return law.keyword == keyword; });
  return found == std::end(laws) ? nullptr : found;
}

Node hardening_curves(Lowering& low, const std::vector<HardeningCurve>& curves, const Origin& where) {
  Node list = list_node(where);
  for (const HardeningCurve& curve : curves) {
    Node item = map_node(where);
    if (curve.rate > 0.0) add(item, "plastic_strain_rate", scalar(low.text(curve.rate, rate), where));
    if (curve.strain.empty()) continue;
    add(item, "plastic_strain", scalar(low.list_text(curve.strain, number), where));
    add(item, "yield_stress", scalar(low.list_text(curve.stress, pressure), where));
    list.items.push_back(std::move(item));
  }
  return list;
}

}  // namespace kerf::lowering
