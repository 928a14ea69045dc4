// An observer outside of Kerf's tree: the fastest node of the model, and how often its speed has grown.
#include <cmath>
#include <limits>

#include <kerf/observer.hpp>

struct FastestNode final : kerf::Observer {
  static void describe(kerf::Schema<FastestNode>& s) {
    s.real(&FastestNode::fail_at, "fail_at", "s", kerf::positive, "time at which the observer fails on the last rank")
        .optional();
    describe_interval(s);
  }

  kerf::ObserverCalls calls() const override { return {.after_forces = true, .after_step = true}; }
  std::vector<kerf::ObservedColumn> columns() const override {
    return {{"speed", "m/s", "of the fastest node"},
            {"node", "-", "its number"},
            {"force", "N", "on it"},
            {"grown", "-", "steps in which the greatest speed has grown"}};
  }

  // Local work first, then one collective call that all ranks make.
  void after_step(kerf::ObservedModel& model) override {
    double greatest = 0.0;
    for (int i = 0; i < model.nodes.n; ++i) {
      if (model.nodes.owned[i] == 0) continue;
      greatest = std::fmax(greatest, norm(model.nodes.v(i)));
      // One rank alone fails, while the others wait for it in the call below.
      if (fail_at > 0.0 && model.time >= fail_at && model.nodes.id[i] == 0)
        throw std::runtime_error("node 0 was not meant to get this far");
    }
    greatest = model.greatest({greatest}).front();
    if (greatest > fastest) grown += 1.0;
    fastest = greatest;
  }

  void after_forces(kerf::ObservedModel&) override { forces_seen += 1.0; }

  void sample(kerf::ObservedModel& model, std::span<double> row) override {
    double least = std::numeric_limits<double>::infinity();
    std::int64_t id = -1;
    for (int i = 0; i < model.nodes.n; ++i)
      if (model.nodes.owned[i] != 0 && -norm(model.nodes.v(i)) < least) {
        least = -norm(model.nodes.v(i));
        id = model.nodes.id[i];
      }
    const auto [speed, node] = model.nearest(least, id);
    bool mine = false;
    double force = 0.0;
    for (int i = 0; i < model.nodes.n; ++i)
      if (model.nodes.id[i] == node && model.nodes.owned[i] != 0) {
        mine = true;
        force = norm(model.nodes.force(i));
      }
    row[0] = -speed;
    row[1] = static_cast<double>(node);
    row[2] = model.from_holder(mine, {force}).front();
    row[3] = grown;
  }

  kerf::ObserverReport report(kerf::ObservedModel&) override {
    return {{{"grown", grown, ""}, {"forces_seen", forces_seen, ""}}, {}};
  }

  std::vector<double> state() const override { return {grown, fastest, forces_seen}; }
  void restore(std::span<const double> numbers) override {
    grown = numbers[0];
    fastest = numbers[1];
    forces_seen = numbers[2];
  }

  double fail_at = 0.0, grown = 0.0, fastest = 0.0, forces_seen = 0.0;
};

KERF_OBSERVER(FastestNode, "fastest_node", "speed of the fastest node over time")
