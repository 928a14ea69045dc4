// Parameters of decks: their definitions, who sees them, and expressions of them.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace kerf::decks {

/// A number of a deck; integers are kept apart because decks may divide them.
struct DeckNumber {
  double real = 0.0;
  bool integer = false;
};

/// One definition of a parameter.
struct Parameter {
  char type = 'R';  // R real, I integer, C text
  DeckNumber value;
  std::string text;  // of type C
  std::int32_t source = -1;  // only seen in this reading of a file and those that it includes; -1 everywhere
  std::int32_t order = 0;  // of the block that defines it
};

/// Where a parameter is asked for: a block, and the readings of files that it stands in, innermost first.
struct Asker {
  std::int32_t order = 0;
  std::vector<std::int32_t> sources;
};

/// All definitions, by names in lower case.
class Parameters {
 public:
  /// The name may be defined again; what stands later sees the later definition. False where the new definition hides
  /// another one with a different value.
  bool define(const std::string& name, const Parameter& parameter);
  /// The innermost local definition before the asker, or the last global one; null where there is none.
  const Parameter* find(std::string_view name, const Asker& asker) const;
  /// Names that the asker sees, for messages.
  std::string names_for(const Asker& asker) const;
  bool empty() const { return definitions_.empty(); }

 private:
  std::map<std::string, std::vector<Parameter>, std::less<>> definitions_;
};

/// The value of an expression, or the sentence that says what is wrong and how many bytes of it stand before the place.
struct DeckExpression {
  DeckNumber value;
  std::string error;
  std::int32_t offset = 0;

  bool ok() const { return error.empty(); }
};

/// Reads "2.0*rho0/&cs**2": + - * / and ** or ^, parentheses, numbers, `pi`, parameters with or without `&`, and
/// functions (abs, acos, asin, atan, atan2, cos, exp, float, int, log, log10, max, min, mod, nint, sin, sqrt, tan,
/// tanh). Angles are in radians. Two integers whose quotient is no integer are an error.
DeckExpression evaluate(std::string_view text, const Parameters& parameters, const Asker& asker);

/// What is said where `name` is not defined.
std::string undefined_parameter(std::string_view name, const Parameters& parameters, const Asker& asker);

}  // namespace kerf::decks
