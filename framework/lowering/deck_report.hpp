// What is told of a deck before its first step: keywords and what became of them, parts, sets, units.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "input/model_input.hpp"

namespace kerf::lowering {

/// What becomes of a keyword.
enum class Fate : std::uint8_t { done, noted, without_effect, refused };

struct KeywordLine {
  std::string keyword;  // without the asterisk
  Fate fate = Fate::done;
  std::vector<std::string> places;  // "deck.k:12"
};

struct PartLine {
  std::int64_t id = 0;
  std::string title, material, name;  // `name` is what the document calls it
  std::map<std::string, std::int64_t> shapes;  // elements by shape
  double volume = 0.0, mass = 0.0;  // [unit of the deck]
};

struct SetLine {
  std::string kind;
  std::int64_t id = 0;
  std::string title;
  std::int64_t n = 0;
};

struct DeckReport {
  std::string units, source_of_units;
  std::vector<KeywordLine> keywords;
  std::vector<PartLine> parts;
  std::vector<SetLine> sets;
  std::int64_t n_nodes = 0;
  std::int64_t n_differing = 0, n_left_out = 0;  // messages of these kinds
};

/// The report as tables, for `kerf check`.
std::string report_text(const DeckReport& report);
/// What stays of the report in summary.json.
DeckNote note_of(const DeckReport& report);

}  // namespace kerf::lowering
