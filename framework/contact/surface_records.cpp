// What a contact definition takes part of the surface for: the records of its slaves and facets.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "contact/engine.hpp"
#include "core/assert.hpp"
#include "model/copies.hpp"

namespace kerf {

/// Takes out facets on planes of symmetry: the body goes on behind them.
void ContactEngine::drop_mirrored(const Model& model, std::vector<ExteriorFacet>& facets) const {
  if (mirrored_.empty()) return;
  std::erase_if(facets, [&](const ExteriorFacet& f) {
    std::array<std::int32_t, 4> memberships{};
    for (std::size_t k = 0; k < 4; ++k) {
      if (on_mirror_[f.nodes[k]] == 0) return false;
      memberships[k] = model.nodes.membership[f.nodes[k]];
    }
    for (const std::int32_t b : mirrors_[on_mirror_[f.nodes[0]]]) {
      const bool all = std::all_of(f.nodes.begin() + 1, f.nodes.end(), [&](std::int32_t n) {
        const std::vector<std::int32_t>& list = mirrors_[on_mirror_[n]];
        return std::binary_search(list.begin(), list.end(), b);
      });
      if (all && mirrored_[static_cast<std::size_t>(b)].holds_facet(f.part, memberships)) return true;
    }
    return false;
  });
}

/// Local numbers, in ascending order, of all nodes of exterior facets, on whatever rank these are, and of free nodes
/// that take part. Collective.
std::vector<std::int32_t> ContactEngine::surface_nodes(const Model& model,
                                                       const std::vector<ExteriorFacet>& facets) const {
  const auto n = static_cast<std::size_t>(model.nodes.n());
  std::vector<char> mark(n, 0);
  for (const ExteriorFacet& f : facets)
    for (const std::int32_t node : f.nodes) mark[node] = 1;
  if (model.ghost_plan) {
    std::vector<std::int64_t> count(mark.begin(), mark.end());
    sum_over_copies(model, count.data(), 1);
    for (std::size_t i = 0; i < n; ++i) mark[i] = count[i] != 0 ? 1 : 0;
  }
  std::vector<std::int32_t> nodes;
  const auto take = [&](std::size_t i) {
    if (mark[i] != 0 || takes_free(model, static_cast<int>(i))) nodes.push_back(static_cast<std::int32_t>(i));
  };
  // Most nodes are neither, which eight of them tell at once.
  constexpr std::size_t some = sizeof(std::uint64_t);
  std::size_t i = 0;
  for (; i + some <= n; i += some) {
    std::uint64_t marks, frees;
    std::memcpy(&marks, &mark[i], some);
    std::memcpy(&frees, &model.nodes.free[i], some);
    if ((marks | frees) == 0) continue;
    for (std::size_t k = i; k < i + some; ++k) take(k);
  }
  for (; i < n; ++i) take(i);
  return nodes;
}

/// The record of a tracked node, if this rank owns it and it is a slave.
void ContactEngine::add_slave(const Model& model, std::size_t tracked, std::vector<ContactNodeRecord>& records) const {
  const NodeStore& nodes = model.nodes;
  const Tracked& t = tracked_[tracked];
  if (!nodes.owned[t.node]) return;
  ContactNodeRecord r;
  r.role = (slaves_.holds(nodes, t.node) ? 1u : 0u) | (request_.symmetric && masters_.holds(nodes, t.node) ? 2u : 0u);
  if (r.role == 0) return;
  r.id = nodes.id[t.node];
  r.box = t.box;
  r.own_box = own_boxes_[tracked];
  r.home = home_[tracked];
  r.local = t.node;
  r.body = t.body;
  r.owner = model.rank();
  records.push_back(r);
}

std::vector<std::int64_t> ContactEngine::slave_ids(const Model& model) const {
  std::vector<ContactNodeRecord> records;
  for (std::size_t k = 0; k < tracked_.size(); ++k) add_slave(model, k, records);
  std::vector<std::int64_t> ids;
  ids.reserve(records.size());
  for (const ContactNodeRecord& r : records) ids.push_back(r.id);
  return ids;
}

/// Fills the record of a facet whose corners are tracked. False where it has no role in this contact.
bool ContactEngine::collect_facet(const Model& model, const ExteriorFacet& f, ContactFacetRecord& r) const {
  const NodeStore& nodes = model.nodes;
  const PartModel& part = model.parts[f.part];
  std::array<std::int32_t, 4> memberships{};
  const Shape& shape = part.store->shape();
  for (int k = 0; k < 8; ++k) {
    const int behind = shape.behind[f.face][k % 4];
    r.locals[k] = k < 4 || behind < 0 ? f.nodes[k % 4] : part.store->node(f.slot, behind);
    r.nodes[k] = nodes.id[r.locals[k]];
    r.owners[k] = model.node_owner[r.locals[k]];
    if (k < 4) memberships[static_cast<std::size_t>(k)] = nodes.membership[r.locals[k]];
  }
  const bool master = masters_.holds_facet(f.part, memberships), slave = slaves_.holds_facet(f.part, memberships);
  r.role = (master ? 1u : 0u) | (slave && request_.symmetric ? 2u : 0u);
  if (r.role == 0 && slave) r.role = ContactFacetRecord::meets_none;
  if (r.role == 0) return false;
  r.id = (part.store->id(f.slot) + part.shift_in_body) * Shape::code_of_faces + f.face;
  r.body = part.body;
  r.bulk_modulus = part.bulk_modulus;
  r.volume = part.store->field(PartStore::mass).at(f.slot, 0) / part.material->density;
  Vec3 x[4], undeformed[4];
  for (int k = 0; k < 4; ++k) {
    KERF_ASSERT(track_of_[r.locals[k]] >= 0, "the corners of a facet that takes part are tracked");
    const std::int32_t tracked = track_of_[r.locals[k]];
    x[k] = predicted_x(model, r.locals[k]);
    undeformed[k] = undeformed_[tracked];
    r.box.include(tracked_[tracked].box);
    r.own_box.include(own_boxes_[tracked]);
  }
  const double area = 0.5 * norm(cross(x[2] - x[0], x[3] - x[1]));
  // Facets may shrink, which makes elements thicker.
  FacetBounds bounds;
  for (int k = 0; k < 4; ++k) r.edge = std::max(r.edge, norm(undeformed[(k + 1) % 4] - undeformed[k]));
  bounds.edge = r.edge;
  bounds.longest_edge = longest_edge(r.locals);
  bounds.thickness = std::max(bounds.longest_edge, r.volume / std::max(area, 1e-300));
  const double reach = law_.reach(bounds);
  r.box.inflate(reach);
  r.own_box.inflate(reach);
  return true;
}

std::vector<ContactFacetRecord> ContactEngine::collect_facets(const Model& model,
                                                              const std::vector<ExteriorFacet>& facets) const {
  std::vector<ContactFacetRecord> records;
  records.reserve(facets.size());
  for (const ExteriorFacet& f : facets) {
    records.emplace_back();
    if (!collect_facet(model, f, records.back())) records.pop_back();
  }
  return records;
}

}  // namespace kerf
