// The work of an element, from its type and the types of its laws.
#include "input/work_model.hpp"

#include "input/model_input.hpp"

namespace kerf {

namespace {

double factor(const std::map<std::string, double>& by_type, const Plugin& plugin, double otherwise, double cost) {
  const auto known = by_type.find(plugin.type);
  return known == by_type.end() ? otherwise * cost : known->second;
}

}  // namespace

double WorkModel::of_element(const Element& element, const MaterialInput& material) const {
  const auto known = elements.find(element.type);
  double work = known == elements.end() ? other_element : known->second;
  const Law& law = material.stress_law();
  work += factor(laws, law, other_law, law.cost());
  if (material.eos) work += factor(eos, *material.eos, other_eos, material.eos->cost());
  return element.cost() * (work + (material.erosion ? erosion : 0.0));
}

}  // namespace kerf
