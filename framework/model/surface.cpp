// Neighbours across faces: matched locally by the smallest node of a face, across ranks by rendezvous.
#include "model/surface.hpp"

#include <algorithm>
#include <unordered_map>

#include "core/assert.hpp"
#include "kerf/collapsed_cell.hpp"
#include "model/model.hpp"
#include "parallel/ownership.hpp"

namespace kerf {

namespace {

std::array<std::int32_t, 4> face_nodes(const PartStore& store, int slot, int face) {
  const auto& corner = store.shape().face[face];
  return {store.node(slot, corner[0]), store.node(slot, corner[1]), store.node(slot, corner[2]),
          store.node(slot, corner[3])};
}

ExteriorFacet facet(const SurfaceMesh& mesh, std::int32_t part, std::int32_t slot, std::int32_t face) {
  return {part, slot, face, face_nodes(*mesh.parts[part].store, slot, face)};
}

struct FaceKey {
  std::int32_t low, mid, high;  // the three larger nodes, sorted; the smallest one is the bucket
  std::int32_t element, face;
};

}  // namespace

Surface::Place Surface::place_of(std::int32_t element, std::int32_t likely_part) const {
  std::int32_t part = likely_part;
  if (element < offset_[part] || element >= offset_[part + 1])
    part = static_cast<std::int32_t>(std::upper_bound(offset_.begin(), offset_.end(), element) - offset_.begin()) - 1;
  return {part, element - offset_[part]};
}

void Surface::build(const SurfaceMesh& mesh) {
  offset_.assign(1, 0);
  for (const PartModel& p : mesh.parts) offset_.push_back(offset_.back() + p.store->n_slots());
  neighbour_.assign(static_cast<std::size_t>(offset_.back()), all_none);
  remote_id_.clear();
  remote_rank_.clear();
  remote_faces_.clear();
  remote_died_.clear();
  known_ = Known::nothing;
  exterior_.clear();
  plan_.reset();
  std::vector<std::int64_t> open;
  match_local(mesh, open);
  if (mesh.is_parallel()) match_remote(mesh, open);
}

void Surface::match_local(const SurfaceMesh& mesh, std::vector<std::int64_t>& open) {
  std::vector<std::int32_t> first(static_cast<std::size_t>(mesh.nodes.n()) + 2, 0);
  const auto each_face = [&](auto&& visit) {
    for (std::size_t p = 0; p < mesh.parts.size(); ++p) {
      const PartStore& store = *mesh.parts[p].store;
      for (int s = 0; s < store.n_slots(); ++s) {
        if (!store.live(s)) continue;
        for (int f = 0; f < store.shape().n_faces; ++f) {
          const std::array<std::int32_t, 4> nodes = face_nodes(store, s, f);
          if (!is_collapsed_face(nodes)) visit(face_key(nodes), offset_[p] + s, f);
        }
      }
    }
  };
  each_face([&](const auto& n, std::int32_t, int) { ++first[n[0] + 1]; });
  for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
  std::vector<FaceKey> keys(static_cast<std::size_t>(first.back()));
  std::vector<std::int32_t> next(first.begin(), first.end());
  each_face([&](const auto& n, std::int32_t e, int f) { keys[next[n[0]]++] = {n[1], n[2], n[3], e, f}; });
  for (int node = 0; node < mesh.nodes.n(); ++node)
    for (std::int32_t i = first[node]; i < first[node + 1]; ++i) {
      const FaceKey& a = keys[i];
      std::int32_t& mine = neighbour_[a.element][a.face];
      if (mine != none) continue;
      for (std::int32_t j = i + 1; j < first[node + 1]; ++j) {
        const FaceKey& b = keys[j];
        if (a.low != b.low || a.mid != b.mid || a.high != b.high) continue;
        mine = b.element;
        neighbour_[b.element][b.face] = a.element;
        break;
      }
      if (mine == none) open.push_back(static_cast<std::int64_t>(a.element) * Shape::code_of_faces + a.face);
    }
}

void Surface::match_remote(const SurfaceMesh& mesh, const std::vector<std::int64_t>& open) {
  // Only a face all of whose nodes are shared can have its other side elsewhere.
  std::vector<char> shared(static_cast<std::size_t>(mesh.nodes.n()), 0);
  for (const std::int32_t g : mesh.ghosts) shared[g] = 1;
  for (const std::int32_t s : mesh.ghost_plan->sources()) shared[s] = 1;
  std::vector<OpenFace> faces;
  std::vector<std::int64_t> where;
  for (const std::int64_t code : open) {
    const auto element = static_cast<std::int32_t>(code / Shape::code_of_faces);
    const int face = static_cast<int>(code % Shape::code_of_faces);
    const Place at = place_of(element, 0);
    const PartStore& store = *mesh.parts[at.part].store;
    const int slot = at.slot;
    OpenFace f;
    bool all = true;
    const auto n = face_nodes(store, slot, face);
    for (int k = 0; k < 4; ++k) {
      all = all && shared[n[k]] != 0;
      f.nodes[k] = mesh.nodes.id[n[k]];
    }
    if (!all) continue;
    f.nodes = face_key(f.nodes);
    f.element = store.id(slot);
    faces.push_back(f);
    where.push_back(code);
  }
  const auto found = match_faces(mesh.comm, faces);
  std::unordered_map<std::int64_t, std::int32_t> number;
  std::vector<Needed> needed;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i].element < 0) continue;
    const auto [it, fresh] = number.emplace(found[i].element, static_cast<std::int32_t>(remote_id_.size()));
    if (fresh) {
      remote_id_.push_back(found[i].element);
      remote_rank_.push_back(found[i].rank);
      needed.push_back({found[i].element, found[i].rank});
    }
    neighbour_[where[i] / Shape::code_of_faces][where[i] % Shape::code_of_faces] = first_remote - it->second;
    remote_faces_.push_back({it->second, static_cast<std::int32_t>(where[i] / Shape::code_of_faces),
                             static_cast<std::int32_t>(where[i] % Shape::code_of_faces)});
  }
  std::unordered_map<std::int64_t, std::int32_t> local;
  for (std::size_t i = 0; i < found.size(); ++i)
    if (found[i].element >= 0)
      local.emplace(faces[i].element, static_cast<std::int32_t>(where[i] / Shape::code_of_faces));
  plan_ = std::make_unique<ExchangePlan>(mesh.comm, needed, [&](std::int64_t id) { return local.at(id); });
  remote_alive_.assign(remote_id_.size(), 1);
}

void Surface::update(const SurfaceMesh& mesh) {
  known_ = known_ == Known::all ? Known::all_but_last_deaths : Known::nothing;
  tidy_ = false;
  if (!mesh.is_parallel() || !plan_) return;
  alive_.assign(neighbour_.size(), 0);
  for (std::size_t p = 0; p < mesh.parts.size(); ++p)
    for (int s = 0; s < mesh.parts[p].store->n_slots(); ++s)
      alive_[offset_[p] + s] = mesh.parts[p].store->live(s) ? 1 : 0;
  const std::vector<std::int64_t> before = remote_alive_;
  plan_->pull(alive_.data(), 1, remote_alive_.data(), 1, 1);
  remote_died_.assign(before.size(), 0);
  for (std::size_t r = 0; r < before.size(); ++r) remote_died_[r] = before[r] != 0 && remote_alive_[r] == 0 ? 1 : 0;
}

std::vector<ExteriorFacet> Surface::opened_by(const SurfaceMesh& mesh, const std::vector<ExteriorFacet>& retired) {
  std::vector<ExteriorFacet> opened;
  for (const ExteriorFacet& r : retired) {
    const std::int32_t dead = offset_[r.part] + r.slot;
    for (const std::int32_t n : neighbour_[dead]) {
      if (n < 0) continue;
      const Place behind = place_of(n, r.part);
      if (!mesh.parts[behind.part].store->live(behind.slot)) continue;
      for (std::int32_t face = 0; face < Shape::most_faces; ++face)
        if (neighbour_[n][face] == dead) opened.push_back(facet(mesh, behind.part, behind.slot, face));
    }
  }
  for (const RemoteFace& f : remote_faces_) {
    if (remote_died_.empty() || remote_died_[f.remote] == 0) continue;
    const Place at = place_of(f.element, 0);
    if (mesh.parts[at.part].store->live(at.slot)) opened.push_back(facet(mesh, at.part, at.slot, f.face));
  }
  if (known_ == Known::all_but_last_deaths) {
    exterior_.insert(exterior_.end(), opened.begin(), opened.end());
    known_ = Known::all;
  }
  return opened;
}

void Surface::compact(const SurfaceMesh& mesh, const std::vector<std::vector<std::int32_t>>& moved) {
  std::vector<std::int32_t> number(neighbour_.size(), none);
  std::vector<std::int32_t> offset(1, 0);
  for (std::size_t p = 0; p < mesh.parts.size(); ++p) {
    for (std::size_t s = 0; s < moved[p].size(); ++s)
      if (moved[p][s] >= 0) number[offset_[p] + static_cast<std::int32_t>(s)] = offset.back() + moved[p][s];
    offset.push_back(offset.back() + mesh.parts[p].store->n_slots());
  }
  std::vector<Neighbours> kept(static_cast<std::size_t>(offset.back()));
  for (std::size_t e = 0; e < neighbour_.size(); ++e) {
    if (number[e] < 0) continue;
    for (int f = 0; f < Shape::most_faces; ++f) {
      const std::int32_t n = neighbour_[e][f];
      kept[number[e]][f] = n >= 0 ? number[n] : n;
    }
  }
  std::erase_if(remote_faces_, [&](const RemoteFace& f) { return number[f.element] < 0; });
  for (RemoteFace& f : remote_faces_) f.element = number[f.element];
  neighbour_ = std::move(kept);
  offset_ = std::move(offset);
  if (known_ != Known::all) exterior_.clear();
  for (ExteriorFacet& f : exterior_) f.slot = moved[f.part][f.slot];
  std::erase_if(exterior_, [](const ExteriorFacet& f) { return f.slot < 0; });
  n_sorted_ = 0;
  tidy_ = false;
  if (plan_) {
    // The plan refers to old element numbers of the boundary elements: dead ones stay in it with flag 0.
    plan_->renumber([&](std::int32_t old) { return number[old]; });
  }
}

bool Surface::open_face(const SurfaceMesh& mesh, int part, std::int32_t element, int face) const {
  const std::int32_t n = neighbour_[element][face];
  if (n == none) return true;
  if (n <= first_remote) return remote_alive_[first_remote - n] == 0;
  const Place behind = place_of(n, part);
  return !mesh.parts[behind.part].store->live(behind.slot);
}

void Surface::find_exterior(const SurfaceMesh& mesh) {
  exterior_.clear();
  for (std::size_t p = 0; p < mesh.parts.size(); ++p) {
    const PartStore& store = *mesh.parts[p].store;
    for (int s = 0; s < store.n_slots(); ++s) {
      if (!store.live(s)) continue;
      for (int f = 0; f < store.shape().n_faces; ++f) {
        if (!open_face(mesh, static_cast<int>(p), offset_[p] + s, f)) continue;
        const ExteriorFacet found = facet(mesh, static_cast<std::int32_t>(p), s, f);
        if (!is_collapsed_face(found.nodes)) exterior_.push_back(found);
      }
    }
  }
  n_sorted_ = exterior_.size();
  known_ = Known::all;
  tidy_ = true;
}

const std::vector<ExteriorFacet>& Surface::exterior(const SurfaceMesh& mesh) {
  if (known_ != Known::all) {
    find_exterior(mesh);
    return exterior_;
  }
  if (tidy_) return exterior_;
  const auto dead = [&](const ExteriorFacet& f) { return !mesh.parts[f.part].store->live(f.slot); };
  const auto tail = exterior_.begin() + static_cast<std::ptrdiff_t>(n_sorted_);
  std::sort(tail, exterior_.end());
  std::inplace_merge(exterior_.begin(), tail, exterior_.end());
  std::erase_if(exterior_, dead);
  n_sorted_ = exterior_.size();
  tidy_ = true;
  return exterior_;
}

std::vector<ExteriorFacet> Surface::exterior_round(const SurfaceMesh& mesh, const std::vector<char>& marked) {
  if (known_ != Known::all) find_exterior(mesh);
  std::vector<ExteriorFacet> round;
  for (const ExteriorFacet& f : exterior_) {
    if ((marked[f.nodes[0]] | marked[f.nodes[1]] | marked[f.nodes[2]] | marked[f.nodes[3]]) == 0) continue;
    if (tidy_ || mesh.parts[f.part].store->live(f.slot)) round.push_back(f);
  }
  return round;
}

void Surface::neighbours(const SurfaceMesh& mesh, int part, int slot, std::vector<std::int64_t>& ids,
                         std::vector<int>& ranks) const {
  for (const std::int32_t n : neighbour_[offset_[part] + slot]) {
    if (n == none) continue;
    if (n <= first_remote) {
      if (remote_alive_[first_remote - n] == 0) continue;
      ids.push_back(remote_id_[first_remote - n]);
      ranks.push_back(remote_rank_[first_remote - n]);
      continue;
    }
    const Place behind = place_of(n, part);
    const PartStore& store = *mesh.parts[behind.part].store;
    if (!store.live(behind.slot)) continue;
    ids.push_back(store.id(behind.slot));
    ranks.push_back(mesh.rank);
  }
}

}  // namespace kerf
