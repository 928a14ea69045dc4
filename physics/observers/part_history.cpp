// What becomes of whole parts over time: mass, momentum, energies, what has eroded.
#include <cmath>
#include <limits>

#include "kerf/observer.hpp"

namespace kerf {
namespace {

class PartHistory final : public Observer {
 public:
  static void describe(Schema<PartHistory>& s) {
    s.texts(&PartHistory::names, "parts", "parts that are followed; all where absent").optional();
    describe_interval(s);
  }

  std::vector<std::string> references() const override { return names; }

  void prepare(ObservedModel& model) override {
    if (names.empty())
      for (const ObservedPart& part : model.parts) names.push_back(part.name);
  }

  std::vector<ObservedColumn> columns() const override {
    std::vector<ObservedColumn> all;
    for (const std::string& name : names) {
      const auto add = [&](const char* what, const char* unit, const char* doc) {
        all.push_back({name + "." + what, unit, doc});
      };
      add("mass", "kg", "mass of live elements");
      add("velocity_x", "m/s", "mean velocity, by mass, of nodes with live elements; NaN where none is left");
      add("velocity_y", "m/s", "the same along y");
      add("velocity_z", "m/s", "the same along z");
      add("kinetic", "J", "kinetic energy of all nodes of the part");
      add("internal", "J", "internal energy of live elements, without the work of bulk viscosity");
      add("momentum_x", "kg m/s", "momentum of all nodes of the part");
      add("momentum_y", "kg m/s", "the same along y");
      add("momentum_z", "kg m/s", "the same along z");
      add("eroded_elements", "-", "elements that have eroded");
      add("eroded_mass", "kg", "mass of the elements that have eroded");
    }
    return all;
  }

  void sample(ObservedModel& model, std::span<double> row) override {
    std::size_t at = 0;
    for (const std::string& name : names)
      for (const double value : values_of(model, model.find_part(name))) row[at++] = value;
  }

 private:
  /// In the order of columns().
  static std::vector<double> values_of(ObservedModel& model, int part) {
    const ObservedPart& body = model.parts[static_cast<std::size_t>(part)];
    const std::vector<double> mass = model.field(part, "mass"), energy = model.field(part, "internal_energy"),
                              viscous = model.field(part, "viscous_energy");
    std::vector<double> internal(mass.size());
    const std::vector<double> ones(mass.size(), 1.0);
    for (std::size_t i = 0; i < mass.size(); ++i) internal[i] = mass[i] * (energy[i] + body.energy) - viscous[i];

    const ObservedNodes& nodes = model.nodes;
    const std::span<const double> kinetic_of_all = model.kinetic_energy();
    // Of a node that parts share, each has the share that its undeformed elements gave to the node's mass.
    const std::vector<double> mass_of_nodes = model.mass_in(part);
    std::vector<double> kinetic, momentum[3], body_mass, body_momentum[3];
    for (int i = 0; i < nodes.n; ++i) {
      const auto place = static_cast<std::size_t>(i);
      const double mass_here = mass_of_nodes[place];
      if (!(mass_here > 0.0)) continue;
      const Vec3 p = nodes.v(i) * mass_here;
      kinetic.push_back(kinetic_of_all[place] * (mass_here / nodes.mass[i]));
      for (int d = 0; d < 3; ++d) momentum[d].push_back(p[d]);
      if (nodes.free[i] != 0) continue;
      body_mass.push_back(mass_here);
      for (int d = 0; d < 3; ++d) body_momentum[d].push_back(p[d]);
    }
    const std::vector<double> s = model.sums({mass, internal, ones, kinetic, momentum[0], momentum[1], momentum[2],
                                              body_mass, body_momentum[0], body_momentum[1], body_momentum[2]});
    const auto mean = [&](double total) {
      return s[7] > 0.0 ? total / s[7] : std::numeric_limits<double>::quiet_NaN();
    };
    const double n_eroded = static_cast<double>(body.n_elements) - s[2];
    const double eroded = n_eroded > 0.0 ? body.mass - s[0] : 0.0;
    return {s[0], mean(s[8]), mean(s[9]), mean(s[10]), s[3], s[1], s[4], s[5], s[6], n_eroded, eroded};
  }

  std::vector<std::string> names;
};

}  // namespace
}  // namespace kerf

KERF_OBSERVER(kerf::PartHistory, "part_history",
              "mass, mean velocity, momentum, energies and erosion of parts over time")
