// The page of the manual that tells what becomes of each keyword and each field of a deck.
#include <fmt/format.h>

#include <cctype>

#include "lowering/handled_fields.hpp"

namespace kerf::lowering {
namespace {

std::string upper(std::string_view text) {
  std::string word(text);
  for (char& c : word) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return word;
}

std::string with_commas(std::string_view words) {
  std::string text;
  for (const char c : words) text += c == ' ' ? std::string(", ") : std::string(1, c);
  return text;
}

const char* fate_text(Fate fate) {
  static const char* const names[] = {"done", "noted", "without effect", "refused"};
  return names[static_cast<std::size_t>(fate)];
}

const char* handling_text(Handling how) {
  static const char* const names[] = {"done", "no effect", "another way", "refused"};
  return names[static_cast<std::size_t>(how)];
}

std::string fields_table(const KeywordRule& rule) {
  std::string text = "| field | what Kerf does | values | |\n|---|---|---|---|\n";
  for (const FieldRule& field : rule.fields) {
    std::string values = with_commas(field.allowed);
    if (!values.empty() && field.how == Handling::only) values = "only " + values;
    if (!values.empty() && field.how == Handling::differs) values = "other than " + values;
    const bool refuses = field.how == Handling::only;
    text += fmt::format("| {} | {} | {} | {} |\n", upper(with_commas(field.fields)),
                        refuses ? "refuses others" : handling_text(field.how), values, field.text);
  }
  return text;
}

}  // namespace

std::string rules_page() {
  std::string text =
      "# Keywords of decks\n\nWhat Kerf does with the keywords of a deck, and with their fields. A field that is not "
      "named here may hold its default, zero or nothing; any other value is refused. Keywords that are not named here "
      "are refused, but for output, which is noted. How decks are run is told in doc/users/decks.md.\n\n"
      "| keyword | what Kerf does | becomes |\n|---|---|---|\n";
  for (const KeywordRule& rule : keyword_rules())
    text += fmt::format("| `*{}` | {} | {} |\n", rule.keyword, fate_text(rule.fate), rule.text);
  for (const KeywordRule& rule : keyword_rules()) {
    if (rule.fields.empty()) continue;
    text += fmt::format("\n## `*{}`\n\n{}", rule.keyword, fields_table(rule));
  }
  return text;
}

}  // namespace kerf::lowering
