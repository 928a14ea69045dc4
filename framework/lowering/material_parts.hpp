// What the laws of materials, the equations of state and the criteria of erosion share while they are lowered.
#pragma once

#include <string_view>
#include <vector>

#include "lowering/lowering.hpp"

namespace kerf::lowering {

/// A material of the document while it is written.
struct Material {
  Node node;
  std::vector<Node> criteria;  // of erosion
  const decks::DeckPart* part = nullptr;
  const decks::Block* eos = nullptr;
  // What the material says that the equation of state is given.
  Node tension_limit;  // nothing where there is none
  Node detonation_velocity, cj_pressure, burn;
};

/// Elastic constants in the units of the deck, and where they stand.
struct Elastic {
  double shear = 0.0, bulk = 0.0, young = 0.0;
  Origin origin;
};
/// From the fields E and PR. Complains of values that no elastic solid has.
Elastic elastic_constants(Lowering& low, const Row& row);

/// A map with a key `type`.
Node typed(const char* type, const Origin& where);
Node strength(Lowering& low, const char* type, const Elastic& elastic);
Node logarithmic(Lowering& low, const Elastic& elastic);
Node plastic_strain_limit(const Row& row, const char* field);
/// Erosion where a condition holds, for example "damage >= 1". `field` is the place of the condition.
Node erosion_where(const Row& row, const char* field, const std::string& condition);

struct MaterialLaw {
  std::string_view keyword;
  bool needs_eos = false;
  void (*lower)(Lowering&, const Row&, Material&) = nullptr;
};
/// Null where Kerf has no law for the keyword.
const MaterialLaw* law_of(std::string_view keyword);

/// The block `eos` for *EOS_... .
Node equation_of_state(Lowering& low, const Row& row, const Material& material);

/// The criteria of *MAT_ADD_EROSION.
void added_criteria(Lowering& low, const Row& row, std::vector<Node>& criteria);

/// Yield stress over plastic strain as the key `curves` of tabulated_hardening. Points that no such curve may have are
/// errors. Pre: both of one length.
struct HardeningCurve {
  double rate = 0.0;
  std::vector<double> strain, stress;
};
Node hardening_curves(Lowering& low, const std::vector<HardeningCurve>& curves, const Origin& where);

}  // namespace kerf::lowering
