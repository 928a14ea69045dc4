// One function for each kind of warning.
#include "review/model_warnings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "kerf/law_use.hpp"
#include "kerf/shape.hpp"
#include "mesh/quality.hpp"
#include "model/node_group.hpp"
#include "parallel/communicator.hpp"
#include "review/encounters.hpp"
#include "review/law_warnings.hpp"

namespace kerf {

namespace {

using Lines = std::vector<std::string>;

std::size_t index(int i) { return static_cast<std::size_t>(i); }

const PartInput& input_of(const Model& model, int part) { return *model.parts[index(part)].input; }

/// Whether the input makes one body of two parts.
bool are_joined(const Model& model, int part, int other) {
  return model.parts[index(part)].body == model.parts[index(other)].body;
}

std::string warning(const std::string& origin, const std::string& text) { return origin + ": warning: " + text; }

void sum_of_all(MPI_Comm comm, std::vector<std::int64_t>& counts) {
  MPI_Allreduce(MPI_IN_PLACE, counts.data(), static_cast<int>(counts.size()), MPI_INT64_T, MPI_SUM, comm);
}

/// Parts that would fly through one another.
void warn_of_missing_contact(const Model& model, const Encounters& encounters, const ContactCover& cover,
                             Lines& lines) {
  const double end = model.input->time.end;
  for (int p = 0; p < static_cast<int>(model.parts.size()); ++p)
    for (int q = p + 1; q < static_cast<int>(model.parts.size()); ++q) {
      const bool known = encounters.parts()[index(p)].spread == 0.0 && encounters.parts()[index(q)].spread == 0.0;
      if (!known || cover.between(p, q) >= 0 || are_joined(model, p, q)) continue;
      const double time = encounters.time_to_meet(p, q);
      if (time > end) continue;
      lines.push_back(warning(
          input_of(model, q).mesh->origin,
          fmt::format("parts {} and {} are on a collision course and meet at about {:.3g} s, but no contact definition "
                      "covers them, so that they will pass through each other; add `contacts: [{{type: "
                      "eroding_surface}}]`, or name both parts in one",
                      input_of(model, p).name, input_of(model, q).name, time)));
    }
}

/// Runs that end before anything happens.
void warn_of_late_contact(const Model& model, const Encounters& encounters, const ContactCover& cover, Lines& lines) {
  const int n = static_cast<int>(model.parts.size());
  const double end = model.input->time.end;
  double first = never;
  std::string who;
  const auto note = [&](double time, const std::string& text) {
    if (time < first) who = text;
    first = std::min(first, time);
  };
  for (int p = 0; p < n; ++p) {
    // What is pressed, driven, held or spinning has something to do without any contact.
    const PartStart& s = encounters.parts()[index(p)];
    if (!s.flies() && !(s.rests() && !s.is_loaded)) return;
    note(encounters.time_to_region(p), fmt::format("of part {} with a wall", input_of(model, p).name));
    for (int q = p + 1; q < n; ++q)
      if (cover.between(p, q) >= 0 && !are_joined(model, p, q) && first > end)
        note(encounters.time_to_meet(p, q),
             fmt::format("of parts {} and {}", input_of(model, p).name, input_of(model, q).name));
  }
  if (first == never || first <= end) return;
  lines.push_back(warning(model.input->end_origin,
                          fmt::format("the first contact, {}, comes at about {:.3g} s, after the end of the run at "
                                      "{:.3g} s; raise time.end, or move the parts together",
                                      who, first, end)));
}

/// Bodies that a wall stops at a good share of their wave speed. The nodes are stopped in the middle of a step, and the
/// step then shrinks while the forces are large, which makes energy; see doc/theory/time_integration.md.
void warn_of_fast_walls(const Model& model, const Encounters& encounters, Lines& lines) {
  constexpr double fast = 0.1, sure_factor = 0.6;
  const TimeInput& time = model.input->time;
  if (time.safety_factor <= sure_factor) return;
  for (int p = 0; p < static_cast<int>(model.parts.size()); ++p) {
    const PartModel& part = model.parts[index(p)];
    const PartStart& s = encounters.parts()[index(p)];
    const double arrival = encounters.time_to_region(p);
    // What starts on the wall is stopped in a short first step.
    if (!s.flies() || !(arrival > 0.0) || arrival > time.end) continue;
    const double wave_speed = std::sqrt((part.bulk_modulus + 4.0 / 3.0 * part.shear_modulus) / part.material->density);
    const double ratio = norm(s.velocity) / wave_speed;
    if (!(ratio > fast)) continue;
    lines.push_back(warning(
        part.input->mesh->origin,
        fmt::format("part {} strikes a wall at {:.2g} of its wave speed, which may raise its energy by 1.5 % at a "
                    "safety_factor of {:g}; set time.safety_factor to {:g}, or let the part start on the wall",
                    part.input->name, ratio, time.safety_factor, sure_factor)));
  }
}

void warn_of_idle_parts(const Model& model, const Encounters& encounters, Lines& lines) {
  for (int p = 0; p < static_cast<int>(model.parts.size()); ++p) {
    const PartStart& s = encounters.parts()[index(p)];
    if (!s.rests() || s.is_held || s.is_loaded || encounters.may_be_touched(p)) continue;
    lines.push_back(
        warning(input_of(model, p).mesh->origin,
                fmt::format("part {} is at rest, no boundary condition holds it, and nothing that moves with the "
                            "velocity of its part will strike it before the end of the run at {:.3g} s; give a part a "
                            "velocity, check the contacts, or leave the part out",
                            input_of(model, p).name, model.input->time.end)));
  }
}

/// Whether neither end of a cell's direction is kept from moving along it. Pre: a face lies opposite.
bool is_free_across(const Model& model, const Encounters& encounters, const PartStore& store, int slot, int face) {
  const Shape& shape = store.shape();
  for (const int side : {face, shape.opposite_face[face]}) {
    std::array<Vec3, 4> x;
    for (std::size_t k = 0; k < 4; ++k) x[k] = model.nodes.x(store.node(slot, shape.face[side][k]));
    const Vec3 area = cross(x[2] - x[0], x[3] - x[1]);
    const Vec3 normal = area * (1.0 / norm(area));
    for (int k = 0; k < 4; ++k)
      if (encounters.holds(store.node(slot, shape.face[side][k]), normal)) return false;
  }
  return true;
}

/// Whether two faces of a cell have a node in common, as opposite ones have where the cell is collapsed.
bool meet(const PartStore& store, int slot, int face, int other) {
  const Shape& shape = store.shape();
  for (const int a : shape.face[face])
    for (const int b : shape.face[other])
      if (store.node(slot, a) == store.node(slot, b)) return true;
  return false;
}

double distance_across(const Model& model, const PartStore& store, int slot, int face) {
  const Shape& shape = store.shape();
  Vec3 sum;
  for (int k = 0; k < 4; ++k)
    sum = sum + model.nodes.x(store.node(slot, shape.face[shape.opposite_face[face]][k])) -
          model.nodes.x(store.node(slot, shape.face[face][k]));
  return 0.25 * norm(sum);
}

/// How many cells of each part have both faces of a pair outside and free, and the greatest thickness of these.
struct SingleLayers {
  std::vector<std::int64_t> n_cells;
  std::vector<double> thickness;  // [m]

  SingleLayers(Model& model, const Encounters& encounters)
      : n_cells(model.parts.size(), 0), thickness(model.parts.size(), 0.0) {
    const std::vector<ExteriorFacet>& facets = model.surface.exterior(model.surface_mesh());
    for (std::size_t i = 0; i < facets.size();) {
      const ExteriorFacet& first = facets[i];
      unsigned faces = 0;
      for (; i < facets.size() && facets[i].part == first.part && facets[i].slot == first.slot; ++i)
        faces |= 1u << facets[i].face;
      const PartStore& store = *model.parts[index(first.part)].store;
      for (int face = 0; face < store.shape().n_faces; ++face) {
        const int opposite = store.shape().opposite_face[face];
        if (opposite < face) continue;  // one of each pair
        const unsigned pair = 1u << face | 1u << opposite;
        if ((faces & pair) != pair || meet(store, first.slot, face, opposite) ||
            !is_free_across(model, encounters, store, first.slot, face))
          continue;
        ++n_cells[index(first.part)];
        double& most = thickness[index(first.part)];
        most = std::max(most, distance_across(model, store, first.slot, face));
        break;
      }
    }
    sum_of_all(model.comm, n_cells);
    MPI_Allreduce(MPI_IN_PLACE, thickness.data(), static_cast<int>(thickness.size()), MPI_DOUBLE, MPI_MAX, model.comm);
  }
};

/// One layer of cells with one point each has no stiffness in bending but that of its hourglass control.
void warn_of_single_layers(Model& model, const Encounters& encounters, Lines& lines) {
  const SingleLayers layers(model, encounters);
  for (int p = 0; p < static_cast<int>(model.parts.size()); ++p) {
    const PartStart& s = encounters.parts()[index(p)];
    const PartModel& part = model.parts[index(p)];
    const bool idle = s.flies() && !encounters.may_be_touched(p);
    // A body as long as it is thick does not bend.
    const bool is_slender = norm(s.high - s.low) >= 4.0 * layers.thickness[index(p)];
    if (idle || !is_slender || 2 * layers.n_cells[index(p)] < part.n_elements) continue;
    lines.push_back(warning(part.input->mesh->origin,
                            fmt::format("part {} has one layer of cells across its thickness of {:.3g} m, and "
                                        "resists bending by its hourglass control only; use three layers or more",
                                        part.input->name, layers.thickness[index(p)])));
  }
}

void warn_of_single_cells(const Model& model, const Encounters& encounters, Lines& lines) {
  std::vector<std::int64_t> n_bound(model.parts.size(), 0);
  for (int i = 0; i < model.nodes.n(); ++i)
    for (const std::int32_t p : model.parts_of(i))
      if (encounters.is_bound(i) || model.parts_of(i).size() > 1) ++n_bound[index(p)];
  sum_of_all(model.comm, n_bound);
  for (int p = 0; p < static_cast<int>(model.parts.size()); ++p)
    if (model.parts[index(p)].n_elements == 1 && n_bound[index(p)] == 0)
      lines.push_back(warning(input_of(model, p).mesh->origin,
                              fmt::format("part {} is a free body of one cell, which has one stress for all of it and "
                                          "can neither bend nor carry a wave; use several cells in each direction",
                                          input_of(model, p).name)));
}

/// Planes of symmetry with a tolerance so large that more than a face of a cell lies on them.
void warn_of_swallowing_planes(const Model& model, Lines& lines) {
  for (const auto& law : model.input->boundaries) {
    const NodeGroup group(model, law->nodes());
    std::vector<char> on_plane(index(model.nodes.n()), 0);
    for (int i = 0; i < model.nodes.n(); ++i)
      on_plane[index(i)] = group.holds(model.nodes, i) && law->mirrors(model.nodes.x(i)) ? 1 : 0;
    std::vector<std::int64_t> n_swallowed(model.parts.size(), 0);
    for (std::size_t p = 0; p < model.parts.size(); ++p) {
      const PartStore& store = *model.parts[p].store;
      for (int s = 0; s < store.n_slots(); ++s) {
        int n = 0;
        for (int k = 0; k < store.n_nodes() && store.live(s); ++k) n += on_plane[index(store.node(s, k))];
        if (n > 4) ++n_swallowed[p];  // more than a face
      }
    }
    sum_of_all(model.comm, n_swallowed);
    for (int p = 0; p < static_cast<int>(model.parts.size()); ++p)
      if (n_swallowed[index(p)] > 0)
        lines.push_back(warning(
            law->origin,
            fmt::format("the tolerance of this plane of symmetry takes in whole cells: {} of the {} of part {}, whose "
                        "faces there are no surface for contact; lower the tolerance, or leave it out",
                        n_swallowed[index(p)], model.parts[index(p)].n_elements, input_of(model, p).name)));
  }
}

/// Planes of symmetry on which nothing lies: a model that was to be cut there is not held.
void warn_of_empty_planes(const Model& model, Lines& lines) {
  for (const auto& law : model.input->boundaries) {
    if (law->type != "symmetry") continue;
    const NodeGroup group(model, law->nodes());
    std::vector<std::int64_t> n_on_plane(1, 0);
    for (int i = 0; i < model.nodes.n(); ++i)
      if (model.nodes.owned[index(i)] != 0 && group.holds(model.nodes, i) && law->mirrors(model.nodes.x(i)))
        ++n_on_plane[0];
    sum_of_all(model.comm, n_on_plane);
    if (n_on_plane[0] == 0)
      lines.push_back(
          warning(law->origin,
                  "no node lies on this plane of symmetry, so that it holds nothing and only turns back what "
                  "reaches it; check its point and normal, give `axis` and `angle` where no short normal "
                  "describes it, or use a rigid_wall if that is meant"));
  }
}

/// Strains are differences of positions: where these are large numbers, their rounding is strain.
void warn_of_distance(const Model& model, const Encounters& encounters, Lines& lines) {
  constexpr double harmless = 1e-6;  // a thousandth of the strain at which soft metals yield
  const double strain = 0x1p-53 * model.scale.farthest / model.scale.shortest_edge;
  if (!(strain > harmless)) return;
  int part = 0;
  double farthest = 0.0;
  for (int p = 0; p < static_cast<int>(model.parts.size()); ++p)
    for (const Vec3 corner : {encounters.parts()[index(p)].low, encounters.parts()[index(p)].high})
      for (int d = 0; d < 3; ++d) {
        if (std::fabs(corner[d]) > farthest) part = p;
        farthest = std::max(farthest, std::fabs(corner[d]));
      }
  lines.push_back(warning(
      input_of(model, part).mesh->origin,
      fmt::format("part {} lies {:.3g} m from the origin, where positions are rounded by up to {:.2g} of the shortest "
                  "edge of the mesh, {:.3g} m, which makes strains of that size; move the model to the origin",
                  input_of(model, part).name, farthest, strain, model.scale.shortest_edge)));
}

/// Moduli that do not belong together, and gases with a strength.
void warn_of_odd_moduli(const Model& model, Lines& lines) {
  for (const PartModel& part : model.parts) {
    const double K = part.bulk_modulus, G = part.shear_modulus;
    const Law& law = part.material->stress_law();
    const auto* holder = dynamic_cast<const EnergyHolder*>(part.material->eos.get());
    if (holder != nullptr && G > 0.0)
      lines.push_back(warning(law.origin, fmt::format("the explosive of part {} keeps its strength when it has burnt, "
                                                      "though its products are a gas; use `strength: {{type: "
                                                      "hydrodynamic}}` unless strength matters before it burns",
                                                      part.input->name)));
    else if (3.0 * K < 2.0 * G)
      lines.push_back(warning(
          law.origin, fmt::format("part {} has a bulk modulus of {:.3g} Pa and a shear modulus of {:.3g} Pa at the "
                                  "start, so that Poisson's ratio is {:.2f}; expected 0 or more: check both and their "
                                  "units",
                                  part.input->name, K, G, (1.5 * K - G) / (3.0 * K + G))));
  }
}

/// Loads without a node or a facet, and loads that are zero at all times.
void warn_of_idle_loads(const Model& model, const std::vector<std::int64_t>& targets, Lines& lines) {
  for (std::size_t k = 0; k < targets.size(); ++k) {
    const Load& load = *model.input->loads[k];
    if (targets[k] == 0)
      lines.push_back(warning(
          load.origin,
          fmt::format(
              "the load {} acts on nothing: no exterior facet has all its corners in what it names; name a part "
              "or a set that holds whole facets of the surface",
              load.type)));
    else if (load.greatest() == 0.0)
      lines.push_back(warning(load.origin, fmt::format("the load {} is zero at all times; check its value and its "
                                                       "curve, or leave it out",
                                                       load.type)));
  }
}

}  // namespace

Lines model_warnings(Model& model, const ContactCover& cover, const std::vector<std::int64_t>& load_targets) {
  Lines lines;
  const Encounters encounters(model, cover);
  warn_of_missing_contact(model, encounters, cover, lines);
  warn_of_late_contact(model, encounters, cover, lines);
  warn_of_fast_walls(model, encounters, lines);
  warn_of_idle_parts(model, encounters, lines);
  warn_of_single_layers(model, encounters, lines);
  warn_of_single_cells(model, encounters, lines);
  warn_of_swallowing_planes(model, lines);
  warn_of_empty_planes(model, lines);
  warn_of_distance(model, encounters, lines);
  warn_of_idle_loads(model, load_targets, lines);
  warn_of_odd_moduli(model, lines);
  for (std::string& line : law_warnings(model)) lines.push_back(std::move(line));
  return lines;
}

}  // namespace kerf
