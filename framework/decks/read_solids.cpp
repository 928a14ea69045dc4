// Reads *ELEMENT_SOLID: one line, or two lines with up to ten nodes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "decks/mesh_builder.hpp"
#include "kerf/shape.hpp"

namespace kerf::decks {
namespace {

const std::vector<std::string> solid_fields = {"EID", "PID", "N1", "N2", "N3", "N4", "N5", "N6", "N7", "N8"};
const std::vector<std::string> second_fields = {"N1", "N2", "N3", "N4", "N5", "N6", "N7", "N8", "N9", "N10"};

/// Volumes below this share of the cube of the longest edge are rounding.
constexpr double no_volume = 1e-13;

std::vector<std::int32_t> solid_widths(CardFormat format) {
  return std::vector<std::int32_t>(10, format == CardFormat::wide ? 20 : format == CardFormat::i10 ? 10 : 8);
}

}  // namespace

void MeshBuilder::read_solids(const Block& block) {
  BulkCard one(deck_, block, errors_, solid_fields, solid_widths(block.format));
  BulkCard two(deck_, block, errors_, second_fields, solid_widths(block.format));
  const Transform& transform = deck_.transform_of(block);
  for (std::size_t k = 0; k < block.n_cards; ++k) {
    if (is_blank(deck_.cards_of(block)[k].view())) continue;
    if (!one.take(deck_.cards_of(block)[k])) continue;
    const std::int64_t label = one.integer(0), part = one.integer(1);
    const Place place = one.place(), part_place = one.place(1);
    std::array<std::int64_t, 10> ids = {};
    std::array<Place, 10> places = {};
    const bool two_lines = one.is_blank_from(2);
    if (two_lines && k + 1 == block.n_cards) {
      errors_.error(place, "solids", fmt::format("element {} has no nodes; expected a second card with them", label));
      return;
    }
    if (two_lines) ++k;
    if (two_lines && !two.take(deck_.cards_of(block)[k])) continue;
    if (one.bad() || !read_ids(two_lines ? two : one, two_lines ? 0 : 2, transform, label, ids, places)) continue;
    if (label <= 0) {
      errors_.error(place, "solids", fmt::format("an element has the id {}; expected one above zero", label));
      continue;
    }
    add_solid(block, transform.id(label, IdKind::element), transform.id(part, IdKind::part), place, part_place, ids,
              places);
  }
}

/// The nodes as the whole deck calls them. Where the last four are blank, the fourth stands for them.
bool MeshBuilder::read_ids(BulkCard& nodes, std::size_t first, const Transform& transform, std::int64_t label,
                           std::array<std::int64_t, 10>& ids, std::array<Place, 10>& places) {
  const std::size_t n = 10 - first;
  for (std::size_t k = 0; k < n; ++k) {
    ids[k] = nodes.integer(first + k);
    places[k] = nodes.place(first + k);
  }
  if (nodes.bad()) return false;
  if (ids[8] == 0 && ids[9] == 0 && std::all_of(ids.begin() + 4, ids.begin() + 8, [](auto id) { return id == 0; }))
    for (std::size_t k = 4; k < 8; ++k) ids[k] = ids[3];
  const bool ten = ids[8] != 0 || ids[9] != 0;
  for (std::size_t k = 0; k < (ten ? 10u : 8u); ++k) {
    if (ids[k] <= 0) {
      errors_.error(places[k], "solids", fmt::format("element {} has no node N{}", label, k + 1));
      return false;
    }
    ids[k] = transform.id(ids[k], IdKind::node);
  }
  return true;
}

std::int32_t MeshBuilder::part_index(std::int64_t id, std::int64_t label, const Place& place) {
  const auto known = part_of_id_.find(id);
  if (known != part_of_id_.end()) return known->second;
  if (declares_parts_ || id <= 0) {
    errors_.error(place, "parts of solids",
                  fmt::format("element {} belongs to part {}, which is not defined", label, id));
    return -1;
  }
  const auto index = static_cast<std::int32_t>(out_.parts.size());
  DeckPart part;
  part.id = id;
  part.place = place;
  out_.parts.push_back(part);
  part_of_id_[id] = index;
  return index;
}

void MeshBuilder::add_solid(const Block& block, std::int64_t label, std::int64_t part, const Place& place,
                            const Place& part_place, const std::array<std::int64_t, 10>& ids,
                            const std::array<Place, 10>& places) {
  const bool ten = ids[8] != 0;
  std::array<std::int32_t, 10> n = {};
  for (std::size_t k = 0; k < (ten ? 10u : 8u); ++k) {
    n[k] = node_index_->find(ids[k]);
    if (n[k] >= 0) continue;
    return errors_.error(places[k], "nodes of solids",
                         fmt::format("element {} names node {}, which is not defined", label, ids[k]));
  }
  RecognisedSolid solid =
      ten ? RecognisedSolid{true, SolidShape::tet10, {n[0], n[1], n[2], n[2], n[3], n[3], n[3], n[3]}}
          : recognised({n[0], n[1], n[2], n[3], n[4], n[5], n[6], n[7]});
  if (!solid.ok)
    return errors_.error(
        place, "shapes of solids",
        fmt::format("element {} has {} different nodes in an order that is no brick, wedge, pyramid or "
                    "tetrahedron",
                    label, n_distinct(solid.nodes)));
  const bool mirror = deck_.transform_of(block).motion.determinant() < 0.0;
  if (mirror) solid.nodes = mirrored(solid);
  const std::int32_t part_number = part_index(part, label, part_place);
  FileMesh& mesh = out_.mesh;
  const std::size_t cell = mesh.cells.size();
  if (ten) {
    if (mirror) n = {n[1], n[0], n[2], n[3], n[4], n[6], n[5], n[8], n[7], n[9]};
    out_.ten_nodes.push_back({static_cast<std::int32_t>(cell), n});
  }
  mesh.cells.push_back(solid.nodes);
  mesh.cell_labels.push_back(label);
  mesh.cell_places.push_back({place.line, place.column});
  out_.cell_sources.push_back(place.source);
  out_.cell_part.push_back(part_number);
  out_.shapes.push_back(solid.shape);
  check_volume(cell, ids);
}

void MeshBuilder::check_volume(std::size_t cell, const std::array<std::int64_t, 10>& ids) {
  const FileMesh& mesh = out_.mesh;
  CellCorners x;
  for (std::size_t k = 0; k < 8; ++k) {
    const std::array<double, 3>& p = mesh.points[static_cast<std::size_t>(mesh.cells[cell][k])];
    x[k] = {p[0], p[1], p[2]};
  }
  const double volume = volume_by_faces(hexahedron, x);
  double longest = 0.0;  // of the sides of the box round the cell
  for (std::size_t k = 1; k < 8; ++k)
    longest = std::max({longest, std::abs(x[k].x - x[0].x), std::abs(x[k].y - x[0].y), std::abs(x[k].z - x[0].z)});
  const bool none = std::abs(volume) <= no_volume * longest * longest * longest;
  if (volume > 0.0 && !none) return;
  const Place place = out_.place_of_cell(cell);
  const std::int64_t label = mesh.cell_labels[cell];
  const std::int32_t p = out_.cell_part[cell];
  const std::int64_t part = p >= 0 ? out_.parts[static_cast<std::size_t>(p)].id : 0;
  if (none && out_.shapes[cell] == SolidShape::tet4 && n_distinct({mesh.cells[cell]}) == 4)
    return errors_.error(
        place, "volumes",
        fmt::format("a tetrahedron needs four nodes that are not in one plane: element {} has nodes {} "
                    "{} {} {} in one plane, volume zero",
                    label, ids[0], ids[1], ids[2], ids[3]));
  if (none || !(volume < 0.0))
    return errors_.error(place, "volumes", fmt::format("element {} of part {} has no volume", label, part));
  errors_.error(
      place, "volumes",
      fmt::format("element {} of part {} has negative volume ({:.6g}); its lower and upper faces may be exchanged",
                  label, part, volume));
}

void MeshBuilder::check_solids() {
  const std::vector<std::int64_t>& labels = out_.mesh.cell_labels;
  std::vector<std::int32_t> order(labels.size());
  std::iota(order.begin(), order.end(), 0);
  const auto label = [&](std::int32_t k) { return labels[static_cast<std::size_t>(k)]; };
  const auto less = [&](std::int32_t a, std::int32_t b) { return label(a) != label(b) ? label(a) < label(b) : a < b; };
  if (!std::is_sorted(order.begin(), order.end(), less)) std::sort(order.begin(), order.end(), less);
  for (std::size_t k = 1; k < order.size(); ++k) {
    if (label(order[k]) != label(order[k - 1])) continue;
    errors_.error(out_.place_of_cell(static_cast<std::size_t>(order[k])), "elements defined twice",
                  fmt::format("element {} is defined twice; first at {}", label(order[k]),
                              deck_.text_of(out_.place_of_cell(static_cast<std::size_t>(order[k - 1])))));
  }
}

}  // namespace kerf::decks
