// Curves of a deck: points with scales and shifts, and functions of time in the document.
#include <fmt/format.h>

#include "lowering/lowering.hpp"

namespace kerf::lowering {
namespace {

/// A function of time that OFFA shifts to later times is zero before, up to 0.999 of the shift.
void begin_later(const Lowering& low, std::int64_t id, Lowering::Points& points) {
  const Row head = low.row(*low.defined("DEFINE_CURVE", "lcid", id, decks::IdKind::function));
  const double scale = head.value("sfa") == 0.0 ? 1.0 : head.value("sfa"), shift = scale * head.value("offa");
  if (shift <= 0.0 || 0.999 * shift >= points.x.front()) return;
  points.x.insert(points.x.begin(), {0.0, 0.999 * shift});
  points.y.insert(points.y.begin(), {0.0, 0.0});
}

/// Programs do not agree on what follows the last point of a function of time.
void warn_of_end(Lowering& low, std::int64_t id, const Lowering::Points& points) {
  const double end = low.end_time();
  if (points.x.back() < end)
    low.differ(points.origin, fmt::format("curve {} ends at {}, before the run does at {}; it keeps its last value, {}",
                                          id, points.x.back(), end, points.y.back()));
}

}  // namespace

Lowering::Points Lowering::curve_points(std::int64_t id, const Origin& where) {
  const decks::Block* block = defined("DEFINE_CURVE", "lcid", id, decks::IdKind::function);
  if (!block) {
    error(where, fmt::format("curve {} is not defined", id));
    return {};
  }
  const Row head = row(*block);
  const decks::Transform& transform = deck.transform_of(*block);
  if (transform.mass != 1.0 || transform.length != 1.0 || transform.time != 1.0)
    refuse(head.origin(), fmt::format("curve {} stands in an include with factors of units, which do not tell what its "
                                      "numbers are; write it into the main deck",
                                      id));
  const auto scale = [&](const char* field) { return head.value(field) == 0.0 ? 1.0 : head.value(field); };
  Points points{{}, {}, head.origin()};
  for (std::size_t r = 0; r < deck.n_repeats(*block); ++r) {
    const Row point = row(*block, r);
    points.x.push_back(scale("sfa") * (point.value("a1") + head.value("offa")));
    points.y.push_back(scale("sfo") * (point.value("o1") + head.value("offo")));
  }
  return points;
}

std::string Lowering::curve(std::int64_t id, const Origin& where) {
  std::string name = fmt::format("curve_{}", id);
  if (curves_.count(id) > 0) return name;
  Points points = curve_points(id, where);
  if (points.x.empty()) return {};
  curves_.insert(id);
  begin_later(*this, id, points);
  warn_of_end(*this, id, points);
  Node block = map_node(points.origin);
  add(block, "times", scalar(list_text(points.x, time), points.origin));
  add(block, "values", scalar(list_text(points.y, number), points.origin));
  Entry* all = root.find("curves");
  Node& map = all ? all->value : add(root, "curves", map_node(where));
  add(map, name, std::move(block));
  return name;
}

}  // namespace kerf::lowering
