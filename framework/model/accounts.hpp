// The one list of what the books hold: sums over the run, and the lines that are reported from them.
//
// A new account is one member of Accounts, which restart files then keep, and one line in book_lines(), from which
// the column of history.csv, the key of summary.json, the row of the closing table and the manual are made.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "kerf/math.hpp"

namespace kerf {

/// Sums over the run; additive over ranks. The order is that of the restart file: new members come last.
struct Accounts {
  std::int64_t hourglass = 0;  // dissipated or stored by hourglass control [energy quanta]
  std::int64_t contact = 0;  // taken from the nodes by contact [energy quanta]
  std::int64_t external = 0;  // work of boundary conditions and loads [energy quanta]
  std::int64_t eroded_internal = 0;  // internal energy of eroded elements, without the viscous share
  std::int64_t eroded_viscous = 0;  // work of bulk viscosity in eroded elements
  std::int64_t dropped_kinetic = 0;  // of dropped free nodes
  std::array<std::int64_t, 3> impulse{};  // of boundary conditions and loads [momentum quanta]
  std::array<std::int64_t, 3> dropped_momentum{};  // [momentum quanta]
  std::int64_t dropped_mass = 0;  // [mass quanta]
  std::int64_t eroded_elements = 0;
  std::int64_t friction = 0;  // the share of friction in contact [energy quanta]
  std::int64_t eroded_chemical = 0;  // of eroded_internal, what laws still held back: unburnt explosive
};

/// All accounts as they stand one after another, to be summed over ranks and stored.
using AccountNumbers = std::array<std::int64_t, sizeof(Accounts) / sizeof(std::int64_t)>;
inline AccountNumbers numbers_of(const Accounts& a) { return std::bit_cast<AccountNumbers>(a); }
inline Accounts accounts_of(const AccountNumbers& numbers) { return std::bit_cast<Accounts>(numbers); }

/// Nodes that contact has let go of.
struct LetGo {
  std::int64_t nodes = 0, mass = 0;  // [mass quanta]
  std::vector<std::int64_t> by_part;
  double deepest = 0.0, first_time = 0.0;  // [m], [s]; 0 where there is none

  void add(int part, std::int64_t mass_quanta, double depth, double time);
};

/// The state of the books at one time, the same on all ranks.
struct Balance {
  double time = 0.0, dt = 0.0;  // [s]
  double initial = 0.0;  // energy of the model at the start [J]
  double kinetic = 0.0, internal = 0.0, hourglass = 0.0, bulk_viscosity = 0.0, contact = 0.0, external = 0.0,
         eroded = 0.0;  // [J]
  double friction = 0.0;  // the share of friction in contact [J]
  double chemical = 0.0;  // held back by laws of live elements [J]
  double released = 0.0, eroded_chemical = 0.0;  // what they have set free; what eroded elements still held [J]
  double given_back = 0.0;  // by contact, without friction, more than it has taken [J]
  double hourglass_given_back = 0.0;  // by hourglass control, more than it has taken [J]
  Vec3 momentum, impulse, dropped_momentum;  // [kg m/s]
  double live_mass = 0.0, free_mass = 0.0, dropped_mass = 0.0;  // [kg]
  std::int64_t eroded_elements = 0;
  LetGo let_go;
  double error = 0.0;
  double imbalance = 1.0;  // of the work of ranks, max / mean
  Accounts totals;  // of all ranks
  double energy_quantum = 0.0;  // [J]

  /// An account of `totals` that is kept in energy quanta [J].
  double joule(std::int64_t quanta) const { return static_cast<double>(quanta) * energy_quantum; }
  /// All lines of the books that add up [J].
  double total() const;
};

/// Where a line of the books goes to, as bits.
enum BookPlace : unsigned {
  in_history = 1,  // a column of history.csv
  in_energy = 2,  // a key of `energy` in summary.json
  adds_up = 4,  // a term of the sum that has to stay what it was
  is_share = 8  // contained in another line; after the others in summary.json
};

struct BookLine {
  const char *name, *unit;
  unsigned places;  // bits of BookPlace
  const char* label;  // in the table at the end of a run; null where the line does not stand there
  const char* doc;  // half a sentence for the manual
  double (*value)(const Balance&);
};

/// All lines, in the order of the columns of history.csv. New lines come last.
inline const std::vector<BookLine>& book_lines() {
  using B = const Balance&;
  static const std::vector<BookLine> lines = {
      {"time", "s", in_history, nullptr, "time", [](B b) { return b.time; }},
      {"dt", "s", in_history, nullptr, "the last time step", [](B b) { return b.dt; }},
      {"initial", "J", in_energy, "initial", "energy of the model at the start", [](B b) { return b.initial; }},
      {"kinetic", "J", in_history | in_energy | adds_up, "kinetic", "kinetic energy of all nodes",
       [](B b) { return b.kinetic; }},
      {"internal", "J", in_history | in_energy | adds_up, "internal",
       "internal energy of live elements, but what explosives have not released", [](B b) { return b.internal; }},
      {"hourglass", "J", in_history | in_energy | adds_up, "hourglass", "what hourglass control has taken",
       [](B b) { return b.hourglass; }},
      {"bulk_viscosity", "J", in_history | in_energy | adds_up, "bulk viscosity", "what bulk viscosity has taken",
       [](B b) { return b.bulk_viscosity; }},
      {"contact", "J", in_history | in_energy | adds_up, "contact", "what contact has taken",
       [](B b) { return b.contact; }},
      {"friction", "J", in_history | in_energy | is_share, "  by friction", "the share of friction in contact",
       [](B b) { return b.friction; }},
      {"external", "J", in_history | in_energy, "external work", "work of boundary conditions and loads on the model",
       [](B b) { return b.external; }},
      {"eroded", "J", in_history | in_energy | adds_up, "eroded",
       "internal energy of eroded elements and kinetic energy of dropped nodes", [](B b) { return b.eroded; }},
      {"balance_error", "-", in_history | in_energy, nullptr,
       "what does not add up, over the greater of initial energy and external work", [](B b) { return b.error; }},
      {"contact_given_back", "J", in_energy | is_share, nullptr, "by contact, without friction, more than it has taken",
       [](B b) { return b.given_back; }},
      {"hourglass_given_back", "J", in_energy | is_share, nullptr, "by hourglass control, more than it has taken",
       [](B b) { return b.hourglass_given_back; }},
      {"momentum_x", "kg m/s", in_history, nullptr, "momentum of all nodes along x", [](B b) { return b.momentum.x; }},
      {"momentum_y", "kg m/s", in_history, nullptr, "the same along y", [](B b) { return b.momentum.y; }},
      {"momentum_z", "kg m/s", in_history, nullptr, "the same along z", [](B b) { return b.momentum.z; }},
      {"mass", "kg", in_history, nullptr, "mass of live elements and free nodes",
       [](B b) { return b.live_mass + b.free_mass; }},
      {"eroded_count", "-", in_history, nullptr, "elements that have eroded",
       [](B b) { return static_cast<double>(b.eroded_elements); }},
      {"let_go_count", "-", in_history, nullptr, "nodes that contact has let go of",
       [](B b) { return static_cast<double>(b.let_go.nodes); }},
      {"imbalance", "-", in_history, nullptr, "greatest work of a rank over the mean", [](B b) { return b.imbalance; }},
      {"chemical", "J", in_history | in_energy | adds_up, "chemical",
       "chemical energy that explosives in live elements have not released", [](B b) { return b.chemical; }},
      {"released", "J", in_history | in_energy | is_share, "  released",
       "chemical energy that explosives have released, which other lines contain", [](B b) { return b.released; }},
      {"eroded_chemical", "J", in_energy | is_share, nullptr, "the share in eroded of explosives that had not burnt",
       [](B b) { return b.eroded_chemical; }},
  };
  return lines;
}

inline double Balance::total() const {
  double sum = 0.0;
  for (const BookLine& line : book_lines())
    if ((line.places & adds_up) != 0) sum += line.value(*this);
  return sum;
}

}  // namespace kerf
