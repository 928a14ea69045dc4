// Asks the boundary conditions of the input about the nodes of this rank.
#include "model/constraints.hpp"

#include <fmt/format.h>

#include <limits>
#include <utility>

#include "model/names.hpp"
#include "model/node_group.hpp"
#include "parallel/communicator.hpp"

namespace kerf {

namespace {

/// The planes of symmetry that a node has met. Projecting on one plane after another would leave the first unless they
/// are at right angles; projecting along what a normal has beyond the normals before it stays on all of them.
class MirrorPlanes {
 public:
  /// Whether all normals so far are at right angles, up to round-off.
  bool upright() const { return upright_; }
  /// Takes a further normal, of any length.
  void add(Vec3 normal) {
    normal = normal * (1.0 / norm(normal));
    Vec3 beyond = normal;
    for (int k = 0; k < n_; ++k) beyond = beyond - along_[k] * dot(beyond, along_[k]);
    const double size = norm(beyond);
    // Two planes that differ by less than this are one plane.
    constexpr double one_plane = 1e-6;
    for (int k = 0; k < n_; ++k) upright_ = upright_ && std::fabs(dot(normal, along_[k])) < 1e-15;
    if (n_ < 3 && size > one_plane) along_[n_++] = beyond * (1.0 / size);
  }
  /// The part of a velocity along all planes.
  Vec3 slide(Vec3 v) const {
    for (int k = 0; k < n_; ++k) v = v - along_[k] * dot(v, along_[k]);
    return v;
  }

 private:
  Vec3 along_[3];
  int n_ = 0;
  bool upright_ = true;
};

}  // namespace

void Constraints::resolve(const Model& model) {
  constrained_.clear();
  const auto& boundaries = model.input->boundaries;
  std::vector<NodeGroup> groups;
  for (const auto& b : boundaries) groups.emplace_back(model, b->nodes());
  lists_ = {};
  near_.assign(boundaries.empty() ? 0 : static_cast<std::size_t>(model.nodes.n()), 0);
  always_ = near_;
  on_oblique_planes_.assign(near_.size(), 0);
  std::vector<std::int32_t> always, near;
  for (std::size_t i = 0; i < near_.size(); ++i) {
    always.clear();
    near.clear();
    for (std::size_t b = 0; b < boundaries.size(); ++b) {
      const auto node = static_cast<std::int32_t>(i);
      if (!groups[b].holds(model.nodes, node)) continue;
      // By the undeformed position, which does not depend on when the question is asked.
      const Boundary::Ask ask = boundaries[b]->ask(model.nodes.reference_position(node));
      if (ask == Boundary::Ask::always) always.push_back(static_cast<std::int32_t>(b));
      if (ask == Boundary::Ask::near_region) near.push_back(static_cast<std::int32_t>(b));
    }
    if (!near.empty()) near_[i] = lists_.number(near);
    if (always.empty()) continue;
    always_[i] = lists_.number(always);
    MirrorPlanes planes;
    for (const std::int32_t b : always) {
      const auto& boundary = *boundaries[static_cast<std::size_t>(b)];
      if (boundary.mirrors(model.nodes.reference_position(static_cast<std::int32_t>(i))))
        planes.add(boundary.region(0.0).normal);
    }
    if (!planes.upright()) on_oblique_planes_[i] = 1;
    constrained_.push_back(static_cast<std::int32_t>(i));
  }
}

std::vector<HalfSpace> Constraints::regions(const Model& model, const Step& step) {
  std::vector<HalfSpace> all;
  for (const auto& b : model.input->boundaries) all.push_back(b->region(step.end()));
  return all;
}

void Constraints::initialise(Model& model) const {
  const auto& boundaries = model.input->boundaries;
  std::vector<MirrorPlanes> met(static_cast<std::size_t>(model.nodes.n()));
  for (const auto& b : boundaries) {
    const NodeGroup group(model, b->nodes());
    for (int i = 0; i < model.nodes.n(); ++i)
      if (group.holds(model.nodes, i)) {
        const BoundaryNode node = boundary_node(model.nodes, i, model.nodes.v(i));
        model.nodes.set_v(i, b->initial(node, model.nodes.v(i)));
        MirrorPlanes& planes = met[static_cast<std::size_t>(i)];
        if (b->mirrors(model.nodes.reference_position(i))) planes.add(b->region(0.0).normal);
        if (!planes.upright()) model.nodes.set_v(i, planes.slide(model.nodes.v(i)));
      }
  }
}

std::vector<std::string> Constraints::complaints(const Model& model) const {
  std::vector<std::string> lines;
  for (const auto& b : model.input->boundaries) {
    const NodeGroup group(model, b->nodes());
    // Of many nodes, the one with the lowest id speaks.
    std::int64_t n = 0, lowest = std::numeric_limits<std::int64_t>::max();
    std::string text;
    int local = -1;
    for (int i = 0; i < model.nodes.n(); ++i) {
      if (!model.nodes.owned[i] || !group.holds(model.nodes, i)) continue;
      std::string line = b->complaint(boundary_node(model.nodes, i, model.nodes.v(i)));
      if (line.empty()) continue;
      ++n;
      if (model.nodes.id[i] > lowest) continue;
      lowest = model.nodes.id[i];
      text = std::move(line);
      local = i;
    }
    n = sum_of(model.comm, n);
    if (local >= 0) {
      const Vec3 x = model.nodes.x(local);
      text = fmt::format("{} at ({:g}, {:g}, {:g}) m {}", node_name(model, lowest), x.x, x.y, x.z, text);
    }
    if (lowest != -greatest(model.comm, -lowest)) text.clear();
    text = first_text(model.comm, text);
    if (n > 0)
      lines.push_back(fmt::format("{}: error: {}{}", b->origin,
                                  n > 1 ? fmt::format("{} nodes cannot start where they are: ", n) : "", text));
  }
  return lines;
}

Vec3 Constraints::constrain(const Model& model, int i, const Step& step, const std::vector<HalfSpace>& planes,
                            Vec3 old_velocity, Vec3 velocity, Vec3* after_each) const {
  const BoundaryNode node = boundary_node(model.nodes, i, old_velocity);
  const BoundaryStep when{step.start + 0.5 * step.dt, step.dt};
  const auto& boundaries = model.input->boundaries;
  std::size_t n_told = 0;
  const auto tell_up_to = [&](std::size_t place) {
    for (; after_each != nullptr && n_told < place; ++n_told) after_each[n_told] = velocity;
  };
  const std::vector<std::int32_t>&always = lists_[always_[i]], &near = lists_[near_[i]];
  MirrorPlanes mirrors;
  // In the order of the input.
  auto a = always.begin();
  auto n = near.begin();
  while (a != always.end() || n != near.end()) {
    const bool anyway = n == near.end() || (a != always.end() && *a < *n);
    const auto b = static_cast<std::size_t>(anyway ? *a++ : *n++);
    tell_up_to(b);
    if (anyway || dot(planes[b].normal, node.position + velocity * step.dt) < planes[b].offset)
      velocity = boundaries[b]->constrain(node, when, velocity);
    if (anyway && on_oblique_planes_[i] && boundaries[b]->mirrors(model.nodes.reference_position(i))) {
      mirrors.add(planes[b].normal);
      velocity = mirrors.slide(velocity);
    }
  }
  tell_up_to(boundaries.size());
  return velocity;
}

}  // namespace kerf
