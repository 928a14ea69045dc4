// Parsing by descent, the check of dimensions, and the stack machine.
#include "core/condition.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <utility>

#include "core/assert.hpp"

namespace kerf {

namespace {

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

}  // namespace

class ConditionParser {
 public:
  ConditionParser(const std::string& text, Condition& out) : text_(text), out_(out) {}

  void parse() {
    try {
      alternatives();
      if (next() != '\0') fail("expected an operator or the end");
      check_depth();
    } catch (const Condition::Fault& fault) {
      out_.syntax_ = fault;
      out_.program_.clear();
      out_.variables_.clear();
    }
  }

 private:
  using Op = Condition::Op;

  [[noreturn]] void fail(const std::string& expected) const { throw Condition::Fault{at_, expected}; }
  char peek(int ahead = 0) const {
    const auto i = static_cast<std::size_t>(at_ + ahead);
    return i < text_.size() ? text_[i] : '\0';
  }
  char next() {
    while (peek() == ' ' || peek() == '\t' || peek() == '\n') ++at_;
    return peek();
  }
  bool take(std::string_view symbol) {
    next();
    if (text_.compare(static_cast<std::size_t>(at_), symbol.size(), symbol) != 0) return false;
    at_ += static_cast<int>(symbol.size());
    return true;
  }
  bool take_word(std::string_view word) {
    next();
    const auto after = static_cast<int>(word.size());
    if (text_.compare(static_cast<std::size_t>(at_), word.size(), word) != 0) return false;
    if (is_letter(peek(after)) || is_digit(peek(after))) return false;
    at_ += after;
    return true;
  }
  void emit(Op op, int offset) {
    Condition::Instruction i;
    i.op = op;
    i.offset = offset;
    out_.program_.push_back(i);
  }
  template <class Operand>
  void chain(std::initializer_list<std::pair<const char*, Op>> operators, bool words, const Operand& operand) {
    operand();
    for (bool again = true; again;) {
      again = false;
      for (const auto& [symbol, op] : operators) {
        next();
        const int offset = at_;
        if (!(words ? take_word(symbol) : take(symbol))) continue;
        operand();
        emit(op, offset);
        again = true;
        break;
      }
    }
  }

  void alternatives() {
    if (++nested_ > 100) fail("expected fewer nested parentheses");
    chain({{"or", Op::logical_or}}, true, [this] { conjunction(); });
    --nested_;
  }
  void conjunction() {
    chain({{"and", Op::logical_and}}, true, [this] { negation(); });
  }
  void negation() {
    next();
    const int offset = at_;
    if (!take_word("not")) return comparison();
    if (++nested_ > 100) fail("expected fewer nots");
    negation();
    --nested_;
    emit(Op::logical_not, offset);
  }
  void comparison() {
    sum();
    next();
    const int offset = at_;
    for (const auto& [symbol, op] : std::initializer_list<std::pair<const char*, Op>>{{"<=", Op::less_equal},
                                                                                      {">=", Op::greater_equal},
                                                                                      {"==", Op::equal},
                                                                                      {"!=", Op::not_equal},
                                                                                      {"<", Op::less},
                                                                                      {">", Op::greater}}) {
      if (!take(symbol)) continue;
      sum();
      emit(op, offset);
      next();
      if (peek() == '<' || peek() == '>' || peek() == '=') fail("expected `and` between two comparisons");
      return;
    }
  }
  void sum() {
    chain({{"+", Op::add}, {"-", Op::subtract}}, false, [this] { product(); });
  }
  void product() {
    chain({{"*", Op::multiply}, {"/", Op::divide}}, false, [this] { signed_value(); });
  }
  void signed_value() {
    next();
    const int offset = at_;
    if (take("-")) {
      if (++nested_ > 100) fail("expected fewer signs");
      signed_value();
      --nested_;
      return emit(Op::negate, offset);
    }
    power();
  }
  void power() {
    value();
    next();
    const int offset = at_;
    if (!take("^")) return;
    signed_value();
    emit(Op::power, offset);
  }
  void value() {
    const char c = next();
    if (take("(")) {
      alternatives();
      if (!take(")")) fail("expected a closing parenthesis");
      return;
    }
    if (is_digit(c) || (c == '.' && is_digit(peek(1)))) return number();
    if (is_letter(c)) return name();
    fail(c == '\0' ? "expected a value before the end" : "expected a number, a name or a parenthesis");
  }

  void number() {
    Condition::Instruction i;
    i.offset = at_;
    const std::string_view rest = std::string_view(text_).substr(static_cast<std::size_t>(at_));
    const std::size_t length = number_length(rest);
    if (length == 0 || !parse_number(rest.substr(0, length), i.value)) fail("expected a number");
    at_ += static_cast<int>(length);
    const int end = at_;
    next();
    const bool reciprocal = peek() == '1' && peek(1) == '/' && is_letter(peek(2));
    const bool is_unit = reciprocal || (is_letter(peek()) && !is_word());
    if (!is_unit) {
      at_ = end;
      out_.program_.push_back(i);
      return;
    }
    read_unit(i, reciprocal);
    out_.program_.push_back(i);
  }
  /// Whether "and" or "or" follows, which are no units.
  bool is_word() const {
    for (const std::string_view word : {"and", "or", "not"}) {
      const auto n = static_cast<int>(word.size());
      if (text_.compare(static_cast<std::size_t>(at_), word.size(), word) == 0 && !is_letter(peek(n)) &&
          !is_digit(peek(n)))
        return true;
    }
    return false;
  }
  /// A unit has no spaces in it; "/" and "." belong to it where a letter follows at once.
  void read_unit(Condition::Instruction& i, bool reciprocal) {
    const int from = at_;
    if (reciprocal) at_ += 2;
    while (is_letter(peek()) || is_digit(peek()) || ((peek() == '/' || peek() == '.') && is_letter(peek(1)))) ++at_;
    const std::string unit = text_.substr(static_cast<std::size_t>(from), static_cast<std::size_t>(at_ - from));
    const auto base = unit_in_base(unit);
    if (!base) {
      at_ = from;
      fail(fmt::format("\"{}\" is no unit, or has a shifted zero; expected a unit such as GPa, m/s or K", unit));
    }
    i.value *= base->factor;
    i.has_unit = true;
    i.dimension = base->exponents;
  }

  void name() {
    const int offset = at_;
    while (is_letter(peek()) || is_digit(peek())) ++at_;
    const std::string found = text_.substr(static_cast<std::size_t>(offset), static_cast<std::size_t>(at_ - offset));
    if (found == "and" || found == "or") {
      at_ = offset;
      fail(fmt::format("expected a value before \"{}\"", found));
    }
    if (take("(")) return call(found, offset);
    auto known = std::find_if(out_.variables_.begin(), out_.variables_.end(),
                              [&](const Condition::Variable& v) { return v.name == found; });
    if (known == out_.variables_.end()) known = out_.variables_.insert(known, {found, offset});
    emit(Op::variable, offset);
    out_.program_.back().variable = static_cast<int>(known - out_.variables_.begin());
  }
  void call(const std::string& name, int offset) {
    static const std::pair<const char*, Op> of_one[] = {
        {"abs", Op::abs}, {"sqrt", Op::sqrt}, {"exp", Op::exp}, {"log", Op::log}};
    static const std::pair<const char*, Op> of_two[] = {{"min", Op::min}, {"max", Op::max}};
    alternatives();
    for (const auto& [known, op] : of_one)
      if (name == known) {
        if (!take(")")) fail("expected a closing parenthesis");
        return emit(op, offset);
      }
    for (const auto& [known, op] : of_two)
      if (name == known) {
        if (!take(",")) fail("expected a comma and a second value");
        alternatives();
        if (!take(")")) fail("expected a closing parenthesis");
        return emit(op, offset);
      }
    at_ = offset;
    fail(fmt::format("there is no function \"{}\"; the functions are abs, sqrt, exp, log, min and max", name));
  }

  void check_depth() {
    int depth = 0;
    for (const Condition::Instruction& i : out_.program_) {
      depth += i.op <= Op::variable ? 1 : i.op <= Op::logical_not ? 0 : -1;
      at_ = i.offset;
      if (depth > Condition::most_depth) fail("expected fewer values that wait for each other; use less parentheses");
    }
  }

  const std::string& text_;
  Condition& out_;
  int at_ = 0, nested_ = 0;
};

/// Runs the program with dimensions in place of values.
class ConditionUnits {
 public:
  ConditionUnits(const Condition& expression, std::vector<std::optional<UnitExponents>> variables)
      : expression_(expression), variables_(std::move(variables)) {}

  std::vector<Condition::Fault> run() {
    for (const Condition::Instruction& i : expression_.program_) step(i);
    if (stack_.back().kind != Kind::condition)
      fault(0, "expected a condition, such as \"damage > 0.9\", and this is a number");
    return std::move(faults_);
  }

 private:
  using Op = Condition::Op;
  // A number without a unit goes with any dimension, and so does what has been complained of.
  enum class Kind { condition, quantity, any };
  struct Value {
    Kind kind = Kind::any;
    UnitExponents dimension{};
    std::optional<double> number = {};  // where it stands in the text
  };

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
  void need_condition(const Value& v, int offset) {
    if (v.kind == Kind::quantity) fault(offset, "expected conditions at this operator, and one side is a number");
  }
  static std::string text(const UnitExponents& d) {
    static const char* const names[] = {"m", "kg", "s", "A", "K", "mol", "cd"};
    std::string all;
    for (std::size_t k = 0; k < d.size(); ++k)
      if (d[k] != 0.0)
        all += fmt::format("{}{}{}", all.empty() ? "" : " ", names[k], d[k] == 1.0 ? "" : fmt::format("{}", d[k]));
    return all.empty() ? "no unit" : all;
  }
  Value agreed(const Value& a, const Value& b, int offset) {
    if (a.kind == Kind::any) return {b.kind, b.dimension, {}};
    if (b.kind == Kind::any) return {a.kind, a.dimension, {}};
    if (a.dimension != b.dimension)
      fault(offset, fmt::format("the sides of this operator have different dimensions, {} and {}; expected the same",
                                text(a.dimension), text(b.dimension)));
    return {Kind::quantity, a.dimension, {}};
  }
  void need_no_dimension(const Value& v, int offset, const char* what) {
    if (v.kind == Kind::quantity && v.dimension != UnitExponents{})
      fault(offset, fmt::format("{} takes a number without unit, and this has {}", what, text(v.dimension)));
  }

  void step(const Condition::Instruction& i) {
    const int at = i.offset;
    switch (i.op) {
      case Op::number:
        return stack_.push_back(i.has_unit ? Value{Kind::quantity, i.dimension, {}} : Value{Kind::any, {}, i.value});
      case Op::variable: {
        const auto& d = variables_[static_cast<std::size_t>(i.variable)];
        return stack_.push_back(d ? Value{Kind::quantity, *d, {}} : Value{});
      }
      case Op::logical_not:
        need_condition(stack_.back(), at);
        stack_.back() = {Kind::condition, {}, {}};
        return;
      case Op::negate:
      case Op::abs: {
        Value v = pop_number(at);
        if (v.number) v.number = i.op == Op::abs ? std::fabs(*v.number) : -*v.number;
        return stack_.push_back(v);
      }
      case Op::sqrt: {
        Value v = pop_number(at);
        for (double& e : v.dimension) e *= 0.5;
        v.number.reset();
        return stack_.push_back(v);
      }
      case Op::exp:
      case Op::log:
        need_no_dimension(pop_number(at), at, i.op == Op::exp ? "exp" : "log");
        return stack_.push_back({Kind::quantity, {}, {}});
      default:
        return of_two(i);
    }
  }
  void of_two(const Condition::Instruction& i) {
    if (i.op == Op::logical_and || i.op == Op::logical_or) {
      need_condition(pop(), i.offset);
      need_condition(pop(), i.offset);
      return stack_.push_back({Kind::condition, {}, {}});
    }
    const Value b = pop_number(i.offset), a = pop_number(i.offset);
    if (i.op == Op::power) return stack_.push_back(raised(a, b, i.offset));
    if (i.op == Op::multiply || i.op == Op::divide) {
      Value v{a.kind == Kind::any && b.kind == Kind::any ? Kind::any : Kind::quantity, a.dimension, {}};
      for (std::size_t k = 0; k < v.dimension.size(); ++k)
        v.dimension[k] += i.op == Op::multiply ? b.dimension[k] : -b.dimension[k];
      return stack_.push_back(v);
    }
    const Value v = agreed(a, b, i.offset);
    const bool compares = i.op >= Op::less;
    stack_.push_back(compares ? Value{Kind::condition, {}, {}} : v);
  }
  Value raised(const Value& a, const Value& b, int offset) {
    need_no_dimension(b, offset, "an exponent");
    if (a.kind == Kind::any) return {};
    if (a.dimension != UnitExponents{} && !b.number) {
      fault(offset, "a quantity with a unit is raised to a power that is not written as a number");
      return {};
    }
    Value v{Kind::quantity, a.dimension, {}};
    for (double& e : v.dimension) e *= b.number.value_or(1.0);
    return v;
  }

  const Condition& expression_;
  std::vector<std::optional<UnitExponents>> variables_;
  std::vector<Value> stack_;
  std::vector<Condition::Fault> faults_;
};

Condition::Condition(const std::string& text) { ConditionParser(text, *this).parse(); }

std::vector<Condition::Fault> Condition::faults(
    const std::function<std::optional<std::string>(const std::string&)>& unit_of) const {
  if (syntax_) return {*syntax_};
  if (program_.empty()) return {{0, "expected a condition, such as \"damage > 0.9\""}};
  std::vector<std::optional<UnitExponents>> dimensions;
  for (const Variable& v : variables_) {
    const auto unit = unit_of(v.name);
    const auto base = unit ? unit_in_base(*unit) : std::nullopt;
    dimensions.push_back(base ? std::optional(base->exponents) : std::nullopt);
  }
  return ConditionUnits(*this, std::move(dimensions)).run();
}

void Condition::evaluate(const double* const* rows, double (&out)[lane_width]) const {
  KERF_ASSERT(!program_.empty(), "only expressions that can be read are evaluated");
  alignas(64) double stack[most_depth][lane_width];
  int top = -1;
  const auto one = [&](const auto& work) {
    double(&a)[lane_width] = stack[top];
    for (int l = 0; l < lane_width; ++l) a[l] = work(a[l]);
  };
  const auto two = [&](const auto& work) {
    double(&a)[lane_width] = stack[top - 1];
    const double(&b)[lane_width] = stack[top];
    for (int l = 0; l < lane_width; ++l) a[l] = work(a[l], b[l]);
    --top;
  };
  const auto holds = [](bool condition) { return select(condition, 1.0, 0.0); };
  for (const Instruction& i : program_) switch (i.op) {
      case Op::number:
        std::fill_n(stack[++top], lane_width, i.value);
        break;
      case Op::variable:
        std::copy_n(rows[i.variable], lane_width, stack[++top]);
        break;
      case Op::negate:
        one([](double a) { return -a; });
        break;
      case Op::abs:
        one([](double a) { return std::fabs(a); });
        break;
      case Op::sqrt:
        one([](double a) { return std::sqrt(a); });
        break;
      case Op::exp:
        one([](double a) { return kerf::exp(a); });
        break;
      case Op::log:
        one([](double a) { return kerf::log(a); });
        break;
      case Op::logical_not:
        one([](double a) { return 1.0 - a; });
        break;
      case Op::add:
        two([](double a, double b) { return a + b; });
        break;
      case Op::subtract:
        two([](double a, double b) { return a - b; });
        break;
      case Op::multiply:
        two([](double a, double b) { return a * b; });
        break;
      case Op::divide:
        two([](double a, double b) { return a / b; });
        break;
      case Op::power:
        two([](double a, double b) { return kerf::pow(a, b); });
        break;
      case Op::min:
        two([](double a, double b) { return min_of(a, b); });
        break;
      case Op::max:
        two([](double a, double b) { return max_of(a, b); });
        break;
      case Op::less:
        two([&](double a, double b) { return holds(a < b); });
        break;
      case Op::less_equal:
        two([&](double a, double b) { return holds(a <= b); });
        break;
      case Op::greater:
        two([&](double a, double b) { return holds(a > b); });
        break;
      case Op::greater_equal:
        two([&](double a, double b) { return holds(a >= b); });
        break;
      case Op::equal:
        two([&](double a, double b) { return holds(a == b); });
        break;
      case Op::not_equal:
        two([&](double a, double b) { return holds(a != b); });
        break;
      case Op::logical_and:
        two([](double a, double b) { return a * b; });
        break;
      case Op::logical_or:
        two([](double a, double b) { return max_of(a, b); });
        break;
    }
  std::copy_n(stack[0], lane_width, out);
}

}  // namespace kerf
