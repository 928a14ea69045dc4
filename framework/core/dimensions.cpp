// Runs the instructions of a formula with dimensions in place of values.
#include "core/dimensions.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "core/units.hpp"

namespace kerf {
namespace {

using Op = Expression::Op;
using Dimension = Expression::Dimension;

// A number without a unit goes with any dimension, and so does what has been complained of.
enum class Kind { condition, quantity, any };

struct Value {
  Kind kind = Kind::any;
  Dimension dimension{};
  std::optional<double> number = {};  // where it stands in the text
};

constexpr Value condition{Kind::condition, {}, {}}, pure_number{Kind::quantity, {}, {}};

std::string text_of(const Dimension& d) {
  static const char* const names[] = {"m", "kg", "s", "A", "K", "mol", "cd"};
  std::string all;
  for (std::size_t k = 0; k < d.size(); ++k)
    if (d[k] != 0.0)
      all += fmt::format("{}{}{}", all.empty() ? "" : " ", names[k], d[k] == 1.0 ? "" : fmt::format("{}", d[k]));
  return all.empty() ? "no unit" : all;
}

class Check {
 public:
  Check(const Expression& formula, std::vector<std::optional<Dimension>> variables)
      : formula_(formula), variables_(std::move(variables)) {}

  std::vector<DimensionFault> run() {
    for (const Expression::Instruction& i : formula_.program()) stack_.push_back(result(i));
    if (stack_.back().kind != Kind::condition)
      fault(0, "expected a condition, such as \"damage > 0.9\", and this is a number");
    return std::move(faults_);
  }

 private:
  void fault(int offset, std::string sentence) { faults_.push_back({offset, std::move(sentence)}); }
  Value pop() {
    const Value v = stack_.back();
    stack_.pop_back();
    return v;
  }
  Value pop_number(int offset) {
    Value v = pop();
    if (v.kind == Kind::condition) {
      fault(offset, "expected numbers at this operator, and one side is a condition");
      v.kind = Kind::any;
    }
    return v;
  }
  void pop_condition(int offset) {
    if (pop().kind == Kind::quantity) fault(offset, "expected conditions at this operator, and one side is a number");
  }
  void pop_pure_number(int offset) { need_no_dimension(pop_number(offset), offset, "this function"); }
  void need_no_dimension(const Value& v, int offset, const char* what) {
    if (v.kind == Kind::quantity && v.dimension != Dimension{})
      fault(offset, fmt::format("{} takes a number without unit, and this has {}", what, text_of(v.dimension)));
  }
  Value agreed(const Value& a, const Value& b, int offset) {
    if (a.kind == Kind::any) return {b.kind, b.dimension, {}};
    if (b.kind == Kind::any) return {a.kind, a.dimension, {}};
    if (a.dimension != b.dimension)
      fault(offset, fmt::format("the sides of this operator have different dimensions, {} and {}; expected the same",
                                text_of(a.dimension), text_of(b.dimension)));
    return {Kind::quantity, a.dimension, {}};
  }

  /// What an instruction leaves on the stack.
  Value result(const Expression::Instruction& i) {
    if (i.op == Op::number)
      return i.index > 0 ? Value{Kind::quantity, formula_.units()[static_cast<std::size_t>(i.index - 1)], {}}
                         : Value{Kind::any, {}, i.number};
    if (i.op == Op::variable) {
      const auto& d = variables_[static_cast<std::size_t>(i.index)];
      return d ? Value{Kind::quantity, *d, {}} : Value{};
    }
    switch (i.op) {
      case Op::opposite:
        pop_condition(i.offset);
        return condition;
      case Op::both:
      case Op::either:
        pop_condition(i.offset);
        pop_condition(i.offset);
        return condition;
      case Op::choose:
        return chosen(i.offset);
      case Op::negate:
      case Op::abs:
      case Op::sign:
      case Op::sqrt:
        return of_one(i.op, pop_number(i.offset));
      case Op::exp:
      case Op::log:
      case Op::log10:
      case Op::sin:
      case Op::cos:
      case Op::tan:
      case Op::asin:
      case Op::acos:
      case Op::atan:
      case Op::tanh:
        pop_pure_number(i.offset);
        return pure_number;
      default:
        return of_two(i);
    }
  }
  Value chosen(int offset) {
    const Value otherwise = pop(), then = pop();
    pop_condition(offset);
    if (then.kind == Kind::condition && otherwise.kind == Kind::condition) return condition;
    if (then.kind == Kind::condition || otherwise.kind == Kind::condition) {
      fault(offset, "one of the two values is a condition, and the other a number; expected two of a kind");
      return {};
    }
    return agreed(then, otherwise, offset);
  }
  static Value of_one(Op op, Value v) {
    if (op == Op::sign) return pure_number;
    if (op == Op::sqrt) {
      for (double& e : v.dimension) e *= 0.5;
      v.number.reset();
    } else if (v.number) {
      v.number = op == Op::abs ? std::fabs(*v.number) : -*v.number;
    }
    return v;
  }
  Value of_two(const Expression::Instruction& i) {
    const Value b = pop_number(i.offset), a = pop_number(i.offset);
    if (i.op == Op::power) return raised(a, b, i.offset);
    if (i.op == Op::multiply || i.op == Op::divide) {
      Value v{a.kind == Kind::any && b.kind == Kind::any ? Kind::any : Kind::quantity, a.dimension, {}};
      for (std::size_t k = 0; k < v.dimension.size(); ++k)
        v.dimension[k] += i.op == Op::multiply ? b.dimension[k] : -b.dimension[k];
      return v;
    }
    const Value v = agreed(a, b, i.offset);
    if (i.op >= Op::less && i.op <= Op::unequal) return condition;
    return i.op == Op::atan2 ? pure_number : v;
  }
  Value raised(const Value& a, const Value& b, int offset) {
    need_no_dimension(b, offset, "an exponent");
    if (a.kind == Kind::any) return {};
    if (a.dimension != Dimension{} && !b.number) {
      fault(offset, "a quantity with a unit is raised to a power that is not written as a number");
      return {};
    }
    Value v{Kind::quantity, a.dimension, {}};
    for (double& e : v.dimension) e *= b.number.value_or(1.0);
    return v;
  }

  const Expression& formula_;
  std::vector<std::optional<Dimension>> variables_;
  std::vector<Value> stack_;
  std::vector<DimensionFault> faults_;
};

}  // namespace

std::vector<DimensionFault> faults_of_condition(
    const Expression& formula, const std::function<std::optional<std::string>(const std::string&)>& unit_of) {
  std::vector<std::optional<Dimension>> dimensions;
  for (const std::string& name : formula.variables()) {
    const auto unit = unit_of(name);
    const auto base = unit ? unit_in_base(*unit) : std::nullopt;
    dimensions.push_back(base ? std::optional(base->exponents) : std::nullopt);
  }
  return Check(formula, std::move(dimensions)).run();
}

}  // namespace kerf
