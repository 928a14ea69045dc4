// Loads of a deck: pressures on segments, forces on nodes, accelerations of bodies, damping.
#include <fmt/format.h>

#include <algorithm>

#include "lowering/lowering.hpp"
#include "lowering/segments.hpp"
#include "mesh/label_map.hpp"

namespace kerf::lowering {
namespace {

using decks::Block;
using decks::IdKind;

void add_curve(Lowering& low, const Row& row, Node& load) {
  if (row.integer("lcid").value <= 0)
    return low.refuse(row.origin("lcid"), fmt::format("LCID = {}; expected a curve", row.integer("lcid").value));
  const std::string curve = low.curve(row.id("lcid", IdKind::function).value, row.origin("lcid"));
  if (!curve.empty()) add(load, "curve", scalar(curve, row.origin("lcid")));
}

/// Segments that one curve loads with one factor.
struct Pressed {
  std::vector<Segment> segments;
  const Row* row = nullptr;
};

void press(Lowering& low, SegmentSets& sets, const Row& row, const std::vector<Segment>& segments) {
  for (const auto& [facets, sign] : sets.of(segments, row.origin())) {
    const Origin where = row.origin("sf");
    Node load = map_node(where);
    add(load, "type", scalar("pressure", where));
    add(load, "facets", scalar(facets, where));
    add(load, "pressure", row.quantity("sf", pressure, sign));
    add_curve(low, row, load);
    low.append("loads", std::move(load));
  }
}

void pressures(Lowering& low) {
  const std::vector<Row> rows = low.rows("LOAD_SEGMENT"), set_rows = low.rows("LOAD_SEGMENT_SET");
  if (rows.empty() && set_rows.empty()) return;
  SegmentSets sets(low);
  std::map<std::pair<std::int64_t, double>, Pressed> groups;
  for (const Row& row : rows) {
    Pressed& group = groups[{row.id("lcid", IdKind::function).value, row.value("sf", pressure)}];
    if (!group.row) group.row = &row;
    Segment segment = sets.segment({row.id("n1", IdKind::node).value, row.id("n2", IdKind::node).value,
                                    row.id("n3", IdKind::node).value, row.id("n4", IdKind::node).value},
                                   row.origin("n1"));
    // In a mirror, the outside of a face is seen from the other side.
    if (low.deck.transform_of(row.block()).motion.determinant() < 0.0) segment.outward = !segment.outward;
    group.segments.push_back(segment);
  }
  for (const auto& [key, group] : groups) press(low, sets, *group.row, group.segments);
  for (const Row& row : set_rows)
    press(low, sets, row, sets.segments_of(row.id("ssid", IdKind::set).value, row.origin("ssid")));
}

void add_force(Lowering& low, const Row& row, const std::string& nodes) {
  const std::int64_t dof = row.integer("dof").value;
  if (dof < 1 || dof > 3 || nodes.empty()) return;  // refused by its field
  if (!low.keeps_directions(row, "a force")) return;
  const Origin where = row.origin("dof");
  Node load = map_node(where);
  add(load, "type", scalar("nodal_force", where));
  add(load, "nodes", scalar(nodes, where));
  std::vector<double> values(3, 0.0);
  values[static_cast<std::size_t>(dof - 1)] = row.value("sf", force);
  add(load, "force", scalar(low.texts(values, force), row.origin("sf")));
  add_curve(low, row, load);
  low.append("loads", std::move(load));
}

void forces(Lowering& low) {
  for (const Row& row : low.rows("LOAD_NODE_SET"))
    add_force(low, row, low.node_set(row.id("nsid", IdKind::set).value, row.origin("nsid")));
  const std::vector<Row> single = low.rows("LOAD_NODE_POINT");
  if (single.empty()) return;
  const LabelMap index(low.mesh.mesh.node_labels);
  for (const Row& row : single) {
    const std::int64_t id = row.id("nid", IdKind::node).value;
    if (const std::int32_t node = index.find(id); node >= 0)
      add_force(low, row, low.nodes(fmt::format("node_{}", id), {node}, row.origin("nid")));
  }
}

void accelerations(Lowering& low) {
  for (const auto& [keyword, axis] :
       {std::pair{"LOAD_BODY_X", 0}, std::pair{"LOAD_BODY_Y", 1}, std::pair{"LOAD_BODY_Z", 2}})
    for (const Block* block : low.blocks(keyword)) {
      const Row row = low.row(*block);
      const Origin where = row.origin("sf");
      if (!low.keeps_directions(row, "an acceleration")) continue;
      Node load = map_node(where);
      add(load, "type", scalar("gravity", where));
      std::vector<double> values(3, 0.0);
      values[static_cast<std::size_t>(axis)] = -row.value("sf", acceleration);
      add(load, "acceleration", scalar(low.texts(values, acceleration), where));
      add_curve(low, row, load);
      low.append("loads", std::move(load));
    }
}

void damping(Lowering& low) {
  for (const Block* block : low.blocks("DAMPING_GLOBAL")) {
    const Row row = low.row(*block);
    const Origin where = row.origin("valdmp");
    Node load = map_node(where);
    add(load, "type", scalar("mass_damping", where));
    if (row.integer("lcid").value > 0) {
      add(load, "coefficient", scalar(low.text(1.0, rate), where));
      add_curve(low, row, load);
    } else {
      if (row.value("valdmp", rate) == 0.0) continue;
      add(load, "coefficient", row.quantity("valdmp", rate));
    }
    const double x = row.value("stx"), y = row.value("sty"), z = row.value("stz");
    if (x != 0.0 || y != 0.0 || z != 0.0) add(load, "factors", scalar(low.texts({x, y, z}, number), row.origin("stx")));
    low.append("loads", std::move(load));
  }
}

}  // namespace

void lower_loads(Lowering& low) {
  pressures(low);
  forces(low);
  accelerations(low);
  damping(low);
}

}  // namespace kerf::lowering
