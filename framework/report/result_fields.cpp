// Field by field, from blocked element arrays to plain columns.
#include "report/result_fields.hpp"

#include <algorithm>
#include <cmath>

#include "core/assert.hpp"
#include "kerf/lanes.hpp"
#include "model/joining.hpp"

namespace kerf {

namespace {

/// Calls `rows(block, to)`, which fills n rows of a block, for all blocks of a part, and lists what live elements have
/// there, n values one after another. Returns the end.
template <int n, class Rows>
double* copy_elements(const PartStore& store, double* out, const Rows& rows) {
  alignas(64) double block_rows[n][lane_width];
  for (int block = 0; block < store.n_blocks(); ++block) {
    rows(block, block_rows);
    const int first = block * lane_width, used = std::min(lane_width, store.n_slots() - first);
    for (int lane = 0; lane < used; ++lane) {
      if (!store.live(first + lane)) continue;
      for (int c = 0; c < n; ++c) *out++ = block_rows[c][lane];
    }
  }
  return out;
}

/// One component of a field, block by block.
class Component {
 public:
  Component(const PartStore& store, PartStore::FieldIndex field, int component = 0)
      : field_(store.field(field)), component_(component) {}
  void read(int block, double (&row)[lane_width]) const {
    const std::size_t first = field_.index(block * lane_width, component_);
    if (field_.is_single)
      std::copy_n(&field_.single_data[first], lane_width, row);
    else
      std::copy_n(&field_.data[first], lane_width, row);
  }

 private:
  const Field& field_;
  int component_;
};

/// Components of the deviator, then pressure.
class Stress {
 public:
  explicit Stress(const PartStore& store) : pressure_(store, PartStore::pressure) {
    for (int c = 0; c < 6; ++c) deviator_.emplace_back(store, PartStore::deviator, c);
  }
  void read_deviator(int block, double (&s)[6][lane_width]) const {
    for (int c = 0; c < 6; ++c) deviator_[c].read(block, s[c]);
  }
  void read(int block, double (&s)[6][lane_width]) const {
    alignas(64) double pressure[lane_width];
    read_deviator(block, s);
    pressure_.read(block, pressure);
    for (int c = 0; c < 3; ++c)
      for (int l = 0; l < lane_width; ++l) s[c][l] -= pressure[l];
  }

 private:
  std::vector<Component> deviator_;
  Component pressure_;
};

double* copy_quotient(const PartStore& store, const Component& over, const Component& under, double* out) {
  return copy_elements<1>(store, out, [&](int block, double(&row)[1][lane_width]) {
    alignas(64) double divisor[lane_width];
    over.read(block, row[0]);
    under.read(block, divisor);
    for (int l = 0; l < lane_width; ++l) row[0][l] /= divisor[l];
  });
}

/// sqrt(3/2 s:s). By each_piece: which lane an element has depends on its rank, and a plain loop may be compiled so
/// that lanes round differently.
double* copy_von_mises(const PartStore& store, double* out) {
  return copy_elements<1>(store, out, [stress = Stress(store)](int block, double(&row)[1][lane_width]) {
    alignas(64) double s[6][lane_width];
    stress.read_deviator(block, s);
    each_piece([&](int lane) {
      Lanes squares{};
      for (int c = 0; c < 6; ++c) {
        const Lanes component = load_lanes(s[c] + lane);
        squares += (c < 3 ? 1.5 : 3.0) * component * component;
      }
      store_lanes(row[0] + lane, sqrt_of(squares));
    });
  });
}

double* copy_component(const PartStore& store, const Component& component, double* out) {
  return copy_elements<1>(store, out, [&](int block, double(&row)[1][lane_width]) { component.read(block, row[0]); });
}

double* copy_elements_of(const PartStore& store, const std::string& name, double* out) {
  const Component mass(store, PartStore::mass);
  if (name == "stress")
    return copy_elements<6>(
        store, out, [stress = Stress(store)](int block, double(&rows)[6][lane_width]) { stress.read(block, rows); });
  if (name == "von_mises") return copy_von_mises(store, out);
  if (name == "pressure") return copy_component(store, {store, PartStore::pressure}, out);
  if (name == "density") return copy_quotient(store, mass, {store, PartStore::volume}, out);
  if (name == "internal_energy") return copy_quotient(store, {store, PartStore::internal_energy}, mass, out);
  if (const auto [field, component] = store.find_variable(name); field != PartStore::n_fields)
    return copy_component(store, {store, field, component}, out);
  // A variable that this part's laws do not have is zero there.
  return copy_elements<1>(store, out, [](int, double(&row)[1][lane_width]) { std::fill_n(row[0], lane_width, 0.0); });
}

int components_of(const std::string& element_field) { return element_field == "stress" ? 6 : 1; }

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

/// A nodal field, as far as possible where it is. Valid until the next one.
HeldValues<double> FrameWriter::nodal(const std::string& name) {
  const NodeStore& nodes = model_.nodes;
  const std::size_t n = local_.size();
  if (name == "mass") return {nodes.mass.data(), n, 1, local_.data()};
  if (name == "velocity") return {nodes.velocity.data(), n, 4, local_.data()};
  if (name == "position") return {nodes.position.data(), n, 4, local_.data()};
  double* out = room_for(3 * n);  // displacement
  for (const std::int32_t i : local_) {
    const Vec3 moved = nodes.x(i) - nodes.reference_position(i);
    for (int d = 0; d < 3; ++d) *out++ = moved[d];
  }
  return {values_.data(), n, 3, nullptr};
}

/// A field of the live elements. Valid until the next one.
HeldValues<double> FrameWriter::elemental(const std::string& name) {
  const auto n_components = static_cast<std::size_t>(components_of(name));
  double* const begin = room_for(n_components * live_.size());
  double* out = begin;
  for (const PartModel& part : model_.parts) out = copy_elements_of(*part.store, name, out);
  KERF_ASSERT(out == begin + n_components * live_.size(), "the live elements are those that were listed");
  return {begin, live_.size(), n_components, nullptr};
}

void FrameWriter::write(double time, ResultsWriter& results) {
  results.begin_frame(time, list_entities());
  results.add_points(owned_, nodal("position"));
  results.add_alive(live_);
  for (const std::string& name : output_.node_fields)
    results.add_node_field(name, name == "mass" ? 1 : 3, owned_, nodal(name));
  for (const std::string& name : output_.element_fields)
    results.add_element_field(name, components_of(name), live_, elemental(name));
  results.end_frame();
  release();
}

}  // namespace kerf
