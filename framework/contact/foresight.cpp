// Where the nodes of one contact definition may be until its next search, and which have left that.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

#ifdef __SSE__
#include <immintrin.h>
#endif

#include "contact/engine.hpp"

namespace kerf {

namespace {

constexpr double farthest = 31.0;  // how far a search looks ahead at most, in slacks: about the longest edge
constexpr double kept_margin = 0.3;  // of a box that is kept at a renewal, round the way that is foretold, in slacks
constexpr double unsteady = 0.25;  // share of a node's motion within its part that it may change by unforeseen

/// Asks for all three coordinates at once whether a node is in its box.
class FrameOrigin {
 public:
  explicit FrameOrigin(Vec3 origin) : origin_{origin.x, origin.y, origin.z, 0.0} {}
  /// In single precision, which may take a node for inside that is outside by half a unit in the last place. There is
  /// room for that: facets' boxes are rounded outwards by two units or more once they have been inflated by the reach.
  /// It may be `aside` of the given place along each axis.
  bool sees_in(const Box& box, const Quad& x, const Quad& aside) const {
    const Quad seen = x - origin_;
    const Floats lowest = __builtin_convertvector(seen - aside, Floats);
    const Floats highest = __builtin_convertvector(seen + aside, Floats);
    static_assert(sizeof(Box) == 6 * sizeof(float) && offsetof(Box, high) == 3 * sizeof(float));
    Floats low, high;  // the fourth entry of `low` and the first of `high` belong to the other corner
    std::memcpy(&low, &box, sizeof low);
    std::memcpy(&high, reinterpret_cast<const char*>(&box) + 2 * sizeof(float), sizeof high);
    const auto above = lowest >= low, below = highest <= __builtin_shufflevector(high, high, 1, 2, 3, 0);
    return (bits_of(above & below) & 7u) == 7u;
  }

 private:
  typedef float Floats __attribute__((vector_size(16)));
  typedef std::int32_t Answer __attribute__((vector_size(16)));
  static unsigned bits_of(Answer yes) {
#ifdef __SSE__
    return static_cast<unsigned>(_mm_movemask_ps(reinterpret_cast<__m128>(yes)));
#else
    return (yes[0] & 1u) | (yes[1] & 2u) | (yes[2] & 4u);
#endif
  }
  Quad origin_;
};

/// How far nodes may go from a time on.
struct Foresight {
  double since_search, ahead;  // to that time, and from it to the next search [s]
  double farthest_way;  // [m]

  /// The box of a node that is at a position at that time and may change its velocity somewhat, seen from a frame.
  Box whereabouts(Vec3 position, Vec3 velocity, const ContactFrame& frame, double margin) const {
    const Vec3 here = position - frame.at(since_search);
    Vec3 way = (velocity - frame.velocity) * ahead;  // steps may have grown
    // Bounded: one racing node must not make boxes that hold the whole model. It will call for a search sooner.
    const double square = dot(way, way);
    if (square > farthest_way * farthest_way) [[unlikely]]
      way = way * (farthest_way / std::sqrt(square));
    return Box::spanned(here, here + way, margin);
  }
};

}  // namespace

/// The frames that most of the exterior nodes of each body are at rest in: mean position and velocity of those whose
/// velocities differ little. The body with the most nodes, which mostly rests, gives the common frame, also to bodies
/// that move like it. Only the size of the boxes depends on it, and how long they can be kept. Collective.
void ContactEngine::choose_frames(const Model& model, const std::vector<std::int32_t>& surface) {
  constexpr int n_rounds = 4;
  constexpr double floor = 1e-6;  // lower bound of the variance of a mean velocity, over the square of the mean
  constexpr std::size_t n_sums = 8;
  constexpr double unknown = 1e300;  // of bodies without elements
  // The frames of the search before are a good start: then one round is enough.
  const bool first_time = within_.empty();
  if (first_time) {
    body_frames_.assign(model.parts.size(), {});
    within_.assign(model.parts.size(), unknown);
  } else {
    constexpr double wider = 4.0;  // because every round narrows it
    body_frames_ = mean_frames_;
    for (double& w : within_) w = std::min(wider * w, unknown);
  }
  std::vector<double>& within = within_;
  std::size_t largest = 0;
  for (int round = first_time ? 0 : n_rounds - 1; round < n_rounds; ++round) {
    // Of differences from the last mean velocity, their squares, nodes, positions.
    std::vector<double> sums(n_sums * model.parts.size(), 0.0);
    for (const std::int32_t i : surface) {
      if (!model.nodes.owned[i] || model.nodes.free[i]) continue;
      const auto body = static_cast<std::size_t>(model.parts[model.nodes.part[i]].body);
      const Vec3 d = model.nodes.v(i) - body_frames_[body].velocity, x = model.nodes.x(i);
      if (dot(d, d) > within[body]) continue;
      const double terms[n_sums] = {d.x, d.y, d.z, dot(d, d), 1.0, x.x, x.y, x.z};
      for (std::size_t k = 0; k < n_sums; ++k) sums[n_sums * body + k] += terms[k];
    }
    // On rank 0 and back, because all ranks must use the same bits.
    std::vector<double> totals(sums.size());
    const Waiting waiting;
    MPI_Reduce(sums.data(), totals.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, 0, model.comm);
    MPI_Bcast(totals.data(), static_cast<int>(totals.size()), MPI_DOUBLE, 0, model.comm);
    for (std::size_t p = 0; p < model.parts.size(); ++p) {
      const double* total = &totals[n_sums * p];
      if (total[4] > totals[n_sums * largest + 4]) largest = p;
      if (!(total[4] > 0.0)) continue;
      ContactFrame& frame = body_frames_[p];
      const Vec3 shift = Vec3{total[0], total[1], total[2]} * (1.0 / total[4]);
      frame.velocity = frame.velocity + shift;
      frame.origin = Vec3{total[5], total[6], total[7]} * (1.0 / total[4]);
      within[p] = std::max(total[3] / total[4] - dot(shift, shift), floor * dot(frame.velocity, frame.velocity));
    }
  }
  mean_frames_ = body_frames_;
  common_frame_ = body_frames_.empty() ? ContactFrame{} : body_frames_[largest];
  const std::vector<char> has_own = bodies_with_own_frame();
  for (std::size_t p = 0; p < body_frames_.size(); ++p)
    if (!has_own[p] || within[p] == unknown) body_frames_[p] = common_frame_;
}

/// Foresees where a node may be from the present time on until the next search or renewal.
void ContactEngine::foresee(const Model& model, std::size_t tracked, double time, unsigned boxes) {
  Tracked& t = tracked_[tracked];
  const Vec3 v = predicted_v(model, t.node), x = model.nodes.x(t.node);
  const ContactFrame& own = body_frames_[t.body];
  const Foresight from{time - search_time_, std::max(horizon_ - time, dt_ahead()), farthest * slack_};
  const double margin = slack_ + std::min(unsteady * norm(v - own.velocity) * from.ahead, from.farthest_way);
  if ((boxes & in_common_frame) != 0) t.box = from.whereabouts(x, v, common_frame_, margin);
  if ((boxes & in_own_frame) != 0) own_boxes_[tracked] = from.whereabouts(x, v, own, margin);
}

/// Adds a node to the tracked ones. False where it has no role in this contact.
bool ContactEngine::track(const Model& model, int node, double time) {
  if (!slaves_.holds(model.nodes, node) && !masters_.holds(model.nodes, node)) return false;
  Tracked t;
  t.node = node;
  t.body = model.parts[model.nodes.part[node]].body;
  track_of_[node] = static_cast<std::int32_t>(tracked_.size());
  tracked_.push_back(t);
  own_boxes_.emplace_back();
  foresee(model, tracked_.size() - 1, time);
  // A run that has become unstable must come as far as to the check that says so.
  const Box& box = tracked_.back().box;
  const Vec3 centre = common_frame_.origin + Vec3{box.centre(0), box.centre(1), box.centre(2)};
  home_.push_back(norm(centre) < beyond ? centre : Vec3{});
  undeformed_.push_back(model.nodes.reference_position(node));
  return true;
}

/// Per body, whether it moves in another way than the common frame; where it does not, both boxes of its nodes are one.
std::vector<char> ContactEngine::bodies_with_own_frame() const {
  std::vector<char> has_own;
  for (const ContactFrame& f : body_frames_) has_own.push_back(norm(f.velocity - common_frame_.velocity) > 0.0);
  return has_own;
}

/// Lists the nodes that are outside of their boxes or may be at the end of the coming step, however short it is.
void ContactEngine::find_strays(const Model& model, const Step& step) {
  strays_.clear();
  const double since = step.end() - search_time_, then = since + dt_ahead();
  struct Origins {
    FrameOrigin now, then;
    bool see_in(const Box& box, const Prediction::Way& way) const {
      return now.sees_in(box, way.start, Quad{}) && then.sees_in(box, way.end, way.aside);
    }
  };
  std::vector<Origins> own;
  for (const ContactFrame& f : body_frames_) own.push_back({FrameOrigin(f.at(since)), FrameOrigin(f.at(then))});
  const std::vector<char> has_own = bodies_with_own_frame();
  const Origins common{FrameOrigin(common_frame_.at(since)), FrameOrigin(common_frame_.at(then))};
  for (std::size_t k = 0; k < tracked_.size(); ++k) {
    constexpr std::size_t ahead = 16;  // far enough for what is known of a node to arrive
    const Tracked& t = tracked_[k];
    const auto later = static_cast<std::size_t>(tracked_[std::min(k + ahead, tracked_.size() - 1)].node);
    __builtin_prefetch(&model.nodes.position[4 * later]);
    __builtin_prefetch(&model.nodes.velocity[4 * later]);
    __builtin_prefetch(&model.nodes.force[4 * later]);
    const Prediction::Way way = prediction_->way(t.node);
    if (!common.see_in(t.box, way) || (has_own[t.body] && !own[t.body].see_in(own_boxes_[k], way)))
      strays_.push_back({static_cast<std::int32_t>(k), in_common_frame | in_own_frame});
  }
}

/// Adds the nodes to strays_ whose boxes are too small for what their velocities foretell until the horizon.
void ContactEngine::find_outgrown(const Model& model, const Step& step) {
  const std::vector<char> has_own = bodies_with_own_frame();
  const double now = step.end();
  const Foresight from{now - search_time_, std::max(horizon_ - now, 0.0), farthest * slack_};
  for (std::size_t k = 0; k < tracked_.size(); ++k) {
    const Tracked& t = tracked_[k];
    const Vec3 v = predicted_v(model, t.node), x = model.nodes.x(t.node);
    const double margin = kept_margin * slack_;
    unsigned outgrown = 0;
    if (!t.box.contains(from.whereabouts(x, v, common_frame_, margin))) outgrown |= in_common_frame;
    if (!has_own[t.body] && outgrown != 0) outgrown |= in_own_frame;
    if (has_own[t.body] && !own_boxes_[k].contains(from.whereabouts(x, v, body_frames_[t.body], margin)))
      outgrown |= in_own_frame;
    if (outgrown != 0) strays_.push_back({static_cast<std::int32_t>(k), outgrown});
  }
}

/// How long an edge of a facet may become until the next search, wherever its corners go.
double ContactEngine::longest_edge(const std::int32_t* corners) const {
  double longest = 0.0;
  for (int k = 0; k < 4; ++k) {
    const Box& a = own_boxes_[track_of_[corners[k]]];
    const Box& b = own_boxes_[track_of_[corners[(k + 1) % 4]]];
    Vec3 most;
    for (int d = 0; d < 3; ++d)
      most[d] = std::max(static_cast<double>(a.high[d]) - b.low[d], static_cast<double>(b.high[d]) - a.low[d]);
    longest = std::max(longest, dot(most, most));
  }
  return std::sqrt(longest);
}

}  // namespace kerf
