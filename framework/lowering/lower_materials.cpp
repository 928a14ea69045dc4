// Materials of a deck: a law of strength, an equation of state and erosion for each pair that parts name.
#include <fmt/format.h>

#include "lowering/lowering.hpp"
#include "lowering/material_parts.hpp"

namespace kerf::lowering {

using decks::Block;
using decks::DeckPart;
using decks::IdKind;

// ---- what the laws have in common ------------------------------------------------------------------------------

Elastic elastic_constants(Lowering& low, const Row& row) {
  const double e = row.value("e", pressure), nu = row.value("pr");
  if (!(e > 0.0)) low.error(row.origin("e"), fmt::format("E = {}; expected Young's modulus above 0", e));
  if (!(nu > -1.0 && nu < 0.5))
    low.error(row.origin("pr"), fmt::format("PR = {}; expected Poisson's ratio above -1 and below 0.5", nu));
  Elastic elastic{e / (2.0 * (1.0 + nu)), e / (3.0 * (1.0 - 2.0 * nu)), e, row.origin("e")};
  return elastic;
}

Node typed(const char* type, const Origin& where) {
  Node node = map_node(where);
  add(node, "type", scalar(type, where));
  return node;
}

Node logarithmic(Lowering& low, const Elastic& elastic) {
  Node eos = typed("logarithmic", elastic.origin);
  add(eos, "bulk_modulus", scalar(low.text(elastic.bulk, pressure), elastic.origin));
  return eos;
}

Node strength(Lowering& low, const char* type, const Elastic& elastic) {
  Node node = typed(type, elastic.origin);
  add(node, "shear_modulus", scalar(low.text(elastic.shear, pressure), elastic.origin));
  return node;
}

Node plastic_strain_limit(const Row& row, const char* field) {
  Node criterion = typed("plastic_strain", row.origin(field));
  add(criterion, "limit", row.quantity(field));
  return criterion;
}

Node erosion_where(const Row& row, const char* field, const std::string& condition) {
  Node criterion = typed("expression", row.origin(field));
  add(criterion, "expression", scalar(condition, row.origin(field)));
  return criterion;
}

// ---- materials and equations of state of parts -----------------------------------------------------------------

namespace {

class Materials {
 public:
  explicit Materials(Lowering& low) : low_(low) {
    if (const Block* control = low.last("CONTROL_TIMESTEP")) {
      erode_ = low.row(*control).integer("erode").value == 1;
      erode_origin_ = low.row(*control).origin("erode");
    }
  }

  void lower() {
    Entry* parts = low_.root.find("parts");
    Node all = map_node(low_.root.origin);
    for (const DeckPart& part : low_.mesh.parts) {
      Entry* entry = parts ? parts->value.find(low_.part_name(part.id)) : nullptr;
      if (!entry) continue;
      const std::string name = material_of(part, all);
      if (!name.empty()) add(entry->value, "material", scalar(name, low_.deck.origin(part.place)));
    }
    add(low_.root, "materials", std::move(all));
  }

 private:
  std::string material_of(const DeckPart& part, Node& all) {
    const Block* material = low_.defined("MAT_", "mid", part.material, IdKind::material);
    if (!material) return {};  // refused by its keyword
    const Block* eos = part.eos == 0 ? nullptr : low_.defined("EOS_", "eosid", part.eos, IdKind::material);
    const bool burns = material->base() == "MAT_HIGH_EXPLOSIVE_BURN";
    const std::string key = fmt::format("{}:{}:{}", part.material, part.eos, burns ? part.id : 0);
    if (const auto known = names_.find(key); known != names_.end()) return known->second;
    Material made = lowered(*material, eos, part);
    if (made.node.entries.empty()) return {};
    const std::string name = name_of(part, burns);
    names_[key] = name;
    add(all, name, std::move(made.node));
    return name;
  }

  std::string name_of(const DeckPart& part, bool burns) {
    std::string name = fmt::format("mat_{}", part.material);
    if (part.eos != 0 && used_materials_.count(part.material) > 0) name += fmt::format("_eos_{}", part.eos);
    if (burns) name += fmt::format("_part_{}", part.id);
    used_materials_.insert(part.material);
    return free_name(name, used_names_);
  }

  Material lowered(const Block& block, const Block* eos, const DeckPart& part) {
    const Row row = low_.row(block);
    Material made;
    made.node = map_node(row.origin());
    const MaterialLaw* law = law_of(block.base());
    if (!law) return {};  // its keyword is refused
    add(made.node, "density", row.quantity("ro", density));
    made.part = &part;
    made.eos = eos;
    law->lower(low_, row, made);
    if (law->needs_eos && !eos)
      low_.error(low_.deck.origin(part.place), fmt::format("part {} has *{} without an equation of state; expected "
                                                           "EOSID to name one",
                                                           part.id, block.base()));
    if (!law->needs_eos && eos)
      low_.differ(low_.deck.origin(part.place),
                  fmt::format("part {} names an equation of state, which *{} has no use for", part.id, block.base()));
    if (law->needs_eos && eos) add(made.node, "eos", equation_of_state(low_, low_.row(*eos), made));
    add_erosion(made, part.material);
    return made;
  }

  void add_erosion(Material& made, std::int64_t material) {
    Origin origin = made.node.origin;
    std::int64_t count = 1;
    const std::size_t own = made.criteria.size();
    for (const Block* block : low_.blocks("MAT_ADD_EROSION"))
      if (low_.row(*block).id("mid", IdKind::material).value == material) {
        origin = low_.row(*block).origin();
        added_criteria(low_, low_.row(*block), made.criteria);
        count = std::max<std::int64_t>(count, low_.row(*block).integer("ncs").value);
      }
    if (erode_) made.criteria.push_back(typed("inversion", erode_origin_));
    if (made.criteria.empty()) return;
    Node erosion = map_node(origin);
    if (count > 1) {
      if (own > 0 || erode_)
        low_.refuse(origin, fmt::format("NCS = {}: several criteria at once, beside others of which one is enough, "
                                        "cannot be told Kerf",
                                        count));
      add(erosion, "rule", scalar("at_least", origin));
      add(erosion, "count", scalar(std::to_string(count), origin));
    }
    Node criteria = list_node(origin);
    criteria.items = std::move(made.criteria);
    add(erosion, "criteria", std::move(criteria));
    add(made.node, "erosion", std::move(erosion));
  }

  Lowering& low_;
  bool erode_ = false;
  Origin erode_origin_;
  std::map<std::string, std::string> names_;
  std::set<std::int64_t> used_materials_;
  std::set<std::string> used_names_;
};

}  // namespace

void lower_materials(Lowering& low) { Materials(low).lower(); }

}  // namespace kerf::lowering
