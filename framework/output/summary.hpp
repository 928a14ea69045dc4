// The contents of summary.json: what a run was, what it ended with and where its time went.
//
// The keys are a contract with everything that reads the file (post-processing, tests): they may be added to, not
// renamed. Members here have the names of the keys.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace kerf {

/// Numbers by name, in the order in which they were first named.
class NamedNumbers {
 public:
  double& operator[](const std::string& name) {
    for (auto& [known, value] : numbers_)
      if (known == name) return value;
    return numbers_.emplace_back(name, 0.0).second;
  }
  auto begin() const { return numbers_.begin(); }
  auto end() const { return numbers_.end(); }

 private:
  std::vector<std::pair<std::string, double>> numbers_;
};

struct Summary {
  /// Nodes that contact has let go of: they came to lie too deep inside a body.
  struct ContactLetGo {
    std::int64_t nodes = 0;
    double mass = 0.0, deepest = 0.0;  // [kg], [m]
    double first_time = 0.0;  // [s]; NaN where there is none
    std::map<std::string, std::int64_t> by_part;
  };
  /// What hourglass control has taken, next to all that has not been given back.
  struct Hourglass {
    double energy = 0.0, dissipated = 0.0;  // [J] by hourglass control; by everything, hourglass control included
    double share() const { return dissipated > 0.0 ? energy / dissipated : 0.0; }
  };
  struct Momentum {  // [kg m/s]
    std::array<double, 3> initial{}, final{}, eroded{};
    std::array<double, 3> external_impulse{};  // of boundary conditions
  };
  struct Mass {  // [kg]
    double initial = 0.0, live = 0.0, free_nodes = 0.0, dropped = 0.0;
  };
  struct Eroded {
    std::int64_t elements = 0;
    std::map<std::string, std::int64_t> by_part, by_criterion;
  };
  /// Elements at the end that have failed and stayed, without deviator and tension.
  struct NoTension {
    std::int64_t elements = 0;
    std::map<std::string, std::int64_t> by_part;  // parts whose material has such a criterion
  };
  struct Part {
    std::int64_t elements = 0, alive = 0;
    double mass = 0.0;  // [kg] live
    std::array<double, 3> velocity{};  // [m/s] mass average; NaN where nothing is left to move
    double kinetic = 0.0;  // [J]
  };
  /// A set of the material library that a material is made of.
  struct LibrarySet {
    std::string set, file, hash;
    bool verified = false;
    std::vector<std::string> overridden;  // paths of what the input gave in place of the set's values
  };
  /// What became of the keyword deck that was the input.
  struct Deck {
    std::string units;  // empty where the input was none
    std::int64_t in_another_way = 0, left_out = 0;
    std::map<std::string, std::vector<std::string>> keywords;
  };
  struct Spread {  // over ranks
    double min = 0.0, mean = 0.0, max = 0.0;
  };
  struct Timer {  // [s]
    Spread total, work;  // the second without sending, receiving and waiting for other ranks
  };
  struct Rebalance {
    std::int64_t cycle = 0;
    double imbalance_before = 0.0, imbalance_after = 0.0;
    std::int64_t elements_moved = 0;
    double seconds = 0.0;
  };

  std::string kerf_version, input, title;  // title of the model, empty where it has none
  std::string precision;  // of what elements compute with: "double" or "single"
  int ranks = 0;
  std::int64_t cycles = 0;
  double end_time = 0.0, wall_seconds = 0.0;  // [s]
  std::int64_t element_cycles = 0;  // live elements, added up over cycles
  double element_cycles_per_second = 0.0;
  std::string state_hash;  // hexadecimal
  std::string exit;  // "completed" or why the run ended
  NamedNumbers energy;  // the lines of the books that are energies [J], and the balance error
  Hourglass hourglass;
  ContactLetGo contact_let_go;
  NamedNumbers contact_impacts;  // steps in which contact acted, and in which it was not solved to the end
  Momentum momentum;
  Mass mass;
  Eroded eroded;
  NoTension no_tension;
  std::map<std::string, Part> parts;
  std::map<std::string, double> measures;  // NaN where there is nothing to measure
  std::map<std::string, std::string> not_measured;  // why
  std::map<std::string, LibrarySet> library;  // by material
  Deck deck;
  std::vector<std::string> warnings;  // of the check before the first step, then of the whole run
  std::map<std::string, Timer> timers;
  Timer steps;  // all phases that every step needs, together
  std::vector<Rebalance> rebalances;
  NamedNumbers work;  // what was looked at in all cycles of this start, on all ranks
  std::map<std::string, NamedNumbers> observers;  // numbers of each; NaN as with measures
};

/// The text of summary.json. Numbers that are not finite become null, which JSON has no other way to say.
std::string summary_text(const Summary& summary);

/// Writes summary.json so that a reader finds the old file or the new one and never half of one. To be called
/// by one rank. Throws std::runtime_error where that fails.
void write_summary(const std::string& path, const Summary& summary);

}  // namespace kerf
