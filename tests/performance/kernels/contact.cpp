// Benchmarks of contact between two blocks, on one rank: the search for candidates, how it follows deaths and nodes
// that leave their boxes, and the forces of eroding_surface.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "contact/candidate_search.hpp"
#include "contact/impacts.hpp"
#include "erosion/erosion.hpp"
#include "erosion/record.hpp"
#include "kerf/contact.hpp"
#include "kerf/shape.hpp"
#include "parallel/scene.hpp"

namespace {

using namespace kerf;
using test::scatter;

/// Two slabs of four layers of cells of about 1 mm, one flying at the other, turned and inclined a little. The records
/// of their surfaces are made much as the contact engine makes them.
class TwoSlabs {
 public:
  static constexpr double dt = 1e-7;  // [s]

  /// `gap` [mm] between the slabs' middles; where it vanishes, half of the faces overlap.
  TwoSlabs(int cells, double gap)
      : input_(test::scene(fmt::format(R"(
time: {{end: 1}}
materials:
  metal:
    density: 7850
    strength: {{type: elastic, shear_modulus: 80e9}}
    eos: {{type: linear, bulk_modulus: 170e9}}
    erosion: {{criteria: [{{type: fuse}}]}}
parts:
  lower:
    material: metal
    mesh: {{type: block, size: [{0}e-3, {0}e-3, 4e-3], origin: [-{1}e-3, -{1}e-3, -4e-3], cells: [{0}, {0}, 4]}}
  upper:
    material: metal
    velocity: [200, 0, -500]
    mesh: {{type: block, size: [{0}e-3, {0}e-3, 4e-3], origin: [-{1}e-3, -{1}e-3, 0], cells: [{2}, {2}, 4]}}
    placement: [{{angle: 0.2}}, {{angle: 1e-3, axis: [0, 1, 0], translate: [0, 0, {3}e-3]}}]
contacts: [{{type: eroding_surface}}]
)",
                                       cells, 0.5 * cells, cells * 9 / 10, gap))) {
    test::generate(model_, *input_);
    ledger_.open(model_);
    boxes_.resize(static_cast<std::size_t>(model_.nodes.n()));
    facets_ = model_.surface.exterior(model_.surface_mesh());
    for (const ExteriorFacet& f : facets_)
      for (int k = 0; k < 4; ++k) track(corner(f, k), slaves_);
    for (const ExteriorFacet& f : facets_) records_.push_back(record(f));
  }

  const Model& model() const { return model_; }
  const Contact& law() const { return *input_->contacts.front(); }
  /// As of a search on one of several ranks, if not `one_rank`.
  std::unique_ptr<CandidateSearch> search(std::vector<ContactNodeRecord> slaves, std::vector<ContactFacetRecord> facets,
                                          bool one_rank = true) const {
    return std::make_unique<CandidateSearch>(std::move(slaves), std::move(facets), true, one_rank ? boxes_.size() : 0);
  }
  const std::vector<ContactNodeRecord>& slaves() const { return slaves_; }
  const std::vector<ContactFacetRecord>& facets() const { return records_; }

  /// What a search is told after a step.
  struct News {
    std::vector<std::int64_t> dead;
    std::vector<ContactFacetRecord> facets;
    std::vector<ContactNodeRecord> slaves;
  };
  /// Kills four elements in the middle of the contact.
  News kill_some(int round);
  /// Some slaves leave their boxes, a share of all of them.
  News stray_some(int round, double share);

 private:
  struct Boxes {
    Box box, own_box;
    bool tracked = false;
  };
  std::int32_t corner(const ExteriorFacet& f, int k) const {
    const int face = k < 4 ? f.face : hexahedron.opposite_face[f.face];
    return model_.parts[f.part].store->node(f.slot, hexahedron.face[face][k % 4]);
  }
  /// Foresees where a node may be, and gives its record.
  ContactNodeRecord foresee(std::int32_t node, Vec3 x) {
    const Vec3 v = model_.nodes.v(node), drift = Vec3{100, 0, -250};
    const double horizon = static_cast<double>(law().search_interval + 1) * dt, slack = 0.002 * model_.dummy_edge;
    Boxes& b = boxes_[static_cast<std::size_t>(node)];
    b = {Box::spanned(x, x + (v - drift) * horizon, slack), Box::spanned(x, x, slack), true};
    ContactNodeRecord r;
    r.id = model_.nodes.id[node];
    r.box = b.box;
    r.own_box = b.own_box;
    r.home = {b.box.centre(0), b.box.centre(1), b.box.centre(2)};
    r.body = model_.nodes.part[node];
    r.role = 1;
    r.local = node;
    return r;
  }
  void track(std::int32_t node, std::vector<ContactNodeRecord>& joined) {
    if (!boxes_[static_cast<std::size_t>(node)].tracked) joined.push_back(foresee(node, model_.nodes.x(node)));
  }
  ContactFacetRecord record(const ExteriorFacet& f) const;

  std::unique_ptr<ModelInput> input_;
  Model model_;
  Ledger ledger_;
  std::vector<Boxes> boxes_;  // per node
  std::vector<ExteriorFacet> facets_;
  std::vector<ContactNodeRecord> slaves_;
  std::vector<ContactFacetRecord> records_;
};

ContactFacetRecord TwoSlabs::record(const ExteriorFacet& f) const {
  const PartModel& part = model_.parts[f.part];
  ContactFacetRecord r;
  r.id = part.store->id(f.slot) * 8 + f.face;
  r.body = f.part;
  r.role = 1;
  r.bulk_modulus = part.bulk_modulus;
  r.volume = part.store->field(PartStore::mass).at(f.slot, 0) / part.material->density;
  Vec3 x[4];
  for (int k = 0; k < 8; ++k) {
    r.locals[k] = corner(f, k);
    r.nodes[k] = model_.nodes.id[r.locals[k]];
    if (k >= 4) continue;
    x[k] = model_.nodes.x(r.locals[k]);
    r.box.include(boxes_[static_cast<std::size_t>(r.locals[k])].box);
    r.own_box.include(boxes_[static_cast<std::size_t>(r.locals[k])].own_box);
  }
  for (int k = 0; k < 4; ++k) r.edge = std::max(r.edge, norm(x[(k + 1) % 4] - x[k]));
  const double area = 0.5 * norm(cross(x[2] - x[0], x[3] - x[1])), slack = 0.002 * model_.dummy_edge;
  const double reach = law().reach({r.edge, r.edge + 2.0 * slack, r.volume / area});
  r.box.inflate(reach);
  r.own_box.inflate(reach);
  return r;
}

TwoSlabs::News TwoSlabs::kill_some(int round) {
  // Of the elements that face the other slab, within 8 mm of the middle, those with the lowest lots.
  std::vector<std::pair<double, ExteriorFacet>> lots;
  for (const ExteriorFacet& f : facets_) {
    if (f.face != 1 - f.part || !model_.parts[f.part].store->live(f.slot)) continue;
    const Vec3 x = model_.nodes.x(corner(f, 0));
    if (std::max(std::fabs(x.x), std::fabs(x.y)) > 8e-3) continue;
    const std::int64_t id = model_.parts[f.part].store->id(f.slot);
    lots.emplace_back(scatter(static_cast<std::uint64_t>(round), static_cast<std::uint64_t>(id)), f);
  }
  std::sort(lots.begin(), lots.end());
  News news;
  Erosion erosion(model_);
  for (int part = 0; part < 2; ++part) {
    auto& judge = dynamic_cast<PartJudge&>(*erosion.judge(model_, part, 1));
    for (std::size_t k = 0; k < 4; ++k)
      if (lots[k].second.part == part) judge.failures.push_back({lots[k].second.slot, 0, 0.0});
  }
  for (const ErosionRecord& r : erosion.erode(model_, Step{1, 0.0, dt, dt}, ledger_)) news.dead.push_back(r.element);
  erosion.update_free_nodes(model_);
  const std::vector<ExteriorFacet> opened = model_.surface.opened_by(model_.surface_mesh(), erosion.retired());
  for (const ExteriorFacet& f : opened)
    for (int k = 0; k < 4; ++k) track(corner(f, k), news.slaves);
  for (const ExteriorFacet& f : opened) news.facets.push_back(record(f));
  return news;
}

TwoSlabs::News TwoSlabs::stray_some(int round, double share) {
  News news;
  std::vector<char> stray(boxes_.size(), 0);
  for (const ContactNodeRecord& s : slaves_) {
    if (scatter(100 + static_cast<std::uint64_t>(round), static_cast<std::uint64_t>(s.id)) >= share) continue;
    stray[static_cast<std::size_t>(s.local)] = 1;
    news.slaves.push_back(foresee(s.local, model_.nodes.x(s.local) + Vec3{0.1e-3, 0.1e-3, 0.0}));
  }
  for (const ExteriorFacet& f : facets_)
    if ((stray[corner(f, 0)] | stray[corner(f, 1)] | stray[corner(f, 2)] | stray[corner(f, 3)]) != 0)
      news.facets.push_back(record(f));
  return news;
}

/// Construction and the first lists; items are facets.
void search_anew(benchmark::State& state) {
  const TwoSlabs slabs(static_cast<int>(state.range(0)), 0.0);
  std::unique_ptr<CandidateSearch> search;
  std::size_t n_pairs = 0;
  for (auto _ : state) {
    state.PauseTiming();
    search.reset();
    auto slaves = slabs.slaves();
    auto facets = slabs.facets();
    state.ResumeTiming();
    search = slabs.search(std::move(slaves), std::move(facets), state.range(1) != 0);
    n_pairs = search->candidates().candidate.size();
  }
  const auto n = static_cast<std::int64_t>(slabs.facets().size());
  state.SetItemsProcessed(state.iterations() * n);
  state.counters["facets"] = static_cast<double>(n);
  state.counters["candidates"] = static_cast<double>(n_pairs);
}
BENCHMARK(search_anew)->ArgNames({"cells", "one_rank"})->ArgsProduct({{32, 96}, {0, 1}})->Unit(benchmark::kMicrosecond);

/// The lists alone, as they are made anew after every change; items are slaves that have candidates.
void list_candidates(benchmark::State& state) {
  const TwoSlabs slabs(static_cast<int>(state.range(0)), 0.0);
  const auto search = slabs.search(slabs.slaves(), slabs.facets());
  std::size_t n_rows = 0;
  for (auto _ : state) n_rows = search->candidates().slave.size();
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(n_rows));
}
BENCHMARK(list_candidates)->ArgName("cells")->Arg(32)->Arg(96)->Unit(benchmark::kMicrosecond);

/// Tells a search the news of one step after the other, then starts again with a fresh one, as the engine does at its
/// interval.
template <class Tell>
void follow(benchmark::State& state, const TwoSlabs& slabs, const std::vector<TwoSlabs::News>& rounds,
            const Tell& tell) {
  std::unique_ptr<CandidateSearch> search;
  std::size_t round = 0, n_facets = 0;
  for (auto _ : state) {
    if (round % rounds.size() == 0) {
      state.PauseTiming();
      search = slabs.search(slabs.slaves(), slabs.facets());
      search->candidates();
      state.ResumeTiming();
    }
    const TwoSlabs::News& news = rounds[round++ % rounds.size()];
    n_facets += news.facets.size();
    tell(*search, news);
  }
  state.counters["new_facets"] = static_cast<double>(n_facets) / static_cast<double>(round);
}

/// Four elements die in a step, ten times; items are dead elements. Without the lists.
void change(benchmark::State& state) {
  TwoSlabs slabs(static_cast<int>(state.range(0)), 0.0);
  std::vector<TwoSlabs::News> rounds;
  for (int r = 0; r < 10; ++r) rounds.push_back(slabs.kill_some(r));
  follow(state, slabs, rounds, [](CandidateSearch& search, const TwoSlabs::News& news) {
    search.change(news.dead, news.facets, news.slaves);
  });
  state.SetItemsProcessed(state.iterations() * 4);
}
BENCHMARK(change)->ArgName("cells")->Arg(32)->Arg(96)->Unit(benchmark::kMicrosecond);

/// Slaves all over the surface leave their boxes in a step, ten times; items are such slaves. Without the lists.
void refresh(benchmark::State& state) {
  TwoSlabs slabs(static_cast<int>(state.range(0)), 0.0);
  std::vector<TwoSlabs::News> rounds;
  for (int r = 0; r < 10; ++r) rounds.push_back(slabs.stray_some(r, 1e-4 * static_cast<double>(state.range(1))));
  std::int64_t n_strays = 0;
  follow(state, slabs, rounds, [&](CandidateSearch& search, const TwoSlabs::News& news) {
    n_strays += static_cast<std::int64_t>(news.slaves.size());
    search.refresh(news.facets, news.slaves);
  });
  state.SetItemsProcessed(n_strays);
}
BENCHMARK(refresh)
    ->ArgNames({"cells", "of_10000"})
    ->ArgsProduct({{32, 96}, {2, 20, 100}})
    ->Unit(benchmark::kMicrosecond);

/// Forces of eroding_surface on the candidates; items are slaves that have any. With a gap of 0, half of those between
/// the slabs are pushed; with one of 0.2 mm, none.
void contact_forces(benchmark::State& state) {
  const TwoSlabs slabs(static_cast<int>(state.range(0)), 0.1 * static_cast<double>(state.range(1)));
  const NodeStore& nodes = slabs.model().nodes;
  const auto search = slabs.search(slabs.slaves(), slabs.facets());
  const Candidates& found = search->candidates();
  AlignedVector<double> position, velocity;
  std::vector<double> mass;
  for (const std::int32_t n : found.node_local) {
    mass.push_back(nodes.mass[n]);
    position.insert(position.end(), &nodes.position[4 * n], &nodes.position[4 * n] + 4);
    velocity.insert(velocity.end(), &nodes.velocity[4 * n], &nodes.velocity[4 * n] + 4);
  }
  ContactView v;
  v.dt = v.kick_dt = TwoSlabs::dt;
  v.n_nodes = static_cast<int>(found.node_id.size());
  v.node_id = found.node_id.data();
  v.position = position.data();
  v.velocity = velocity.data();
  v.mass = mass.data();
  v.node_body = found.node_body.data();
  v.n_facets = static_cast<int>(found.facet_id.size());
  v.facet_id = found.facet_id.data();
  v.facet_nodes = found.facet_nodes.data();
  v.facet_body = found.facet_body.data();
  v.facet_bulk_modulus = found.facet_bulk_modulus.data();
  v.facet_volume = found.facet_volume.data();
  v.facet_edge = found.facet_edge.data();
  v.n_slaves = static_cast<int>(found.slave.size());
  v.slave = found.slave.data();
  v.candidate_rows = found.candidates.data();
  v.candidate = found.candidate.data();
  v.around_rows = found.around_rows.data();
  v.around = found.around.data();

  std::vector<std::int64_t> force(position.size()), shares(MassSplit::width * mass.size());
  std::size_t n_pushed = 0;
  for (auto _ : state) {
    state.PauseTiming();
    std::fill(force.begin(), force.end(), 0);
    std::fill(shares.begin(), shares.end(), 0);
    state.ResumeTiming();
    ContactTouches touches;
    slabs.law().find_touches(v, touches);
    const MassSplit split{shares.data(), slabs.model().quanta.mass};
    const std::vector<std::int32_t> none;
    add_shares(v, touches, split);
    ContactForces forces(force.data(), nullptr, slabs.model().quanta.force);
    Impacts(v, touches, slabs.law().response(), split, none).add_round(velocity.data(), forces);
    n_pushed = touches.touches().size();
    if (forces.overflow_node() >= 0) state.SkipWithError("a contact force is beyond all bounds");
  }
  state.SetItemsProcessed(state.iterations() * v.n_slaves);
  state.counters["slaves"] = v.n_slaves;
  state.counters["pushed"] = static_cast<double>(n_pushed);
  state.counters["candidates_per_slave"] = static_cast<double>(found.candidate.size()) / v.n_slaves;
}
BENCHMARK(contact_forces)
    ->ArgNames({"cells", "gap_0.1mm"})
    ->ArgsProduct({{32, 96}, {0, 2}})
    ->Unit(benchmark::kMicrosecond);

}  // namespace
