// Title, time and output of a deck.
#include <fmt/format.h>

#include <algorithm>

#include "lowering/lowering.hpp"

namespace kerf::lowering {
namespace {

using decks::Block;

/// A title without the sign that stands before names of parameters in an input.
std::string without_dollars(std::string title) {
  std::replace(title.begin(), title.end(), '$', ' ');
  return title;
}

bool has_explosive(const Lowering& low) { return !low.blocks("MAT_HIGH_EXPLOSIVE_BURN").empty(); }

void lower_time(Lowering& low) {
  const Block* termination = low.last("CONTROL_TERMINATION");
  if (!termination) return;  // check_references has complained
  const Row end = low.row(*termination);
  Node block = map_node(end.origin());
  add(block, "end", end.quantity("endtim", time));
  if (end.integer("endcyc").value > 0)
    add(block, "maximum_cycles", scalar(std::to_string(end.integer("endcyc").value), end.origin("endcyc")));
  double safety = 0.0;
  Origin at = end.origin();
  if (const Block* control = low.last("CONTROL_TIMESTEP")) {
    const Row step = low.row(*control);
    safety = step.value("tssfac");
    at = step.origin("tssfac");
    if (step.value("dtinit", time) > 0.0) add(block, "initial_step", step.quantity("dtinit", time));
    if (safety < 0.0) low.refuse(at, "*CONTROL_TIMESTEP TSSFAC < 0: a curve of the factor is not taken");
  }
  if (safety <= 0.0) safety = has_explosive(low) ? 0.67 : 0.9;
  add(block, "safety_factor", scalar(number_text(safety), at));
  add(low.root, "time", std::move(block));
}

void lower_output(Lowering& low) {
  const double end = low.end_time();
  Node block = map_node(low.root.origin);
  for (const auto& [keyword, key] :
       {std::pair{"DATABASE_BINARY_D3PLOT", "results_interval"}, std::pair{"DATABASE_GLSTAT", "history_interval"}}) {
    const std::vector<const Block*> all = low.blocks(keyword);
    if (all.empty()) continue;
    const Row row = low.row(*all.back());
    if (row.value("dt", time) > 0.0)
      add(block, key, row.quantity("dt", time));
    else if (std::string_view(keyword).ends_with("D3PLOT") && row.integer("npltc").value > 0 && end > 0.0)
      add(block, key,
          scalar(low.text(end / static_cast<double>(row.integer("npltc").value), time), row.origin("npltc")));
  }
  if (!block.entries.empty()) add(low.root, "output", std::move(block));
}

}  // namespace

void lower_control(Lowering& low) {
  if (!low.deck.title().empty()) {
    const std::vector<const Block*> titles = low.blocks("TITLE");
    add(low.root, "title",
        scalar(without_dollars(low.deck.title()),
               titles.empty() ? low.root.origin : low.deck.origin(low.deck.place_of(*titles.back()))));
  }
  lower_time(low);
  lower_output(low);
}

}  // namespace kerf::lowering
