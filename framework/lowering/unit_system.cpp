// Names, factors and aliases of systems of units.
#include "lowering/unit_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace kerf::lowering {
namespace {

constexpr double pound = 0.45359237, inch = 0.0254, foot = 0.3048, gravity = 9.80665;

struct NamedUnit {
  std::string_view name;
  std::string_view in_input;  // as Kerf's input calls it
  double in_si;
};

constexpr NamedUnit masses[] = {
    {"kg", "kg", 1.0},
    {"g", "g", 1e-3},
    {"mg", "mg", 1e-6},
    {"t", "Mg", 1e3},
    {"ton", "Mg", 1e3},
    {"tonne", "Mg", 1e3},
    {"mtrc_ton", "Mg", 1e3},
    {"lb", "lb", pound},
    {"lbm", "lb", pound},
    {"slug", "slug", pound* gravity / foot},
    {"lbf-s2/in", "(lbf s2/in)", pound* gravity / inch},
    {"slinch", "(lbf s2/in)", pound* gravity / inch},
    {"blob", "(lbf s2/in)", pound* gravity / inch},
};
constexpr NamedUnit lengths[] = {{"m", "m", 1.0},      {"mm", "mm", 1e-3},     {"cm", "cm", 1e-2},
                                 {"um", "um", 1e-6},   {"micron", "um", 1e-6}, {"in", "in", inch},
                                 {"inch", "in", inch}, {"ft", "ft", foot},     {"foot", "ft", foot}};
constexpr NamedUnit times[] = {{"s", "s", 1.0},          {"sec", "s", 1.0},       {"ms", "ms", 1e-3},
                               {"msec", "ms", 1e-3},     {"us", "us", 1e-6},      {"usec", "us", 1e-6},
                               {"microsec", "us", 1e-6}, {"micro_s", "us", 1e-6}, {"ns", "ns", 1e-9}};

/// Units of pressure and force that people know by name.
struct Known {
  const char* name;
  Dimension dimension;
  double in_si;
};
constexpr Known known[] = {{"Pa", pressure, 1.0},      {"kPa", pressure, 1e3},    {"MPa", pressure, 1e6},
                           {"GPa", pressure, 1e9},     {"Mbar", pressure, 1e11},  {"N", force, 1.0},
                           {"kN", force, 1e3},         {"MN", force, 1e6},        {"Pa s", viscosity, 1.0},
                           {"GPa ms", viscosity, 1e6}, {"MPa s", viscosity, 1e6}, {"Mbar us", viscosity, 1e5}};

template <std::size_t n>
std::optional<BaseUnit> unit_named(const NamedUnit (&units)[n], std::string_view name) {
  for (const NamedUnit& unit : units)
    if (unit.name == name) return BaseUnit{std::string(unit.in_input), unit.in_si};
  return {};
}

double power(double base, int exponent) {
  double product = 1.0;
  for (int k = 0; k < std::abs(exponent); ++k) product *= base;
  return exponent < 0 ? 1.0 / product : product;
}

std::string factor_text(const std::string& name, int exponent) {
  return exponent == 1 ? name : fmt::format("{}{}{}", name, name.back() == ')' ? "^" : "", exponent);
}

/// The words between separators, without blanks.
std::vector<std::string> words_of(const std::string& text, char separator) {
  std::vector<std::string> found(1);
  for (const char c : text) {
    if (c == separator) {
      found.emplace_back();
    } else if (c != ' ') {
      found.back() += c;
    }
  }
  return found;
}

/// Whether two names have the same units in any order: "mm-ms-kg" is "kg-mm-ms".
bool same_units(const std::string& a, const std::string& b) {
  const std::vector<std::string> left = words_of(a, '-'), right = words_of(b, '-');
  return std::is_permutation(left.begin(), left.end(), right.begin(), right.end());
}

UnitSystem system_of(const char* mass, const char* length, const char* time) {
  return {*unit_named(masses, mass), *unit_named(lengths, length), *unit_named(times, time)};
}

}  // namespace

UnitSystem::UnitSystem(BaseUnit mass, BaseUnit length, BaseUnit time)
    : mass_(std::move(mass)), length_(std::move(length)), time_(std::move(time)) {}

double product_of(Dimension d, double mass, double length, double time) {
  return power(mass, d.mass) * power(length, d.length) * power(time, d.time);
}

double UnitSystem::in_si(Dimension d) const { return product_of(d, mass_.in_si, length_.in_si, time_.in_si); }

std::string UnitSystem::text_of(Dimension d) const {
  if (d == number) return {};
  const double si = in_si(d);
  for (const Known& unit : known)
    if (unit.dimension == d && std::abs(si / unit.in_si - 1.0) < 1e-12) return unit.name;
  std::string above, below;
  int n_below = 0;
  const std::pair<std::string, int> factors[] = {
      {mass_.name, d.mass}, {length_.name, d.length}, {time_.name, d.time}, {"K", d.temperature}};
  for (const auto& [name, exponent] : factors) {
    if (exponent > 0) above += (above.empty() ? "" : " ") + factor_text(name, exponent);
    if (exponent >= 0) continue;
    below += (below.empty() ? "" : " ") + factor_text(name, -exponent);
    ++n_below;
  }
  if (below.empty()) return above;
  return (above.empty() ? "1" : above) + "/" + (n_below > 1 ? "(" + below + ")" : below);
}

std::string UnitSystem::name() const { return fmt::format("{}, {}, {}", mass_.name, length_.name, time_.name); }

const std::vector<NamedSystem>& usual_systems() {
  static const std::vector<NamedSystem> systems = {
      {"t-mm-s", system_of("t", "mm", "s")},       {"kg-mm-ms", system_of("kg", "mm", "ms")},
      {"g-mm-ms", system_of("g", "mm", "ms")},     {"g-cm-us", system_of("g", "cm", "us")},
      {"kg-m-s", system_of("kg", "m", "s")},       {"lbf-in-s", system_of("slinch", "in", "s")},
      {"slug-ft-s", system_of("slug", "ft", "s")}, {"kg-cm-us", system_of("kg", "cm", "us")},
      {"kg-cm-ms", system_of("kg", "cm", "ms")},   {"g-cm-s", system_of("g", "cm", "s")},
      {"mg-mm-us", system_of("mg", "mm", "us")},   {"kg-mm-s", system_of("kg", "mm", "s")}};
  return systems;
}

std::string parse_unit_system(const std::string& text, std::optional<UnitSystem>& found) {
  const std::string wanted = text == "si" || text == "SI" ? "kg-m-s" : text == "cgs" ? "g-cm-s" : text;
  std::vector<std::string> aliases;
  for (const NamedSystem& system : usual_systems()) {
    aliases.push_back(system.alias);
    if (same_units(wanted, system.alias)) found = system.units;
  }
  if (found) return {};
  const std::string expected =
      fmt::format("expected mass, length and time, such as g,cm,us, or one of si, {}", fmt::join(aliases, ", "));
  const std::vector<std::string> words = words_of(wanted, ',');
  if (words.size() != 3) return fmt::format("\"{}\" is no system of units; {}", text, expected);
  const std::optional<BaseUnit> mass = unit_named(masses, words[0]), length = unit_named(lengths, words[1]),
                                time = unit_named(times, words[2]);
  if (!mass) return fmt::format("\"{}\" is no unit of mass; {}", words[0], expected);
  if (!length) return fmt::format("\"{}\" is no unit of length; {}", words[1], expected);
  if (!time) return fmt::format("\"{}\" is no unit of time; {}", words[2], expected);
  found.emplace(*mass, *length, *time);
  return {};
}

}  // namespace kerf::lowering
