// Runs one contact definition in parallel: who may touch whom, on which rank, and carrying the forces back.
//
// Contact has a decomposition of its own (Brown, Attaway, Plimpton & Hendrickson, CMAME 184 (2000) 375-390): space
// is cut into boxes of equal numbers of slave nodes; each rank gets the slaves in its box and all facets that
// reach into it.
#pragma once

#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "contact/candidate_search.hpp"
#include "contact/channel.hpp"
#include "contact/impacts.hpp"
#include "contact/load.hpp"
#include "core/timers.hpp"
#include "kerf/contact.hpp"
#include "kerf/partitioner.hpp"
#include "model/distinct_lists.hpp"
#include "model/model.hpp"
#include "model/node_group.hpp"
#include "model/prediction.hpp"
#include "model/step.hpp"
#include "parallel/sparse_exchange.hpp"

namespace kerf {

/// How fast things move in contact, from which the longest step follows in which nothing passes unseen.
struct ContactSpeeds {
  double longest_step = 1e300;  // in which no pair closes too far [s]
  double most[6] = {-1e300, -1e300, -1e300, -1e300, -1e300, -1e300};  // of -v and v of all nodes that take part [m/s]

  void join(const ContactSpeeds& other) {
    longest_step = other.longest_step < longest_step ? other.longest_step : longest_step;
    for (int d = 0; d < 6; ++d) most[d] = other.most[d] > most[d] ? other.most[d] : most[d];
  }
  /// Bound of the speed of one node relative to another [m/s].
  double fastest_pair() const;
};

/// What the candidates of a definition need before they serve for a step, from the least to the most.
enum class SearchNeed : std::int64_t { nothing, strays, renewal, everything };

/// What all ranks have agreed on before a definition makes its forces.
struct ContactPlan {
  SearchNeed need = SearchNeed::everything;
  bool has_news = true;  // for ranks that do not expect any: records must be sent with an agreement of all
  ImpactPace pace;
};

/// What a rank finds about its candidates before the forces of a step.
struct ContactNeed {
  SearchNeed what = SearchNeed::nothing;
  std::int64_t has_news = 0;  // 1 where this rank has records for a rank that it has not told anything yet
};

class ContactEngine {
 public:
  /// What ranks tell each other about changes of the surface: some lists of a message that several definitions share.
  class Post {
   public:
    enum List { slaves, facets, dead, holders, n_lists };
    Post(SparseExchange& exchange, std::size_t definition)
        : exchange_(exchange), first_(n_lists * static_cast<int>(definition)) {}
    template <class T>
    void put(List list, int rank, const T& item) {
      exchange_.put(first_ + list, rank, item);
    }
    template <class T>
    std::vector<T> take(List list) const {
      return exchange_.take<T>(first_ + list);
    }

   private:
    SparseExchange& exchange_;
    int first_;
  };

  /// Cost of keeping one candidate until the next search, over the cost of searching for one slave.
  static constexpr double candidate_work = 0.3;

  /// `space` is needed on more than one rank.
  ContactEngine(const Model& model, const Contact& law, std::unique_ptr<SpatialDecomposition> space);

  /// The next forces need a fresh search whatever has moved.
  void invalidate() { valid_ = false; }
  /// The same after nodes got other local numbers. Local.
  void renumbered(const Model& model);
  /// After elements were retired and before stores are compacted: puts what other ranks have to know into the post, or
  /// leaves it to the next search. Collective among ranks that share nodes.
  void announce_change(const Model& model, double time, const std::vector<std::int64_t>& dead_elements,
                       std::vector<ExteriorFacet> opened, Post& post);
  /// Notes the ranks that have been told something in an agreement of all, and those that have told this one. Local.
  void meet_partners(const std::vector<int>& receivers, const std::vector<int>& senders);
  /// After the post was delivered: takes the dead facets out and the opened ones in. Collective among ranks that have
  /// met.
  void take_change(const Model& model, const Post& post);
  /// What this rank's candidates need before the forces of a step that is not longer than that of `longest`. Pre: as
  /// for add_forces(). Local.
  ContactNeed need(Model& model, const Step& step, const Prediction& longest);
  /// Adds this definition's forces to the owners of the nodes, searching first if needed. Pre: the nodes' forces are
  /// the sums of all others, on all copies; `prediction` is what they will do; `plan` has the greatest need of all
  /// ranks. Collective.
  void add_forces(Model& model, const Step& step, const Prediction& prediction, const ContactPlan& plan,
                  Timers& timers);
  /// Of the impacts of this rank in the last forces.
  const ImpactEffort& effort() const { return effort_; }
  /// Of this rank, as they are after the last forces. Which ranks know a node does not matter.
  const ContactSpeeds& speeds() const { return speeds_; }
  /// What the law has found in the last forces.
  const ContactTouches& touches() const { return touches_; }
  /// Id of a node of the last view.
  std::int64_t id_of(int node) const { return found_->node_id[node]; }
  double mass_of(int node) const { return mass_[node]; }
  /// Least distance at which a facet bounds the step of a node that closes in on it [m].
  double least_sight() const { return least_sight_; }
  /// Forces of the last call on nodes that this rank owns.
  const ContactLoad& load() const { return load_; }
  /// Whether candidates have been looked for, and those of this rank.
  bool has_candidates() const { return found_ != nullptr; }
  const Candidates& candidates() const { return *found_; }
  /// Pairs of nodes and facets that this rank's law has to look at in a step.
  std::size_t n_candidates() const;
  /// Surface nodes of this rank that candidates are looked for.
  std::size_t n_surface_nodes() const { return tracked_.size(); }
  /// Ids of the slaves that this rank owns, with or without candidates.
  std::vector<std::int64_t> slave_ids(const Model& model) const;
  /// How far boxes reach, of this rank: what records of a search would be sent by.
  struct Spread {
    double slave = 0.0;  // of a slave, beyond its middle, the farthest [m]
    double facets = 0.0;  // of facets, beyond their corners, added up [m]
    std::int64_t n_facets = 0;
  };
  Spread spread() const;
  bool has_friction() const { return law_.response().friction > 0.0; }
  /// Candidates of the local nodes that this rank owns, at the last complete search; empty where the nodes have got
  /// other numbers since.
  const std::vector<std::int64_t>& candidates_of_nodes() const { return n_candidates_; }
  /// How often candidates were looked for, the same on all ranks.
  struct Counts {
    std::int64_t searches = 0, renewals = 0, refreshes = 0;
  };
  const Counts& counts() const { return counts_; }
  /// Of all renewals so far, on this rank: nodes with new boxes, and all that there were.
  struct Renewed {
    std::int64_t nodes = 0, all = 0;
  };
  const Renewed& renewed() const { return renewed_; }
  /// Sentence about a force that cannot be, or empty. Local.
  const std::string& trouble() const { return trouble_; }
  /// Sentences about bodies that overlap at the start. Collective; the same on all ranks.
  std::vector<std::string> initial_penetrations(Model& model);

 private:
  class Exchange;
  /// Where a node may be before the candidates become incomplete, seen from the common frame.
  struct Tracked {
    Box box;
    std::int32_t node = 0, body = 0;
  };
  static constexpr unsigned in_common_frame = 1, in_own_frame = 2;
  /// One of tracked_ that has left its boxes or is about to.
  struct Stray {
    std::int32_t tracked = 0;
    unsigned boxes = 0;  // that it needs anew
  };
  void search(Model& model, const Step& step);
  bool renewal_due(const Step& step) const;
  void look_ahead(const Model& model, const Step& step);
  void foresee_strays(const Model& model, const Step& step);
  std::vector<ContactNodeRecord> stray_slaves(const Model& model) const;
  void keep_complete(Model& model, const Step& step, const ContactPlan& plan);
  void prepare_refresh(Model& model);
  bool has_news() const;
  std::vector<char> bodies_with_own_frame() const;
  void find_strays(const Model& model, const Step& step);
  void find_outgrown(const Model& model, const Step& step);
  void refresh(Model& model, bool all_that_will_leave, bool has_news);
  void drop_mirrored(const Model& model, std::vector<ExteriorFacet>& facets) const;
  std::vector<std::int32_t> surface_nodes(const Model& model, const std::vector<ExteriorFacet>& facets) const;
  void foresee(const Model& model, std::size_t tracked, double time, unsigned boxes = in_common_frame | in_own_frame);
  bool track(const Model& model, int node, double time);
  bool keeps_free(const Model& model) const;
  bool takes_free(const Model& model, int node) const;
  void untrack_free(const Model& model, std::vector<ContactNodeRecord>& leaving);
  void choose_frames(const Model& model, const std::vector<std::int32_t>& surface);
  void add_slave(const Model& model, std::size_t tracked, std::vector<ContactNodeRecord>& records) const;
  double longest_edge(const std::int32_t* corners) const;
  bool collect_facet(const Model& model, const ExteriorFacet& f, ContactFacetRecord& record) const;
  std::vector<ContactFacetRecord> collect_facets(const Model& model, const std::vector<ExteriorFacet>& facets) const;
  void distribute(const Model& model, std::vector<ContactNodeRecord>& slaves, std::vector<ContactFacetRecord>& facets);
  double unevenness(const Model& model, const std::vector<ContactNodeRecord>& slaves,
                    const std::vector<double>& weights) const;
  void count_candidates(const Model& model);
  struct Extent {
    double edge, reach;  // [m]
  };
  Extent extent_of(const Model& model, const std::vector<ContactNodeRecord>& slaves) const;
  double farthest_reach(const std::vector<ContactNodeRecord>& slaves) const;
  static double half_edge(const Box& box);
  double mean_half_edge() const;
  void note_spread(const std::vector<ContactFacetRecord>& facets);
  using Introductions = std::vector<std::pair<int, int>>;  // owners and holders
  Introductions put(const Model& model, const std::vector<ContactNodeRecord>& slaves,
                    const std::vector<ContactFacetRecord>& facets, Post& post);
  void take(std::vector<ContactNodeRecord>& slaves, std::vector<ContactFacetRecord>& facets, const Post& post);
  void send(const Model& model, std::vector<ContactNodeRecord>& slaves, std::vector<ContactFacetRecord>& facets);
  void connect(const Model& model, bool fresh);
  void measure_speeds(const Model& model);
  void measure_sight(const Model& model);
  Vec3 predicted_v(const Model& model, int node) const;
  Vec3 predicted_x(const Model& model, int node) const;
  double dt_ahead() const;
  void pull(const Model& model);
  void split_masses(const ContactView& view, double quantum);
  void list_active(const ContactView& view);
  void push_velocities(const Model& model);
  void push(Model& model);
  ContactView view() const;

  static constexpr std::int64_t renewals = 5;  // search intervals between two complete searches
  static constexpr double beyond = 1e15;  // what no length of a sound model reaches [m]

  const Contact& law_;
  ContactRequest request_;
  NodeGroup slaves_, masters_;
  std::vector<NodeGroup> mirrored_;  // nodes of each boundary condition, in the order of the input
  std::unique_ptr<SpatialDecomposition> space_;
  std::vector<std::int64_t> n_candidates_;  // per local node that this rank owns, at the last search; or empty
  bool space_built_ = false, valid_ = false;
  double best_unevenness_ = 1.0;  // of the work of ranks with boxes of space that were just made
  std::int64_t last_search_ = 0, last_renewal_ = 0;  // cycles
  ContactFrame common_frame_;  // of the body that has most of the surface
  std::vector<ContactFrame> body_frames_;  // per part; used for the first part of each body
  // Of the last search, by part: frames before those that move like the common one became it, and the square of the
  // difference from the frame's velocity up to which nodes counted [m2/s2].
  std::vector<ContactFrame> mean_frames_;
  std::vector<double> within_;
  Renewed renewed_;
  double facet_spread_ = 0.0;  // of the facets of the last complete search, beyond the boxes of their corners [m]
  std::int64_t n_facets_ = 0;
  double search_time_ = 0.0, horizon_ = 0.0, slack_ = 0.0, slave_reach_ = 0.0;  // [s], [s], [m], [m]
  std::vector<Tracked> tracked_;
  // Of the tracked nodes, seen from the frames of their bodies; apart, because few bodies have one of their own to look
  // at in every cycle.
  std::vector<Box> own_boxes_;
  std::vector<Vec3> home_;  // of the tracked nodes: decides about their rank [m]
  std::vector<Vec3> undeformed_;  // positions of the tracked nodes [m]
  std::vector<Stray> strays_;
  Counts counts_;
  std::vector<std::int32_t> track_of_;  // per local node: where it is in tracked_, or -1
  DistinctLists mirrors_;  // boundary conditions, as places in the input
  std::vector<std::int32_t> on_mirror_;  // per local node: a list of the conditions on whose plane of symmetry it lies
  std::unique_ptr<CandidateSearch> search_;
  const Candidates* found_ = nullptr;  // of search_
  ContactChannel channel_;  // between owners of nodes and ranks that look at them
  std::vector<char> has_facets_;  // per rank: whether this one has sent it facets since the last search
  std::set<std::pair<int, int>> introduced_;  // owners and holders that this rank has made known to each other
  // What has changed since the last step, on the way to other ranks.
  std::vector<ContactNodeRecord> changed_slaves_;
  std::vector<ContactFacetRecord> new_facets_;
  std::vector<std::int64_t> dead_elements_;
  bool reaches_too_far_ = false;
  std::unique_ptr<SparseExchange> outbox_;  // of the records of strays
  Introductions in_outbox_;  // of introduced_, the ones that nobody has heard of before the outbox is sent
  std::set<int> told_, tellers_;  // ranks that have got records from this one since the last search, and the reverse
  const Prediction* prediction_ = nullptr;  // of the step that is being made; null for the model as it stands
  AlignedVector<double> position_, velocity_;  // of the nodes of the view, predicted
  AlignedVector<double> pushed_velocity_;  // of the active nodes of the view, with the contact forces so far
  std::vector<double> mass_;
  std::vector<std::int64_t> force_, friction_, total_force_, share_;  // of the active nodes of the view
  std::vector<std::int32_t> active_;  // nodes of the view that this rank's touches have
  std::vector<char> is_active_;
  ImpactEffort effort_;
  ContactTouches touches_;
  ContactSpeeds speeds_;
  double least_sight_ = 0.0;  // of all facets that the model can have [m]
  ContactLoad load_;
  std::string trouble_;
};

}  // namespace kerf
