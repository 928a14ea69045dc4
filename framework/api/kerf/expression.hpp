// Formulas of the input, ready to be evaluated: "-u0 * x / r", "plastic_strain > 0.5 and pressure < 0 Pa".
//
// A plugin has a member `Expression` (or a list of them) and declares it by Schema::expression; the engine reads the
// text with core/expression.cpp, whose first lines say what a formula may hold. Values are the same bits on every
// machine: the functions are those of kerf/functions.hpp. A number that is none (NaN) remains visible: a comparison
// with it is neither true nor false but NaN, and so is what hangs on that comparison.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "kerf/math.hpp"

namespace kerf {

/// A formula as a list of instructions for a stack of numbers. Truth is 1, falsehood 0; every number but 0 is true, and
/// NaN is unknown.
class Expression {
 public:
  enum class Op : std::uint8_t {
    number,
    variable,
    negate,
    add,
    subtract,
    multiply,
    divide,
    power,
    less,
    at_most,
    greater,
    at_least,
    equal,
    unequal,
    both,
    either,
    opposite,
    choose,  // if(condition, a, b)
    min,
    max,
    abs,
    sign,
    sqrt,
    exp,
    log,
    log10,
    sin,
    cos,
    tan,
    asin,
    acos,
    atan,
    atan2,
    tanh,
    hypot
  };
  struct Instruction {
    Op op = Op::number;
    int index = 0;  // of a variable; of a number: 0, or one more than the place of its unit in units()
    double number = 0.0;
    int offset = 0;  // characters of the text before it
  };
  /// Powers of m, kg, s, A, K, mol and cd.
  using Dimension = std::array<double, 7>;
  /// Numbers that the stack can hold; deeper formulas are refused.
  static constexpr int most_depth = 32;

  /// No formula; value() is 0.
  Expression() = default;
  /// Pre: the program leaves one number, needs no more than most_depth, and indexes `variables`.
  Expression(std::string text, std::vector<std::string> variables, std::vector<Instruction> program,
             std::vector<Dimension> units = {})
      : text_(std::move(text)),
        variables_(std::move(variables)),
        program_(std::move(program)),
        units_(std::move(units)) {}

  bool empty() const { return program_.empty(); }
  /// As the user wrote it.
  const std::string& text() const { return text_; }
  /// Names of the variables, in the order in which value() takes them: the declared ones, or, where the declaration
  /// left them open, those that the formula names, each once, by first appearance.
  const std::vector<std::string>& variables() const { return variables_; }
  const std::vector<Instruction>& program() const { return program_; }
  /// Dimensions of the numbers that are written with a unit.
  const std::vector<Dimension>& units() const { return units_; }

  /// The value for variables in SI units, in the order of variables().
  double value(const double* variables) const {
    double result = 0.0;
    run<1>([variables](int i, int) { return variables[i]; }, &result);
    return result;
  }
  /// The values at `lane_width` points; rows[i] has variable i of all of them. Loops over points vectorise.
  void values(const double* const* rows, double* results) const {
    run<lane_width>([rows](int i, int lane) { return rows[i][lane]; }, results);
  }

 private:
  template <int n>
  struct Stack {
    double number[most_depth][n];
    int size = 0;

    template <class F>
    void unary(F f) {
      double* a = number[size - 1];
      for (int l = 0; l < n; ++l) a[l] = f(a[l]);
    }
    template <class F>
    void binary(F f) {
      --size;
      double* a = number[size - 1];
      const double* b = number[size];
      for (int l = 0; l < n; ++l) a[l] = f(a[l], b[l]);
    }
    void choose() {
      size -= 2;
      double* a = number[size - 1];
      const double *b = number[size], *c = number[size + 1];
      for (int l = 0; l < n; ++l) a[l] = select(a[l] == a[l], select(a[l] != 0.0, b[l], c[l]), a[l]);
    }
  };

  template <int n, class Variable>
  void run(Variable variable, double* results) const {
    Stack<n> stack;
    for (const Instruction& i : program_) {
      if (i.op == Op::number) {
        for (int l = 0; l < n; ++l) stack.number[stack.size][l] = i.number;
        ++stack.size;
      } else if (i.op == Op::variable) {
        for (int l = 0; l < n; ++l) stack.number[stack.size][l] = variable(i.index, l);
        ++stack.size;
      } else if (i.op <= Op::opposite) {
        apply_operator(i.op, stack);
      } else {
        apply_function(i.op, stack);
      }
    }
    for (int l = 0; l < n; ++l) results[l] = program_.empty() ? 0.0 : stack.number[0][l];
  }

  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  static double truth(bool b) { return select(b, 1.0, 0.0); }
  static double compared(double a, double b, bool holds) { return select((a == a) & (b == b), truth(holds), unknown); }
  static bool is_false(double a) { return a == 0.0; }
  static bool is_true(double a) { return (a == a) & (a != 0.0); }

  template <class S>
  static void apply_operator(Op op, S& s) {
    switch (op) {
      case Op::negate:
        return s.unary([](double a) { return -a; });
      case Op::add:
        return s.binary([](double a, double b) { return a + b; });
      case Op::subtract:
        return s.binary([](double a, double b) { return a - b; });
      case Op::multiply:
        return s.binary([](double a, double b) { return a * b; });
      case Op::divide:
        return s.binary([](double a, double b) { return a / b; });
      case Op::power:
        return s.binary([](double a, double b) { return kerf::pow(a, b); });
      case Op::less:
        return s.binary([](double a, double b) { return compared(a, b, a < b); });
      case Op::at_most:
        return s.binary([](double a, double b) { return compared(a, b, a <= b); });
      case Op::greater:
        return s.binary([](double a, double b) { return compared(a, b, a > b); });
      case Op::at_least:
        return s.binary([](double a, double b) { return compared(a, b, a >= b); });
      case Op::equal:
        return s.binary([](double a, double b) { return compared(a, b, a == b); });
      case Op::unequal:
        return s.binary([](double a, double b) { return compared(a, b, a != b); });
      case Op::both:
        return s.binary([](double a, double b) {
          return select(is_false(a) | is_false(b), 0.0, select(is_true(a) & is_true(b), 1.0, unknown));
        });
      case Op::either:
        return s.binary([](double a, double b) {
          return select(is_true(a) | is_true(b), 1.0, select(is_false(a) & is_false(b), 0.0, unknown));
        });
      default:  // opposite
        return s.unary([](double a) { return select(a == a, truth(a == 0.0), a); });
    }
  }

  template <class S>
  static void apply_function(Op op, S& s) {
    switch (op) {
      case Op::choose:
        return s.choose();
      case Op::min:
        return s.binary([](double a, double b) { return select(a == a, min_of(a, b), a); });  // NaN remains
      case Op::max:
        return s.binary([](double a, double b) { return select(a == a, max_of(a, b), a); });
      case Op::abs:
        return s.unary([](double a) { return std::fabs(a); });
      case Op::sign:
        return s.unary([](double a) { return select(a > 0.0, 1.0, select(a < 0.0, -1.0, a)); });
      case Op::sqrt:
        return s.unary([](double a) { return std::sqrt(a); });
      case Op::exp:
        return s.unary([](double a) { return kerf::exp(a); });
      case Op::log:
        return s.unary([](double a) { return kerf::log(a); });
      case Op::log10:
        return s.unary([](double a) { return kerf::log10(a); });
      case Op::sin:
        return s.unary([](double a) { return kerf::sin(a); });
      case Op::cos:
        return s.unary([](double a) { return kerf::cos(a); });
      case Op::tan:
        return s.unary([](double a) { return kerf::tan(a); });
      case Op::asin:
        return s.unary([](double a) { return kerf::asin(a); });
      case Op::acos:
        return s.unary([](double a) { return kerf::acos(a); });
      case Op::atan:
        return s.unary([](double a) { return kerf::atan(a); });
      case Op::atan2:
        return s.binary([](double a, double b) { return kerf::atan2(a, b); });
      case Op::tanh:
        return s.unary([](double a) { return kerf::tanh(a); });
      default:  // hypot
        return s.binary([](double a, double b) { return kerf::hypot(a, b); });
    }
  }

  std::string text_;
  std::vector<std::string> variables_;
  std::vector<Instruction> program_;
  std::vector<Dimension> units_;
};

}  // namespace kerf

KERF_SIZES(expression, KERF_SIZE(Expression), KERF_SIZE(Expression::Instruction))
