// An observer outside of Kerf's tree that acts: springs from the nodes of a part to the points in space where they were
// at the start.
#include <cmath>
#include <stdexcept>

#include <kerf/observer.hpp>

struct SpringToPoint final : kerf::Observer {
  static void describe(kerf::Schema<SpringToPoint>& s) {
    s.text(&SpringToPoint::part, "part", "part whose nodes are held");
    s.real(&SpringToPoint::stiffness, "stiffness", "N/(kg m)", kerf::positive, "force per mass of a node and way");
    s.vector(&SpringToPoint::offset, "offset", "m", kerf::any_value, "of the points from where the nodes were")
        .by_default("[0, 0, 0]");
    s.real(&SpringToPoint::spoil_at, "spoil_at", "s", kerf::positive, "time at which a force is no number").optional();
    s.boolean(&SpringToPoint::ghosts, "ghosts", "whether copies of nodes are loaded as well, which is wrong")
        .by_default("false");
    describe_interval(s);
  }
  std::vector<std::string> references() const override { return {part}; }
  kerf::ObserverCalls calls() const override { return {.forces = true}; }
  std::vector<kerf::ObservedColumn> columns() const override { return {{"energy", "J", "in the springs"}}; }

  void add_forces(kerf::ObservedModel& model, kerf::ObservedForces& forces) override {
    const int p = model.find_part(part);
    const std::vector<double> mass = model.mass_in(p);
    for (int i = 0; i < model.nodes.n; ++i) {
      if (!model.belongs_to(i, p) || (model.nodes.owned[i] == 0 && !ghosts)) continue;
      double k = stiffness * mass[static_cast<std::size_t>(i)];
      if (spoil_at > 0.0 && model.time >= spoil_at && model.nodes.id[i] == 3) k = std::sqrt(-1.0);
      forces.add(i, -k * (model.nodes.x(i) - model.reference(i) - offset));
    }
  }

  void sample(kerf::ObservedModel& model, std::span<double> row) override {
    const std::vector<double> mass = model.mass_in(model.find_part(part));
    std::vector<double> energy;
    for (int i = 0; i < model.nodes.n; ++i) {
      const kerf::Vec3 way = model.nodes.x(i) - model.reference(i) - offset;
      energy.push_back(0.5 * stiffness * mass[static_cast<std::size_t>(i)] * dot(way, way));
    }
    row[0] = model.sums({energy}).front();
  }

  std::string part;
  double stiffness = 0.0, spoil_at = 0.0;  // [N/(kg m)], [s]
  kerf::Vec3 offset;  // [m]
  bool ghosts = false;
};

KERF_OBSERVER(SpringToPoint, "spring_to_point", "springs from the nodes of a part to where they were")
