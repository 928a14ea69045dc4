// Times at nodes fall from "never" in rounds. In each, every node takes the earliest time that its elements find from
// the times of the round before, and copies on other ranks take the earliest of all. What a round gives is a function
// of the round before and of nothing else, neither of the order of elements nor of who holds them; so the bits of all
// rounds, and of the last one, which changes nothing, are the same on any number of ranks. Only elements with a node
// that the last round changed are computed, for the others would find again what they have found.
#include "model/arrival.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <tuple>
#include <utility>

#include "core/assert.hpp"
#include "kerf/collapsed_cell.hpp"
#include "kerf/law_use.hpp"
#include "model/copies.hpp"
#include "model/eikonal.hpp"
#include "model/sight.hpp"
#include "parallel/communicator.hpp"

namespace kerf {

namespace {

using eikonal::Known;
using eikonal::never;

/// A law that asks, and the surface round all that it is the law of.
struct Fronts {
  const FrontLaw* law = nullptr;
  double slowness = 0.0;  // [s/m]
  std::unique_ptr<Sight> sight;
  std::vector<char> is_seen;  // per origin: whether some node of this rank sees it
};

/// A part with such a law.
struct FrontPart {
  int part = 0, fronts = 0;
  PartStore::FieldIndex field = PartStore::eos_state;  // where the arrival time goes
  int component = 0;
};

struct Facet {
  std::array<std::int64_t, 4> key{};  // ids of nodes in ascending order
  std::int64_t fronts = 0;
  std::array<double, 12> corners{};
};

/// A time of a node, on its way to the node's owner.
struct NodeTime {
  std::int64_t id = 0;
  double time = never;
};

/// An element and its distance from an origin.
struct Nearest {
  double distance = never;
  std::int64_t element = std::numeric_limits<std::int64_t>::max();
};

std::size_t index(int i) { return static_cast<std::size_t>(i); }

class ArrivalFinder {
 public:
  explicit ArrivalFinder(Model& model) : model_(model) { find_parts(); }

  bool has_work() const { return !parts_.empty(); }
  void solve() {
    find_surfaces();
    list_elements();
    light_what_is_seen();
    light_nearest();
    while (sum_of(model_.comm, exchange()) > 0) make_round();
    set_states();
  }

 private:
  struct Element {
    std::int32_t part = 0, slot = 0;  // the former of parts_
  };

  void find_parts() {
    for (std::size_t p = 0; p < model_.parts.size(); ++p) {
      const MaterialInput& m = *model_.parts[p].material;
      for (const Law* law : m.laws()) {
        const auto* front = dynamic_cast<const FrontLaw*>(law);
        if (front == nullptr || !front->asks_for_arrival()) continue;
        FrontPart found;
        found.part = static_cast<int>(p);
        std::tie(found.field, found.component) = model_.parts[p].store->find_variable(front->arrival_variable());
        KERF_ASSERT(found.field != PartStore::n_fields, "a law with fronts declares the variable for their arrival");
        for (; index(found.fronts) < fronts_.size(); ++found.fronts)
          if (fronts_[index(found.fronts)].law == front) break;
        if (index(found.fronts) == fronts_.size())
          fronts_.push_back(
              {front, 1.0 / front->front_speed(m.density), nullptr, std::vector<char>(index(front->n_origins()), 0)});
        parts_.push_back(found);
      }
    }
    is_uniform_ = fronts_.size() == 1;
  }

  PartStore& store_of(const FrontPart& p) { return *model_.parts[index(p.part)].store; }
  PartStore& store_of(const Element& e) { return store_of(parts_[index(e.part)]); }
  Fronts& fronts_of(const Element& e) { return fronts_[index(parts_[index(e.part)].fronts)]; }

  /// Faces that a law does not have on both sides, on all ranks.
  void find_surfaces() {
    std::vector<std::vector<Facet>> outgoing(index(model_.n_ranks()));
    for (const FrontPart& p : parts_) {
      const PartStore& store = store_of(p);
      for (int s = 0; s < store.n_slots(); ++s)
        for (int f = 0; store.live(s) && f < store.shape().n_faces; ++f) {
          Facet facet;
          facet.fronts = p.fronts;
          std::array<std::int32_t, 4> corners{};
          for (std::size_t k = 0; k < 4; ++k) corners[k] = store.node(s, store.shape().face[f][k]);
          if (is_collapsed_face(corners)) continue;
          for (std::size_t k = 0; k < 4; ++k) {
            const std::int32_t node = corners[k];
            facet.key[k] = model_.nodes.id[index(node)];
            for (int d = 0; d < 3; ++d) facet.corners[3 * k + index(d)] = model_.nodes.x(node)[d];
          }
          facet.key = face_key(facet.key);
          outgoing[static_cast<std::size_t>(facet.key[0] % model_.n_ranks())].push_back(facet);
        }
    }
    std::vector<Facet> all;
    for (const auto& list : all_to_all(model_.comm, outgoing)) all.insert(all.end(), list.begin(), list.end());
    const auto name = [](const Facet& f) { return std::pair(f.fronts, f.key); };
    std::sort(all.begin(), all.end(), [&](const Facet& a, const Facet& b) { return name(a) < name(b); });
    std::vector<Facet> single;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const bool twice =
          (i > 0 && name(all[i - 1]) == name(all[i])) || (i + 1 < all.size() && name(all[i + 1]) == name(all[i]));
      if (!twice) single.push_back(all[i]);
    }
    std::vector<std::vector<SightFacet>> facets(fronts_.size());
    const std::vector<std::vector<Facet>> copies(index(model_.n_ranks()), single);
    for (const auto& list : all_to_all(model_.comm, copies))
      for (const Facet& f : list) {
        SightFacet corners;
        for (std::size_t k = 0; k < 4; ++k) corners[k] = {f.corners[3 * k], f.corners[3 * k + 1], f.corners[3 * k + 2]};
        facets[static_cast<std::size_t>(f.fronts)].push_back(corners);
      }
    for (std::size_t k = 0; k < fronts_.size(); ++k) fronts_[k].sight = std::make_unique<Sight>(std::move(facets[k]));
  }

  void list_elements() {
    const std::size_t n = index(model_.nodes.n());
    time_.assign(n, never);
    is_exact_.assign(n, 0);
    std::vector<int> count(n + 1, 0);
    const auto each_node = [&](const auto& work) {
      for (std::size_t e = 0; e < elements_.size(); ++e) {
        const PartStore& store = store_of(elements_[e]);
        const DistinctCell cell = distinct(elements_[e]);
        for (int k = 0; k < cell.shape->n_nodes; ++k)
          work(e, index(store.node(elements_[e].slot, cell.corner[index(k)])));
      }
    };
    for (std::size_t p = 0; p < parts_.size(); ++p)
      for (int s = 0; s < store_of(parts_[p]).n_slots(); ++s)
        if (store_of(parts_[p]).live(s)) elements_.push_back({static_cast<std::int32_t>(p), s});
    each_node([&](std::size_t, std::size_t node) { ++count[node + 1]; });
    for (std::size_t i = 0; i < n; ++i) count[i + 1] += count[i];
    first_ = count;
    around_.resize(index(count[n]));
    each_node([&](std::size_t e, std::size_t node) { around_[index(count[node]++)] = static_cast<std::int32_t>(e); });
  }

  /// The earliest front that comes straight through one material; `never` where none does.
  static double straight(Fronts& f, Vec3 x) {
    double first = never;
    for (int k = 0; k < f.law->n_origins(); ++k) {
      const FrontOrigin o = f.law->origin(k, x);
      const double time = o.time + f.slowness * norm(x - o.point);
      if (!(time < first) || !f.sight->is_free(o.point, x)) continue;
      first = time;
      f.is_seen[index(k)] = 1;
    }
    return first;
  }

  void light_what_is_seen() {
    // A node of several laws is asked once for each.
    std::vector<std::int32_t> asked(time_.size(), -1);
    for (std::size_t k = 0; k < fronts_.size(); ++k)
      for (const Element& e : elements_) {
        const PartStore& store = store_of(e);
        if (parts_[index(e.part)].fronts != static_cast<int>(k)) continue;
        for (int c = 0; c < store.n_nodes(); ++c) {
          const std::size_t node = index(store.node(e.slot, c));
          if (asked[node] == static_cast<std::int32_t>(k)) continue;
          asked[node] = static_cast<std::int32_t>(k);
          const double time = straight(fronts_[k], model_.nodes.x(static_cast<int>(node)));
          if (!(time < time_[node])) continue;
          set_time(node, time);
          is_exact_[node] = is_uniform_ ? 1 : 0;
        }
      }
  }

  DistinctCell distinct(const Element& e) {
    const PartStore& store = store_of(e);
    ElementNodeIds nodes{};
    for (int k = 0; k < store.n_nodes(); ++k) nodes[index(k)] = store.node(e.slot, k);
    return {store.shape(), nodes};
  }

  Vec3 centre(const Element& e) {
    const PartStore& store = store_of(e);
    const DistinctCell cell = distinct(e);
    Vec3 sum;
    for (int k = 0; k < cell.shape->n_nodes; ++k) sum = sum + model_.nodes.x(store.node(e.slot, cell.corner[index(k)]));
    return sum * (1.0 / cell.shape->n_nodes);
  }

  /// Where no node sees an origin, because it lies outside, the nearest element burns from there.
  void light_nearest() {
    for (const Fronts& f : fronts_)
      for (int k = 0; k < f.law->n_origins(); ++k) {
        if (greatest(model_.comm, std::int64_t{f.is_seen[index(k)]}) != 0) continue;
        Nearest mine;
        const Element* found = nullptr;
        for (const Element& e : elements_) {
          if (&fronts_of(e) != &f) continue;
          const Vec3 x = centre(e);
          const Nearest here{norm(x - f.law->origin(k, x).point), store_of(e).id(e.slot)};
          if (here.distance > mine.distance || (here.distance == mine.distance && here.element > mine.element))
            continue;
          mine = here;
          found = &e;
        }
        const double least_distance = least(model_.comm, mine.distance);
        const std::int64_t candidate =
            mine.distance == least_distance ? mine.element : std::numeric_limits<std::int64_t>::max();
        if (-greatest(model_.comm, -candidate) != candidate || found == nullptr) continue;
        const PartStore& store = store_of(*found);
        for (int c = 0; c < store.n_nodes(); ++c) {
          const std::size_t node = index(store.node(found->slot, c));
          const Vec3 x = model_.nodes.x(static_cast<int>(node));
          const FrontOrigin o = f.law->origin(k, x);
          set_time(node, o.time + f.slowness * norm(x - o.point));
        }
      }
  }

  void set_time(std::size_t node, double time) {
    if (!(time < time_[node])) return;
    time_[node] = time;
    changed_.push_back(static_cast<std::int32_t>(node));
  }

  /// Gives all copies of a node the earliest of their times. Returns how many nodes of this rank the round has changed.
  std::int64_t exchange() {
    if (model_.ghost_plan) {
      std::vector<std::vector<NodeTime>> outgoing(index(model_.n_ranks()));
      for (const std::int32_t node : changed_)
        if (model_.nodes.owned[index(node)] == 0)
          outgoing[index(model_.node_owner[index(node)])].push_back({model_.nodes.id[index(node)], time_[index(node)]});
      for (const auto& list : all_to_all(model_.comm, outgoing))
        for (const NodeTime& t : list) set_time(index(model_.local_node(t.id)), t.time);
      std::vector<std::int64_t> bits(time_.size());
      for (std::size_t i = 0; i < time_.size(); ++i) bits[i] = std::bit_cast<std::int64_t>(time_[i]);
      copy_to_ghosts(model_, bits.data(), 1);
      for (const std::int32_t g : model_.ghosts) set_time(index(g), std::bit_cast<double>(bits[index(g)]));
    }
    return static_cast<std::int64_t>(changed_.size());
  }

  void make_round() {
    std::vector<std::int32_t> active;
    for (const std::int32_t node : changed_)
      active.insert(active.end(), around_.begin() + first_[index(node)], around_.begin() + first_[index(node) + 1]);
    std::sort(active.begin(), active.end());
    active.erase(std::unique(active.begin(), active.end()), active.end());
    changed_.clear();
    std::vector<std::pair<std::size_t, double>> found;
    for (const std::int32_t e : active) {
      const Element& element = elements_[index(e)];
      const PartStore& store = store_of(element);
      const DistinctCell cell = distinct(element);
      const auto corners = known(element, cell);
      for (int k = 0; k < cell.shape->n_nodes; ++k) {
        const std::size_t node = index(store.node(element.slot, cell.corner[index(k)]));
        if (is_exact_[node] != 0) continue;
        const double time =
            through(*cell.shape, corners, k, corners[index(k)].x, fronts_of(element).slowness, time_[node]);
        if (time < time_[node]) found.emplace_back(node, time);
      }
    }
    for (const auto& [node, time] : found) set_time(node, time);
  }

  /// Of the distinct nodes of an element.
  std::array<Known, Shape::most_nodes> known(const Element& e, const DistinctCell& cell) {
    const PartStore& store = store_of(e);
    std::array<Known, Shape::most_nodes> corners;
    for (int k = 0; k < cell.shape->n_nodes; ++k) {
      const std::int32_t node = store.node(e.slot, cell.corner[index(k)]);
      corners[index(k)] = {model_.nodes.x(node), time_[index(node)]};
    }
    return corners;
  }

  /// The earliest arrival at x through an element, from all its corners but one (-1: from all), where it is earlier
  /// than `time`. Nothing arrives before the earliest of what it comes from, so most pieces need not be computed.
  static double through(const Shape& shape, const std::array<Known, Shape::most_nodes>& corners, int but, Vec3 x,
                        double slowness, double time) {
    double first = never;
    for (int k = 0; k < shape.n_nodes; ++k)
      if (k != but) first = std::min(first, corners[index(k)].time);
    if (!(first < time)) return time;
    for (int k = 0; k < shape.n_nodes; ++k)
      if (k != but) time = std::min(time, eikonal::from_point(x, corners[index(k)], slowness));
    for (int f = 0; f < shape.n_faces; ++f) {
      const int(&n)[4] = shape.face[f];
      const auto at = [&](int k) -> const Known& { return corners[index(n[k % 4])]; };
      const auto is_early = [&](int k) { return at(k).time < time; };
      for (int k = 0; k < 4; ++k) {
        if (n[k] == but) continue;
        for (int l = k + 1; l < 4; ++l)
          if (n[l] != but && (is_early(k) || is_early(l)))
            time = std::min(time, eikonal::from_line(x, at(k), at(l), slowness));
        if (n[(k + 1) % 4] != but && n[(k + 2) % 4] != but && (is_early(k) || is_early(k + 1) || is_early(k + 2)))
          time = std::min(time, eikonal::from_triangle(x, at(k), at(k + 1), at(k + 2), slowness));
      }
    }
    return time;
  }

  void set_states() {
    for (const Element& e : elements_) {
      const FrontPart& p = parts_[index(e.part)];
      Fronts& f = fronts_of(e);
      const Vec3 x = centre(e);
      double time = straight(f, x);
      const DistinctCell cell = distinct(e);
      if (!is_uniform_ || !(time < never)) time = through(*cell.shape, known(e, cell), -1, x, f.slowness, time);
      store_of(e).field(p.field).set(e.slot, p.component, std::min(time, FrontLaw::never));
    }
  }

  Model& model_;
  std::vector<Fronts> fronts_;
  std::vector<FrontPart> parts_;
  bool is_uniform_ = true;  // one law: what is seen cannot be overtaken
  std::vector<Element> elements_;
  std::vector<int> first_;  // per node: where its elements begin in around_
  std::vector<std::int32_t> around_;
  std::vector<double> time_;  // per node [s]
  std::vector<char> is_exact_;  // per node: seen in a straight line
  std::vector<std::int32_t> changed_;  // nodes
};

}  // namespace

void find_arrivals(Model& model) {
  ArrivalFinder finder(model);
  if (finder.has_work()) finder.solve();
}

}  // namespace kerf
