// Which keywords and fields of decks Kerf carries out, which change nothing, and which it refuses.
//
// A field that no rule names may hold its default, zero or nothing. What a rule allows is carried out by the steps of
// lowering; `kerf reference` writes the rules into the manual.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "lowering/lowering.hpp"

namespace kerf::lowering {

enum class Handling : std::uint8_t {
  used,  // carried out
  no_effect,  // changes nothing in Kerf
  differs,  // done in another way: a warning unless the value is one of `allowed`
  only  // refused unless the value is one of `allowed`
};

struct FieldRule {
  std::string_view fields;  // names, separated by blanks
  Handling how = Handling::used;
  std::string_view allowed;  // numbers, separated by blanks
  std::string_view text;  // what becomes of it
};

struct KeywordRule {
  std::string_view keyword;  // a name ending in * stands for all that begin so
  Fate fate = Fate::done;
  std::string_view text;  // what becomes of it
  std::vector<FieldRule> fields;
};

/// In the order of the manual.
const std::vector<KeywordRule>& keyword_rules();
/// The rule of a keyword, or null.
const KeywordRule* rule_of(std::string_view base);

/// Ids of what parts with elements are made of. Everything else of these kinds changes nothing.
struct UsedIds {
  std::set<std::int64_t> sections, materials, equations, hourglass;
};

/// Judges every keyword and every field of the deck, and notes the fates in the report.
void check_handled(Lowering& lowering, const UsedIds& used);

/// The rules as a page of the manual, in Markdown.
std::string rules_page();

}  // namespace kerf::lowering
