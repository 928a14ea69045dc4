// Collects the variables of all laws of a material.
#include "model/law_variables.hpp"

#include <algorithm>

namespace kerf {

namespace {

/// Whether any law of the material asks for any of `inputs`, of Inputs.
bool asks_for(const MaterialInput& material, unsigned inputs) {
  const std::vector<const Law*> laws = material.laws();
  return std::any_of(laws.begin(), laws.end(), [&](const Law* l) { return (l->asked_inputs() & inputs) != 0; });
}

}  // namespace

PartStore::Variables variables_of(const MaterialInput& material, int& first) {
  PartStore::Variables all;
  all.material = material.stress_law().state_variables();
  if (material.eos) all.eos = material.eos->state_variables();
  all.place = asks_for(material, with_initial_length | with_reference_position);
  if (!material.erosion) return all;
  const ErosionInput& erosion = *material.erosion;
  const auto keep = [&all](const char* name) {
    StateVariable v;
    v.name = name;
    v.unit = "-";
    all.erosion.push_back(v);
  };
  keep("erosion_verdicts");  // which criteria failed at their last look, as a whole number of bits
  if (erosion.fade_out > 0)
    for (const char* name :
         {"fade_out_cycles", "fade_out_criterion", "fade_out_value", "fade_out_strength", "fade_out_tension"})
      keep(name);
  const bool keeps_elements = std::any_of(erosion.criteria.begin(), erosion.criteria.end(),
                                          [](const auto& c) { return c->then == "no_tension"; });
  if (keeps_elements) keep("no_tension");  // 1 where an element has failed and stays, without deviator and tension
  first = static_cast<int>(all.erosion.size());
  all.softening = erosion.fade_out > 0 || keeps_elements;
  for (const auto& c : erosion.criteria) {
    all.softening = all.softening || c->softens();
    all.place = all.place || c->nonlocal().radius > 0.0;
    for (const StateVariable& v : c->state_variables()) all.erosion.push_back(v);
  }
  return all;
}

}  // namespace kerf
