// The search: a coarse grid tells which cells are near another part, trees find the pairs, cutting measures them.
//
// A grid of cubes lies over the boxes in which parts may meet. Cells in cubes where there is one part only are left
// out, so that a model whose parts just touch costs a few passes over its elements. Each cube belongs to a rank, which
// is sent all cells in it; a pair is looked at by the rank whose cube holds the lowest corner of what the boxes of the
// two cells share.
#include "review/initial_overlap.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "contact/box_tree.hpp"
#include "core/fixed_sum.hpp"
#include "kerf/collapsed_cell.hpp"
#include "mesh/quality.hpp"
#include "mesh/shared_volume.hpp"
#include "parallel/communicator.hpp"

namespace kerf {

namespace {

/// An axis-parallel box in double precision; empty by default.
struct Extent {
  Vec3 low{far, far, far}, high{-far, -far, -far};  // [m]
  static constexpr double far = std::numeric_limits<double>::max();

  void include(Vec3 x) {
    for (int d = 0; d < 3; ++d) {
      low[d] = std::min(low[d], x[d]);
      high[d] = std::max(high[d], x[d]);
    }
  }
  void include(const Extent& other) {
    include(other.low);
    include(other.high);
  }
  bool is_empty() const { return low.x > high.x || low.y > high.y || low.z > high.z; }
  bool meets(const Extent& b) const {
    return low.x <= b.high.x && low.y <= b.high.y && low.z <= b.high.z && high.x >= b.low.x && high.y >= b.low.y &&
           high.z >= b.low.z;
  }
  Extent common(const Extent& b) const {
    Extent c;
    for (int d = 0; d < 3; ++d) {
      c.low[d] = std::max(low[d], b.low[d]);
      c.high[d] = std::min(high[d], b.high[d]);
    }
    return c;
  }
};

Extent extent_of(const Cell& cell) {
  Extent e;
  for (int k = 0; k < cell.shape->n_nodes; ++k) e.include(cell.x[static_cast<std::size_t>(k)]);
  return e;
}

Cell cell_of(const Model& model, const PartStore& store, int slot) {
  ElementNodeIds nodes{};
  CellCorners x;
  for (int k = 0; k < store.n_nodes(); ++k) {
    const std::int32_t node = store.node(slot, k);
    nodes[static_cast<std::size_t>(k)] = node;
    x[static_cast<std::size_t>(k)] = model.nodes.x(node);
  }
  const DistinctCell cell(store.shape(), nodes);
  return {cell.shape, cell.of(x)};
}

/// The shape of a cell as it is sent to other ranks: all hexahedra have eight nodes, all wedges six.
const Shape& shape_with(const Shape& whole, int n_nodes) {
  for (const Shape* shape : {&collapsed::wedge, &collapsed::pyramid, &collapsed::tetrahedron})
    if (whole.n_nodes == hexahedron.n_nodes && shape->n_nodes == n_nodes) return *shape;
  return whole;
}

/// Boxes round the parts, of all ranks. Collective.
std::vector<Extent> extents_of_parts(const Model& model) {
  std::vector<Extent> extents(model.parts.size());
  for (int i = 0; i < model.nodes.n(); ++i)
    for (const std::int32_t p : model.parts_of(i)) extents[static_cast<std::size_t>(p)].include(model.nodes.x(i));
  std::vector<double> limits;
  for (const Extent& e : extents)
    for (int d = 0; d < 3; ++d) limits.insert(limits.end(), {-e.low[d], e.high[d]});
  MPI_Allreduce(MPI_IN_PLACE, limits.data(), static_cast<int>(limits.size()), MPI_DOUBLE, MPI_MAX, model.comm);
  for (std::size_t p = 0; p < extents.size(); ++p)
    for (int d = 0; d < 3; ++d) {
      extents[p].low[d] = -limits[6 * p + 2 * static_cast<std::size_t>(d)];
      extents[p].high[d] = limits[6 * p + 2 * static_cast<std::size_t>(d) + 1];
    }
  return extents;
}

/// Where parts may meet: per part the boxes that it has in common with others.
struct MeetingPlaces {
  std::vector<std::vector<Extent>> of_part;
  Extent all;

  explicit MeetingPlaces(const std::vector<Extent>& parts) : of_part(parts.size()) {
    for (std::size_t p = 0; p < parts.size(); ++p)
      for (std::size_t q = 0; q < parts.size(); ++q) {
        const Extent common = parts[p].common(parts[q]);
        if (p == q || common.is_empty()) continue;
        of_part[p].push_back(common);
        all.include(common);
      }
  }
  bool meets(std::size_t part, const Extent& e) const {
    return std::any_of(of_part[part].begin(), of_part[part].end(), [&](const Extent& b) { return b.meets(e); });
  }
};

/// The grid of cubes, with the first and the last of the parts that have a cell in a cube.
class Cubes {
 public:
  Cubes(const Extent& region, std::int64_t n_elements) : low_(region.low) {
    const auto most = std::clamp(n_elements, std::int64_t{512}, std::int64_t{1} << 18);
    const Vec3 length = region.high - region.low;
    edge_ = std::max({length.x, length.y, length.z}) / 1024.0;
    if (!(edge_ > 0.0)) edge_ = 1.0;  // the boxes of two parts have just a point in common
    do {
      edge_ *= 1.25;
      for (int d = 0; d < 3; ++d) n_[static_cast<std::size_t>(d)] = static_cast<std::int64_t>(length[d] / edge_) + 1;
    } while (n_[0] * n_[1] * n_[2] > most);
    first_.assign(static_cast<std::size_t>(n_[0] * n_[1] * n_[2]), nobody);
    last_ = first_;
  }
  /// Calls `visit(cube)` for all that a box reaches; what lies outside of the grid counts for the cubes at its edge.
  template <class Visit>
  void each(const Extent& e, const Visit& visit) const {
    const auto first = place_of(e.low), last = place_of(e.high);
    for (std::int64_t k = first[2]; k <= last[2]; ++k)
      for (std::int64_t j = first[1]; j <= last[1]; ++j)
        for (std::int64_t i = first[0]; i <= last[0]; ++i) visit(static_cast<std::size_t>(i + n_[0] * (j + n_[1] * k)));
  }
  void mark(std::size_t cube, std::size_t part) {
    first_[cube] = std::max(first_[cube], -static_cast<std::int32_t>(part));
    last_[cube] = std::max(last_[cube], static_cast<std::int32_t>(part));
  }
  /// Collective.
  void join_ranks(MPI_Comm comm) {
    for (std::vector<std::int32_t>* parts : {&first_, &last_})
      MPI_Allreduce(MPI_IN_PLACE, parts->data(), static_cast<int>(parts->size()), MPI_INT32_T, MPI_MAX, comm);
  }
  bool has_several_parts(std::size_t cube) const { return last_[cube] != nobody && last_[cube] != -first_[cube]; }
  /// Blocks of cubes are dealt out in turn, so that no rank gets a whole surface.
  int rank_of(std::size_t cube, int n_ranks) const {
    const auto at = static_cast<std::int64_t>(cube);
    const std::int64_t i = at % n_[0], j = at / n_[0] % n_[1], k = at / (n_[0] * n_[1]);
    return static_cast<int>((i / 4 + 7 * (j / 4) + 13 * (k / 4)) % n_ranks);
  }
  int rank_of(Vec3 x, int n_ranks) const {
    const auto p = place_of(x);
    return rank_of(static_cast<std::size_t>(p[0] + n_[0] * (p[1] + n_[1] * p[2])), n_ranks);
  }
  Vec3 origin() const { return low_; }

 private:
  std::array<std::int64_t, 3> place_of(Vec3 x) const {
    std::array<std::int64_t, 3> p{};
    for (int d = 0; d < 3; ++d) {
      const auto n = n_[static_cast<std::size_t>(d)];
      const double place = std::clamp((x[d] - low_[d]) / edge_, 0.0, static_cast<double>(n - 1));
      p[static_cast<std::size_t>(d)] = static_cast<std::int64_t>(place);
    }
    return p;
  }
  Vec3 low_;
  double edge_ = 1.0;  // [m]
  std::array<std::int64_t, 3> n_{1, 1, 1};
  static constexpr std::int32_t nobody = std::numeric_limits<std::int32_t>::min();
  std::vector<std::int32_t> first_, last_;  // per cube; the former with a minus
};

/// A cell near another part, as it is sent to the ranks that look at it.
struct Suspect {
  std::int64_t id = 0, part = 0, n_corners = 0;
  CellCorners corners;
  std::array<std::int64_t, Shape::most_nodes> nodes{};  // ids, in ascending order; negative where no parts are joined

  Cell cell(const Model& model) const {
    const Shape& whole = model.parts[static_cast<std::size_t>(part)].store->shape();
    return {&shape_with(whole, static_cast<int>(n_corners)), corners};
  }
};

/// Whether two cells have a node in common.
bool are_joined(const Suspect& a, const Suspect& b) {
  for (std::size_t i = 0, j = 0; i < a.nodes.size() && j < b.nodes.size();) {
    if (a.nodes[i] == b.nodes[j] && a.nodes[i] >= 0) return true;
    ++(a.nodes[i] <= b.nodes[j] ? i : j);
  }
  return false;
}

/// Calls `take(part, cell, slot, box)` for all cells of this rank that reach into a meeting place.
template <class Take>
void each_near(const Model& model, const MeetingPlaces& places, const Take& take) {
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    if (places.of_part[p].empty()) continue;
    const PartStore& store = *model.parts[p].store;
    for (int s = 0; s < store.n_slots(); ++s) {
      if (!store.live(s)) continue;
      const Cell cell = cell_of(model, store, s);
      const Extent e = extent_of(cell);
      if (places.meets(p, e)) take(p, cell, s, e);
    }
  }
}

/// The cells that this rank has to look at. Collective.
std::vector<Suspect> collect_suspects(const Model& model, const MeetingPlaces& places, Cubes& cubes) {
  each_near(model, places, [&](std::size_t part, const Cell&, int, const Extent& e) {
    cubes.each(e, [&](std::size_t cube) { cubes.mark(cube, part); });
  });
  cubes.join_ranks(model.comm);
  std::vector<std::vector<Suspect>> outgoing(static_cast<std::size_t>(model.n_ranks()));
  std::vector<std::int64_t> last_sent(outgoing.size(), -1);  // a cell goes to each rank once
  each_near(model, places, [&](std::size_t part, const Cell& cell, int slot, const Extent& e) {
    const PartStore& store = *model.parts[part].store;
    Suspect suspect{store.id(slot), static_cast<std::int64_t>(part), cell.shape->n_nodes, cell.x, {}};
    suspect.nodes.fill(-1);
    for (int k = 0; model.has_joined_parts() && k < store.n_nodes(); ++k)
      suspect.nodes[static_cast<std::size_t>(k)] = model.nodes.id[store.node(slot, k)];
    std::sort(suspect.nodes.begin(), suspect.nodes.end());
    cubes.each(e, [&](std::size_t cube) {
      if (!cubes.has_several_parts(cube)) return;
      const auto rank = static_cast<std::size_t>(cubes.rank_of(cube, model.n_ranks()));
      if (last_sent[rank] == suspect.id) return;
      last_sent[rank] = suspect.id;
      outgoing[rank].push_back(suspect);
    });
  });
  std::vector<Suspect> all;
  for (auto& from_one : all_to_all(model.comm, outgoing)) all.insert(all.end(), from_one.begin(), from_one.end());
  // Neighbours in number are neighbours in space, mostly: what the trees live on.
  std::sort(all.begin(), all.end(),
            [](const Suspect& a, const Suspect& b) { return a.part != b.part ? a.part < b.part : a.id < b.id; });
  return all;
}

/// What is known of a suspect before it is compared with others.
struct Outline {
  Extent box;
  double tolerance = 0.0;  // a millionth of the cell, and more than the round-off of its positions [m]

  explicit Outline(const Cell& cell) : box(extent_of(cell)) {
    double farthest = 0.0;
    for (int d = 0; d < 3; ++d) farthest = std::max({farthest, std::fabs(box.low[d]), std::fabs(box.high[d])});
    tolerance = 1e-6 * longest_edge(*cell.shape, cell.x) + 64.0 * std::numeric_limits<double>::epsilon() * farthest;
  }
};

/// The part of both boxes that is thicker than `tolerance`; empty for cells that just touch.
Extent common_box(const Extent& a, const Extent& b, double tolerance) {
  const Extent common = a.common(b);
  for (int d = 0; d < 3; ++d)
    if (!(common.high[d] - common.low[d] > tolerance)) return {};
  return common;
}

/// What two parts share, as far as one rank has seen it.
struct Found {
  std::vector<double> volumes;  // of pairs of cells [m3]
  Extent where;
};

/// Of two cells, the one that is warped more is cut by the other one: planes fit that one better.
SharedVolume shared_by(const Cell& a, const FacePlanes& planes_of_a, const Cell& b, double tolerance) {
  const FacePlanes planes_of_b(b);
  if (planes_of_b.greatest_warp > planes_of_a.greatest_warp)
    return shared_volume(b, planes_of_b, a, planes_of_a, tolerance);
  return shared_volume(a, planes_of_a, b, planes_of_b, tolerance);
}

/// All pairs of cells that are this rank's to look at; entry p * n + q for parts p < q of n.
std::vector<Found> compare(const Model& model, const Cubes& cubes, const std::vector<Suspect>& suspects) {
  const std::size_t n = model.parts.size();
  std::vector<Found> found(n * n);
  std::vector<std::size_t> first(n + 1, 0);
  for (const Suspect& s : suspects) ++first[static_cast<std::size_t>(s.part) + 1];
  for (std::size_t p = 0; p < n; ++p) first[p + 1] += first[p];
  std::vector<Outline> outlines;
  outlines.reserve(suspects.size());
  for (const Suspect& s : suspects) outlines.emplace_back(s.cell(model));
  const auto box_of = [&](const Outline& o) {
    return Box::spanned(o.box.low - cubes.origin(), o.box.high - cubes.origin(), 0.0);
  };
  for (std::size_t q = 1; q < n; ++q) {
    BoxTree tree;
    for (std::size_t i = first[q]; i < first[q + 1]; ++i) tree.add(box_of(outlines[i]));
    tree.finish();
    for (std::size_t i = 0; i < first[q]; ++i) {  // cells of the parts before q
      const Cell a = suspects[i].cell(model);
      const FacePlanes planes(a);
      Found& pair = found[static_cast<std::size_t>(suspects[i].part) * n + q];
      tree.each(box_of(outlines[i]), [&](std::size_t place) {
        const std::size_t j = first[q] + place;
        const double tolerance = std::min(outlines[i].tolerance, outlines[j].tolerance);
        const Extent common = common_box(outlines[i].box, outlines[j].box, tolerance);
        if (common.is_empty() || cubes.rank_of(common.low, model.n_ranks()) != model.rank()) return;
        if (are_joined(suspects[i], suspects[j])) return;
        const SharedVolume s = shared_by(a, planes, suspects[j].cell(model), tolerance);
        if (!(s.volume > 0.0)) return;
        pair.volumes.push_back(s.volume);
        pair.where.include(Extent{s.low, s.high});
      });
    }
  }
  return found;
}

}  // namespace

std::string Overlap::sentence(const Model& model, const char* when) const {
  const Vec3 middle = (low + high) * 0.5, size = high - low;
  return fmt::format(
      "parts {} and {} overlap {}: they share {:.4g} m3 in a box of {:.4g} x {:.4g} x {:.4g} m round "
      "({:.5g}, {:.5g}, {:.5g}) m",
      model.parts[static_cast<std::size_t>(first)].input->name,
      model.parts[static_cast<std::size_t>(second)].input->name, when, volume, size.x, size.y, size.z, middle.x,
      middle.y, middle.z);
}

std::vector<Overlap> find_overlaps(const Model& model) {
  const MeetingPlaces places(extents_of_parts(model));
  if (places.all.is_empty()) return {};
  Cubes cubes(places.all, model.n_elements);
  const std::vector<Suspect> suspects = collect_suspects(model, places, cubes);
  const std::vector<Found> found = compare(model, cubes, suspects);
  std::vector<std::int64_t> n_pairs;
  for (const Found& f : found) n_pairs.push_back(static_cast<std::int64_t>(f.volumes.size()));
  MPI_Allreduce(MPI_IN_PLACE, n_pairs.data(), static_cast<int>(n_pairs.size()), MPI_INT64_T, MPI_SUM, model.comm);
  std::vector<Overlap> overlaps;
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (n_pairs[k] == 0) continue;
    Overlap o;
    o.first = static_cast<int>(k / model.parts.size());
    o.second = static_cast<int>(k % model.parts.size());
    o.volume = order_free_sum(model.comm, found[k].volumes);
    for (int d = 0; d < 3; ++d) {
      o.low[d] = least(model.comm, found[k].where.low[d]);
      o.high[d] = greatest(model.comm, found[k].where.high[d]);
    }
    overlaps.push_back(o);
  }
  return overlaps;
}

ContactCover::ContactCover(const Model& model) {
  for (const auto& law : model.input->contacts) {
    const ContactRequest request = law->request();
    definitions_.push_back({NodeGroup(model, request.slaves), NodeGroup(model, request.masters)});
  }
}

int ContactCover::between(int part, int other) const {
  for (std::size_t k = 0; k < definitions_.size(); ++k) {
    const Sides& s = definitions_[k];
    if ((s.slaves.reaches(part) && s.masters.reaches(other)) || (s.slaves.reaches(other) && s.masters.reaches(part)))
      return static_cast<int>(k);
  }
  return -1;
}

}  // namespace kerf
