// Field by field, from blocked element arrays to plain columns.
#include "report/result_fields.hpp"

#include <algorithm>

#include "core/assert.hpp"
#include "input/output_fields.hpp"
#include "model/joining.hpp"
#include "model/names.hpp"
#include "report/field_values.hpp"

namespace kerf {

namespace {

/// Units of the fields that the output has, by name.
std::vector<std::pair<std::string, std::string>> units_of_fields(const Model& model) {
  std::vector<std::pair<std::string, std::string>> units;
  for (const std::string& name : model.input->output.node_fields) units.emplace_back(name, find_node_field(name)->unit);
  for (const std::string& name : model.input->output.element_fields)
    units.emplace_back(name, unit_of_field(model.parts, name));
  return units;
}

}  // namespace

void write_topology(const Model& model, ResultsWriter& results) {
  const std::int64_t n = model.n_elements, r = model.rank(), n_ranks = model.n_ranks();
  const std::int64_t first = n * r / n_ranks, last = n * (r + 1) / n_ranks;
  std::vector<std::int64_t> ids;
  std::vector<ElementNodeIds> nodes;
  std::vector<std::int32_t> part_of;
  std::vector<ResultsWriter::PartTopology> parts;
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    const PartModel& part = model.parts[p];
    parts.push_back({part.input->name, part.n_elements, &part.store->shape()});
    for (std::int64_t e = std::max(first, part.first_element); e < std::min(last, part.first_element + part.n_elements);
         ++e) {
      ids.push_back(e);
      part_of.push_back(static_cast<std::int32_t>(p));
      nodes.push_back(part.input->mesh->element(e - part.first_element));
      for (int k = 0; k < part.store->n_nodes(); ++k) nodes.back()[static_cast<std::size_t>(k)] += part.first_node;
    }
  }
  if (model.has_joined_parts()) {
    std::vector<std::int64_t> of_mesh;
    for (const ElementNodeIds& n : nodes) of_mesh.insert(of_mesh.end(), n.begin(), n.end());
    const std::vector<std::int64_t> of_model = model.shared.ids.resolve(model.comm, of_mesh);
    for (std::size_t e = 0; e < nodes.size(); ++e)
      std::copy_n(of_model.begin() + static_cast<std::ptrdiff_t>(e * Shape::most_nodes), Shape::most_nodes,
                  nodes[e].begin());
  }
  results.write_topology(ids, nodes, part_of, parts);
  if (has_labels(model))
    results.write_labels([&](std::int64_t id) { return element_label(model, id); },
                         [&](std::int64_t id) { return node_label(model, id); });
  results.note_units(units_of_fields(model));
}

/// Lists what this rank holds, unless that is known. Returns whether it is as it was at the frame before.
bool FrameWriter::list_entities() {
  std::vector<std::int64_t> now{model_.node_arrangement()};
  for (const PartModel& part : model_.parts) now.push_back(part.store->arrangement());
  const bool same = now == arrangement_;
  if (same && !(owned_.empty() && live_.empty())) return true;
  arrangement_ = now;
  owned_.clear();
  local_.clear();
  live_.clear();
  for (int i = 0; i < model_.nodes.n(); ++i) {
    if (!model_.nodes.owned[i]) continue;
    local_.push_back(i);
    owned_.push_back(model_.nodes.id[i]);
  }
  for (const PartModel& part : model_.parts)
    for (int s = 0; s < part.store->n_slots(); ++s)
      if (part.store->live(s)) live_.push_back(part.store->id(s));
  return same;
}

/// Lists and values of large models do not lie about between frames.
void FrameWriter::release() {
  constexpr std::size_t large = std::size_t{16} << 20;
  if (8 * (values_.capacity() + owned_.capacity() + live_.capacity()) <= large) return;
  for (auto* list : {&owned_, &live_}) std::vector<std::int64_t>().swap(*list);
  std::vector<std::int32_t>().swap(local_);
  std::vector<double>().swap(values_);
}

/// Room for the values of one field.
double* FrameWriter::room_for(std::size_t n) {
  if (values_.size() < n) {
    values_.clear();  // nothing to be copied
    values_.resize(n);
  }
  return values_.data();
}

/// A nodal field; one that is stored as it stands is taken from where it is. Valid until the next one.
HeldValues<double> FrameWriter::nodal(const std::string& name) {
  const NodeStore& nodes = model_.nodes;
  const std::size_t n = local_.size();
  if (name == "mass") return {nodes.mass.data(), n, 1, local_.data()};
  if (name == "velocity") return {nodes.velocity.data(), n, 4, local_.data()};
  if (name == "position") return {nodes.position.data(), n, 4, local_.data()};
  const NodeField& field = *find_node_field(name);
  const auto n_components = static_cast<std::size_t>(field.n_components);
  double* out = room_for(n_components * n);
  for (const std::int32_t i : local_) {
    field.fill({nodes.reference_position(i), nodes.x(i), nodes.v(i), nodes.mass[i]}, out);
    out += n_components;
  }
  return {values_.data(), n, n_components, nullptr};
}

int FrameWriter::components_of(const std::string& element_field) {
  const ElementField* field = find_element_field(element_field);
  return field == nullptr ? 1 : field->n_components;
}

/// A field of the live elements. Valid until the next one.
HeldValues<double> FrameWriter::elemental(const std::string& name) {
  const auto n_components = static_cast<std::size_t>(components_of(name));
  double* const begin = room_for(n_components * live_.size());
  double* out = begin;
  if (name == owner_field().name)
    out = std::fill_n(out, live_.size(), static_cast<double>(model_.rank()));
  else  // a variable that a part's laws do not have is zero there
    for (const PartModel& part : model_.parts) out = FieldOfPart(*part.store, name).of_all(out);
  KERF_ASSERT(out == begin + n_components * live_.size(), "the live elements are those that were listed");
  return {begin, live_.size(), n_components, nullptr};
}

void FrameWriter::write(double time, ResultsWriter& results) {
  results.begin_frame(time, list_entities());
  results.add_points(owned_, nodal("position"));
  results.add_alive(live_);
  for (const std::string& name : output_.node_fields)
    results.add_node_field(name, find_node_field(name)->n_components, owned_, nodal(name));
  for (const std::string& name : output_.element_fields)
    results.add_element_field(name, components_of(name), live_, elemental(name));
  results.end_frame();
  release();
}

}  // namespace kerf
