// Field by field, from blocked element arrays to plain columns.
#include "dynamics/result_fields.hpp"

#include <algorithm>
#include <cmath>

#include "dynamics/setup.hpp"

namespace kerf {

namespace {

struct Column {
  int components = 1;
  std::vector<double> values;
};

SymTensor deviator_of(const PartStore& store, int s) {
  const Field& f = store.field(PartStore::deviator);
  return {f.at(s, 0), f.at(s, 1), f.at(s, 2), f.at(s, 3), f.at(s, 4), f.at(s, 5)};
}

void append_element(const PartModel& part, int s, const std::string& name,
                    const std::pair<PartStore::FieldIndex, int>& variable, Column& column) {
  const PartStore& store = *part.store;
  if (name == "pressure") {
    column.values.push_back(store.field(PartStore::pressure).at(s, 0));
  } else if (name == "density") {
    column.values.push_back(store.field(PartStore::mass).at(s, 0) / store.field(PartStore::volume).at(s, 0));
  } else if (name == "internal_energy") {
    column.values.push_back(store.field(PartStore::internal_energy).at(s, 0) / store.field(PartStore::mass).at(s, 0));
  } else if (name == "von_mises") {
    column.values.push_back(von_mises(deviator_of(store, s)));
  } else if (name == "stress") {
    const SymTensor d = deviator_of(store, s);
    const double p = store.field(PartStore::pressure).at(s, 0);
    column.values.insert(column.values.end(), {d.xx - p, d.yy - p, d.zz - p, d.xy, d.yz, d.zx});
  } else {
    // A variable that this part's laws do not have is zero there.
    column.values.push_back(variable.first == PartStore::n_fields ? 0.0
                                                                  : store.field(variable.first).at(s, variable.second));
  }
}

void append_node(const Model& model, int i, const std::string& name, Column& column) {
  const NodeStore& nodes = model.nodes;
  if (name == "mass") {
    column.values.push_back(nodes.mass[i]);
    return;
  }
  const Vec3 v = name == "velocity" ? nodes.v(i) : nodes.x(i) - reference_position(model, nodes.id[i]);
  column.values.insert(column.values.end(), {v.x, v.y, v.z});
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
  std::vector<double> positions;
  std::vector<std::int32_t> local;
  for (int i = 0; i < model.nodes.n(); ++i) {
    if (!model.nodes.owned[i]) continue;
    local.push_back(i);
    owned.push_back(model.nodes.id[i]);
    const Vec3 x = model.nodes.x(i);
    positions.insert(positions.end(), {x.x, x.y, x.z});
  }
  results.add_points(owned, positions);
  for (const PartModel& part : model.parts)
    for (int s = 0; s < part.store->n_slots(); ++s)
      if (part.store->live(s)) live.push_back(part.store->id(s));
  results.add_alive(live);
  for (const std::string& name : output.node_fields) {
    Column column;
    column.components = name == "mass" ? 1 : 3;
    for (const std::int32_t i : local) append_node(model, i, name, column);
    results.add_node_field(name, column.components, owned, column.values);
  }
  for (const std::string& name : output.element_fields) {
    Column column;
    column.components = name == "stress" ? 6 : 1;
    for (const PartModel& part : model.parts) {
      const auto variable = part.store->find_variable(name);
      for (int s = 0; s < part.store->n_slots(); ++s)
        if (part.store->live(s)) append_element(part, s, name, variable, column);
    }
    results.add_element_field(name, column.components, live, column.values);
  }
  results.end_frame();
}

}  // namespace kerf
