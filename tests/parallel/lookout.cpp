// Gathering of the engine's forces and the comparison with brute force.
#include "parallel/lookout.hpp"

#include <fmt/format.h>

#include <map>

#include "parallel/brute_contact.hpp"
#include "parallel/communicator.hpp"
#include "parallel/scene.hpp"

namespace kerf::test {

void compare_contact_forces(const Simulation& simulation, const Step& step, ForceComparison& comparison) {
  using Force = std::array<std::int64_t, 3>;
  struct Loaded {
    std::int64_t node;
    Force force;
  };
  const Model& model = simulation.model();
  std::vector<Loaded> loaded;
  const ContactLoad& load = simulation.contacts().front()->load();
  for (std::size_t k = 0; k < load.nodes.size(); ++k) {
    const Force f{load.force[4 * k], load.force[4 * k + 1], load.force[4 * k + 2]};
    if (f != Force{}) loaded.push_back({model.nodes.id[load.nodes[k]], f});
  }
  loaded = gather_to_root(model.comm, loaded);
  std::vector<std::int32_t> edges;
  for (const ContactTouch& t : simulation.contacts().front()->touches().touches())
    if (t.second >= 0) edges.push_back(t.second);
  comparison.n_edges += static_cast<std::int64_t>(gather_to_root(model.comm, edges).size());
  const GlobalModel global = gather_globally(model);
  if (model.rank() != 0) return;
  ++comparison.n_looks;
  comparison.n_loaded += static_cast<std::int64_t>(loaded.size());
  std::map<std::int64_t, Force> engine;
  for (const Loaded& l : loaded)
    for (int d = 0; d < 3; ++d) engine[l.node][d] += l.force[d];
  BruteContact brute(global, model.parts, *model.input->contacts.front());
  brute.predict(engine, model.quanta, simulation.next_step());
  const auto expected = brute.forces(model.quanta, simulation.contact_plans().front().pace);
  if (engine == expected && global.trouble.empty()) return;
  ++comparison.n_different;
  if (!comparison.first_difference.empty()) return;
  std::string nodes = global.trouble;
  for (const auto& [node, force] : expected) {
    const auto it = engine.find(node);
    if (it == engine.end())
      nodes += fmt::format(" {} is missing", node);
    else if (it->second != force)
      nodes += fmt::format(" {} differs", node);
  }
  for (const auto& [node, force] : engine)
    if (expected.count(node) == 0) nodes += fmt::format(" {} is too many", node);
  comparison.first_difference = fmt::format("cycle {}: node{}", step.cycle, nodes);
}

}  // namespace kerf::test
