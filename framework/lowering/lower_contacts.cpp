// Contacts of a deck.
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "lowering/lowering.hpp"
#include "lowering/segments.hpp"

namespace kerf::lowering {
namespace {

using decks::Block;
using decks::IdKind;

/// Beyond as many pairs of parts, two surfaces become one contact of all of them.
constexpr std::size_t most_pairs = 12;

class Contacts {
 public:
  explicit Contacts(Lowering& low) : low_(low) {}

  void lower() {
    for (const Block& block : low_.deck.blocks())
      if (block.base().rfind("CONTACT_", 0) == 0) lower(block);
    if (const Block* control = low_.last("CONTROL_CONTACT")) keep_free_nodes(low_.row(*control));
    if (!list_.items.empty()) add(low_.root, "contacts", std::move(list_));
  }

 private:
  void keep_free_nodes(const Row& control) {
    if (control.integer("enmass").value == 0) return;
    Node checks = map_node(control.origin("enmass"));
    add(checks, "free_nodes", scalar("keep", control.origin("enmass")));
    add(low_.root, "checks", std::move(checks));
  }

  void lower(const Block& block) {
    const std::string& base = block.base();
    if (base == "CONTACT_INTERIOR")
      return low_.differ(
          low_.deck.origin(low_.deck.place_of(block)),
          "*CONTACT_INTERIOR: nothing holds elements apart inside a part; a run in which one turns inside "
          "out stops");
    if (!block.name.spec || !block.name.spec->card(1) || !block.name.spec->card(1)->field("surfatyp")) return;
    if (base.find("TIED") != std::string::npos || base.find("TRANSDUCER") != std::string::npos) return;  // refused
    const Row row = low_.row(block);
    const bool single = base.find("SINGLE") != std::string::npos || base.find("GENERAL") != std::string::npos;
    const std::vector<std::string> a = surface(row, "surfa", "surfatyp", single);
    const bool has_b = !single && (row.integer("surfb").value != 0 || row.integer("surfbtyp").value == 5);
    const std::vector<std::string> b = has_b ? surface(row, "surfb", "surfbtyp", single) : a;
    if (!single && !has_b && row.integer("surfa").value != 0)
      low_.differ(row.origin("surfb"),
                  fmt::format("*{} without a second surface: the first one touches itself", block.written));
    if (a.empty() || b.empty()) return;
    pairs(row, a, b);
  }

  std::vector<std::string> surface(const Row& row, const char* field, const char* type, bool single) {
    const std::int64_t kind = row.integer(type).value;
    const Origin where = row.origin(field);
    if (kind == 5 || (row.integer(field).value == 0 && (kind == 0 || single))) return all_parts();
    if (row.integer(field).value == 0) {
      low_.error(where, fmt::format("the contact does not say which surface; expected the number of a {}",
                                    kind == 2   ? "part set"
                                    : kind == 3 ? "part"
                                                : "node set"));
      return {};
    }
    if (kind == 2) return low_.parts_of_set(row.id(field, IdKind::set).value, where);
    if (kind == 3) {
      const std::string name = low_.part_name(row.id(field, IdKind::part).value);
      if (name.empty()) low_.refuse(where, "a part without solids, or without a law, cannot be in contact");
      return name.empty() ? std::vector<std::string>() : std::vector<std::string>{name};
    }
    if (kind == 4) return parts_or_set(row.id(field, IdKind::set).value, where);
    if (kind == 0) return segments(row.id(field, IdKind::set).value, where);
    return {};  // refused by its field
  }

  std::vector<std::string> all_parts() const {
    std::vector<std::string> all;
    for (const decks::DeckPart& part : low_.mesh.parts)
      if (const std::string name = low_.part_name(part.id); !name.empty() && low_.has_cells(part.id))
        all.push_back(name);
    return all;
  }

  /// The parts whose nodes a set holds, all of them, or else the set.
  std::vector<std::string> parts_or_set(std::int64_t id, const Origin& where) {
    const std::vector<std::int32_t>* nodes = low_.nodes_of_set(id);
    std::vector<std::string> whole;
    std::vector<std::int32_t> covered;  // parts may share nodes
    for (const MeshBlock& block : low_.mesh.mesh.blocks) {
      const std::vector<std::int32_t>& of_part = low_.nodes_of_part(block.label);
      const bool all = nodes && std::includes(nodes->begin(), nodes->end(), of_part.begin(), of_part.end());
      if (!all || low_.part_name(block.label).empty()) continue;
      whole.push_back(low_.part_name(block.label));
      covered.insert(covered.end(), of_part.begin(), of_part.end());
    }
    std::sort(covered.begin(), covered.end());
    covered.erase(std::unique(covered.begin(), covered.end()), covered.end());
    if (nodes && !whole.empty() && covered == *nodes) return whole;
    const std::string set = low_.node_set(id, where);
    return set.empty() ? std::vector<std::string>() : std::vector<std::string>{set};
  }

  /// Sets whose facets are the segments, and no others.
  std::vector<std::string> segments(std::int64_t id, const Origin& where) {
    if (!segment_sets_) segment_sets_.emplace(low_);
    return segment_sets_->facets_of(segment_sets_->segments_of(id, where), where);
  }

  void pairs(const Row& row, const std::vector<std::string>& a, const std::vector<std::string>& b) {
    std::vector<std::string> left = a, right = b, both = a;
    std::sort(left.begin(), left.end());
    std::sort(right.begin(), right.end());
    if (left == right) return contact(row, a, true);
    std::set<std::pair<std::string, std::string>> found;
    for (const std::string& one : a)
      for (const std::string& other : b) found.insert(std::minmax(one, other));
    if (found.size() > most_pairs) {
      for (const std::string& other : b)
        if (std::find(a.begin(), a.end(), other) == a.end()) both.push_back(other);
      low_.differ(row.origin("surfa"), fmt::format("contact of {} parts with {} becomes one of all of them with one "
                                                   "another, since more than {} pairs would be slow",
                                                   a.size(), b.size(), most_pairs));
      return contact(row, both, false);
    }
    for (const auto& [one, other] : found) one == other ? contact(row, {one}, true) : contact(row, {one, other}, false);
  }

  void contact(const Row& row, const std::vector<std::string>& parts, bool self) {
    const Origin where = row.origin("surfa");
    Node node = map_node(where);
    add(node, "type", scalar("eroding_surface", where));
    if (parts.size() < low_.part_names.size() || parts != all_parts()) {
      Node list = list_node(where);
      for (const std::string& part : parts) list.items.push_back(scalar(part, where));
      add(node, "parts", std::move(list));
    }
    add(node, "self_contact", scalar(self ? "true" : "false", where));
    refuse_end(row);
    const double fs = row.value("fs"), fd = row.value("fd");
    if (fs < 0.0 || fs == 2.0)
      low_.refuse(row.origin("fs"), fmt::format("FS = {}: friction of parts or from a table is not taken", fs));
    if (row.value("dc") != 0.0 && fs != fd)
      low_.refuse(row.origin("dc"),
                  "DC: friction that changes with the speed of sliding is not taken; expected 0, or "
                  "equal FS and FD");
    if (fs > 0.0) add(node, "friction", row.quantity("fs"));
    list_.items.push_back(std::move(node));
  }

  /// A contact may end after the run does.
  void refuse_end(const Row& row) {
    const double dt = row.value("dt", time);
    if (dt != 0.0 && dt < low_.end_time())
      low_.refuse(row.origin("dt"), fmt::format("DT = {}: contact that ends before the run does is not taken", dt));
  }

  Lowering& low_;
  std::optional<SegmentSets> segment_sets_;  // made when a contact first names segments
  Node list_ = list_node({});
};

}  // namespace

void lower_contacts(Lowering& low) { Contacts(low).lower(); }

}  // namespace kerf::lowering
