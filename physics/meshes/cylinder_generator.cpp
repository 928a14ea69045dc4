// Solid rods along z meshed with hexahedra.
#include "cylinder_generator.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

#include "kerf/functions.hpp"
#include "kerf/meshes/grading.hpp"
#include "kerf/plugin.hpp"

namespace kerf {

namespace {

constexpr double pi = 3.14159265358979323846;

// A tip that is at least this wide (relative to the rod) is meshed by narrowing the section down to it: its
// smallest edge is then no less than about 0.28 of the rod's cells. Below, a cap closes the nose; with the
// default tip its smallest edges are 0.35 to 0.4 of the cells of a rod with five or more cells along a radius.
constexpr double flat_tip_fraction = 0.35;
// The cap starts where the nose has narrowed to this fraction of the rod's radius: early enough to keep its
// cells large, late enough for it to be stubby.
constexpr double cap_fraction = 0.7;
constexpr double default_tip_fraction = 0.1;
// The section is kept in memory, one line of numbers per layer too.
constexpr int most_cells_along_radius = 2000, most_layers = 10'000'000;

}  // namespace

void NoseInput::describe(Schema<NoseInput>& s) {
  s.choice(&NoseInput::type, "type", {"flat", "conical", "ogival", "hemispherical"}, "shape of the nose")
      .by_default("flat");
  s.real(&NoseInput::length, "length", "m", positive, "height of a conical nose from its base to its flat tip")
      .optional();
  s.real(&NoseInput::caliber_radius_head, "caliber_radius_head", "-", Range{0.5, 100.0, false, false},
         "radius of an ogive's arc over the rod's diameter")
      .optional();
  s.real(&NoseInput::tip_radius_fraction, "tip_radius_fraction", "-", between(0.0, 0.95),
         "radius of the flat tip of a conical or ogival nose over the rod's radius; by default 0.1. From 0.35 on the "
         "section is narrowed down to the tip, below the tip is covered by a cap that keeps cells large")
      .optional();
  s.rule("type", "a conical nose takes a length, and no other nose does",
         [](const NoseInput& n) { return (n.type == "conical") == (n.length > 0.0); });
  s.rule("type", "an ogival nose takes a caliber_radius_head, and no other nose does",
         [](const NoseInput& n) { return (n.type == "ogival") == (n.caliber_radius_head > 0.0); });
  s.rule("tip_radius_fraction", "only conical and ogival noses take a tip_radius_fraction",
         [](const NoseInput& n) { return n.tip_radius_fraction < 0.0 || n.type == "conical" || n.type == "ogival"; });
}

void CylinderGenerator::describe(Schema<CylinderGenerator>& s) {
  using C = CylinderGenerator;
  s.real(&C::radius, "radius", "m", positive, "radius of the rod");
  s.real(&C::length, "length", "m", positive, "length of the rod, nose included; its base is at the origin");
  s.real(&C::cell_size, "cell_size", "m", positive, "cell size aimed at in the section and along the rod").optional();
  s.integer(&C::core_cells, "core_cells", between(1, 1000), "cells from the axis to the side of the section's core")
      .optional();
  s.integer(&C::ring_cells, "ring_cells", between(1, 1000), "cells from the core to the rim").optional();
  s.integer(&C::axial_cells, "axial_cells", between(1, most_layers),
            "layers along the rod (with a nose: along a flat rod of this length)")
      .optional();
  s.real(&C::axial_ratio, "axial_ratio", "-", positive,
         "size of the last layer over that of the first; with a nose, of the cylindrical stretch")
      .by_default("1.0");
  s.boolean(&C::exact_section, "exact_section",
            "whether the nodes are moved outwards a little so that the polygonal section has the circle's area")
      .by_default("false");
  s.choice(&C::sector, "sector", {"full", "half", "quarter"},
           "part of the rod that is meshed: all, y >= 0, or x >= 0 and y >= 0")
      .by_default("full");
  s.block(&C::nose, "nose", "shape of the end at z = length").by_default("{}");
  s.rule("cell_size", "give either a cell_size or all of core_cells, ring_cells and axial_cells", [](const C& c) {
    const int given = (c.core_cells > 0) + (c.ring_cells > 0) + (c.axial_cells > 0);
    return c.cell_size > 0.0 ? given == 0 : given == 3;
  });
}

std::vector<std::string> CylinderGenerator::check() const {
  std::vector<std::string> errors;
  if (cell_size > radius)
    errors.push_back(fmt::format(
        "cell_size ({:g} m) is larger than the radius ({:g} m); use at most half of the radius", cell_size, radius));
  if (cell_size > 0.0 && radius / cell_size > most_cells_along_radius)
    errors.push_back(
        fmt::format("cell_size ({:g} m) makes {:.3g} cells along the radius ({:g} m); at most {} are possible",
                    cell_size, radius / cell_size, radius, most_cells_along_radius));
  if (cell_size > 0.0 && length / cell_size > most_layers)
    errors.push_back(
        fmt::format("cell_size ({:g} m) makes {:.3g} layers along the rod ({:g} m); at most {} are possible", cell_size,
                    length / cell_size, length, most_layers));
  if (cell_size > length)
    errors.push_back(fmt::format("cell_size ({:g} m) is larger than the length ({:g} m)", cell_size, length));
  const double nose_length = make_profile().length();
  if (nose_length > length * (1.0 + 1e-9))
    errors.push_back(fmt::format("the nose ({:g} m) is longer than the rod ({:g} m)", nose_length, length));
  if (nose.type == "conical" && nose.length < 0.3 * radius)
    errors.push_back(
        fmt::format("a conical nose of {:g} m on a radius of {:g} m is too flat to be meshed; the least "
                    "length is 0.3 times the radius",
                    nose.length, radius));
  return errors;
}

NoseProfile CylinderGenerator::make_profile() const {
  const double tip = nose.tip_radius_fraction < 0.0 ? default_tip_fraction : nose.tip_radius_fraction;
  if (nose.type == "conical") return NoseProfile::conical(radius, nose.length, tip * radius);
  if (nose.type == "ogival") return NoseProfile::ogival(radius, nose.caliber_radius_head, tip * radius);
  if (nose.type == "hemispherical") return NoseProfile::ogival(radius, 0.5, 0.0);
  return NoseProfile::flat(radius);
}

std::vector<std::string> CylinderGenerator::prepare() {
  if (auto errors = check(); !errors.empty()) return errors;
  profile_ = make_profile();
  nose_base_ = std::max(0.0, length - profile_.length());

  int n_core = static_cast<int>(core_cells), n_ring = static_cast<int>(ring_cells);
  double nominal = axial_cells > 0 ? length / static_cast<double>(axial_cells) : cell_size;
  if (cell_size > 0.0) {
    // About 0.7 of the cells along a radius belong to the core: then cells at the rim are as wide as at the axis.
    n_core = static_cast<int>(cells_along(0.7 * radius, cell_size));
    n_ring = std::max(1, static_cast<int>(cells_along(radius, cell_size)) - n_core);
  }
  section_ = ButterflySection(sector, n_core, n_ring);
  const double segment = 2.0 * pi / (8.0 * n_core);
  stretch_ = exact_section ? std::sqrt(segment / kerf::sin(segment)) : 1.0;
  inside_index_.assign(static_cast<std::size_t>(section_.n_core_nodes()), -1);
  inside_core_.clear();
  for (int s = 0; s < section_.n_core_nodes(); ++s)
    if (!section_.on_core_boundary(s)) {
      inside_index_[static_cast<std::size_t>(s)] = static_cast<int>(inside_core_.size());
      inside_core_.push_back(s);
    }
  lay_planes(nominal);
  return {};
}

// The flat layers: the cylindrical stretch, then the nose up to its flat tip or to where its cap starts.
void CylinderGenerator::lay_planes(double nominal) {
  planes_.assign(1, {0.0, radius});
  if (nose_base_ > 1e-9 * length) {
    const auto z = graded_lines(0.0, nose_base_, cells_along(nose_base_, nominal), axial_ratio);
    for (std::size_t i = 1; i < z.size(); ++i) planes_.push_back({z[i], radius});
    nominal = z.back() - z[z.size() - 2];
  }
  if (profile_.length() <= 0.0) {
    n_layers_ = static_cast<std::int64_t>(planes_.size());
    return;
  }
  const bool flat_tip = profile_.tip_radius() >= flat_tip_fraction * radius;
  const bool blunt = profile_.length() <= radius * (1.0 + 1e-9);  // the whole nose is a cap
  const double end_fraction = flat_tip ? profile_.tip_radius() / radius : blunt ? 1.0 : cap_fraction;
  const double top = flat_tip ? profile_.length() : profile_.height_at(end_fraction * radius);
  if (top > 1e-9 * length) {
    // Layers get thinner as cells get narrower, by the square root so that neither edge becomes very short.
    const double ratio = std::sqrt(end_fraction);
    const auto heights = graded_lines(0.0, top, cells_along(top, 0.5 * nominal * (1.0 + ratio)), ratio);
    for (std::size_t i = 1; i < heights.size(); ++i)
      planes_.push_back({nose_base_ + heights[i], profile_.radius_at(heights[i])});
    planes_.back() = {flat_tip ? length : nose_base_ + top, end_fraction * radius};
  }
  n_layers_ = static_cast<std::int64_t>(planes_.size());
  if (!flat_tip) {
    cap_arc_ = profile_.arc_to(top);
    lay_cap();
  }
}

// Layers of the cap's lower half, up to the edge where its sides meet its cover half-way along the meridian:
// as many as make its cells as high as they are wide.
void CylinderGenerator::lay_cap() {
  const double width = 0.25 * pi * planes_.back().radius / section_.n_core();
  n_layers_ += cells_along(0.5 * (profile_.arc_length() - cap_arc_), width);
}

CylinderGenerator::Place CylinderGenerator::place(std::int64_t i) const {
  const std::int64_t in_layers = n_layers_ * section_.n_nodes();
  if (i < in_layers) return {i / section_.n_nodes(), section_.name(static_cast<int>(i % section_.n_nodes()))};
  const std::int64_t extra = i - in_layers, n_inside = static_cast<std::int64_t>(inside_core_.size());
  ButterflySection::Node name = section_.name(inside_core_[static_cast<std::size_t>(extra % n_inside)]);
  name.k = static_cast<int>(extra / n_inside) + 1;
  return {n_layers_ - 1, name};
}

Vec3 CylinderGenerator::node(std::int64_t i) const {
  const auto n_planes = static_cast<std::int64_t>(planes_.size());
  if (i < n_planes * section_.n_nodes()) {
    const Plane& plane = planes_[static_cast<std::size_t>(i / section_.n_nodes())];
    const int s = static_cast<int>(i % section_.n_nodes());
    const double r = plane.radius * stretch_;
    return {r * section_.x(s), r * section_.y(s), plane.z};
  }
  const Place p = place(i);
  const double height = static_cast<double>(p.layer - n_planes + 1) / static_cast<double>(n_layers_ - n_planes);
  return cap_point(p.name, height);
}

Vec3 CylinderGenerator::cap_point(const ButterflySection::Node& name, double height) const {
  const Vec3 inner = onto_cap(section_.reference_core(name.i, name.j, height));
  if (name.k == 0) return inner;
  const Vec3 outer = onto_cap(section_.reference_rim(name.i, name.j, height));
  const double t = static_cast<double>(name.k) / section_.n_ring();
  return inner * (1.0 - t) + outer * t;
}

// From the upper half of the unit ball to the cap: rays from the centre keep their azimuth and are scaled to
// reach the surface; equal angles on the ball are equal lengths of the meridian.
Vec3 CylinderGenerator::onto_cap(Vec3 p) const {
  const double across = kerf::hypot(p.x, p.y), distance = kerf::hypot(across, p.z);
  const double base_z = planes_.back().z;
  if (distance == 0.0) return {0.0, 0.0, base_z};
  const double t = kerf::atan2(p.z, across) * (2.0 / pi);
  const auto surface = profile_.at_arc(cap_arc_ + (profile_.arc_length() - cap_arc_) * t);
  const double z = base_z + distance * (nose_base_ + surface.height - base_z);
  if (across == 0.0) return {0.0, 0.0, z};
  const double scale = stretch_ * distance * surface.radius / across;
  return {scale * p.x, scale * p.y, z};
}

// Node above a core node, k cells into the cover of the cap.
std::int64_t CylinderGenerator::cover_node(int section_node, int k) const {
  const std::int64_t top_layer = (n_layers_ - 1) * section_.n_nodes();
  if (k == 0) return top_layer + section_node;
  const int inside = inside_index_[static_cast<std::size_t>(section_node)];
  if (inside >= 0)
    return n_layers_ * section_.n_nodes() + (k - 1) * static_cast<std::int64_t>(inside_core_.size()) + inside;
  const auto& name = section_.name(section_node);
  return top_layer + section_.node_at(name.i, name.j, k);
}

ElementNodeIds CylinderGenerator::element(std::int64_t e) const {
  ElementNodeIds nodes{};
  const std::int64_t in_layers = (n_layers_ - 1) * section_.n_quads();
  if (e < in_layers) {
    const std::int64_t bottom = e / section_.n_quads() * section_.n_nodes();
    const auto& quad = section_.quad(static_cast<int>(e % section_.n_quads()));
    for (std::size_t i = 0; i < 4; ++i) {
      nodes[i] = bottom + quad[i];
      nodes[i + 4] = nodes[i] + section_.n_nodes();
    }
    return nodes;
  }
  const int k = static_cast<int>((e - in_layers) / section_.n_core_quads());
  const auto& quad = section_.quad(static_cast<int>((e - in_layers) % section_.n_core_quads()));
  for (std::size_t i = 0; i < 4; ++i) {
    nodes[i] = cover_node(quad[i], k);
    nodes[i + 4] = cover_node(quad[i], k + 1);
  }
  return nodes;
}

std::vector<std::string> CylinderGenerator::face_names() const {
  std::vector<std::string> names{"z_min", "z_max", "lateral"};
  if (sector != "full") names.push_back("symmetry_y");
  if (sector == "quarter") names.push_back("symmetry_x");
  return names;
}

bool CylinderGenerator::on_face(std::int64_t i, int face) const {
  const Place p = place(i);
  const bool on_rim = p.name.k == section_.n_ring(), on_last_layer = p.layer == n_layers_ - 1;
  switch (face) {
    case 0:
      return p.layer == 0;
    case 1:
      return on_last_layer && (!has_cap() || on_rim);
    case 2:  // the cover's inner surface nodes belong to z_max alone
      return on_rim && i < n_layers_ * section_.n_nodes();
    case 3:
      return p.name.j == 0;
    default:
      return p.name.i == 0;
  }
}

}  // namespace kerf

KERF_REGISTER(KERF_TYPE(kerf::CylinderGenerator, "mesh", "cylinder",
                        "solid rod along z of hexahedra with a flat, conical, ogival or hemispherical nose"))
