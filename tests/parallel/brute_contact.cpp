// Hand-built contact views and tests of points against hexahedra, written for clarity and not for speed.
#include "parallel/brute_contact.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "contact/impacts.hpp"
#include "kerf/shape.hpp"
#include "model/surface.hpp"

namespace kerf::test {

namespace {

double six_volumes(Vec3 a, Vec3 b, Vec3 c, Vec3 d) { return dot(b - a, cross(c - a, d - a)); }

bool in_tetrahedron(Vec3 p, Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  const double whole = six_volumes(a, b, c, d);
  const double sign = whole < 0.0 ? -1.0 : 1.0;
  return sign * whole > 0.0 && sign * six_volumes(p, b, c, d) >= 0.0 && sign * six_volumes(a, p, c, d) >= 0.0 &&
         sign * six_volumes(a, b, p, d) >= 0.0 && sign * six_volumes(a, b, c, p) >= 0.0;
}

double distance_to_segment(Vec3 p, Vec3 a, Vec3 b) {
  const Vec3 along = b - a;
  const double length = dot(along, along);
  const double t = length > 0.0 ? std::clamp(dot(p - a, along) / length, 0.0, 1.0) : 0.0;
  return norm(p - a - along * t);
}

double distance_to_triangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 n = cross(b - a, c - a);
  const bool above =
      dot(cross(b - a, p - a), n) >= 0.0 && dot(cross(c - b, p - b), n) >= 0.0 && dot(cross(a - c, p - c), n) >= 0.0;
  if (above && norm(n) > 0.0) return std::fabs(dot(p - a, n)) / norm(n);
  return std::min({distance_to_segment(p, a, b), distance_to_segment(p, b, c), distance_to_segment(p, c, a)});
}

}  // namespace

BruteContact::Hexahedron::Hexahedron(const GlobalModel& global, const GlobalElement& e) {
  low = {1e300, 1e300, 1e300};
  high = low * -1.0;
  for (int k = 0; k < 8; ++k) {
    x[k] = global.x(e.nodes[k]);
    centre = centre + x[k] * 0.125;
    for (int d = 0; d < 3; ++d) {
      low[d] = std::min(low[d], x[k][d]);
      high[d] = std::max(high[d], x[k][d]);
    }
  }
}

/// Whether one of 24 tetrahedra holds the point: each face is four triangles round its centre.
bool BruteContact::Hexahedron::holds(Vec3 p) const {
  for (int d = 0; d < 3; ++d)
    if (p[d] < low[d] || p[d] > high[d]) return false;
  for (const auto& face : hexahedron.face) {
    const Vec3 middle = (x[face[0]] + x[face[1]] + x[face[2]] + x[face[3]]) * 0.25;
    for (int k = 0; k < 4; ++k)
      if (in_tetrahedron(p, x[face[k]], x[face[(k + 1) % 4]], middle, centre)) return true;
  }
  return false;
}

BruteContact::BruteContact(const GlobalModel& global, const std::vector<PartModel>& parts, const Contact& law)
    : global_(global), parts_(parts), law_(law), request_(law.request()) {
  list_nodes();
  list_facets();
  list_pairs();
}

unsigned BruteContact::role(int part, const std::vector<std::string>& names) const {
  return names.empty() || std::find(names.begin(), names.end(), parts_[part].input->name) != names.end() ? 1u : 0u;
}

void BruteContact::list_nodes() {
  for (const NodeRecord& n : global_.nodes) {
    number_[n.id] = static_cast<std::int32_t>(node_id_.size());
    node_id_.push_back(n.id);
    node_body_.push_back(n.part);
    mass_.push_back(n.mass);
    for (int d = 0; d < 4; ++d) {
      position_.push_back(d < 3 ? n.position[d] : 0.0);
      velocity_.push_back(d < 3 ? n.velocity[d] : 0.0);
    }
  }
}

Vec3 BruteContact::undeformed(std::int64_t node) const {
  const auto part = std::find_if(parts_.begin(), parts_.end(), [&](const PartModel& p) {
    return node >= p.first_node && node < p.first_node + p.n_nodes;
  });
  return part->placement->apply(part->input->mesh->node(node - part->first_node));
}

void BruteContact::list_facets() {
  facets_of_node_.resize(node_id_.size());
  for (const GlobalFacet& f : global_.exterior()) {  // in the order of their ids
    const GlobalElement& e = global_.element(f.element);
    const auto number = static_cast<std::int32_t>(facet_id_.size());
    facet_id_.push_back(f.element * 8 + f.face);
    facet_body_.push_back(e.part);
    bulk_modulus_.push_back(parts_[e.part].bulk_modulus);
    volume_.push_back(e.record[0] / parts_[e.part].material->density);  // the record starts with the mass
    edge_.push_back(0.0);
    for (int k = 0; k < 4; ++k) {
      const Vec3 a = undeformed(e.nodes[hexahedron.face[f.face][k]]),
                 b = undeformed(e.nodes[hexahedron.face[f.face][(k + 1) % 4]]);
      edge_.back() = std::max(edge_.back(), norm(b - a));
    }
    for (int k = 0; k < 4; ++k) {
      facet_nodes_.push_back(number_.at(e.nodes[hexahedron.face[f.face][k]]));
      facet_opposite_.push_back(number_.at(e.nodes[hexahedron.face[hexahedron.opposite_face[f.face]][k]]));
      facets_of_node_[facet_nodes_.back()].push_back(number);
    }
  }
}

void BruteContact::list_pairs() {
  std::vector<unsigned> facet_roles;
  for (const std::int32_t part : facet_body_)
    facet_roles.push_back(role(part, request_.masters) | (request_.symmetric ? role(part, request_.slaves) << 1 : 0u));
  std::vector<std::int32_t> in_ring(node_id_.size(), -1);  // the slave whose ring a node was last found in
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(node_id_.size()); ++n) {
    const NodeRecord& record = global_.nodes[n];
    const bool free = record.free != 0 && record.mass > 0.0 && request_.free_nodes;
    if (facets_of_node_[n].empty() && !free) continue;
    const unsigned roles =
        role(record.part, request_.slaves) | (request_.symmetric ? role(record.part, request_.masters) << 1 : 0u);
    if (roles == 0) continue;
    const auto first = static_cast<std::int32_t>(candidate_.size());
    std::vector<std::int32_t> ring{n};
    for (const std::int32_t f : facets_of_node_[n])
      ring.insert(ring.end(), facet_nodes_.begin() + 4 * f, facet_nodes_.begin() + 4 * f + 4);
    for (const std::int32_t r : ring) in_ring[r] = n;
    for (std::size_t f = 0; f < facet_id_.size(); ++f) {
      if ((facet_roles[f] & roles) == 0) continue;
      if (facet_body_[f] == record.part) {
        if (!request_.same_part) continue;
        bool near = false;
        for (std::size_t k = 4 * f; k < 4 * f + 4; ++k)
          near = near || in_ring[facet_nodes_[k]] == n || in_ring[facet_opposite_[k]] == n;
        if (near) continue;
      }
      candidate_.push_back(static_cast<std::int32_t>(f));
    }
    slave_.push_back(n);
    candidate_rows_.push_back({first, static_cast<std::int32_t>(candidate_.size())});
    const auto first_around = static_cast<std::int32_t>(around_.size());
    around_.insert(around_.end(), facets_of_node_[n].begin(), facets_of_node_[n].end());
    around_rows_.push_back({first_around, static_cast<std::int32_t>(around_.size())});
    ring_.push_back(std::move(ring));
  }
}

ContactView BruteContact::view() const {
  ContactView v;
  v.dt = dt_;
  v.kick_dt = kick_dt_;
  v.n_nodes = static_cast<int>(node_id_.size());
  v.node_id = node_id_.data();
  v.position = position_.data();
  v.velocity = velocity_.data();
  v.mass = mass_.data();
  v.node_body = node_body_.data();
  v.n_facets = static_cast<int>(facet_id_.size());
  v.facet_id = facet_id_.data();
  v.facet_nodes = facet_nodes_.data();
  v.facet_body = facet_body_.data();
  v.facet_bulk_modulus = bulk_modulus_.data();
  v.facet_volume = volume_.data();
  v.facet_edge = edge_.data();
  v.n_slaves = static_cast<int>(slave_.size());
  v.slave = slave_.data();
  v.candidate_rows = candidate_rows_.data();
  v.candidate = candidate_.data();
  v.around_rows = around_rows_.data();
  v.around = around_.data();
  return v;
}

void BruteContact::predict(const std::map<std::int64_t, std::array<std::int64_t, 3>>& contact, const Quanta& quanta,
                           const Step& next) {
  dt_ = next.dt;
  kick_dt_ = next.kick_dt();
  for (std::size_t n = 0; n < node_id_.size(); ++n) {
    const NodeRecord& r = global_.nodes[n];
    const auto it = contact.find(r.id);
    const double a = (r.mass > 0.0 ? 1.0 / r.mass : 0.0) * (quanta.force.quantum * kick_dt_);
    for (std::size_t d = 0; d < 3; ++d) {
      const std::int64_t force = r.force[d] - (it != contact.end() ? it->second[d] : 0);
      velocity_[4 * n + d] = r.velocity[d] + static_cast<double>(force) * a;
      position_[4 * n + d] = r.position[d] + velocity_[4 * n + d] * dt_;
    }
  }
}

std::map<std::int64_t, std::array<std::int64_t, 3>> BruteContact::forces(const Quanta& quanta,
                                                                         const ImpactPace& pace) const {
  std::vector<std::int64_t> force(4 * node_id_.size(), 0), friction = force,
                                                           shares(MassSplit::width * node_id_.size(), 0);
  ContactForces sink(force.data(), friction.data(), quanta.force);
  const ContactView seen = view();
  ContactTouches touches;
  law_.find_touches(seen, touches);
  const MassSplit split{shares.data(), quanta.mass};
  add_shares(seen, touches, split);
  std::vector<std::int32_t> all(node_id_.size());
  std::iota(all.begin(), all.end(), 0);
  Impacts impacts(seen, touches, law_.response(), split, all);
  struct OneRank final : ImpactExchange {
    std::function<const double*()> pushed;
    const double* velocities() override { return pushed(); }
    void add_up(std::vector<std::int64_t>&) override {}
  } exchange;
  AlignedVector<double> velocity = velocity_;
  exchange.pushed = [&] {
    for (std::size_t i = 0; i < 4 * mass_.size(); ++i)
      if (i % 4 < 3 && mass_[i / 4] > 0.0)
        velocity[i] = velocity_[i] + static_cast<double>(force[i]) * (quanta.force.quantum * kick_dt_ / mass_[i / 4]);
    return velocity.data();
  };
  impacts.add_to(sink, exchange, pace);
  std::map<std::int64_t, std::array<std::int64_t, 3>> result;
  for (std::size_t n = 0; n < node_id_.size(); ++n)
    if (force[4 * n] != 0 || force[4 * n + 1] != 0 || force[4 * n + 2] != 0)
      result[node_id_[n]] = {force[4 * n], force[4 * n + 1], force[4 * n + 2]};
  return result;
}

bool BruteContact::is_pushed(std::int64_t node) const {
  const auto it = std::find(slave_.begin(), slave_.end(), number_.at(node));
  return it != slave_.end() && row_is_pushed(static_cast<std::size_t>(it - slave_.begin()));
}

bool BruteContact::row_is_pushed(std::size_t row) const {
  ContactTouches touches;
  ContactView one = view();
  one.n_slaves = 1;
  one.slave += row;
  one.candidate_rows += row;
  one.around_rows += row;
  law_.find_touches(one, touches);
  return !touches.touches().empty();
}

double BruteContact::depth_below_surface(Vec3 p, int part) const {
  double least = 1e300, depth = 1e300;
  for (std::size_t f = 0; f < facet_id_.size(); ++f) {
    if (facet_body_[f] != part) continue;
    Vec3 x[4];
    double size = 0.0;
    for (int k = 0; k < 4; ++k) {
      const double* at = &position_[4 * facet_nodes_[4 * f + k]];
      x[k] = {at[0], at[1], at[2]};
    }
    const Vec3 middle = (x[0] + x[1] + x[2] + x[3]) * 0.25;
    double distance = 1e300;
    for (int k = 0; k < 4; ++k) {
      distance = std::min(distance, distance_to_triangle(p, x[k], x[(k + 1) % 4], middle));
      size = std::max(size, norm(x[(k + 1) % 4] - x[k]));
    }
    if (distance >= least) continue;
    least = distance;
    const double area = 0.5 * norm(cross(x[2] - x[0], x[3] - x[1]));
    depth = distance / std::min({volume_[f] / area, size, edge_[f]});
  }
  return depth;
}

std::vector<Intruder> BruteContact::intruders() const {
  std::vector<Hexahedron> hexahedra;
  for (const GlobalElement& e : global_.elements) hexahedra.emplace_back(global_, e);
  std::vector<Intruder> result;
  for (std::size_t row = 0; row < slave_.size(); ++row) {
    const NodeRecord& node = global_.nodes[slave_[row]];
    const Vec3 p{node.position[0], node.position[1], node.position[2]};
    for (std::size_t e = 0; e < hexahedra.size(); ++e) {
      const GlobalElement& element = global_.elements[e];
      if (!hexahedra[e].holds(p)) continue;
      const bool own = element.part == node.part;
      if (own && std::any_of(element.nodes.begin(), element.nodes.end(), [&](std::int64_t id) {
            const auto n = number_.at(id);
            return std::find(ring_[row].begin(), ring_[row].end(), n) != ring_[row].end();
          }))
        continue;
      Intruder i;
      i.node = node.id;
      i.element = element.id;
      i.own_part = own;
      i.free = node.free != 0;
      i.pushed = row_is_pushed(row);
      i.depth = depth_below_surface(p, element.part);
      result.push_back(i);
    }
  }
  return result;
}

}  // namespace kerf::test
