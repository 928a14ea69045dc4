// Conditions of named quantities that a user writes, such as "damage > 0.9 and pressure < -1.2 GPa": parsed and
// checked once, with their units, then evaluated for blocks of points without allocation.
//
// Numbers may carry a unit, written without spaces: "1.2 GPa", "5 J/m2", "3 1/s". A number without a unit is in SI and
// goes with any dimension. From weak to strong: or, and, not, comparisons (< <= > >= == !=), + -, * /, unary minus, ^.
// Functions: abs, sqrt, exp, log, min(a, b), max(a, b).
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/units.hpp"
#include "kerf/math.hpp"

namespace kerf {

class Condition {
 public:
  /// What is wrong, and how many characters from the beginning of the text.
  struct Fault {
    int offset = 0;
    std::string sentence;
  };
  /// A name and its first place in the text.
  struct Variable {
    std::string name;
    int offset = 0;
  };

  Condition() = default;
  explicit Condition(const std::string& text);

  /// The quantities that are named, each once, in the order of the text. Empty where the text cannot be read.
  const std::vector<Variable>& variables() const { return variables_; }
  /// All that is wrong, given the unit of every variable; nothing of a variable without one. The whole has to be a
  /// condition, that is true or false.
  std::vector<Fault> faults(const std::function<std::optional<std::string>(const std::string&)>& unit_of) const;
  /// 1 where the condition holds, else 0. `rows` are those of the variables, in their order and in SI units. Pre: there
  /// are no faults.
  void evaluate(const double* const* rows, double (&out)[lane_width]) const;

 private:
  enum class Op {
    number,
    variable,  // push
    negate,
    abs,
    sqrt,
    exp,
    log,
    logical_not,  // of one
    add,
    subtract,
    multiply,
    divide,
    power,
    min,
    max,  // of two
    less,
    less_equal,
    greater,
    greater_equal,
    equal,
    not_equal,
    logical_and,
    logical_or
  };
  struct Instruction {
    Op op = Op::number;
    int offset = 0;  // in the text
    double value = 0.0;  // of a number, in SI units
    int variable = 0;  // which
    bool has_unit = false;
    UnitExponents dimension{};  // of a number with a unit
  };
  static constexpr int most_depth = 32;  // of the stack
  friend class ConditionParser;
  friend class ConditionUnits;

  std::vector<Instruction> program_;  // in the order of a stack machine
  std::vector<Variable> variables_;
  std::optional<Fault> syntax_;
};

}  // namespace kerf
