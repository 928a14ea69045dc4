// Placing of the bodies, and the observer that looks for intruders.
#include "parallel/flight.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "dynamics/simulation.hpp"
#include "parallel/brute_contact.hpp"
#include "parallel/scene.hpp"
#include "report/state_hash.hpp"

namespace kerf::test {

namespace {

struct Body {
  int cells[3] = {};
  double size[3] = {};  // [m]
  Vec3 axis{0.0, 0.0, 1.0}, centre, velocity;
  double angle = 0.0;

  /// How far it reaches from its centre along a direction [m].
  double reach(Vec3 direction) const {
    double sum = 0.0;
    for (int d = 0; d < 3; ++d) {
      Vec3 edge;
      edge[d] = 1.0;
      const Vec3 turned = edge * std::cos(angle) + cross(axis, edge) * std::sin(angle) +
                          axis * (dot(axis, edge) * (1.0 - std::cos(angle)));
      sum += 0.5 * size[d] * std::fabs(dot(turned, direction));
    }
    return sum;
  }
  std::string text(int number) const {
    return fmt::format(
        "  body_{}:\n    mesh: {{type: block, size: [{}, {}, {}], origin: [{}, {}, {}], cells: [{}, {}, {}]}}\n"
        "    material: metal\n    velocity: [{}, {}, {}]\n"
        "    placement:\n      - {{angle: {}, axis: [{}, {}, {}], translate: [{}, {}, {}]}}\n",
        number, size[0], size[1], size[2], -0.5 * size[0], -0.5 * size[1], -0.5 * size[2], cells[0], cells[1], cells[2],
        velocity.x, velocity.y, velocity.z, angle, axis.x, axis.y, axis.z, centre.x, centre.y, centre.z);
  }
};

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed) {}
  double real(double low, double high) { return low + (high - low) * static_cast<double>(random_() >> 11) * 0x1p-53; }
  int whole(int low, int high) {
    return low + static_cast<int>(random_() % static_cast<std::uint64_t>(high - low + 1));
  }
  Vec3 direction() {
    for (;;) {
      const Vec3 v{real(-1.0, 1.0), real(-1.0, 1.0), real(-1.0, 1.0)};
      if (norm(v) > 0.1 && norm(v) <= 1.0) return v * (1.0 / norm(v));
    }
  }

 private:
  std::mt19937_64 random_;
};

/// The first body rests in the middle; each other one starts just clear of it and flies at it.
std::vector<Body> place(const Flight& flight) {
  Dice dice(flight.seed);
  std::vector<Body> bodies(static_cast<std::size_t>(flight.n_bodies));
  Vec3 first_way;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    Body& body = bodies[b];
    for (int d = 0; d < 3; ++d) {
      body.cells[d] = dice.whole(2, 4);
      body.size[d] = body.cells[d] * dice.real(0.7e-3, 1.4e-3);
    }
    if (!flight.aligned) {
      body.axis = dice.direction();
      body.angle = dice.real(0.0, 3.0);
    }
    if (b == 0) continue;
    Vec3 way = flight.aligned ? Vec3{0.0, 0.0, 1.0} : dice.direction();
    if (b == 1) first_way = way;
    if (b == 2) way = first_way * -1.0;  // from behind, so that the bodies cannot meet before they strike the first
    Vec3 aside = cross(way, dice.direction());
    aside = aside * (1.0 / norm(aside));
    const double clear = bodies[0].reach(way) + body.reach(way) + 0.02e-3;
    const double offset = dice.real(0.0, 0.6) * (bodies[0].reach(aside) + body.reach(aside));
    body.centre = way * clear + aside * offset;
    body.velocity = (way * -1.0 + aside * dice.real(-0.5, 0.2)) * flight.speed;
  }
  return bodies;
}

class Lookout final : public StepObserver {
 public:
  Lookout(const Simulation& simulation, const Flight& flight, FlightReport& report)
      : simulation_(simulation), flight_(flight), report_(report) {}

  void after_forces(Model&, const Step& step) override {
    if (due(step)) compare_contact_forces(simulation_, step, report_.forces);
  }
  void after_step(Simulation& simulation, const Step& step) override {
    report_.cycles = step.cycle;
    if (!due(step)) return;
    const Model& model = simulation.model();
    const GlobalModel global = gather_globally(model);
    if (model.rank() != 0) return;
    ++report_.n_looks;
    report_.n_ends_inside = 0;
    const BruteContact brute(global, model.parts, *model.input->contacts.front());
    for (const Intruder& i : brute.intruders()) note(i, step);
  }

 private:
  bool due(const Step& step) const { return flight_.look_interval > 0 && step.cycle % flight_.look_interval == 0; }
  void note(const Intruder& i, const Step& step) {
    if (i.own_part) {
      ++report_.n_inside_own;
      report_.n_unpushed_own += i.pushed ? 0 : 1;
      report_.deepest_own = std::max(report_.deepest_own, i.depth);
      return;
    }
    ++report_.n_inside;
    ++report_.n_ends_inside;
    // A node that contact holds at the surface is inside of it or not by round-off, and eroding_surface takes a facet
    // that looks the same way as the node's own surface for flush up to this height.
    constexpr double at_surface = 0.05;
    report_.n_unpushed += i.pushed || i.depth < at_surface ? 0 : 1;
    if (i.depth <= report_.deepest) return;
    report_.deepest = i.depth;
    report_.worst = fmt::format("cycle {}: {}node {} in element {}, depth {:.3f}, {}", step.cycle,
                                i.free ? "free " : "", i.node, i.element, i.depth, i.pushed ? "pushed" : "not pushed");
  }

  const Simulation& simulation_;
  const Flight& flight_;
  FlightReport& report_;
};

}  // namespace

std::string flight_input(const Flight& flight) {
  // Time for the bodies to come to rest against each other or to part.
  const double end = std::min(5e-3 / flight.speed + 2e-6, 2e-5);
  std::string text = fmt::format(
      "time: {{end: {}, minimum_step: 1e-12}}\n"
      "materials:\n  metal:\n    density: 7850\n    eos: {{type: linear, bulk_modulus: 160e9}}\n    strength: {}\n"
      "    erosion: {{criteria: [{{type: inversion}}, {{type: fuse}}{}]}}\nparts:\n",
      end,
      flight.plastic ? "{type: elastic_plastic, shear_modulus: 80e9, yield_stress: 1e9, hardening_modulus: 0.3e9}"
                     : "{type: elastic, shear_modulus: 80e9}",
      flight.deletion == Flight::Deletion::strain ? ", {type: geometric_strain, limit: 0.4}" : "");
  const std::vector<Body> bodies = place(flight);
  for (std::size_t b = 0; b < bodies.size(); ++b) text += bodies[b].text(static_cast<int>(b));
  if (flight.force_interval > 0) text += fmt::format("balance: {{force_interval: {}}}\n", flight.force_interval);
  return text + "contacts:\n  - " + flight.contact + "\n";
}

FlightReport fly(const Flight& flight, MPI_Comm comm) {
  FlightReport report;
  const auto input = scene(flight_input(flight));
  Simulation simulation(comm, *input);
  if (flight.deletion == Flight::Deletion::random)
    light_fuses(simulation.model(), [&](std::int64_t id) {
      const auto item = static_cast<std::uint64_t>(id);
      return scatter(flight.seed, 2 * item) < 0.25 ? std::floor(5.0 + 120.0 * scatter(flight.seed, 2 * item + 1)) : 1e9;
    });
  Lookout lookout(simulation, flight, report);
  simulation.observe(lookout);
  simulation.run();
  const Balance balance = simulation.sample();
  report.energy_error = balance.error;
  report.n_eroded = balance.eroded_elements;
  report.state_hash = state_hash(simulation.model());
  return report;
}

}  // namespace kerf::test
