// Reads formulas of the input, by recursive descent, into instructions for a stack.
//
// From loosest to tightest: `or`; `and`; `not`; one comparison (< <= > >= == !=); + and -; * and /; the sign; ^, which
// binds to the right (2^3^2 = 2^9, -x^2 = -(x^2)). Further: parentheses; numbers, with a unit where one follows ("2
// GPa", "300 m/s", "5 1/ms", converted to SI); `pi`; `$name` for a parameter of the input; names of variables, which
// are in SI units; and the functions of the table below. Dimensions are checked elsewhere: core/dimensions.cpp.
#include "core/expression.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "core/diagnostics.hpp"
#include "core/units.hpp"

namespace kerf {
namespace {

using Op = Expression::Op;

struct Function {
  const char* name;
  Op op;
  int n_arguments;  // of min and max: at least this many
};

constexpr Function functions[] = {
    {"sqrt", Op::sqrt, 1},   {"exp", Op::exp, 1},   {"log", Op::log, 1},     {"log10", Op::log10, 1},
    {"min", Op::min, 2},     {"max", Op::max, 2},   {"abs", Op::abs, 1},     {"sign", Op::sign, 1},
    {"sin", Op::sin, 1},     {"cos", Op::cos, 1},   {"tan", Op::tan, 1},     {"asin", Op::asin, 1},
    {"acos", Op::acos, 1},   {"atan", Op::atan, 1}, {"atan2", Op::atan2, 2}, {"tanh", Op::tanh, 1},
    {"hypot", Op::hypot, 2}, {"if", Op::choose, 3},
};

// Of parentheses, signs and powers within each other: more is no formula that a person wrote.
constexpr int most_nested = 100;

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) || c == '_'; }
bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }
// Units have letters beyond ASCII as well (a micro sign).
bool is_unit_letter(char c) { return is_letter(c) || (static_cast<unsigned char>(c) & 0x80) != 0; }

/// Thrown within the reader only.
struct Refusal {
  std::string sentence;
  std::size_t at;
};

class Reader {
 public:
  Reader(std::string_view text, const std::vector<std::string>& variables, const ParameterText& parameter)
      : text_(text), parameter_(parameter), variables_(variables), open_(variables.empty()) {}

  ReadExpression read() {
    try {
      any_of_several();
      if (peek() != '\0') unexpected("an operator or the end");
    } catch (const Refusal& refusal) {
      return {{}, refusal.sentence, static_cast<int>(refusal.at)};
    }
    return {Expression(std::string(text_), variables_, program_, units_), {}, 0};
  }

 private:
  [[noreturn]] void refuse(std::size_t at, const std::string& what) const {
    throw Refusal{fmt::format("\"{}\", character {}: {}", text_, at + 1, what), at};
  }
  [[noreturn]] void unexpected(const std::string& expected) {
    const char c = peek();
    refuse(at_, c == '\0' ? fmt::format("the formula ends too early; expected {}", expected)
                          : fmt::format("unexpected `{}`; expected {}", token(), expected));
  }
  /// What stands at the place, for a message.
  std::string token() const {
    std::size_t end = at_;
    while (end < text_.size() && (is_unit_letter(text_[end]) || is_digit(text_[end]))) ++end;
    return std::string(text_.substr(at_, std::max<std::size_t>(1, end - at_)));
  }
  /// The next character that is no space; 0 at the end.
  char peek() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  /// Where the next character that is no space stands.
  std::size_t here() {
    peek();
    return at_;
  }
  bool take(std::string_view symbol) {
    peek();
    if (text_.substr(at_, symbol.size()) != symbol) return false;
    at_ += symbol.size();
    return true;
  }
  void expect(char c, const char* what) {
    if (peek() != c) unexpected(what);
    ++at_;
  }
  /// The name at the place; empty where there is none.
  std::string_view word() {
    if (!is_letter(peek())) return {};
    std::size_t end = at_;
    while (end < text_.size() && (is_letter(text_[end]) || is_digit(text_[end]))) ++end;
    return text_.substr(at_, end - at_);
  }
  bool take_word(std::string_view wanted) {
    if (word() != wanted) return false;
    at_ += wanted.size();
    return true;
  }

  void emit(Op op, int n_taken, std::size_t offset) { add({op, 0, 0.0, static_cast<int>(offset)}, 1 - n_taken); }
  void emit_number(double value, std::size_t offset, const std::string& unit) {
    Expression::Instruction i{Op::number, 0, value, static_cast<int>(offset)};
    if (const auto base = unit.empty() ? std::nullopt : unit_in_base(unit)) {
      units_.push_back(base->exponents);
      i.index = static_cast<int>(units_.size());
    }
    add(i, 1);
  }
  void add(const Expression::Instruction& i, int growth) {
    program_.push_back(i);
    depth_ += growth;
    if (depth_ > Expression::most_depth)
      refuse(at_, "the formula is nested too deeply; write long sums and products from left to right");
  }
  /// Counts how deeply calls are nested, so that no text can exhaust the stack.
  struct Nested {
    explicit Nested(Reader& r) : reader(r) {
      if (++reader.nested_ > most_nested) reader.refuse(reader.at_, "the formula is nested too deeply");
    }
    ~Nested() { --reader.nested_; }
    Nested(const Nested&) = delete;
    Nested& operator=(const Nested&) = delete;
    Reader& reader;
  };

  void any_of_several() {
    all_of_several();
    for (std::size_t at = here(); take_word("or"); at = here()) {
      all_of_several();
      emit(Op::either, 2, at);
    }
  }
  void all_of_several() {
    condition();
    for (std::size_t at = here(); take_word("and"); at = here()) {
      condition();
      emit(Op::both, 2, at);
    }
  }
  void condition() {
    const Nested nested(*this);
    if (const std::size_t at = here(); take_word("not")) {
      condition();
      return emit(Op::opposite, 1, at);
    }
    sum();
    Op op = Op::equal;
    const std::size_t at = here();
    if (!take_comparison(op)) return;
    sum();
    emit(op, 2, at);
    const std::size_t again = here();
    if (take_comparison(op)) refuse(again, "comparisons do not chain; write `a < b and b < c`");
  }
  bool take_comparison(Op& op) {
    static constexpr std::pair<std::string_view, Op> signs[] = {{"<=", Op::at_most}, {">=", Op::at_least},
                                                                {"==", Op::equal},   {"!=", Op::unequal},
                                                                {"<", Op::less},     {">", Op::greater}};
    for (const auto& [sign, meaning] : signs)
      if (take(sign)) {
        op = meaning;
        return true;
      }
    if (peek() == '=') refuse(at_, "`=` compares nothing; write `==`");
    return false;
  }
  void sum() {
    product();
    for (;;) {
      const char c = peek();
      if (c != '+' && c != '-') return;
      const std::size_t at = at_++;
      product();
      emit(c == '+' ? Op::add : Op::subtract, 2, at);
    }
  }
  void product() {
    signed_power();
    for (;;) {
      const char c = peek();
      if (c != '*' && c != '/') return;
      if (text_.substr(at_, 2) == "**") refuse(at_, "`**` is no operator; write `^` for a power");
      const std::size_t at = at_++;
      signed_power();
      emit(c == '*' ? Op::multiply : Op::divide, 2, at);
    }
  }
  void signed_power() {
    const Nested nested(*this);
    const char c = peek();
    if (c == '+' || c == '-') {
      const std::size_t at = at_++;
      signed_power();
      if (c == '-') emit(Op::negate, 1, at);
      return;
    }
    operand();
    if (peek() != '^') return;
    const std::size_t at = at_++;
    signed_power();
    emit(Op::power, 2, at);
  }
  void operand() {
    const char c = peek();
    if (c == '(') {
      ++at_;
      any_of_several();
      return expect(')', "`)`");
    }
    if (is_digit(c) || c == '.') return number();
    if (c == '$') return parameter();
    if (is_letter(c)) return name();
    unexpected("a number, a name or `(`");
  }
  void number() {
    const std::size_t length = number_length(text_.substr(at_)), start = at_;
    double value = 0.0;
    if (length == 0 || !parse_number(text_.substr(at_, length), value))
      refuse(at_, fmt::format("`{}` is no number that fits double precision", token()));
    at_ += length;
    const std::string unit = unit_here();
    if (unit.empty()) return emit_number(value, start, unit);
    const Quantity q = to_si_of_any_kind(value, unit);
    if (!q.ok()) refuse(start, fmt::format("{}; write `*` between a number and a name", q.error));
    emit_number(q.value, start, unit);
  }
  /// The unit after a number: names joined by `/` without spaces, each with digits as its power ("kg/m3"); "1/" may
  /// stand before them ("1/s").
  std::string unit_here() {
    std::size_t end = at_;
    while (end < text_.size() && text_[end] == ' ') ++end;
    const std::size_t start = end;
    const bool inverse = end > at_ && text_.substr(end, 2) == "1/";
    if (inverse) end += 2;
    const auto names = [&] {
      while (end < text_.size() && is_unit_letter(text_[end])) ++end;
      while (end < text_.size() && is_digit(text_[end])) ++end;
    };
    if (end >= text_.size() || !is_unit_letter(text_[end])) return {};
    names();
    const std::string_view first = text_.substr(start, end - start);
    if (first == "and" || first == "or") return {};
    while (end + 1 < text_.size() && text_[end] == '/' && is_unit_letter(text_[end + 1])) {
      ++end;
      names();
    }
    at_ = end;
    return std::string(text_.substr(start, end - start));
  }
  void parameter() {
    const std::size_t start = at_++;
    const std::string name(at_ < text_.size() && is_letter(text_[at_]) ? word() : std::string_view());
    const std::string* value = parameter_ && !name.empty() ? parameter_(name) : nullptr;
    if (!value) refuse(start, fmt::format("there is no parameter \"{}\"; declare it in the block `parameters`", name));
    at_ += name.size();
    // Its text is one number, with a unit where it has one.
    const std::string_view text = trimmed(*value);
    const std::size_t length = number_length(text);
    double number = 0.0;
    if (length == 0 || !parse_number(text.substr(0, length), number))
      refuse(start, fmt::format("the parameter ${} is \"{}\"; expected a number", name, *value));
    const std::string unit(trimmed(text.substr(length)));
    if (unit.empty()) return emit_number(number, start, unit);
    const Quantity q = to_si_of_any_kind(number, unit);
    if (!q.ok()) refuse(start, fmt::format("the parameter ${}: {}", name, q.error));
    emit_number(q.value, start, unit);
  }
  void name() {
    const std::size_t start = at_;
    const std::string name(word());
    at_ += name.size();
    if (name == "and" || name == "or" || name == "not")
      refuse(start, fmt::format("unexpected `{}`; expected a number, a name or `(`", name));
    if (peek() == '(') return call(name, start);
    if (name == "pi") return emit_number(3.14159265358979323846, start, {});
    auto it = std::find(variables_.begin(), variables_.end(), name);
    if (it == variables_.end()) {
      if (!open_) refuse(start, unknown(name));
      it = variables_.insert(variables_.end(), name);
    }
    add({Op::variable, static_cast<int>(it - variables_.begin()), 0.0, static_cast<int>(start)}, 1);
  }
  std::string unknown(const std::string& name) const {
    std::string list;
    for (const std::string& v : variables_) list += (list.empty() ? "" : ", ") + v;
    // All short names are near to each other.
    const std::string near = name.size() > 2 ? nearest_name(name, variables_) : "";
    return fmt::format("there is no variable `{}`; {}", name,
                       near.empty() ? "the variables are " + list : "did you mean " + near + "?");
  }
  void call(const std::string& name, std::size_t start) {
    const auto* f = std::find_if(std::begin(functions), std::end(functions),
                                 [&](const Function& each) { return name == each.name; });
    if (f == std::end(functions)) {
      std::vector<std::string> names;
      for (const Function& each : functions) names.emplace_back(each.name);
      const std::string near = nearest_name(name, names);
      refuse(start, fmt::format("there is no function `{}`; {}", name,
                                near.empty() ? fmt::format("the functions are {}", fmt::join(names, ", "))
                                             : "did you mean " + near + "?"));
    }
    const bool folds = f->op == Op::min || f->op == Op::max;
    ++at_;
    int n = 0;
    do {
      any_of_several();
      ++n;
      if (folds && n > 1) emit(f->op, 2, start);
    } while (take(","));
    expect(')', "`,` or `)`");
    if (folds ? n < 2 : n != f->n_arguments)
      refuse(start, fmt::format("{} takes {}{} argument{}, not {}", name, folds ? "at least " : "", f->n_arguments,
                                f->n_arguments == 1 ? "" : "s", n));
    if (!folds) emit(f->op, n, start);
  }

  std::string_view text_;
  const ParameterText& parameter_;
  std::vector<std::string> variables_;
  const bool open_;  // any name is a variable
  std::vector<Expression::Instruction> program_;
  std::vector<Expression::Dimension> units_;
  std::size_t at_ = 0;
  int depth_ = 0, nested_ = 0;
};

}  // namespace

ReadExpression read_expression(std::string_view text, const std::vector<std::string>& variables,
                               const ParameterText& parameter) {
  return Reader(text, variables, parameter).read();
}

}  // namespace kerf
