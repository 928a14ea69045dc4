// Equations of state, one for each keyword *EOS_ that Kerf has, and the detonators of explosives.
#include <fmt/format.h>

#include <algorithm>

#include "lowering/material_parts.hpp"

namespace kerf::lowering {
namespace {

using decks::IdKind;

/// Whether *INITIAL_DETONATION means the explosive of a part.
bool is_meant(Lowering& low, const Row& row, const decks::DeckPart& part) {
  const std::int64_t written = row.integer("pid").value;
  if (written == 0) return true;
  if (written > 0) return row.id("pid", IdKind::part).value == part.id;
  const std::int64_t set = low.deck.transform_of(row.block()).id(-written, IdKind::set);
  const auto found = std::find_if(low.mesh.part_sets.begin(), low.mesh.part_sets.end(),
                                  [&](const decks::DeckIdSet& s) { return s.id == set; });
  if (found == low.mesh.part_sets.end()) {
    low.error(row.origin("pid"), fmt::format("part set {} is not defined", set));
    return false;
  }
  return std::binary_search(found->ids.begin(), found->ids.end(), part.id);
}

void add_detonators(Lowering& low, Node& eos, const Material& material) {
  Node list = list_node(eos.origin);
  for (const Row& row : low.rows("INITIAL_DETONATION")) {
    if (!is_meant(low, row, *material.part)) continue;
    Node detonator = map_node(row.origin("pid"));
    const std::array<double, 3> point =
        low.deck.transform_of(row.block()).motion({row.value("x"), row.value("y"), row.value("z")});
    add(detonator, "point", scalar(low.texts({point[0], point[1], point[2]}, length), row.origin("x")));
    add(detonator, "time", row.quantity("lt", time));
    list.items.push_back(std::move(detonator));
  }
  if (!list.items.empty()) add(eos, "detonators", std::move(list));
}

Node linear_polynomial(const Row& row) {
  Node eos = typed("linear_polynomial", row.origin());
  for (int k = 0; k <= 6; ++k) {
    const std::string field = fmt::format("c{}", k);
    if (row.value(field) != 0.0) add(eos, fmt::format("C{}", k), row.quantity(field, k < 4 ? pressure : number));
  }
  add(eos, "initial_energy", row.quantity("e0", pressure));
  return eos;
}

Node jwl(Lowering& low, const Row& row, const Material& material) {
  Node eos = typed("jwl", row.origin());
  add(eos, "A", row.quantity("a", pressure));
  add(eos, "B", row.quantity("b", pressure));
  add(eos, "R1", row.quantity("r1"));
  add(eos, "R2", row.quantity("r2"));
  add(eos, "omega", row.quantity("omeg"));
  add(eos, "initial_energy", row.quantity("e0", pressure));
  if (!material.detonation_velocity.is_nothing()) {
    add(eos, "detonation_velocity", material.detonation_velocity);
    add(eos, "cj_pressure", material.cj_pressure);
    add(eos, "burn", material.burn);
    add_detonators(low, eos, material);
  }
  return eos;
}

Node gruneisen(const Row& row) {
  Node eos = typed("mie_gruneisen", row.origin());
  add(eos, "c0", row.quantity("c", velocity));
  add(eos, "s", row.quantity("s1"));
  add(eos, "s2", row.quantity("s2"));
  add(eos, "s3", row.quantity("s3"));
  add(eos, "gamma0", row.quantity("gamao"));
  add(eos, "gamma_slope", row.quantity("a"));
  add(eos, "initial_energy", row.quantity("e0", pressure));
  return eos;
}

}  // namespace

Node equation_of_state(Lowering& low, const Row& row, const Material& material) {
  const std::string& base = row.block().base();
  Node eos;
  if (base == "EOS_LINEAR_POLYNOMIAL") {
    eos = linear_polynomial(row);
  } else if (base == "EOS_JWL") {
    if (!material.tension_limit.is_nothing() && material.tension_limit.text != low.text(0.0, pressure))
      low.differ(
          material.tension_limit.origin,
          "a pressure cut-off has no effect with *EOS_JWL: the pressure of detonation products falls below 0 only "
          "where their energy does");
    return jwl(low, row, material);
  } else if (base == "EOS_GRUNEISEN") {
    eos = gruneisen(row);
  } else {
    return typed("linear", row.origin());  // its keyword is refused
  }
  if (!material.tension_limit.is_nothing()) add(eos, "tension_limit", material.tension_limit);
  return eos;
}

}  // namespace kerf::lowering
