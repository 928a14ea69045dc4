// How the candidates of a contact definition are kept complete between searches.
#include <algorithm>
#include <utility>

#include "contact/engine.hpp"
#include "parallel/communicator.hpp"

namespace kerf {

/// Foresees anew where the strays may be.
void ContactEngine::foresee_strays(const Model& model, const Step& step) {
  for (const auto& [k, boxes] : strays_) foresee(model, static_cast<std::size_t>(k), step.end(), boxes);
}

/// Records of the strays that this rank owns and that are slaves.
std::vector<ContactNodeRecord> ContactEngine::stray_slaves(const Model& model) const {
  std::vector<ContactNodeRecord> slaves;
  for (const auto& [k, boxes] : strays_) add_slave(model, static_cast<std::size_t>(k), slaves);
  return slaves;
}

/// Collects the records of the strays and of the facets round them, for this rank or into the outbox. What the outbox
/// holds already stays in it.
void ContactEngine::prepare_refresh(Model& model) {
  changed_slaves_ = stray_slaves(model);
  std::vector<char> stray(static_cast<std::size_t>(model.nodes.n()), 0);
  for (const auto& [k, boxes] : strays_) stray[tracked_[k].node] = 1;
  std::vector<ExteriorFacet> round = model.surface.exterior_round(model.surface_mesh(), stray);
  drop_mirrored(model, round);
  new_facets_ = collect_facets(model, round);
  if (model.n_ranks() == 1) return;
  if (!outbox_) outbox_ = std::make_unique<SparseExchange>(model.comm, Post::n_lists);
  Post post(*outbox_, 0);
  const Introductions fresh = put(model, changed_slaves_, new_facets_, post);
  in_outbox_.insert(in_outbox_.end(), fresh.begin(), fresh.end());
}

bool ContactEngine::has_news() const {
  if (!outbox_) return false;
  const std::vector<int> receivers = outbox_->receivers();
  return std::any_of(receivers.begin(), receivers.end(), [this](int rank) { return !told_.contains(rank); });
}

void ContactEngine::meet_partners(const std::vector<int>& receivers, const std::vector<int>& senders) {
  told_.insert(receivers.begin(), receivers.end());
  tellers_.insert(senders.begin(), senders.end());
}

/// Looks for what the strays and the facets round them may touch. Collective.
void ContactEngine::refresh(Model& model, bool all_that_will_leave, bool has_news) {
  if (model.n_ranks() > 1) {
    if (!outbox_) outbox_ = std::make_unique<SparseExchange>(model.comm, Post::n_lists);
    const std::vector<int> receivers = outbox_->receivers();
    if (has_news) {
      outbox_->deliver();
      meet_partners(receivers, outbox_->senders());
    } else {
      outbox_->deliver_among(told_, tellers_);
    }
    take(changed_slaves_, new_facets_, Post(*outbox_, 0));
    outbox_.reset();
    in_outbox_.clear();
  }
  if (all_that_will_leave)
    search_->renew(new_facets_, changed_slaves_);
  else
    search_->refresh(new_facets_, changed_slaves_);
  connect(model, false);
}

/// Adds the nodes to strays_ that need other boxes until the next renewal, and foresees all of strays_ anew.
void ContactEngine::look_ahead(const Model& model, const Step& step) {
  horizon_ = step.end() + dt_ahead() + static_cast<double>(law_.search_interval + 1) * step.dt;
  find_outgrown(model, step);
  foresee_strays(model, step);
}

bool ContactEngine::renewal_due(const Step& step) const { return step.cycle - last_renewal_ >= law_.search_interval; }

ContactNeed ContactEngine::need(Model& model, const Step& step, const Prediction& longest) {
  // Nobody has heard of the ranks in records that were prepared and not sent.
  outbox_.reset();
  for (const std::pair<int, int>& pair : std::exchange(in_outbox_, {})) introduced_.erase(pair);
  if (!valid_ || step.cycle - last_search_ >= renewals * law_.search_interval) return {SearchNeed::everything, 0};
  prediction_ = &longest;
  ContactNeed mine;
  strays_.clear();
  changed_slaves_.clear();
  new_facets_.clear();
  if (renewal_due(step)) {
    look_ahead(model, step);
    mine.what = SearchNeed::renewal;
  } else {
    find_strays(model, step);
    foresee_strays(model, step);
    if (!strays_.empty()) mine.what = SearchNeed::strays;
    if (search_->stale() || strays_.size() > std::max(tracked_.size() / 100, std::size_t{64}))
      mine.what = SearchNeed::renewal;
  }
  if (mine.what != SearchNeed::nothing) prepare_refresh(model);
  mine.has_news = has_news() ? 1 : 0;
  if (model.n_ranks() > 1 && farthest_reach(changed_slaves_) > slave_reach_) mine.what = SearchNeed::everything;
  prediction_ = nullptr;
  return mine;
}

/// Does what is needed so that whatever may touch in this cycle is among the candidates. Collective.
void ContactEngine::keep_complete(Model& model, const Step& step, const ContactPlan& plan) {
  SearchNeed need = plan.need;
  bool news = plan.has_news;
  if (need == SearchNeed::nothing) return;
  if (need == SearchNeed::strays) {
    ++counts_.refreshes;
    refresh(model, false, news);
    return;
  }
  if (need == SearchNeed::renewal && !renewal_due(step)) {
    // Not foretold by the count of cycles: nobody has looked so far ahead yet. The boxes of the strays of this step are
    // new already, and still have to be told.
    look_ahead(model, step);
    prepare_refresh(model);
    news = true;
    const double reach = model.n_ranks() > 1 ? greatest(model.comm, farthest_reach(changed_slaves_)) : 0.0;
    if (reach > slave_reach_) need = SearchNeed::everything;
  }
  if (need == SearchNeed::everything) {
    search(model, step);
    return;
  }
  last_renewal_ = step.cycle;
  renewed_.nodes += static_cast<std::int64_t>(strays_.size());
  renewed_.all += static_cast<std::int64_t>(tracked_.size());
  refresh(model, true, news);
  ++counts_.renewals;
}

void ContactEngine::announce_change(const Model& model, double time, const std::vector<std::int64_t>& dead_elements,
                                    std::vector<ExteriorFacet> opened, Post& post) {
  if (!valid_) return;
  drop_mirrored(model, opened);
  changed_slaves_.clear();
  untrack_free(model, changed_slaves_);
  for (const std::int32_t i : surface_nodes(model, opened))
    if (track_of_[i] < 0 && track(model, i, time)) add_slave(model, tracked_.size() - 1, changed_slaves_);
  new_facets_ = collect_facets(model, opened);
  dead_elements_ = dead_elements;
  if (model.n_ranks() == 1) return;
  // Facets of the search went as far as the slaves of the search could reach: one that reaches farther needs another
  // search. The others hear of it before the next forces.
  reaches_too_far_ = farthest_reach(changed_slaves_) > slave_reach_;
  put(model, changed_slaves_, new_facets_, post);
  for (std::size_t r = 0; r < has_facets_.size(); ++r)
    for (const std::int64_t element : dead_elements)
      if (has_facets_[r] != 0) post.put(Post::dead, static_cast<int>(r), element);
}

void ContactEngine::take_change(const Model& model, const Post& post) {
  if (!valid_) return;
  if (model.n_ranks() > 1) {
    take(changed_slaves_, new_facets_, post);
    dead_elements_ = post.take<std::int64_t>(Post::dead);
  }
  search_->change(dead_elements_, new_facets_, changed_slaves_);
  connect(model, false);
  if (model.n_ranks() > 1 && reaches_too_far_) valid_ = false;
}

/// Stops tracking nodes that have become free and do not take part any more. Their slaves are added without a role.
void ContactEngine::untrack_free(const Model& model, std::vector<ContactNodeRecord>& leaving) {
  if (keeps_free(model)) return;
  for (std::size_t k = tracked_.size(); k-- > 0;) {
    const std::int32_t node = tracked_[k].node;
    if (!model.nodes.free[node]) continue;
    const std::size_t n_before = leaving.size();
    add_slave(model, k, leaving);
    if (leaving.size() > n_before) leaving.back().role = 0;
    track_of_[tracked_.back().node] = static_cast<std::int32_t>(k);
    track_of_[node] = -1;
    tracked_[k] = tracked_.back();
    own_boxes_[k] = own_boxes_.back();
    home_[k] = home_.back();
    undeformed_[k] = undeformed_.back();
    tracked_.pop_back();
    own_boxes_.pop_back();
    home_.pop_back();
    undeformed_.pop_back();
  }
}

}  // namespace kerf
