// What is known of an element that died.
#pragma once

#include <cstdint>
#include <string>

namespace kerf {

/// One element at the moment of its death.
struct ErosionRecord {
  double time = 0.0;  // [s]
  std::int64_t cycle = 0;
  std::int64_t element = 0;  // global id
  std::string part, criterion;
  double value = 0.0;  // of the criterion
  double mass = 0.0;  // [kg]
  double energy = 0.0;  // [J] internal energy that left with it
  std::int64_t label = 0;  // the number that the user knows it by
};

}  // namespace kerf
