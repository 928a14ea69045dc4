// Takes up contact forces that a restart file has brought.
#include "contact/load.hpp"

#include "model/model.hpp"

namespace kerf {

ContactLoad load_on_owned(const Model& model, const ForceByNode& forces) {
  ContactLoad load;
  for (int i = 0; i < model.nodes.n(); ++i) {
    const auto it = forces.find(model.nodes.id[i]);
    if (!model.nodes.owned[i] || it == forces.end()) continue;
    const auto& f = it->second;
    load.nodes.push_back(i);
    load.force.insert(load.force.end(), {f[0], f[1], f[2], 0});
    load.friction.insert(load.friction.end(), {f[3], f[4], f[5], 0});
  }
  return load;
}

}  // namespace kerf
