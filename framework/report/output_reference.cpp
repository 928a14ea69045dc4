// Tables of history.csv, summary.json, fields and timers.
#include "report/output_reference.hpp"

#include <fmt/format.h>

#include "core/timers.hpp"
#include "input/output_fields.hpp"
#include "model/accounts.hpp"

namespace kerf {

namespace {

std::string row(const std::string& name, const std::string& unit, const std::string& doc) {
  return fmt::format("| `{}` | {} | {} |\n", name, unit == "-" ? "" : unit, doc);
}

std::string heading(const std::string& title, const std::string& first) {
  return fmt::format("\n## {}\n\n| {} | unit | meaning |\n|---|---|---|\n", title, first);
}

}  // namespace

std::string output_reference() {
  std::string text =
      "# output\n\nWhat is written, from the tables that the writers use. How the files are made and read: "
      "[output](../users/output.md).\n";
  text += heading("Columns of history.csv", "column");
  for (const BookLine& line : book_lines())
    if ((line.places & in_history) != 0) text += row(line.name, line.unit, line.doc);
  text += heading("Keys of `energy` in summary.json", "key");
  for (const unsigned shares : {0u, unsigned{is_share}})
    for (const BookLine& line : book_lines())
      if ((line.places & in_energy) != 0 && (line.places & is_share) == shares)
        text += row(line.name, line.unit, line.doc);
  text += heading("Element fields", "field");
  for (const ElementField& field : element_fields()) text += row(field.name, field.unit, field.doc);
  text += row(owner_field().name, owner_field().unit, owner_field().doc);
  text += "\nEvery state variable of a law is an element field, too.\n";
  text += heading("Node fields", "field");
  for (const NodeField& field : node_fields()) text += row(field.name, field.unit, field.doc);
  text += heading("Timers", "timer");
  for (const TimerInfo& timer : timer_table) text += row(timer.name, "s", timer.doc);
  return text;
}

}  // namespace kerf
