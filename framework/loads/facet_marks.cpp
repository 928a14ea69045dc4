// Choice of facets by the names of parts and sets, and their succession when elements die.
#include "loads/facet_marks.hpp"

#include <algorithm>

#include "kerf/collapsed_cell.hpp"
#include "model/node_group.hpp"
#include "model/setup.hpp"
#include "parallel/communicator.hpp"

namespace kerf {

namespace {

unsigned faces_marked(const PartStore& store, int slot, std::size_t law) {
  return static_cast<unsigned>(store.field(PartStore::loaded_faces).at(slot, static_cast<int>(law)));
}

void mark(Model& model, const ExteriorFacet& f, std::size_t law) {
  PartStore& store = *model.parts[static_cast<std::size_t>(f.part)].store;
  const unsigned faces = faces_marked(store, f.slot, law) | 1u << f.face;
  store.field(PartStore::loaded_faces).set(f.slot, static_cast<int>(law), static_cast<double>(faces));
}

/// Facets on a plane of symmetry, behind which the body goes on.
class Mirrors {
 public:
  explicit Mirrors(const Model& model) : model_(model) {
    for (const auto& b : model.input->boundaries) groups_.emplace_back(model, b->nodes());
  }
  bool hold(const ExteriorFacet& f) const {
    for (std::size_t b = 0; b < groups_.size(); ++b) {
      bool all = true;
      for (const std::int32_t i : f.nodes)
        all = all && groups_[b].holds(model_.nodes, i) && model_.input->boundaries[b]->mirrors(model_.nodes.x(i));
      if (all) return true;
    }
    return false;
  }

 private:
  const Model& model_;
  std::vector<NodeGroup> groups_;
};

}  // namespace

FacetMarks::FacetMarks(const ModelInput& input) : laws_(facet_loads(input)) {
  for (const FacetLoad* law : laws_) follows_ = follows_ || law->follows_erosion();
}

void FacetMarks::choose(Model& model) const {
  if (laws_.empty()) return;
  std::vector<NodeGroup> groups;
  for (const FacetLoad* law : laws_) groups.emplace_back(model, law->targets());
  const Mirrors mirrors(model);
  for (const ExteriorFacet& f : model.surface.exterior(model.surface_mesh())) {
    const auto& of_node = model.nodes.membership;
    const std::array<std::int32_t, 4> of_corners = {of_node[f.nodes[0]], of_node[f.nodes[1]], of_node[f.nodes[2]],
                                                    of_node[f.nodes[3]]};
    bool is_mirror = false, is_asked = false;
    for (std::size_t k = 0; k < laws_.size(); ++k) {
      if (!groups[k].holds_facet(f.part, of_corners)) continue;
      if (!is_asked) is_mirror = mirrors.hold(f);
      is_asked = true;
      if (!is_mirror) mark(model, f, k);
    }
  }
}

std::vector<FacetMarks::Marked> FacetMarks::find(const Model& model) const {
  std::vector<Marked> marks;
  if (laws_.empty()) return marks;
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    const PartStore& store = *model.parts[p].store;
    const Shape& shape = store.shape();
    for (int s = 0; s < store.n_slots(); ++s) {
      if (!store.live(s)) continue;
      for (std::size_t k = 0; k < laws_.size(); ++k) {
        const unsigned faces = faces_marked(store, s, k);
        for (int face = 0; face < shape.n_faces && faces != 0; ++face) {
          if ((faces >> face & 1u) == 0) continue;
          Marked m{{static_cast<std::int32_t>(p), s, face, {}}, k};
          for (std::size_t c = 0; c < 4; ++c) m.facet.nodes[c] = store.node(s, shape.face[face][c]);
          marks.push_back(m);
        }
      }
    }
  }
  return marks;
}

void FacetMarks::before_erosion(const Model& model, const std::vector<ExteriorFacet>& failing) {
  dying_.clear();
  if (!follows_) return;
  for (const ExteriorFacet& e : failing) {
    const PartStore& store = *model.parts[static_cast<std::size_t>(e.part)].store;
    const Shape& shape = store.shape();
    Dying element;
    for (int face = 0; face < shape.n_faces; ++face) {
      FaceKey nodes{};
      for (std::size_t c = 0; c < 4; ++c) nodes[c] = model.nodes.id[store.node(e.slot, shape.face[face][c])];
      if (!is_collapsed_face(nodes)) element.faces[static_cast<std::size_t>(element.n_faces++)] = face_key(nodes);
    }
    for (std::size_t k = 0; k < laws_.size(); ++k) {
      if (!laws_[k]->follows_erosion() || faces_marked(store, e.slot, k) == 0) continue;
      element.law = static_cast<std::int32_t>(k);
      dying_.push_back(element);
    }
    if (element.law == none) dying_.push_back(element);
  }
}

/// Faces of all dead elements that a law marks, or that touch, face to face, an element of that kind. In order.
std::vector<FacetMarks::FaceKey> FacetMarks::reached(const std::vector<Dying>& dead, std::int32_t law) {
  std::vector<FaceKey> faces;
  std::vector<char> taken(dead.size(), 0);
  const auto known = [&](const FaceKey& key) { return std::binary_search(faces.begin(), faces.end(), key); };
  for (bool changed = true; changed;) {
    changed = false;
    std::vector<FaceKey> more;
    for (std::size_t i = 0; i < dead.size(); ++i) {
      const auto end = dead[i].faces.begin() + dead[i].n_faces;
      if (taken[i] != 0 || !(dead[i].law == law || std::any_of(dead[i].faces.begin(), end, known))) continue;
      taken[i] = 1;
      changed = true;
      more.insert(more.end(), dead[i].faces.begin(), end);
    }
    faces.insert(faces.end(), more.begin(), more.end());
    std::sort(faces.begin(), faces.end());
  }
  return faces;
}

bool FacetMarks::after_erosion(Model& model, const std::vector<ExteriorFacet>& opened) {
  if (!follows_) return false;
  const std::vector<std::vector<Dying>> to_all(static_cast<std::size_t>(model.n_ranks()), dying_);
  std::vector<Dying> dead;
  for (const auto& of_rank : all_to_all(model.comm, to_all)) dead.insert(dead.end(), of_rank.begin(), of_rank.end());
  bool any = false;
  for (std::size_t k = 0; k < laws_.size(); ++k) {
    if (!laws_[k]->follows_erosion()) continue;
    const std::vector<FaceKey> faces = reached(dead, static_cast<std::int32_t>(k));
    for (const ExteriorFacet& f : opened) {
      FaceKey nodes{};
      for (std::size_t c = 0; c < 4; ++c) nodes[c] = model.nodes.id[f.nodes[c]];
      if (!std::binary_search(faces.begin(), faces.end(), face_key(nodes))) continue;
      mark(model, f, k);
      any = true;
    }
  }
  return any;
}

}  // namespace kerf
