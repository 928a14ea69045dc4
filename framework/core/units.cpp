// Units: strict parsing of numbers, and conversion by udunits2 with a check of the dimension.
#include "core/units.hpp"

#include <fmt/format.h>
#include <udunits2.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

#include "core/diagnostics.hpp"

namespace kerf {
namespace {

struct FreeUnit {
  void operator()(ut_unit* unit) const { ut_free(unit); }
};
using Unit = std::unique_ptr<ut_unit, FreeUnit>;

// The database takes some milliseconds to read, so it is read when the first unit is met.
ut_system* unit_system() {
  static ut_system* const system = [] {
    ut_set_error_message_handler(ut_ignore);
    ut_system* made = ut_read_xml(nullptr);
    if (!made) throw std::runtime_error("the unit database of udunits2 cannot be read; install libudunits2-data");
    // udunits2 knows the degree of arc as "degree" and "arc_degree" only.
    Unit degree(ut_parse(made, "degree", UT_UTF8));
    ut_map_name_to_unit("deg", UT_UTF8, degree.get());
    ut_map_symbol_to_unit("deg", UT_UTF8, degree.get());
    return made;
  }();
  return system;
}

const std::vector<std::string> common_units = {
    "m",    "mm",    "cm",     "um",  "km",  "s",   "ms",  "us",   "ns",   "m/s",  "km/s", "mm/us", "kg",
    "g",    "kg/m3", "g/cm3",  "Pa",  "kPa", "MPa", "GPa", "kbar", "Mbar", "K",    "degC", "J",     "kJ",
    "J/kg", "kJ/g",  "J/kg/K", "1/s", "N",   "kN",  "rad", "deg",  "N/m",  "N/m3", "J/m2", "Pa s"};

constexpr std::array<std::pair<std::string_view, std::string_view>, 26> quantities = {{
    {"m", "a length"},
    {"m2", "an area"},
    {"m3", "a volume"},
    {"s", "a time"},
    {"1/s", "a rate"},
    {"m/s", "a velocity"},
    {"m/s2", "an acceleration"},
    {"kg", "a mass"},
    {"kg/m3", "a density"},
    {"Pa", "a pressure"},
    {"1/Pa", "a compliance"},
    {"Pa s", "a viscosity"},
    {"N", "a force"},
    {"N/m", "a stiffness"},
    {"N/m3", "a penalty stiffness"},
    {"J", "an energy"},
    {"J/kg", "a specific energy"},
    {"J/m3", "an energy density"},
    {"J/m2", "an energy per area"},
    {"J/kg/K", "a specific heat"},
    {"J/(kg K)", "a specific heat"},
    {"kg/m2", "a mass per area"},
    {"K", "a temperature"},
    {"1/K", "an expansion coefficient"},
    {"rad", "an angle"},
    {"rad/s", "an angular velocity"},
}};

// A radian is a plain number to udunits2, which would let "45 %" through as an angle.
bool measures_angle(std::string_view unit) {
  return unit.find("rad") != unit.npos || unit.find("deg") != unit.npos || unit.find("arc") != unit.npos ||
         unit.find("\u00b0") != unit.npos || unit.find("turn") != unit.npos || unit.find("rev") != unit.npos;
}

// "5 10 m" and "1,5 m" are slips of the pen, although udunits2 reads "10 m" as a unit.
bool may_start_unit(std::string_view unit) {
  const auto c = static_cast<unsigned char>(unit.front());
  return std::isalpha(c) || c >= 0x80 || c == '%' || c == '(' || unit.substr(0, 2) == "1/";
}

std::string unknown_unit(std::string_view text, std::string_view unit, const std::string& si_unit) {
  const std::string near = nearest_name(std::string(unit), common_units);
  if (!near.empty() && near != unit)
    return fmt::format("\"{}\" has the unknown unit \"{}\"; did you mean {}?", text, unit, near);
  return fmt::format("\"{}\" has the unknown unit \"{}\"; expected {}", text, unit, quantity_name(si_unit));
}

Quantity converted(std::string_view text, double number, std::string_view unit, const std::string& si_unit) {
  const Unit from(ut_parse(unit_system(), std::string(unit).c_str(), UT_UTF8));
  if (!from) return {0.0, unknown_unit(text, unit, si_unit)};
  const Unit to(ut_parse(unit_system(), si_unit.c_str(), UT_UTF8));
  if (!to) throw std::runtime_error("a parameter is declared in \"" + si_unit + "\", which is no unit");
  const bool angles_agree = si_unit != "rad" || measures_angle(unit);
  if (!angles_agree || !ut_are_convertible(from.get(), to.get()))
    return {0.0, fmt::format("\"{}\" has the wrong dimension; expected {}, for example {}", text,
                             quantity_name(si_unit), quantity_text(number, si_unit))};
  cv_converter* converter = ut_get_converter(from.get(), to.get());
  if (!converter) return {0.0, unknown_unit(text, unit, si_unit)};
  const double origin = cv_convert_double(converter, 0.0);
  const double value = cv_convert_double(converter, number);
  cv_free(converter);
  if (origin != 0.0 && si_unit != "K")  // "m since 4" and logarithms: only temperatures have a shifted zero
    return {0.0, unknown_unit(text, unit, si_unit)};
  if (!std::isfinite(value)) return {0.0, fmt::format("\"{}\" is too large", text)};
  return {value, {}};
}

std::string not_a_number(std::string_view text, const std::string& si_unit) {
  return fmt::format("\"{}\" is not a number; expected {}", text, quantity_name(si_unit));
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  const auto is_space = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; };
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

std::size_t number_length(std::string_view text) {
  std::size_t sign = !text.empty() && (text[0] == '+' || text[0] == '-') ? 1 : 0;
  const std::string_view digits = text.substr(sign);
  // from_chars would take "inf" and "nan".
  if (digits.empty() || !(std::isdigit(static_cast<unsigned char>(digits[0])) || digits[0] == '.')) return 0;
  double value = 0.0;
  const auto [end, status] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (status == std::errc::invalid_argument) return 0;
  return sign + static_cast<std::size_t>(end - digits.data());
}

std::optional<UnitInBase> unit_in_base(const std::string& unit) {
  if (unit == "-") return UnitInBase{};
  static const char* const names[] = {"m", "kg", "s", "A", "K", "mol", "cd"};
  const Unit from(ut_parse(unit_system(), unit.c_str(), UT_UTF8));
  if (!from) return {};
  // The definition is a text such as "1000000000 m-1.kg.s-2"; angles are "rad".
  char text[256];
  const int length = ut_format(from.get(), text, sizeof text, UT_ASCII | UT_DEFINITION);
  if (length < 0 || length >= static_cast<int>(sizeof text)) return {};
  UnitInBase found;
  std::string product;
  std::string_view rest(text, static_cast<std::size_t>(length));
  if (rest.find('@') != rest.npos) return {};
  if (const std::size_t n = number_length(rest); n > 0) rest = trimmed(rest.substr(n));
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('.'), rest.size());
    const std::string_view term = rest.substr(0, end);
    rest = end < rest.size() ? rest.substr(end + 1) : std::string_view{};
    const std::size_t letters = std::min(term.find_first_of("-0123456789"), term.size());
    if (term.substr(0, letters) == "rad" || term == "1") continue;
    const auto* name = std::find(std::begin(names), std::end(names), term.substr(0, letters));
    double exponent = 1.0;
    if (name == std::end(names) || (letters < term.size() && !parse_number(term.substr(letters), exponent))) return {};
    found.exponents[static_cast<std::size_t>(name - names)] += exponent;
    product += fmt::format("{}{}{}", product.empty() ? "" : ".", *name, exponent);
  }
  if (product.empty()) product = measures_angle(unit) ? "rad" : "1";
  const Unit to(ut_parse(unit_system(), product.c_str(), UT_ASCII));
  cv_converter* converter = to ? ut_get_converter(from.get(), to.get()) : nullptr;
  if (!converter) return {};
  found.factor = cv_convert_double(converter, 1.0);
  const bool shifted = cv_convert_double(converter, 0.0) != 0.0;
  cv_free(converter);
  if (shifted) return {};
  return found;
}

bool parse_number(std::string_view text, double& value) {
  text = trimmed(text);
  if (number_length(text) != text.size() || text.empty()) return false;
  if (text.front() == '+') text.remove_prefix(1);
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  return status == std::errc() && std::isfinite(value);
}

std::string octal_complaint(std::string_view number) {
  number = trimmed(number);
  const std::string_view digits = !number.empty() && (number[0] == '+' || number[0] == '-') ? number.substr(1) : number;
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  if (digits.size() < 2 || digits[0] != '0' || !std::all_of(digits.begin(), digits.end(), is_digit)) return {};
  return fmt::format("\"{}\" begins with a zero, which some programs take for an octal number; leave the zero out",
                     number);
}

Quantity to_si(std::string_view text, const std::string& si_unit) {
  text = trimmed(text);
  const std::size_t length = number_length(text);
  if (length == 0) return {0.0, not_a_number(text, si_unit)};
  double number = 0.0;
  if (!parse_number(text.substr(0, length), number))
    return {0.0, fmt::format("\"{}\" does not fit a double-precision number", text)};
  const std::string octal = octal_complaint(text.substr(0, length));
  if (!octal.empty()) return {0.0, octal};
  const std::string_view unit = trimmed(text.substr(length));
  if (unit.empty()) return {number, {}};
  if (unit.front() == ',')
    return {0.0, fmt::format("\"{}\" is not a number; write a decimal point, not a comma", text)};
  const bool is_hexadecimal = (unit.front() == 'x' || unit.front() == 'X') && text.substr(0, length) == "0";
  if (!may_start_unit(unit) || is_hexadecimal) return {0.0, not_a_number(text, si_unit)};
  if (si_unit == "-")
    return {0.0, fmt::format("\"{}\" has a unit; expected a number without unit, for example {}", text, number)};
  return converted(text, number, unit, si_unit);
}

Quantity to_si_of_any_kind(double number, const std::string& unit) {
  const std::string text = fmt::format("{} {}", number, unit);
  const Unit from(ut_parse(unit_system(), unit.c_str(), UT_UTF8));
  if (!from || !may_start_unit(unit)) return {0.0, fmt::format("\"{}\" has the unknown unit \"{}\"", text, unit)};
  for (const auto& [si_unit, name] : quantities) {
    const Unit to(ut_parse(unit_system(), std::string(si_unit).c_str(), UT_UTF8));
    if (!ut_are_convertible(from.get(), to.get())) continue;
    const Quantity q = converted(text, number, unit, std::string(si_unit));
    if (q.ok()) return q;  // udunits2 takes a rate for a time as well, which converted() refuses
  }
  return {0.0, fmt::format("\"{}\" has a unit of no quantity that Kerf knows", text)};
}

std::string quantity_name(const std::string& si_unit) {
  if (si_unit == "-" || si_unit.empty()) return "a number without unit";
  for (const auto& [unit, name] : quantities)
    if (unit == si_unit) return fmt::format("{} in {}", name, si_unit);
  return "a number in " + si_unit;
}

std::string quantity_text(double value, const std::string& si_unit) {
  return si_unit == "-" || si_unit.empty() ? fmt::format("{}", value) : fmt::format("{} {}", value, si_unit);
}

}  // namespace kerf
