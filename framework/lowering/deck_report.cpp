// The report of a deck as tables.
#include "lowering/deck_report.hpp"

#include <fmt/format.h>

namespace kerf::lowering {
namespace {

const char* name_of(Fate fate) {
  static const char* const names[] = {"done", "noted", "without effect", "refused"};
  return names[static_cast<std::size_t>(fate)];
}

/// The first places, and how many more there are.
std::string places_of(const KeywordLine& line) {
  constexpr std::size_t most = 3;
  std::string text;
  for (std::size_t k = 0; k < line.places.size() && k < most; ++k) text += (k == 0 ? "" : ", ") + line.places[k];
  if (line.places.size() > most) text += fmt::format(" and {} more", line.places.size() - most);
  return text;
}

std::string shapes_of(const PartLine& part) {
  std::string text;
  for (const auto& [shape, n] : part.shapes) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", n, shape);
  return text.empty() ? "no solids" : text;
}

}  // namespace

DeckNote note_of(const DeckReport& report) {
  DeckNote note{report.units, report.n_differing, report.n_left_out, {}};
  for (const KeywordLine& line : report.keywords) note.keywords[name_of(line.fate)].push_back("*" + line.keyword);
  return note;
}

std::string report_text(const DeckReport& report) {
  std::string text = fmt::format("units                {} ({})\n\n", report.units, report.source_of_units);
  text += fmt::format("{:<46}{:<16}{}\n", "keyword", "", "where");
  for (const KeywordLine& line : report.keywords)
    text += fmt::format("{:<46}{:<16}{}\n", "*" + line.keyword, name_of(line.fate), places_of(line));
  text += fmt::format("\n{:>10}  {:<24}{:<46}{:<30}{:>14}{:>14}\n", "part", "called", "material", "elements", "volume",
                      "mass");
  for (const PartLine& part : report.parts)
    text += fmt::format("{:>10}  {:<24}{:<46}{:<30}{:>14.8g}{:>14.8g}\n", part.id, part.name, part.material,
                        shapes_of(part), part.volume, part.mass);
  if (!report.sets.empty()) text += fmt::format("\n{:>10}  {:<10}{:>10}  {}\n", "set", "of", "members", "title");
  for (const SetLine& set : report.sets)
    text += fmt::format("{:>10}  {:<10}{:>10}  {}\n", set.id, set.kind, set.n, set.title);
  text += fmt::format("\nnodes of the deck    {}\n", report.n_nodes);
  text += fmt::format("done in another way  {}\nleft out             {}\n\n", report.n_differing, report.n_left_out);
  return text;
}

}  // namespace kerf::lowering
