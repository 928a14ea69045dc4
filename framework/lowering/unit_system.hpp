// The units of a deck: which mass, length and time its numbers are in, and how a value is written with them.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace kerf::lowering {

/// Exponents of mass, length, time and temperature.
struct Dimension {
  int mass = 0, length = 0, time = 0, temperature = 0;
  bool operator==(const Dimension&) const = default;
};

inline constexpr Dimension number{}, length{0, 1, 0}, time{0, 0, 1}, rate{0, 0, -1}, velocity{0, 1, -1},
    acceleration{0, 1, -2}, density{1, -3, 0}, pressure{1, -1, -2}, viscosity{1, -1, -1}, force{1, 1, -2},
    temperature{0, 0, 0, 1}, specific_heat{0, 2, -2, -1};

/// mass^m length^l time^t, with the exponents of a dimension.
double product_of(Dimension dimension, double mass, double length, double time);

/// One unit of each kind; `name` is what Kerf's input calls it.
struct BaseUnit {
  std::string name;
  double in_si = 1.0;
};

class UnitSystem {
 public:
  /// Pre: the names are units that Kerf's input knows.
  UnitSystem(BaseUnit mass, BaseUnit length, BaseUnit time);

  /// What one unit of a dimension is in SI.
  double in_si(Dimension dimension) const;
  /// The unit of a dimension as the input writes it: "GPa", "g/(cm us2)"; "" for a number.
  std::string text_of(Dimension dimension) const;
  /// "kg, mm, ms".
  std::string name() const;
  const std::string& length_name() const { return length_.name; }

 private:
  BaseUnit mass_, length_, time_;
};

/// Takes "g,cm,us" or an alias such as "g-cm-us" or "si" apart. Returns what is wrong with the text, or nothing.
std::string parse_unit_system(const std::string& text, std::optional<UnitSystem>& found);

/// The systems that decks are written in, each with its alias, the most usual first.
struct NamedSystem {
  std::string alias;
  UnitSystem units;
};
const std::vector<NamedSystem>& usual_systems();

}  // namespace kerf::lowering
