// Initial velocities of a deck. Where several cards mean one node, the last of them counts.
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "lowering/lowering.hpp"
#include "mesh/label_map.hpp"

namespace kerf::lowering {
namespace {

using decks::Block;
using decks::IdKind;

/// Boundaries and sets are made for a few names, and looked up one by one.
constexpr std::size_t most_velocities = 2000;

/// A velocity that nodes get, and the nodes that no later card takes over.
struct Given {
  std::string keyword;
  Origin origin;
  std::array<double, 3> velocity{}, spin{}, point{};  // in the units of the deck; the spin in rad per time
  std::vector<std::int32_t> nodes;
  std::string name;
};

bool is_zero(const std::array<double, 3>& v) { return v[0] == 0.0 && v[1] == 0.0 && v[2] == 0.0; }

class InitialVelocities {
 public:
  explicit InitialVelocities(Lowering& low) : low_(low), owner_(low.mesh.mesh.points.size(), -1) {}

  void lower() {
    for (const Block& block : low_.deck.blocks()) {
      if (block.base() == "INITIAL_VELOCITY") of_set(low_.row(block));
      if (block.base() == "INITIAL_VELOCITY_GENERATION") generated(low_.row(block));
      if (block.base() == "INITIAL_VELOCITY_NODE") of_nodes(block);
    }
    for (std::size_t node = 0; node < owner_.size(); ++node)
      if (owner_[node] >= 0)
        given_[static_cast<std::size_t>(owner_[node])].nodes.push_back(static_cast<std::int32_t>(node));
    for (Given& given : given_) write(given);
  }

 private:
  /// A velocity that an include would turn is refused.
  std::array<double, 3> moving(const Row& row, const std::array<const char*, 3>& fields) const {
    const std::array<double, 3> v = three(row, fields, velocity);
    if (!is_zero(v)) low_.keeps_directions(row, "a velocity");
    return v;
  }

  std::array<double, 3> three(const Row& row, const std::array<const char*, 3>& fields, Dimension dimension) const {
    return {row.value(fields[0], dimension), row.value(fields[1], dimension), row.value(fields[2], dimension)};
  }

  /// The manual of the format does not say which of two kinds of cards counts.
  void take_over(std::int32_t node, std::size_t card) {
    std::int32_t& owner = owner_[static_cast<std::size_t>(node)];
    if (owner >= 0 && given_[static_cast<std::size_t>(owner)].keyword != given_[card].keyword && !warned_) {
      warned_ = true;
      low_.differ(given_[card].origin,
                  fmt::format("*{} and *{} mean the same node, {}; the one that is written last counts",
                              given_[static_cast<std::size_t>(owner)].keyword, given_[card].keyword,
                              low_.mesh.mesh.node_labels[static_cast<std::size_t>(node)]));
    }
    owner = static_cast<std::int32_t>(card);
  }

  void give(Given given, const std::vector<std::int32_t>& nodes) {
    given_.push_back(std::move(given));
    for (const std::int32_t node : nodes) take_over(node, given_.size() - 1);
  }

  std::vector<std::int32_t> all_nodes() const {
    std::vector<std::int32_t> all(owner_.size());
    for (std::size_t k = 0; k < all.size(); ++k) all[k] = static_cast<std::int32_t>(k);
    return all;
  }

  std::vector<std::int32_t> nodes_of_set(std::int64_t id, const Origin& where) {
    if (id == 0) return all_nodes();
    if (const std::vector<std::int32_t>* nodes = low_.nodes_of_set(id)) return *nodes;
    low_.error(where, fmt::format("node set {} is not defined", id));
    return {};
  }

  void of_set(const Row& row) {
    const std::int64_t id = row.id("nsid", IdKind::set).value, exempt = row.id("nsidex", IdKind::set).value;
    give({row.block().base(),
          row.origin("vx"),
          moving(row, {"vx", "vy", "vz"}),
          {},
          {},
          {},
          fmt::format("moving_{}", id)},
         nodes_of_set(id, row.origin("nsid")));
    if (exempt != 0)
      give({row.block().base(),
            row.origin("vxe"),
            moving(row, {"vxe", "vye", "vze"}),
            {},
            {},
            {},
            fmt::format("exempt_{}", exempt)},
           nodes_of_set(exempt, row.origin("nsidex")));
  }

  void of_nodes(const Block& block) {
    if (!index_) index_.emplace(low_.mesh.mesh.node_labels);
    std::map<std::array<double, 3>, std::size_t> groups;
    for (std::size_t r = 0; r < low_.deck.n_repeats(block); ++r) {
      const Row row = low_.row(block, r);
      const std::int32_t node = index_->find(row.id("nid", IdKind::node).value);
      if (node < 0) continue;  // the check of references has complained
      const std::array<double, 3> v = moving(row, {"vx", "vy", "vz"});
      const auto [group, is_new] = groups.emplace(v, given_.size());
      if (is_new)
        given_.push_back(
            {row.block().base(), row.origin("vx"), v, {}, {}, {}, fmt::format("moving_{}", given_.size() + 1)});
      take_over(node, group->second);
    }
    if (groups.size() > most_velocities)
      low_.refuse(low_.deck.origin(low_.deck.place_of(block)),
                  fmt::format("*{} gives {} different velocities, each of which becomes a boundary; more than {} would "
                              "take too long",
                              block.written, groups.size(), most_velocities));
  }

  std::vector<std::int32_t> nodes_of_generation(const Row& row) {
    const std::int64_t kind = row.integer("styp").value;
    const Origin where = row.origin("id");
    if (row.integer("id").value == 0) return all_nodes();
    if (kind == 3) return nodes_of_set(row.id("id", IdKind::set).value, where);
    if (kind == 2) return low_.nodes_of_part(row.id("id", IdKind::part).value);
    if (kind != 1) {
      low_.refuse(row.origin("styp"), fmt::format("STYP = {}; expected 1, 2 or 3", kind));
      return {};
    }
    const std::int64_t id = row.id("id", IdKind::set).value;
    std::vector<std::int32_t> nodes;
    for (const decks::DeckIdSet& set : low_.mesh.part_sets)
      for (const std::int64_t part : set.id == id ? set.ids : std::vector<std::int64_t>())
        for (const std::int32_t node : low_.nodes_of_part(part)) nodes.push_back(node);
    return nodes;
  }

  void generated(const Row& row) {
    Given given{row.block().base(),
                row.origin("vx"),
                moving(row, {"vx", "vy", "vz"}),
                {},
                {},
                {},
                fmt::format("moving_{}", row.integer("id").value)};
    if (row.value("omega", rate) != 0.0 && !take_spin(row, given)) return;
    const std::vector<std::int32_t> nodes = nodes_of_generation(row);
    if (nodes.empty())
      low_.error(row.origin("id"),
                 "no node gets this velocity; expected a part, or a set of parts or "
                 "nodes, with elements");
    give(std::move(given), nodes);
  }

  bool take_spin(const Row& row, Given& given) {
    if (!low_.stands_still(row, "a spin")) return false;
    given.point = three(row, {"xc", "yc", "zc"}, length);
    const std::array<double, 3> axis = three(row, {"nx", "ny", "nz"}, number);
    if (axis[0] == -999.0) {
      low_.refuse(row.origin("nx"), "NX = -999: an axis through two nodes is not taken; expected its direction");
      return false;
    }
    const double long_as = std::sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    if (!(long_as > 0.0)) {
      low_.error(row.origin("nx"), "a spin OMEGA needs an axis; expected NX, NY, NZ that are not all 0");
      return false;
    }
    for (std::size_t k = 0; k < 3; ++k) given.spin[k] = row.value("omega", rate) * axis[k] / long_as;
    return true;
  }

  /// The name of a part whose nodes these are, all of them; empty where there is none.
  std::string part_of(const std::vector<std::int32_t>& nodes) const {
    for (const auto& [id, name] : low_.part_names)
      if (low_.nodes_of_part(id) == nodes) return name;
    return {};
  }

  void write(Given& given) {
    if (given.nodes.empty() || (is_zero(given.velocity) && is_zero(given.spin))) return;
    const Origin& where = given.origin;
    Node node = map_node(where);
    add(node, "type", scalar("initial_velocity", where));
    std::string name;
    if (given.nodes.size() < owner_.size()) {
      name = part_of(given.nodes);
      if (name.empty()) name = low_.nodes(given.name, given.nodes, where);
      add(node, "nodes", scalar(name, where));
    }
    const auto text = [&](const std::array<double, 3>& v, Dimension d) { return low_.texts({v[0], v[1], v[2]}, d); };
    add(node, "velocity", scalar(text(given.velocity, velocity), where));
    if (!is_zero(given.spin)) {
      const std::string unit = "rad/" + low_.units.text_of(time);
      add(node, "angular_velocity", scalar(text(given.spin, number) + " " + unit, where));
      add(node, "point", scalar(text(given.point, length), where));
    }
    low_.append("boundaries", std::move(node));
  }

  Lowering& low_;
  std::vector<std::int32_t> owner_;  // per node: which of given_, or -1
  std::vector<Given> given_;
  std::optional<LabelMap> index_;  // of nodes
  bool warned_ = false;
};

}  // namespace

void lower_initial(Lowering& low) { InitialVelocities(low).lower(); }

}  // namespace kerf::lowering
