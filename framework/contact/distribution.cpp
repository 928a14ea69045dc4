// The ranks that slaves and facets of a contact definition are sent to.
#include <algorithm>
#include <numeric>
#include <utility>

#include "contact/engine.hpp"
#include "parallel/communicator.hpp"

namespace kerf {

namespace {

/// Cost of keeping one candidate until the next search, over the cost of searching for one slave.
constexpr double candidate_work = 0.3;
/// Ranks keep their boxes of space while the busiest has at most this times the mean work.
constexpr double worst_share = 1.1;
/// Distance that slaves may leave their rank's box before the next search, over its edge.
constexpr double spare_share = 0.05;

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
  if (!space_built_ || uneven(model, slaves, weights)) {
    std::vector<double> coordinates;
    for (const ContactNodeRecord& s : slaves)
      for (int d = 0; d < 3; ++d) coordinates.push_back(s.home[d]);
    space_->build(model.comm, coordinates, weights);
    space_built_ = true;
  }
  // Leaves some for slaves that join before the next search, and for the way that all make until then, as far as that
  // does not send many facets to ranks that do not need them.
  const double reach = reach_of(model, slaves);
  const double way = 2.0 * static_cast<double>(renewals - 1) * reach;
  slave_reach_ =
      1.5 * reach + std::min(way, spare_share * extent_of(model, slaves) / kerf::pow(model.n_ranks(), 1.0 / 3.0));
  send(model, slaves, facets);
}

/// Whether the present boxes of space share out the work badly. Collective.
bool ContactEngine::uneven(const Model& model, const std::vector<ContactNodeRecord>& slaves,
                           const std::vector<double>& weights) const {
  std::vector<double> work(static_cast<std::size_t>(model.n_ranks()), 0.0);
  for (std::size_t k = 0; k < slaves.size(); ++k) work[space_->owner(slaves[k].home)] += weights[k];
  // From rank 0, because all must decide alike.
  std::vector<double> sums(work.size());
  MPI_Reduce(work.data(), sums.data(), model.n_ranks(), MPI_DOUBLE, MPI_SUM, 0, model.comm);
  MPI_Bcast(sums.data(), model.n_ranks(), MPI_DOUBLE, 0, model.comm);
  const double total = std::accumulate(sums.begin(), sums.end(), 0.0);
  return *std::max_element(sums.begin(), sums.end()) * model.n_ranks() > worst_share * total;
}

/// Longest edge of the box round the homes of all slaves. Collective.
double ContactEngine::extent_of(const Model& model, const std::vector<ContactNodeRecord>& slaves) const {
  double longest = 0.0;
  for (int d = 0; d < 3; ++d) {
    double low = beyond, high = -beyond;
    for (const ContactNodeRecord& s : slaves) {
      low = std::min(low, s.home[d]);
      high = std::max(high, s.home[d]);
    }
    longest = std::max(longest, greatest(model.comm, high) + greatest(model.comm, -low));
  }
  return longest;
}

/// How far slaves reach out of the place that decides about their rank. Collective.
double ContactEngine::reach_of(const Model& model, const std::vector<ContactNodeRecord>& slaves) const {
  double reach = 0.0;
  for (const ContactNodeRecord& s : slaves)
    for (const auto& [box, frame] : {std::pair(&s.box, &common_frame_), std::pair(&s.own_box, &body_frames_[s.body])}) {
      const Vec3 home = s.home - frame->origin;
      for (int d = 0; d < 3; ++d) reach = std::max({reach, box->high[d] - home[d], home[d] - box->low[d]});
    }
  return greatest(model.comm, std::min(reach, beyond));
}

/// Replaces the records that this rank made by those that concern its box of space.
void ContactEngine::send(const Model& model, std::vector<ContactNodeRecord>& slaves,
                         std::vector<ContactFacetRecord>& facets) {
  const auto n_ranks = static_cast<std::size_t>(model.n_ranks());
  std::vector<std::vector<ContactNodeRecord>> nodes_out(n_ranks);
  for (const ContactNodeRecord& s : slaves) nodes_out[space_->owner(s.home)].push_back(s);
  std::vector<std::vector<ContactFacetRecord>> facets_out(n_ranks);
  std::vector<int> ranks;
  for (const ContactFacetRecord& f : facets) {
    Vec3 low, high;
    for (int d = 0; d < 3; ++d) {
      const double common = common_frame_.origin[d], own = body_frames_[f.body].origin[d];
      low[d] = std::min(common + f.box.low[d], own + f.own_box.low[d]) - slave_reach_;
      high[d] = std::max(common + f.box.high[d], own + f.own_box.high[d]) + slave_reach_;
    }
    space_->owners(low, high, ranks);
    for (const int r : ranks) facets_out[r].push_back(f);
  }
  slaves.clear();
  facets.clear();
  for (const auto& list : all_to_all(model.comm, nodes_out)) slaves.insert(slaves.end(), list.begin(), list.end());
  for (const auto& list : all_to_all(model.comm, facets_out)) facets.insert(facets.end(), list.begin(), list.end());
}

}  // namespace kerf
