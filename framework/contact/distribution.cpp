// The ranks that slaves and facets of a contact definition are sent to.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "contact/engine.hpp"
#include "parallel/communicator.hpp"

namespace kerf {

namespace {

/// Ranks keep their boxes of space while the busiest has at most this times what it had in new ones, over the mean.
constexpr double worst_share = 1.15;
/// Distance that slaves may leave their rank's box before the next search, over its edge.
constexpr double spare_share = 0.05;

/// The records for another rank, to which the local numbers of this one mean nothing.
ContactNodeRecord without_local_numbers(ContactNodeRecord slave) {
  slave.local = -1;
  return slave;
}
ContactFacetRecord without_local_numbers(ContactFacetRecord facet) {
  for (std::int32_t& local : facet.locals) local = -1;
  return facet;
}

}  // namespace

/// Sends every slave to the rank whose box holds it and every facet to all ranks that it may reach.
void ContactEngine::distribute(const Model& model, std::vector<ContactNodeRecord>& slaves,
                               std::vector<ContactFacetRecord>& facets) {
  // A slave costs some work at a search, and some for each of its candidates until the next.
  std::vector<double> weights;
  weights.reserve(slaves.size());
  for (const ContactNodeRecord& s : slaves)
    weights.push_back(1.0 +
                      (n_candidates_.empty() ? 0.0 : candidate_work * static_cast<double>(n_candidates_[s.local])));
  const double now = space_built_ ? unevenness(model, slaves, weights) : 0.0;
  if (!space_built_ || now > worst_share * best_unevenness_) {
    std::vector<double> coordinates;
    for (const ContactNodeRecord& s : slaves)
      for (int d = 0; d < 3; ++d) coordinates.push_back(s.home[d]);
    space_->build(model.comm, coordinates, weights);
    space_built_ = true;
    best_unevenness_ = unevenness(model, slaves, weights);
  }
  // Leaves some for slaves that join before the next search, and for the way that all make until then, as far as that
  // does not send many facets to ranks that do not need them.
  const auto [extent, reach] = extent_of(model, slaves);
  const double way = 2.0 * static_cast<double>(renewals - 1) * reach;
  slave_reach_ = 1.5 * reach + std::min(way, spare_share * extent / kerf::pow(model.n_ranks(), 1.0 / 3.0));
  has_facets_.assign(static_cast<std::size_t>(model.n_ranks()), 0);
  introduced_.clear();
  send(model, slaves, facets);
}

/// Greatest over mean work of the ranks with the present boxes of space. Collective.
double ContactEngine::unevenness(const Model& model, const std::vector<ContactNodeRecord>& slaves,
                                 const std::vector<double>& weights) const {
  // In whole numbers, whose sums are the same on all ranks.
  constexpr double units = 1024.0;  // of the search for one slave
  std::vector<std::int64_t> work(static_cast<std::size_t>(model.n_ranks()), 0);
  for (std::size_t k = 0; k < slaves.size(); ++k)
    work[space_->owner(slaves[k].home)] += std::llrint(units * weights[k]);
  const Waiting waiting;
  MPI_Allreduce(MPI_IN_PLACE, work.data(), model.n_ranks(), MPI_INT64_T, MPI_SUM, model.comm);
  const auto total = static_cast<double>(std::accumulate(work.begin(), work.end(), std::int64_t{0}));
  if (!(total > 0.0)) return 1.0;
  return static_cast<double>(*std::max_element(work.begin(), work.end())) * model.n_ranks() / total;
}

/// Longest edge of the box round the homes of all slaves, and how far any of them reaches. Collective.
ContactEngine::Extent ContactEngine::extent_of(const Model& model, const std::vector<ContactNodeRecord>& slaves) const {
  double most[7] = {-beyond, -beyond, -beyond, -beyond, -beyond, -beyond, farthest_reach(slaves)};
  for (const ContactNodeRecord& s : slaves)
    for (int d = 0; d < 3; ++d) {
      most[d] = std::max(most[d], -s.home[d]);
      most[3 + d] = std::max(most[3 + d], s.home[d]);
    }
  const Waiting waiting;
  MPI_Allreduce(MPI_IN_PLACE, most, 7, MPI_DOUBLE, MPI_MAX, model.comm);
  return {std::max({most[0] + most[3], most[1] + most[4], most[2] + most[5], 0.0}), most[6]};
}

/// How far slaves reach out of the place that decides about their rank.
double ContactEngine::farthest_reach(const std::vector<ContactNodeRecord>& slaves) const {
  double reach = 0.0;
  for (const ContactNodeRecord& s : slaves)
    for (const auto& [box, frame] : {std::pair(&s.box, &common_frame_), std::pair(&s.own_box, &body_frames_[s.body])}) {
      const Vec3 home = s.home - frame->origin;
      for (int d = 0; d < 3; ++d) reach = std::max({reach, box->high[d] - home[d], home[d] - box->low[d]});
    }
  return std::min(reach, beyond);
}

double ContactEngine::half_edge(const Box& box) {
  double edge = 0.0;
  for (int d = 0; d < 3; ++d) edge = std::max(edge, static_cast<double>(box.high[d]) - box.low[d]);
  return std::min(0.5 * edge, beyond);
}

/// Of the boxes of tracked nodes, half the longest edge [m].
double ContactEngine::mean_half_edge() const {
  double sum = 0.0;
  for (const Tracked& t : tracked_) sum += half_edge(t.box);
  return tracked_.empty() ? 0.0 : sum / static_cast<double>(tracked_.size());
}

void ContactEngine::note_spread(const std::vector<ContactFacetRecord>& facets) {
  n_facets_ = static_cast<std::int64_t>(facets.size());
  facet_spread_ = 0.0;
  for (const ContactFacetRecord& f : facets) facet_spread_ += std::max(half_edge(f.box) - 0.5 * f.edge, 0.0);
  facet_spread_ -= static_cast<double>(n_facets_) * mean_half_edge();
}

ContactEngine::Spread ContactEngine::spread() const {
  Spread now{0.0, facet_spread_ + static_cast<double>(n_facets_) * mean_half_edge(), n_facets_};
  for (const Tracked& t : tracked_) now.slave = std::max(now.slave, half_edge(t.box));
  return now;
}

/// Puts records into the post of the ranks whose box of space they concern, and makes the owners of their nodes known
/// to these ranks. Returns the pairs of owners and holders that are made known.
ContactEngine::Introductions ContactEngine::put(const Model& model, const std::vector<ContactNodeRecord>& slaves,
                                                const std::vector<ContactFacetRecord>& facets, Post& post) {
  Introductions fresh;
  const auto introduce = [&](int owner, int holder) {
    if (owner == holder || !introduced_.emplace(owner, holder).second) return;
    post.put(Post::holders, owner, holder);
    fresh.emplace_back(owner, holder);
  };
  for (const ContactNodeRecord& s : slaves) {
    const int r = space_->owner(s.home);
    post.put(Post::slaves, r, r == model.rank() ? s : without_local_numbers(s));
    introduce(s.owner, r);
  }
  std::vector<int> ranks;
  for (const ContactFacetRecord& f : facets) {
    Vec3 low, high;
    for (int d = 0; d < 3; ++d) {
      const double common = common_frame_.origin[d], own = body_frames_[f.body].origin[d];
      low[d] = std::min(common + f.box.low[d], own + f.own_box.low[d]) - slave_reach_;
      high[d] = std::max(common + f.box.high[d], own + f.own_box.high[d]) + slave_reach_;
    }
    space_->owners(low, high, ranks);
    for (const int r : ranks) {
      post.put(Post::facets, r, r == model.rank() ? f : without_local_numbers(f));
      has_facets_[r] = 1;
      for (const int owner : f.owners) introduce(owner, r);
    }
  }
  return fresh;
}

/// Replaces records by those that the post has brought.
void ContactEngine::take(std::vector<ContactNodeRecord>& slaves, std::vector<ContactFacetRecord>& facets,
                         const Post& post) {
  slaves = post.take<ContactNodeRecord>(Post::slaves);
  facets = post.take<ContactFacetRecord>(Post::facets);
  for (const ContactNodeRecord& s : slaves) channel_.meet_owner(s.owner);
  int last = -1;
  for (const ContactFacetRecord& f : facets)
    for (const int owner : f.owners) {
      if (owner != last) channel_.meet_owner(owner);
      last = owner;
    }
  for (const int holder : post.take<int>(Post::holders)) channel_.meet_holder(holder);
}

/// Replaces the records of a search by those that concern this rank's box of space. Collective.
void ContactEngine::send(const Model& model, std::vector<ContactNodeRecord>& slaves,
                         std::vector<ContactFacetRecord>& facets) {
  SparseExchange exchange(model.comm, Post::n_lists);
  Post post(exchange, 0);
  put(model, slaves, facets, post);
  const std::vector<int> receivers = exchange.receivers();
  exchange.deliver();
  told_.clear();
  tellers_.clear();
  meet_partners(receivers, exchange.senders());
  take(slaves, facets, post);
}

}  // namespace kerf
