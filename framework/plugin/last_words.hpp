// A sentence that is put together where no memory may be asked for: in a handler of signals.
#pragma once

#include <cstddef>
#include <cstdint>

#include "plugin/culprit.hpp"

namespace kerf {

class LastWords {
 public:
  /// Begins with "error: " and the rank, where it is known.
  LastWords();
  LastWords& add(const char* text);
  LastWords& add(std::int64_t number);
  LastWords& add_seconds(double seconds);
  /// What the program is doing: "in phase elements of cycle 3", or "while reading the input".
  LastWords& add_activity();
  /// " in FUNCTION", where it is known.
  LastWords& add_function(const Culprit& culprit);
  /// Writes the sentence as one line on the standard error.
  void say();

 private:
  char text_[3000];
  std::size_t length_ = 0;
};

}  // namespace kerf
