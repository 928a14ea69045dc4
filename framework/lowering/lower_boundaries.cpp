// Boundary conditions of a deck: held nodes, prescribed motions, rigid walls.
#include <fmt/format.h>

#include <algorithm>

#include "lowering/lowering.hpp"
#include "mesh/label_map.hpp"

namespace kerf::lowering {
namespace {

using decks::IdKind;

Node boundary(const char* type, const Origin& where, const std::string& nodes) {
  Node node = map_node(where);
  add(node, "type", scalar(type, where));
  if (!nodes.empty()) add(node, "nodes", scalar(nodes, where));
  return node;
}

Node components(const std::string& letters, const Origin& where) {
  Node list = list_node(where);
  for (const char letter : letters) list.items.push_back(scalar(std::string(1, letter), where));
  return list;
}

void add_fixed(Lowering& low, const std::string& nodes, const std::string& letters, const Origin& where) {
  if (nodes.empty() || letters.empty()) return;
  Node fixed = boundary("fixed", where, nodes);
  add(fixed, "components", components(letters, where));
  low.append("boundaries", std::move(fixed));
}

/// The components that a card holds; none where its include turns them.
std::string held(Lowering& low, const Row& row) {
  std::string letters;
  for (const auto& [field, letter] : {std::pair{"dofx", 'x'}, std::pair{"dofy", 'y'}, std::pair{"dofz", 'z'}})
    if (row.integer(field).value != 0) letters += letter;
  if (letters.empty() || letters == "xyz" || low.keeps_directions(row, "a constraint in one direction")) return letters;
  return {};
}

/// Nodes that several cards name one by one, with the place of the first.
struct Gathered {
  std::vector<std::int32_t> nodes;
  Origin origin;
};

void gather(Gathered& group, std::int32_t node, const Origin& where) {
  if (node < 0) return;
  if (group.nodes.empty()) group.origin = where;
  group.nodes.push_back(node);
}

void held_nodes(Lowering& low) {
  for (const Row& row : low.rows("BOUNDARY_SPC_SET"))
    if (const std::string letters = held(low, row); !letters.empty())
      add_fixed(low, low.node_set(row.id("nsid", IdKind::set).value, row.origin("nsid")), letters, row.origin("nsid"));
  const std::vector<Row> single = low.rows("BOUNDARY_SPC_NODE");
  std::map<std::string, Gathered> groups;
  if (!single.empty()) {
    const LabelMap index(low.mesh.mesh.node_labels);
    for (const Row& row : single)
      if (const std::string letters = held(low, row); !letters.empty())
        gather(groups[letters], index.find(row.id("nid", IdKind::node).value), row.origin("nid"));
  }
  for (auto& [letters, group] : groups)
    if (!group.nodes.empty())
      add_fixed(low, low.nodes("held_" + letters, std::move(group.nodes), group.origin), letters, group.origin);
}

/// What the code TC of *NODE holds.
void node_codes(Lowering& low) {
  static const char* const letters[] = {"", "x", "y", "z", "xy", "yz", "xz", "xyz"};
  std::map<std::int8_t, std::vector<std::int32_t>> groups;
  for (const decks::NodeCode& code : low.mesh.codes)
    if (code.tc > 0 && code.tc <= 7) groups[code.tc].push_back(code.node);
  const std::vector<const decks::Block*> blocks = low.blocks("NODE");
  for (const decks::Block* block : blocks)
    if (!groups.empty() && low.is_turned(*block))
      low.refuse(low.deck.origin(low.deck.place_of(*block)),
                 "nodes of an include that is turned have constraint codes, which are not turned with it; write them "
                 "into the main deck");
  for (auto& [code, members] : groups) {
    const Origin where = low.deck.origin(low.deck.place_of(*blocks.front()));
    const std::string held = letters[static_cast<std::size_t>(code)];
    add_fixed(low, low.nodes(fmt::format("code_{}_{}", code, held), std::move(members), where), held, where);
  }
}

void add_motion(Lowering& low, const Row& row, const std::string& nodes) {
  const Origin where = row.origin("dof");
  const std::int64_t dof = row.integer("dof").value, vad = row.integer("vad").value;
  if (dof < 1 || dof > 3 || (vad != 0 && vad != 2) || nodes.empty()) return;  // refused by its field
  if (!low.keeps_directions(row, "a motion")) return;
  Node motion = boundary("prescribed_motion", where, nodes);
  add(motion, "components", components(std::string(1, "xyz"[dof - 1]), where));
  const Dimension dimension = vad == 0 ? velocity : length;
  std::vector<double> values(3, 0.0);
  values[static_cast<std::size_t>(dof - 1)] = row.value("sf", dimension);
  add(motion, vad == 0 ? "velocity" : "displacement", scalar(low.texts(values, dimension), row.origin("sf")));
  const std::string curve = low.curve(row.id("lcid", IdKind::function).value, row.origin("lcid"));
  if (!curve.empty()) add(motion, "curve", scalar(curve, row.origin("lcid")));
  if (row.value("birth", time) > 0.0) add(motion, "birth", row.quantity("birth", time));
  if (row.value("death", time) > 0.0 && row.value("death", time) < 1e19)
    add(motion, "death", row.quantity("death", time));
  low.append("boundaries", std::move(motion));
}

void motions(Lowering& low) {
  for (const Row& row : low.rows("BOUNDARY_PRESCRIBED_MOTION_SET"))
    add_motion(low, row, low.node_set(row.id("nsid", IdKind::set).value, row.origin("nsid")));
  const std::vector<Row> single = low.rows("BOUNDARY_PRESCRIBED_MOTION_NODE");
  if (single.empty()) return;
  const LabelMap index(low.mesh.mesh.node_labels);
  for (const Row& row : single) {
    const std::int64_t id = row.id("nid", IdKind::node).value;
    if (const std::int32_t node = index.find(id); node >= 0)
      add_motion(low, row, low.nodes(fmt::format("node_{}", id), {node}, row.origin("nid")));
  }
}

/// The nodes that a wall is for; empty for all.
std::string nodes_of_wall(Lowering& low, const Row& row) {
  const std::int64_t id = row.id("nsid", IdKind::set).value, exempt = row.id("nsidex", IdKind::set).value;
  if (exempt == 0) return id == 0 ? std::string() : low.node_set(id, row.origin("nsid"));
  const std::vector<std::int32_t>*from = low.nodes_of_set(id), *without = low.nodes_of_set(exempt);
  std::vector<std::int32_t> all(low.mesh.mesh.points.size()), kept;
  for (std::size_t k = 0; k < all.size(); ++k) all[k] = static_cast<std::int32_t>(k);
  if (id != 0 && from) all = *from;
  for (const std::int32_t node : all)
    if (!without || !std::binary_search(without->begin(), without->end(), node)) kept.push_back(node);
  return low.nodes(fmt::format("wall_without_{}", exempt), std::move(kept), row.origin("nsidex"));
}

void walls(Lowering& low) {
  for (const decks::Block* block : low.blocks("RIGIDWALL_PLANAR")) {
    const Row row = low.row(*block);
    const Origin where = row.origin("xt");
    if (!low.stands_still(row, "a wall")) continue;
    Node wall = boundary("rigid_wall", row.origin(), nodes_of_wall(low, row));
    add(wall, "point", row.vector({"xt", "yt", "zt"}, length));
    std::vector<double> normal;
    for (const auto& [head, tail] : {std::pair{"xh", "xt"}, std::pair{"yh", "yt"}, std::pair{"zh", "zt"}})
      normal.push_back(row.value(head, length) - row.value(tail, length));
    add(wall, "normal", scalar(low.texts(normal, number), row.origin("xh")));
    const double friction = row.value("fric");
    if (friction < 0.0 || friction > 1.0)
      low.refuse(row.origin("fric"), fmt::format("*RIGIDWALL_PLANAR FRIC = {}: nodes that stick or weld are not taken; "
                                                 "expected 0 to 1",
                                                 friction));
    if (friction == 1.0)
      low.differ(row.origin("fric"),
                 "*RIGIDWALL_PLANAR FRIC = 1 means that nothing slides; Kerf takes a coefficient "
                 "of friction of 1");
    if (friction > 0.0) add(wall, "friction", row.quantity("fric"));
    low.append("boundaries", std::move(wall));
  }
}

}  // namespace

void lower_boundaries(Lowering& low) {
  held_nodes(low);
  node_codes(low);
  motions(low);
  walls(low);
}

}  // namespace kerf::lowering
