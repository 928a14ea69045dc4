// Free flight: swept boxes where doubt must count as a meeting, rays where a meeting must be sure.
#include "review/encounters.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "model/constraints.hpp"
#include "model/held_energy.hpp"
#include "model/node_group.hpp"
#include "parallel/communicator.hpp"

namespace kerf {

namespace {

constexpr int n_rays = 128;  // along each side of the common shadow

std::size_t index(int i) { return static_cast<std::size_t>(i); }

void greatest_of_all(MPI_Comm comm, std::vector<double>& values) {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_MAX, comm);
}

/// The shadow of bodies on the plane across their flight.
struct Frame {
  Vec3 along, across[2];

  explicit Frame(Vec3 flight) : along(flight * (1.0 / norm(flight))) {
    const Vec3 a = along;
    const Vec3 least = std::fabs(a.x) <= std::fabs(a.y) && std::fabs(a.x) <= std::fabs(a.z) ? Vec3{1.0, 0.0, 0.0}
                       : std::fabs(a.y) <= std::fabs(a.z)                                   ? Vec3{0.0, 1.0, 0.0}
                                                                                            : Vec3{0.0, 0.0, 1.0};
    const Vec3 side = cross(a, least);
    across[0] = side * (1.0 / norm(side));
    across[1] = cross(a, across[0]);
  }
};

/// Parallel rays through the rectangle that the shadows of two parts have in common.
class Rays {
 public:
  Rays(const Model& model, const Frame& frame, int part, int other) : frame_(frame) {
    std::vector<double> limits(8, -never);
    for (int i = 0; i < model.nodes.n(); ++i) {
      for (const std::int32_t p : model.parts_of(i)) {
        if (p != part && p != other) continue;
        const std::size_t first = p == part ? 0 : 4;
        for (std::size_t d = 0; d < 2; ++d) {
          const double s = dot(model.nodes.x(i), frame.across[d]);
          limits[first + 2 * d] = std::max(limits[first + 2 * d], -s);
          limits[first + 2 * d + 1] = std::max(limits[first + 2 * d + 1], s);
        }
      }
    }
    greatest_of_all(model.comm, limits);
    for (std::size_t d = 0; d < 2; ++d) {
      low_[d] = std::max(-limits[2 * d], -limits[4 + 2 * d]);
      step_[d] = (std::min(limits[2 * d + 1], limits[4 + 2 * d + 1]) - low_[d]) / n_rays;
    }
  }
  /// Shadows that have just a line in common pass by one another.
  bool are_there(double tolerance) const { return step_[0] * n_rays > tolerance && step_[1] * n_rays > tolerance; }

  /// Calls `meet(ray, height)` for the rays through a quadrilateral.
  template <class Meet>
  void each_through(const std::array<Vec3, 4>& quad, const Meet& meet) const {
    triangle(quad[0], quad[1], quad[2], meet);
    triangle(quad[0], quad[2], quad[3], meet);
  }

 private:
  int first_ray(double s, std::size_t d) const {
    return static_cast<int>(std::clamp(std::ceil((s - low_[d]) / step_[d] - 0.5), 0.0, 1.0 * n_rays));
  }
  template <class Meet>
  void triangle(Vec3 a, Vec3 b, Vec3 c, const Meet& meet) const {
    const Vec3 p[3] = {a, b, c};
    double s[3][2], h[3];
    for (std::size_t k = 0; k < 3; ++k) {
      h[k] = dot(p[k], frame_.along);
      for (std::size_t d = 0; d < 2; ++d) s[k][d] = dot(p[k], frame_.across[d]);
    }
    const double area = (s[1][0] - s[0][0]) * (s[2][1] - s[0][1]) - (s[2][0] - s[0][0]) * (s[1][1] - s[0][1]);
    if (area == 0.0) return;  // seen from its side
    const auto range = [&](std::size_t d) {
      return std::pair(first_ray(std::min({s[0][d], s[1][d], s[2][d]}), d),
                       first_ray(std::max({s[0][d], s[1][d], s[2][d]}), d));
    };
    const auto [i_first, i_end] = range(0);
    const auto [j_first, j_end] = range(1);
    for (int j = j_first; j < j_end; ++j)
      for (int i = i_first; i < i_end; ++i) {
        const double x = low_[0] + (i + 0.5) * step_[0], y = low_[1] + (j + 0.5) * step_[1];
        const double v = ((x - s[0][0]) * (s[2][1] - s[0][1]) - (s[2][0] - s[0][0]) * (y - s[0][1])) / area;
        const double w = ((s[1][0] - s[0][0]) * (y - s[0][1]) - (x - s[0][0]) * (s[1][1] - s[0][1])) / area;
        if (v >= 0.0 && w >= 0.0 && v + w <= 1.0)
          meet(index(i + n_rays * j), h[0] + v * (h[1] - h[0]) + w * (h[2] - h[0]));
      }
  }

  Frame frame_;
  std::array<double, 2> low_{}, step_{};  // [m]
};

}  // namespace

Encounters::Encounters(Model& model, const ContactCover& cover) : model_(model), end_(model.input->time.end) {
  find_boundaries();
  find_starts();
  find_regions();
  find_touched(cover);
}

void Encounters::find_boundaries() {
  always_.assign(index(model_.nodes.n()), 0);
  const auto& boundaries = model_.input->boundaries;
  std::vector<NodeGroup> groups;
  for (const auto& law : boundaries) groups.emplace_back(model_, law->nodes());
  std::vector<std::int32_t> always;
  for (int i = 0; i < model_.nodes.n(); ++i) {
    always.clear();
    for (std::size_t b = 0; b < boundaries.size(); ++b)
      if (groups[b].holds(model_.nodes, i) && boundaries[b]->ask(model_.nodes.x(i)) == Boundary::Ask::always)
        always.push_back(static_cast<std::int32_t>(b));
    if (!always.empty()) always_[index(i)] = lists_.number(always);
  }
}

bool Encounters::holds(int i, Vec3 direction) const {
  const BoundaryNode node = boundary_node(model_.nodes, i, {});
  // A step too short for a node to get anywhere, and a velocity whose change tells.
  const BoundaryStep step{0.0, 1e-12 * end_};
  for (const std::int32_t b : lists_[always_[index(i)]]) {
    const Boundary& law = *model_.input->boundaries[index(b)];
    const Vec3 change = law.constrain(node, step, direction) - law.constrain(node, step, {});
    if (dot(change, direction) < 0.5) return true;
  }
  return false;
}

namespace {

// Of a part: least and greatest coordinates and velocities, the former with the opposite sign; then the three marks.
constexpr std::size_t n_limits = 15, held = 12, driven = 13, loaded = 14;

}  // namespace

/// Marks what the conditions of a node do to its part.
void Encounters::look_at_conditions(int i, double* of_part) const {
  const NodeStore& nodes = model_.nodes;
  for (const std::int32_t b : lists_[always_[index(i)]]) {
    const Boundary& law = *model_.input->boundaries[index(b)];
    if (law.mirrors(nodes.x(i))) continue;
    of_part[held] = 1.0;
    constexpr int looks = 16;
    for (int k = 0; k <= looks && of_part[driven] < 1.0; ++k) {
      const BoundaryNode node = boundary_node(nodes, i, {});
      const Vec3 moved = law.constrain(node, {end_ * k / looks, 1e-12 * end_}, {});
      if (norm(moved) > 0.0) of_part[driven] = 1.0;
    }
  }
}

void Encounters::find_starts() {
  const std::size_t n = model_.parts.size();
  const NodeStore& nodes = model_.nodes;
  std::vector<NodeGroup> targets;  // of loads
  for (const auto& load : model_.input->loads) targets.emplace_back(model_, load->targets());
  std::vector<double> limits(n_limits * n, -never);
  for (int i = 0; i < nodes.n(); ++i)
    for (const std::int32_t p : model_.parts_of(i)) {
      double* of_part = &limits[n_limits * index(p)];
      for (int d = 0; d < 3; ++d) {
        of_part[d] = std::max(of_part[d], -nodes.x(i)[d]);
        of_part[3 + d] = std::max(of_part[3 + d], nodes.x(i)[d]);
        of_part[6 + d] = std::max(of_part[6 + d], -nodes.v(i)[d]);
        of_part[9 + d] = std::max(of_part[9 + d], nodes.v(i)[d]);
      }
      if (nodes.force[4 * i] != 0 || nodes.force[4 * i + 1] != 0 || nodes.force[4 * i + 2] != 0) of_part[loaded] = 1.0;
      for (const NodeGroup& group : targets)
        if (group.holds(nodes, i)) of_part[loaded] = 1.0;
      look_at_conditions(i, of_part);
    }
  greatest_of_all(model_.comm, limits);
  for (std::size_t p = 0; p < n; ++p) {
    const double* l = &limits[n_limits * p];
    PartStart s;
    s.low = {-l[0], -l[1], -l[2]};
    s.high = {l[3], l[4], l[5]};
    const Vec3 slowest{-l[6], -l[7], -l[8]}, fastest{l[9], l[10], l[11]};
    s.velocity = (slowest + fastest) * 0.5;
    s.spread = norm(fastest - slowest);
    s.is_held = l[held] > 0.0;
    s.is_driven = l[driven] > 0.0;
    s.is_loaded = l[loaded] > 0.0 || acts_by_itself(model_.parts[p]);
    parts_.push_back(s);
  }
  share_starts();
}

/// What holds, drives, loads or turns one part of a body does so to all.
void Encounters::share_starts() {
  for (std::size_t p = 0; p < parts_.size(); ++p)
    for (std::size_t q = 0; q < parts_.size(); ++q) {
      if (p == q || model_.parts[p].body != model_.parts[q].body) continue;
      PartStart& s = parts_[p];
      const PartStart& other = parts_[q];
      s.is_held = s.is_held || other.is_held;
      s.is_driven = s.is_driven || other.is_driven;
      s.is_loaded = s.is_loaded || other.is_loaded;
      s.spread = std::max(s.spread, other.spread);
    }
}

/// By the corner of each part that is nearest to the region, at both ends of the run: walls move at constant velocity.
void Encounters::find_regions() {
  to_region_.assign(parts_.size(), never);
  const auto& boundaries = model_.input->boundaries;
  for (const auto& law : boundaries) {
    const NodeGroup group(model_, law->nodes());
    const HalfSpace at_start = law->region(0.0), at_end = law->region(end_);
    std::vector<double> gap(2 * parts_.size(), -never);  // least ones at the start and at the end, with a minus
    for (int i = 0; i < model_.nodes.n(); ++i) {
      const Vec3 x = model_.nodes.x(i);
      if (!group.holds(model_.nodes, i) || law->ask(x) != Boundary::Ask::near_region || law->mirrors(x)) continue;
      for (const std::int32_t p : model_.parts_of(i)) {
        double* of_part = &gap[2 * index(p)];
        of_part[0] = std::max(of_part[0], at_start.offset - dot(at_start.normal, x));
        of_part[1] = std::max(of_part[1], at_end.offset - dot(at_end.normal, x + model_.nodes.v(i) * end_));
      }
    }
    greatest_of_all(model_.comm, gap);
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      const double first = -gap[2 * p], last = -gap[2 * p + 1];
      if (first == never) continue;
      const double tolerance = model_.scale.tolerance() * norm(at_start.normal);
      if (first <= tolerance && last < first)
        to_region_[p] = 0.0;
      else if (last < first)
        to_region_[p] = std::min(to_region_[p], end_ * first / (first - last));
    }
  }
}

/// Whether the box of one part, moved along the relative flight until the end of the run, meets that of the other.
bool Encounters::boxes_may_meet(int part, int other) const {
  const PartStart &a = parts_[index(part)], &b = parts_[index(other)];
  const Vec3 u = a.velocity - b.velocity;
  double enter = 0.0, leave = end_;
  for (int d = 0; d < 3; ++d) {
    const double tolerance = model_.scale.tolerance();
    const double to_touch = b.low[d] - a.high[d] - tolerance, to_part = b.high[d] - a.low[d] + tolerance;
    if (u[d] == 0.0) {
      if (to_touch > 0.0 || to_part < 0.0) return false;
      continue;
    }
    enter = std::max(enter, std::min(to_touch / u[d], to_part / u[d]));
    leave = std::min(leave, std::max(to_touch / u[d], to_part / u[d]));
  }
  return enter <= leave;
}

/// Bodies that move stir those in their way; what has met something, or spins, or is driven, may go anywhere within
/// twice the greatest speed of all.
void Encounters::find_touched(const ContactCover& cover) {
  const int n = static_cast<int>(parts_.size());
  touched_.assign(parts_.size(), false);
  double fastest = 0.0;
  std::vector<bool> scatters(parts_.size(), false);
  for (int p = 0; p < n; ++p) {
    const PartStart& s = parts_[index(p)];
    fastest = std::max(fastest, norm(s.velocity) + s.spread);
    const PartModel& part = model_.parts[index(p)];
    if (s.is_loaded || s.is_driven)
      fastest =
          std::max(fastest, std::sqrt((part.bulk_modulus + 4.0 / 3.0 * part.shear_modulus) / part.material->density));
    touched_[index(p)] = time_to_region(p) <= end_;
    scatters[index(p)] = touched_[index(p)] || s.spread > 0.0 || s.is_loaded || s.is_driven;
  }
  const auto within_reach = [&](const PartStart& a, const PartStart& b) {
    for (int d = 0; d < 3; ++d)
      if (a.low[d] - 2.0 * fastest * end_ > b.high[d] || a.high[d] + 2.0 * fastest * end_ < b.low[d]) return false;
    return true;
  };
  for (bool changed = true; changed;) {
    changed = false;
    for (int p = 0; p < n; ++p)
      for (int q = 0; q < n; ++q) {
        if (p == q || touched_[index(q)]) continue;
        if (model_.parts[index(p)].body == model_.parts[index(q)].body) {
          if (touched_[index(p)]) touched_[index(q)] = scatters[index(q)] = changed = true;
          continue;
        }
        if (cover.between(p, q) < 0) continue;
        const PartStart &a = parts_[index(p)], &b = parts_[index(q)];
        const bool meets = !(a.rests() && b.rests()) && boxes_may_meet(p, q);
        if (!meets && !(scatters[index(p)] && within_reach(a, b))) continue;
        touched_[index(q)] = scatters[index(q)] = changed = true;
      }
  }
}

double Encounters::time_to_meet(int part, int other) const {
  const PartStart &a = parts_[index(part)], &b = parts_[index(other)];
  const Vec3 u = a.velocity - b.velocity;
  if (norm(u) == 0.0) return never;
  const Frame frame(u);
  const Rays rays(model_, frame, part, other);
  const double tolerance = model_.scale.tolerance();
  if (!rays.are_there(tolerance)) return never;
  // Along each ray: how far the first part reaches, and where the other begins and ends, the former with a minus.
  constexpr std::size_t n = std::size_t{n_rays} * n_rays;
  std::vector<double> limits(2 * n, -never);
  for (const ExteriorFacet& f : model_.surface.exterior(model_.surface_mesh())) {
    if (f.part != part && f.part != other) continue;
    std::array<Vec3, 4> quad;
    for (std::size_t k = 0; k < 4; ++k) quad[k] = model_.nodes.x(f.nodes[k]);
    rays.each_through(quad, [&](std::size_t ray, double height) {
      double& limit = limits[f.part == part ? ray : n + ray];
      limit = std::max(limit, f.part == part ? height : -height);
    });
  }
  greatest_of_all(model_.comm, limits);
  double gap = never;
  for (std::size_t ray = 0; ray < n; ++ray) {
    if (limits[ray] == -never || limits[n + ray] == -never) continue;
    const double between = -limits[n + ray] - limits[ray];
    if (between >= -tolerance) gap = std::min(gap, std::max(between, 0.0));
  }
  return gap / norm(u);
}

}  // namespace kerf
