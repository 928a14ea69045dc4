// Looks parameters up and evaluates expressions, by recursive descent.
#include "decks/parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "decks/card_text.hpp"
#include "kerf/functions.hpp"

namespace kerf::decks {
namespace {

constexpr int most_nested = 60;

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

bool sees(const Parameter& parameter, const Asker& asker) {
  return parameter.order < asker.order && (parameter.source < 0 || std::find(asker.sources.begin(), asker.sources.end(),
                                                                             parameter.source) != asker.sources.end());
}

/// Thrown within the reader only.
struct Refusal {
  std::string sentence;
  std::size_t at;
};

class Reader {
 public:
  Reader(std::string_view text, const Parameters& parameters, const Asker& asker)
      : text_(text), parameters_(parameters), asker_(asker) {}

  DeckExpression read() {
    try {
      const DeckNumber value = sum();
      if (peek() != '\0') refuse(at_, fmt::format("unexpected `{}` in an expression", peek()));
      if (!std::isfinite(value.real)) refuse(0, "the expression has no finite value");
      return {value, {}, 0};
    } catch (const Refusal& refusal) {
      return {{}, refusal.sentence, static_cast<std::int32_t>(refusal.at)};
    }
  }

 private:
  [[noreturn]] void refuse(std::size_t at, const std::string& what) const { throw Refusal{what, at}; }
  char peek() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  struct Nested {
    explicit Nested(Reader& r) : reader(r) {
      if (++reader.nested_ > most_nested) reader.refuse(reader.at_, "the expression is nested too deeply");
    }
    ~Nested() { --reader.nested_; }
    Nested(const Nested&) = delete;
    Nested& operator=(const Nested&) = delete;
    Reader& reader;
  };

  DeckNumber sum() {
    const Nested nested(*this);
    DeckNumber value = product();
    for (char c = peek(); c == '+' || c == '-'; c = peek()) {
      ++at_;
      const DeckNumber right = product();
      value = {c == '+' ? value.real + right.real : value.real - right.real, value.integer && right.integer};
    }
    return value;
  }
  DeckNumber product() {
    DeckNumber value = signed_power();
    for (char c = peek(); c == '*' || c == '/'; c = peek()) {
      const std::size_t at = at_++;
      const DeckNumber right = signed_power();
      if (c == '/') value = quotient(value, right, at);
      if (c == '*') value = {value.real * right.real, value.integer && right.integer};
    }
    return value;
  }
  DeckNumber quotient(DeckNumber a, DeckNumber b, std::size_t at) const {
    if (b.real == 0.0) refuse(at, "division by zero");
    const DeckNumber q{a.real / b.real, a.integer && b.integer};
    if (q.integer && q.real != std::floor(q.real))
      refuse(at, fmt::format("{}/{} divides two integers with a remainder; write {}.0 if a real number is meant",
                             a.real, b.real, a.real));
    return q;
  }
  DeckNumber signed_power() {
    const Nested nested(*this);
    const char c = peek();
    if (c == '+' || c == '-') {
      ++at_;
      const DeckNumber value = signed_power();
      return {c == '-' ? -value.real : value.real, value.integer};
    }
    const DeckNumber base = operand();
    peek();
    const bool stars = text_.substr(at_, 2) == "**";
    if (!stars && peek() != '^') return base;
    at_ += stars ? 2 : 1;
    const DeckNumber exponent = signed_power();
    return {power(base.real, exponent.real), base.integer && exponent.integer && exponent.real >= 0.0};
  }
  static double power(double base, double exponent) {
    if (exponent == std::floor(exponent) && std::abs(exponent) <= 64.0) {  // exact for integers, negative ones too
      double product = 1.0;
      for (int k = 0; k < static_cast<int>(std::abs(exponent)); ++k) product *= base;
      return exponent < 0.0 ? 1.0 / product : product;
    }
    return kerf::pow(base, exponent);
  }
  DeckNumber operand() {
    const char c = peek();
    if (c == '(') {
      ++at_;
      const DeckNumber value = sum();
      close();
      return value;
    }
    if (is_digit(c) || c == '.') return number();
    if (c == '&' || is_letter(c)) return name();
    refuse(at_, c == '\0' ? "the expression ends too early" : fmt::format("unexpected `{}` in an expression", c));
  }
  void close() {
    if (peek() != ')') refuse(at_, "a parenthesis is not closed");
    ++at_;
  }
  DeckNumber number() {
    const std::size_t start = at_;
    bool integer = true;
    while (at_ < text_.size() && (is_digit(text_[at_]) || text_[at_] == '.')) integer = text_[at_++] != '.' && integer;
    if (at_ < text_.size() && std::string_view("eEdD").find(text_[at_]) != std::string_view::npos) {
      std::size_t end = at_ + 1;
      if (end < text_.size() && (text_[end] == '+' || text_[end] == '-')) ++end;
      if (end < text_.size() && is_digit(text_[end])) {
        while (end < text_.size() && is_digit(text_[end])) ++end;
        at_ = end;
        integer = false;
      }
    }
    double value = 0.0;
    const std::string_view written = text_.substr(start, at_ - start);
    if (!read_deck_real(written, value)) refuse(start, fmt::format("\"{}\" is no number", written));
    return {value, integer};
  }
  DeckNumber name() {
    const std::size_t start = at_;
    if (text_[at_] == '&') ++at_;
    std::size_t end = at_;
    while (end < text_.size() && (is_letter(text_[end]) || is_digit(text_[end]))) ++end;
    const std::string_view name = text_.substr(at_, end - at_);
    at_ = end;
    if (peek() == '(' && text_[start] != '&') return call(lower_case(name), start);
    const Parameter* parameter = parameters_.find(name, asker_);
    if (parameter && parameter->type == 'C')
      refuse(start, fmt::format("parameter {} is text; an expression takes numbers", name));
    if (parameter) return parameter->value;
    if (lower_case(name) == "pi") return {3.14159265358979323846, false};
    refuse(start, undefined_parameter(name, parameters_, asker_));
  }
  DeckNumber call(const std::string& function, std::size_t start) {
    ++at_;
    std::vector<DeckNumber> values;
    do {
      values.push_back(sum());
    } while (peek() == ',' && ++at_ > 0);
    close();
    if (values.size() == 1) return of_one(function, values[0], start);
    if (values.size() == 2) return of_two(function, values[0], values[1], start);
    refuse(start, fmt::format("there is no function `{}` of {} arguments", function, values.size()));
  }
  DeckNumber of_one(const std::string& f, DeckNumber a, std::size_t start) const {
    const double x = a.real;
    if (f == "abs") return {std::abs(x), a.integer};
    if (f == "float") return {x, false};
    if (f == "int") return {std::trunc(x), true};
    if (f == "nint") return {std::round(x), true};
    if (f == "sqrt") return {std::sqrt(x), false};
    if (f == "exp") return {kerf::exp(x), false};
    if (f == "log") return {kerf::log(x), false};
    if (f == "log10") return {kerf::log10(x), false};
    if (f == "sin") return {kerf::sin(x), false};
    if (f == "cos") return {kerf::cos(x), false};
    if (f == "tan") return {kerf::tan(x), false};
    if (f == "asin") return {kerf::asin(x), false};
    if (f == "acos") return {kerf::acos(x), false};
    if (f == "atan") return {kerf::atan(x), false};
    if (f == "tanh") return {kerf::tanh(x), false};
    refuse(start, fmt::format("there is no function `{}` of one argument", f));
  }
  DeckNumber of_two(const std::string& f, DeckNumber a, DeckNumber b, std::size_t start) const {
    const bool integer = a.integer && b.integer;
    if (f == "min") return {std::min(a.real, b.real), integer};
    if (f == "max") return {std::max(a.real, b.real), integer};
    if (f == "mod" && b.real != 0.0) return {std::fmod(a.real, b.real), integer};
    if (f == "atan2") return {kerf::atan2(a.real, b.real), false};
    refuse(start, f == "mod" ? "division by zero" : fmt::format("there is no function `{}` of two arguments", f));
  }

  std::string_view text_;
  const Parameters& parameters_;
  const Asker& asker_;
  std::size_t at_ = 0;
  int nested_ = 0;
};

}  // namespace

bool Parameters::define(const std::string& name, const Parameter& parameter) {
  std::vector<Parameter>& all = definitions_[lower_case(name)];
  const bool hides = std::any_of(all.begin(), all.end(), [&](const Parameter& other) {
    return other.source == parameter.source &&
           (other.value.real != parameter.value.real || other.text != parameter.text);
  });
  all.push_back(parameter);
  return !hides;
}

const Parameter* Parameters::find(std::string_view name, const Asker& asker) const {
  const auto found = definitions_.find(lower_case(name));
  if (found == definitions_.end()) return nullptr;
  const Parameter* best = nullptr;
  std::ptrdiff_t depth = 0;  // of the best, from the innermost; global ones are farthest
  for (const Parameter& parameter : found->second) {
    if (!sees(parameter, asker)) continue;
    const auto at = std::find(asker.sources.begin(), asker.sources.end(), parameter.source) - asker.sources.begin();
    if (!best || at <= depth) {
      best = &parameter;
      depth = at;
    }
  }
  return best;
}

std::string Parameters::names_for(const Asker& asker) const {
  std::string names;
  std::size_t n = 0;
  for (const auto& [name, all] : definitions_) {
    if (std::none_of(all.begin(), all.end(), [&](const Parameter& p) { return sees(p, asker); })) continue;
    if (++n <= 20) names += (names.empty() ? "" : ", ") + name;
  }
  return n > 20 ? names + fmt::format(" and {} more", n - 20) : names;
}

DeckExpression evaluate(std::string_view text, const Parameters& parameters, const Asker& asker) {
  return Reader(text, parameters, asker).read();
}

std::string undefined_parameter(std::string_view name, const Parameters& parameters, const Asker& asker) {
  const std::string names = parameters.names_for(asker);
  const std::string shown = to_utf8(name);
  return names.empty() ? fmt::format("parameter {} is not defined before this place; there are no parameters", shown)
                       : fmt::format("parameter {} is not defined; the parameters are: {}", shown, names);
}

}  // namespace kerf::decks
