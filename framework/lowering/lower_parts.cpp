// Parts of a deck: their mesh, their element with hourglass control and bulk viscosity, and their material's name.
#include <fmt/format.h>

#include <algorithm>

#include "lowering/lowering.hpp"

namespace kerf::lowering {
namespace {

using decks::Block;
using decks::DeckPart;
using decks::IdKind;

/// What the element of a part is given.
struct ElementValues {
  double coefficient = 0.1, quadratic = 1.5, linear = 0.06;
  std::int64_t form = 1;  // IHQ
  Origin origin;
};

void take_bulk_viscosity(const Row& row, ElementValues& values) {
  if (row.given("q1") && row.value("q1") != 0.0) values.quadratic = row.value("q1");
  if (row.given("q2") && row.value("q2") != 0.0) values.linear = row.value("q2");
}

ElementValues defaults(Lowering& low) {
  ElementValues values;
  values.origin = low.root.origin;
  if (const Block* viscosity = low.last("CONTROL_BULK_VISCOSITY")) take_bulk_viscosity(low.row(*viscosity), values);
  if (const Block* control = low.last("CONTROL_HOURGLASS")) {
    const Row row = low.row(*control);
    values.origin = row.origin("ihq");
    if (row.integer("ihq").value != 0) values.form = row.integer("ihq").value;
    if (row.value("qh") != 0.0) values.coefficient = row.value("qh");
  }
  return values;
}

/// The row of a definition that several cards of one keyword may hold.
const Row* row_with(const std::vector<Row>& rows, const char* field, std::int64_t id) {
  const auto found =
      std::find_if(rows.begin(), rows.end(), [&](const Row& r) { return r.id(field, IdKind::other).value == id; });
  return found == rows.end() ? nullptr : &*found;
}

class Parts {
 public:
  explicit Parts(Lowering& low)
      : low_(low), defaults_(defaults(low)), sections_(low.rows("SECTION_SOLID")), hourglass_(low.rows("HOURGLASS")) {}

  void lower() {
    Node all = map_node(low_.root.origin);
    for (const DeckPart& part : low_.mesh.parts) {
      const std::string name = low_.part_name(part.id);
      MeshBlock* block = block_of(part.id);
      if (name.empty() || !block) continue;
      const Origin here = low_.deck.origin(part.place);
      Node node = map_node(here);
      Node mesh = map_node(here);
      add(mesh, "type", scalar("file", here));
      add(mesh, "file", scalar(low_.options.mesh_name, here));
      add(mesh, "unit", scalar(low_.units.length_name(), here));
      block->name = name;
      add(mesh, "block", scalar(name, here));
      add(node, "mesh", std::move(mesh));
      add(node, "element", element_of(part));
      add(all, name, std::move(node));
    }
    add(low_.root, "parts", std::move(all));
  }

 private:
  MeshBlock* block_of(std::int64_t id) const {
    for (MeshBlock& block : low_.mesh.mesh.blocks)
      if (block.label == id) return &block;
    return nullptr;
  }

  Node element_of(const DeckPart& part) {
    check_section(part);
    ElementValues values = defaults_;
    if (const Row* row = row_with(hourglass_, "hgid", part.hourglass); row && part.hourglass != 0) {
      values.origin = row->origin("ihq");
      if (row->integer("ihq").value != 0) values.form = row->integer("ihq").value;
      values.coefficient = row->value("qm") != 0.0 ? row->value("qm") : 0.1;
      take_bulk_viscosity(*row, values);
    }
    const Origin& at = values.origin;
    Node element = map_node(at);
    add(element, "type", scalar("hex8", at));
    add(element, "hourglass", scalar(hourglass_form(values), at));
    add(element, "hourglass_coefficient", scalar(number_text(values.coefficient), at));
    add(element, "linear_viscosity", scalar(number_text(values.linear), at));
    add(element, "quadratic_viscosity", scalar(number_text(values.quadratic), at));
    return element;
  }

  std::string hourglass_form(const ElementValues& values) {
    if (values.form >= 1 && values.form <= 3) return "viscous";
    if (values.form == 4 || values.form == 5) return "stiffness";
    const bool near = values.form == 6 || values.form == 7 || values.form == 9;
    const std::string what = fmt::format("hourglass control IHQ {}", values.form);
    if (!near)
      low_.refuse(values.origin, what + " is not done by Kerf; expected 1 to 7 or 9");
    else if (warned_forms_.insert(values.form).second)
      low_.differ(values.origin, what + " becomes that of stiffness (5), with the same coefficient");
    return "stiffness";
  }

  void check_section(const DeckPart& part) {
    const Row* row = row_with(sections_, "secid", part.section);
    if (!row) {
      if (part.section != 0)
        low_.refuse(low_.deck.origin(part.place), fmt::format("part {} has section {}, which is none of solids; Kerf "
                                                              "has solids only",
                                                              part.id, part.section));
      return;
    }
    const std::int64_t form = row->integer("elform").value;
    if (form == 0 || form == 1) return;
    const std::string what = fmt::format("*SECTION_SOLID ELFORM {} of part {}", form, part.id);
    if (form == 2 || form == -1 || form == -2 || form == 10 || form == 13 || form == 15)
      low_.differ(row->origin("elform"), what + " becomes 1: elements with one point of integration");
    else
      low_.refuse(row->origin("elform"), what + ": Kerf has no such element; expected 0, 1, 2, -1, -2, 10, 13 or 15");
  }

  Lowering& low_;
  const ElementValues defaults_;
  const std::vector<Row> sections_, hourglass_;
  std::set<std::int64_t> warned_forms_;
};

}  // namespace

void lower_parts(Lowering& low) { Parts(low).lower(); }

}  // namespace kerf::lowering
