// The JSON behind summary.hpp.
#include "output/summary.hpp"

#include <nlohmann/json.hpp>

#include "output/file.hpp"

namespace kerf {

namespace {

using Json = nlohmann::ordered_json;

template <class Value, class Convert>
Json object_of(const std::map<std::string, Value>& values, Convert&& convert) {
  Json object = Json::object();
  for (const auto& [name, value] : values) object[name] = convert(value);
  return object;
}

Json json_of(const NamedNumbers& numbers) {
  Json object = Json::object();
  for (const auto& [name, value] : numbers) object[name] = value;
  return object;
}

Json json_of(const Summary::Hourglass& h) {
  return {{"energy", h.energy}, {"dissipated", h.dissipated}, {"share", h.share()}};
}

Json json_of(const Summary::Eroded& e) {
  const auto count = [](std::int64_t n) { return Json(n); };
  return {{"elements", e.elements},
          {"by_part", object_of(e.by_part, count)},
          {"by_criterion", object_of(e.by_criterion, count)}};
}

Json json_of(const Summary::Part& p) {
  return {
      {"elements", p.elements}, {"alive", p.alive}, {"mass", p.mass}, {"velocity", p.velocity}, {"kinetic", p.kinetic}};
}

Json json_of(const Summary::LibrarySet& l) {
  return {{"set", l.set}, {"file", l.file}, {"hash", l.hash}, {"verified", l.verified}, {"overridden", l.overridden}};
}

Json json_of(const Summary::Timer& t) {
  Json json{{"min", t.total.min}, {"mean", t.total.mean}, {"max", t.total.max}};
  json["work"] = {{"min", t.work.min}, {"mean", t.work.mean}, {"max", t.work.max}};
  return json;
}

Json json_of(const Summary::Rebalance& r) {
  return {{"cycle", r.cycle},
          {"imbalance_before", r.imbalance_before},
          {"imbalance_after", r.imbalance_after},
          {"elements_moved", r.elements_moved},
          {"seconds", r.seconds}};
}

}  // namespace

std::string summary_text(const Summary& s) {
  Json json;
  json["kerf_version"] = s.kerf_version;
  json["input"] = s.input;
  json["title"] = s.title;
  json["precision"] = s.precision;
  json["ranks"] = s.ranks;
  json["cycles"] = s.cycles;
  json["end_time"] = s.end_time;
  json["wall_seconds"] = s.wall_seconds;
  json["element_cycles"] = s.element_cycles;
  json["element_cycles_per_second"] = s.element_cycles_per_second;
  json["state_hash"] = s.state_hash;
  json["exit"] = s.exit;
  json["energy"] = json_of(s.energy);
  json["hourglass"] = json_of(s.hourglass);
  json["contact_impacts"] = json_of(s.contact_impacts);
  const Summary::ContactLetGo& let_go = s.contact_let_go;
  json["contact_let_go"] = {{"nodes", let_go.nodes},
                            {"mass", let_go.mass},
                            {"deepest", let_go.deepest},
                            {"first_time", let_go.first_time},
                            {"by_part", object_of(let_go.by_part, [](std::int64_t n) { return Json(n); })}};
  json["momentum"] = {{"initial", s.momentum.initial},
                      {"final", s.momentum.final},
                      {"eroded", s.momentum.eroded},
                      {"external_impulse", s.momentum.external_impulse}};
  json["mass"] = {{"initial", s.mass.initial},
                  {"live", s.mass.live},
                  {"free_nodes", s.mass.free_nodes},
                  {"dropped", s.mass.dropped}};
  json["eroded"] = json_of(s.eroded);
  json["no_tension"] = {{"elements", s.no_tension.elements},
                        {"by_part", object_of(s.no_tension.by_part, [](std::int64_t n) { return Json(n); })}};
  json["parts"] = object_of(s.parts, [](const Summary::Part& p) { return json_of(p); });
  json["measures"] = object_of(s.measures, [](double v) { return Json(v); });
  json["not_measured"] = object_of(s.not_measured, [](const std::string& reason) { return Json(reason); });
  json["library"] = object_of(s.library, [](const Summary::LibrarySet& l) { return json_of(l); });
  if (!s.deck.units.empty())
    json["deck"] = {{"units", s.deck.units},
                    {"in_another_way", s.deck.in_another_way},
                    {"left_out", s.deck.left_out},
                    {"keywords", s.deck.keywords}};
  json["warnings"] = s.warnings;
  json["timers"] = object_of(s.timers, [](const Summary::Timer& t) { return json_of(t); });
  json["steps"] = json_of(s.steps);
  json["rebalances"] = Json::array();
  for (const Summary::Rebalance& r : s.rebalances) json["rebalances"].push_back(json_of(r));
  json["work"] = json_of(s.work);
  json["observers"] = object_of(s.observers, [](const NamedNumbers& n) { return json_of(n); });
  // Names come from the user's file; a byte that is not UTF-8 must not cost the whole summary.
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

void write_summary(const std::string& path, const Summary& summary) { replace_file(path, summary_text(summary)); }

}  // namespace kerf
