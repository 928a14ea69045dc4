// Field by field, from blocked element arrays to plain columns.
#include "dynamics/result_fields.hpp"

#include <algorithm>
#include <cmath>

#include "dynamics/setup.hpp"

namespace kerf {

namespace {

SymTensor deviator_of(const PartStore& store, int s) {
  const Field& f = store.field(PartStore::deviator);
  return {f.at(s, 0), f.at(s, 1), f.at(s, 2), f.at(s, 3), f.at(s, 4), f.at(s, 5)};
}

/// Appends `value(slot)` of all live elements of a part.
template <class Value>
void append(const PartStore& store, std::vector<double>& values, const Value& value) {
  for (int s = 0; s < store.n_slots(); ++s)
    if (store.live(s)) values.push_back(value(s));
}

void append_elements(const PartStore& store, const std::string& name, std::vector<double>& values) {
  const Field &mass = store.field(PartStore::mass), &pressure = store.field(PartStore::pressure);
  if (name == "pressure") {
    append(store, values, [&](int s) { return pressure.at(s, 0); });
  } else if (name == "density") {
    append(store, values, [&](int s) { return mass.at(s, 0) / store.field(PartStore::volume).at(s, 0); });
  } else if (name == "internal_energy") {
    append(store, values, [&](int s) { return store.field(PartStore::internal_energy).at(s, 0) / mass.at(s, 0); });
  } else if (name == "von_mises") {
    append(store, values, [&](int s) { return von_mises(deviator_of(store, s)); });
  } else if (name == "stress") {
    for (int s = 0; s < store.n_slots(); ++s) {
      if (!store.live(s)) continue;
      const SymTensor d = deviator_of(store, s);
      const double p = pressure.at(s, 0);
      values.insert(values.end(), {d.xx - p, d.yy - p, d.zz - p, d.xy, d.yz, d.zx});
    }
  } else if (const auto [field, component] = store.find_variable(name); field != PartStore::n_fields) {
    append(store, values, [&, c = component](int s) { return store.field(field).at(s, c); });
  } else {
    append(store, values, [](int) { return 0.0; });  // a variable that this part's laws do not have is zero there
  }
}

/// Values of the nodes with the given local numbers.
std::vector<double> node_values(const Model& model, const std::string& name, const std::vector<std::int32_t>& local) {
  const NodeStore& nodes = model.nodes;
  std::vector<double> values;
  values.reserve(3 * local.size());
  for (const std::int32_t i : local) {
    if (name == "mass") {
      values.push_back(nodes.mass[i]);
      continue;
    }
    const Vec3 v = name == "velocity"   ? nodes.v(i)
                   : name == "position" ? nodes.x(i)
                                        : nodes.x(i) - reference_position(model, nodes.id[i]);
    values.insert(values.end(), {v.x, v.y, v.z});
  }
  return values;
}

}  // namespace

void write_topology(const Model& model, ResultsWriter& results) {
  const std::int64_t n = model.n_elements, r = model.rank(), n_ranks = model.n_ranks();
  const std::int64_t first = n * r / n_ranks, last = n * (r + 1) / n_ranks;
  std::vector<std::int64_t> ids, nodes;
  std::vector<std::int32_t> parts;
  std::vector<std::string> names;
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    const PartModel& part = model.parts[p];
    names.push_back(part.input->name);
    for (std::int64_t e = std::max(first, part.first_element); e < std::min(last, part.first_element + part.n_elements);
         ++e) {
      ids.push_back(e);
      parts.push_back(static_cast<std::int32_t>(p));
      for (const std::int64_t node : part.input->mesh->element(e - part.first_element))
        nodes.push_back(part.first_node + node);
    }
  }
  results.write_topology(ids, nodes, parts, names);
}

void write_frame(const Model& model, const OutputInput& output, double time, ResultsWriter& results) {
  results.begin_frame(time);
  std::vector<std::int64_t> owned, live;
  std::vector<std::int32_t> local;
  for (int i = 0; i < model.nodes.n(); ++i) {
    if (!model.nodes.owned[i]) continue;
    local.push_back(i);
    owned.push_back(model.nodes.id[i]);
  }
  results.add_points(owned, node_values(model, "position", local));
  for (const PartModel& part : model.parts)
    for (int s = 0; s < part.store->n_slots(); ++s)
      if (part.store->live(s)) live.push_back(part.store->id(s));
  results.add_alive(live);
  for (const std::string& name : output.node_fields)
    results.add_node_field(name, name == "mass" ? 1 : 3, owned, node_values(model, name, local));
  std::vector<double> values;
  for (const std::string& name : output.element_fields) {
    const int components = name == "stress" ? 6 : 1;
    values.clear();
    values.reserve(live.size() * static_cast<std::size_t>(components));
    for (const PartModel& part : model.parts) append_elements(*part.store, name, values);
    results.add_element_field(name, components, live, values);
  }
  results.end_frame();
}

}  // namespace kerf
