// What an element, a node in contact and a re-balance cost: factors of the program, or those that a file gives.
//
// The unit of work is an element cycle: one cycle of a hex8 with elastic-plastic strength and a linear equation of
// state.
#pragma once

#include <map>
#include <string>

#include "kerf/balance_policy.hpp"
#include "kerf/element.hpp"

namespace kerf {

struct MaterialInput;

struct WorkModel {
  double other_element = 0.8;  // without its laws, times Element::cost(); of a type that no file names
  double other_law = 0.2;  // of a law of stress, times Law::cost(); of a type that no file names
  double other_eos = 0.0;  // times Law::cost(); of a type that no file names
  double erosion = 0.1;  // of an element whose material has criteria
  std::map<std::string, double> elements, laws, eos;  // by type
  double contact_node = 0.9, contact_candidate = 0.7;  // of a node, of each of its candidates
  double eroded_element = 90.0;  // once, when it goes
  MoveCost move{0.0, 60.0, 0.0};
  double element_cycle = 0.0;  // [s]; 0 where nothing was measured

  /// Of one element in one cycle, without contact.
  double of_element(const Element& element, const MaterialInput& material) const;
  /// Of a node in one cycle.
  double of_contact(double n_candidates) const { return contact_node + contact_candidate * n_candidates; }
};

}  // namespace kerf
