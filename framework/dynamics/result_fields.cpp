// Field by field, from blocked element arrays to plain columns.
#include "dynamics/result_fields.hpp"

#include <algorithm>
#include <cmath>

#include "core/assert.hpp"
#include "dynamics/setup.hpp"

namespace kerf {

namespace {

/// Calls `value(block, lane, to)`, which writes n doubles, for all live elements of a part. Returns the end.
template <int n, class Value>
double* copy_elements(const PartStore& store, double* out, const Value& value) {
  for (int block = 0; block < store.n_blocks(); ++block)
    for (int lane = 0; lane < lane_width; ++lane) {
      const int slot = block * lane_width + lane;
      if (slot >= store.n_slots() || !store.live(slot)) continue;
      value(block, lane, out);
      out += n;
    }
  return out;
}

/// A component of a field.
class Rows {
 public:
  Rows(const PartStore& store, PartStore::FieldIndex field, int component = 0)
      : field_(store.field(field)), component_(component) {}
  double operator()(int block, int lane) const { return field_.at(block * lane_width + lane, component_); }

 private:
  const Field& field_;
  int component_;
};

double* copy_stress(const PartStore& store, double* out) {
  std::vector<Rows> s;
  for (int c = 0; c < 6; ++c) s.emplace_back(store, PartStore::deviator, c);
  const Rows pressure(store, PartStore::pressure);
  return copy_elements<6>(store, out, [&](int b, int l, double* to) {
    for (int c = 0; c < 6; ++c) to[c] = c < 3 ? s[c](b, l) - pressure(b, l) : s[c](b, l);
  });
}

double* copy_elements_of(const PartStore& store, const std::string& name, double* out) {
  const auto each = [&](const auto& value) {
    return copy_elements<1>(store, out, [&](int b, int l, double* to) { *to = value(b, l); });
  };
  const Rows mass(store, PartStore::mass);
  if (name == "stress") return copy_stress(store, out);
  if (name == "pressure") return each(Rows(store, PartStore::pressure));
  if (name == "density")
    return each([&, volume = Rows(store, PartStore::volume)](int b, int l) { return mass(b, l) / volume(b, l); });
  if (name == "internal_energy")
    return each(
        [&, energy = Rows(store, PartStore::internal_energy)](int b, int l) { return energy(b, l) / mass(b, l); });
  if (name == "von_mises") {
    std::vector<Rows> s;
    for (int c = 0; c < 6; ++c) s.emplace_back(store, PartStore::deviator, c);
    return each([&](int b, int l) {
      return von_mises({s[0](b, l), s[1](b, l), s[2](b, l), s[3](b, l), s[4](b, l), s[5](b, l)});
    });
  }
  if (const auto [field, component] = store.find_variable(name); field != PartStore::n_fields)
    return each(Rows(store, field, component));
  return each([](int, int) { return 0.0; });  // a variable that this part's laws do not have is zero there
}

int components_of(const std::string& element_field) { return element_field == "stress" ? 6 : 1; }

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

void FrameWriter::fill_nodes(const std::string& name) {
  const NodeStore& nodes = model_.nodes;
  values_.resize((name == "mass" ? 1 : 3) * local_.size());
  double* out = values_.data();
  const auto copy_vectors = [&](const AlignedVector<double>& nodal) {
    for (const std::int32_t i : local_)
      for (std::size_t d = 0; d < 3; ++d) *out++ = nodal[4 * static_cast<std::size_t>(i) + d];
  };
  if (name == "mass") {
    for (const std::int32_t i : local_) *out++ = nodes.mass[i];
  } else if (name == "velocity") {
    copy_vectors(nodes.velocity);
  } else {
    copy_vectors(nodes.position);
    if (name == "position") return;
    out = values_.data();
    for (const std::int32_t i : local_) {
      const Vec3 home = reference_position(model_, nodes.id[i]);
      for (int d = 0; d < 3; ++d) *out++ -= home[d];
    }
  }
}

void FrameWriter::fill_elements(const std::string& name) {
  values_.resize(live_.size() * static_cast<std::size_t>(components_of(name)));
  double* out = values_.data();
  for (const PartModel& part : model_.parts) out = copy_elements_of(*part.store, name, out);
  KERF_ASSERT(out == values_.data() + values_.size(), "the live elements are those that were listed");
}

void FrameWriter::write(double time, ResultsWriter& results) {
  results.begin_frame(time, list_entities());
  fill_nodes("position");
  results.add_points(owned_, values_);
  results.add_alive(live_);
  for (const std::string& name : output_.node_fields) {
    fill_nodes(name);
    results.add_node_field(name, name == "mass" ? 1 : 3, owned_, values_);
  }
  for (const std::string& name : output_.element_fields) {
    fill_elements(name);
    results.add_element_field(name, components_of(name), live_, values_);
  }
  results.end_frame();
  release();
}

}  // namespace kerf
