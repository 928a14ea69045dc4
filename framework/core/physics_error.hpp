// What stops a run that goes wrong physically; leads to exit code 3 on every rank.
#pragma once

#include <stdexcept>
#include <string>

namespace kerf {

/// Thrown on all ranks together, with the same message.
class PhysicsError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace kerf
