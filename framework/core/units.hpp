// Turns numbers with units, as a user writes them, into SI values, and SI values into text.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace kerf {

/// A converted value, or the sentence that says why there is none.
struct Quantity {
  double value = 0.0;
  std::string error;

  bool ok() const { return error.empty(); }
};

/// Converts "2.586 GPa", "45 deg" or a bare number (which is SI) to `si_unit`. "-" stands for a number without
/// dimension, which takes no unit. Throws std::runtime_error where the unit database cannot be read.
Quantity to_si(std::string_view text, const std::string& si_unit);

/// Exponents of the base units m, kg, s, A, K, mol, cd.
using UnitExponents = std::array<double, 7>;

/// A unit as a multiple of a product of base units.
struct UnitInBase {
  double factor = 1.0;
  UnitExponents exponents{};
};
/// Nothing where `unit` is unknown, or where its zero is shifted, as that of degC. "-" is the number 1.
std::optional<UnitInBase> unit_in_base(const std::string& unit);

/// Converts a number with a unit of any kind of quantity that Kerf knows: to Pa, m, s, kg, K, rad and what is made of
/// them. Throws std::runtime_error where the unit database cannot be read.
Quantity to_si_of_any_kind(double number, const std::string& unit);

/// Reads a whole text as a finite decimal number; no octal, no unit, nothing trailing.
bool parse_number(std::string_view text, double& value);

/// The sentence that refuses a whole number with leading zeros ("010" is 8 to many readers of YAML); else empty.
std::string octal_complaint(std::string_view number);

/// Length of the number that `text` begins with; 0 where it does not begin with one.
std::size_t number_length(std::string_view text);

/// What a unit measures, with its article: "a velocity in m/s", "a number without unit".
std::string quantity_name(const std::string& si_unit);

/// The shortest text that reads back as `value`, with its unit: "5400 kg/m3".
std::string quantity_text(double value, const std::string& si_unit);

/// `text` without spaces at either end.
std::string_view trimmed(std::string_view text);

}  // namespace kerf
