// Judges the keywords and fields of a deck by the table of rules.
#include "lowering/handled_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "kerf/functions.hpp"

namespace kerf::lowering {

using decks::Block;
using decks::CardSpec;
using decks::CardWhen;
using decks::FieldSpec;
using decks::FieldType;
using decks::IdKind;
using decks::KeywordUse;

namespace {

std::string upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

std::vector<std::string_view> words(std::string_view text) {
  std::vector<std::string_view> found;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    if (end > 0) found.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return found;
}

bool names(const FieldRule& rule, std::string_view field) {
  const std::vector<std::string_view> all = words(rule.fields);
  return std::find(all.begin(), all.end(), field) != all.end();
}

/// The rule of a field: its own, or that of the fields that no rule names.
const FieldRule& rule_for(const KeywordRule& keyword, std::string_view field) {
  static const FieldRule unnamed{"", Handling::only, "0", "Kerf does not do this"};
  static const FieldRule free{"", Handling::no_effect, "", ""};
  for (const FieldRule& rule : keyword.fields)
    if (names(rule, field)) return rule;
  return keyword.fate == Fate::done && !keyword.fields.empty() ? unnamed : free;
}

std::string listed(std::string_view allowed) {
  std::string text;
  const std::vector<std::string_view> all = words(allowed);
  for (std::size_t k = 0; k < all.size(); ++k)
    text += fmt::format("{}{}", k == 0 ? "" : k + 1 == all.size() ? " or " : ", ", all[k]);
  return text;
}

class Judge {
 public:
  Judge(Lowering& lowering, const UsedIds& used) : low_(lowering), used_(used) {}

  void judge() {
    for (const Block& block : low_.deck.blocks()) note(block, fate_of(block));
    for (auto& [keyword, line] : lines_) low_.report.keywords.push_back(std::move(line));
  }

 private:
  void note(const Block& block, Fate fate) {
    const std::string key = block.base() + static_cast<char>('0' + static_cast<int>(fate));
    KeywordLine& line = lines_[key];
    line.keyword = block.base();
    line.fate = fate;
    line.places.push_back(
        fmt::format("{}:{}", *low_.deck.sources()[static_cast<std::size_t>(block.source)].name, block.line));
  }

  Fate fate_of(const Block& block) {
    const KeywordRule* rule = rule_of(block.base());
    const Origin here = low_.deck.origin(low_.deck.place_of(block));
    if (is_set(block.base())) return decks::is_read_set(block.base()) ? Fate::done : Fate::without_effect;
    if (is_mesh_of_others(block)) return Fate::refused;
    if (const Fate unused = of_unused(block); unused != Fate::done) return unused;
    if (!rule) return of_unruled(block, here);
    if (!block.name.spec) return rule->fate;
    check_fields(block, *rule);
    return rule->fate;
  }

  static bool is_set(const std::string& base) { return base.rfind("SET_", 0) == 0; }

  /// Elements that are no solids.
  bool is_mesh_of_others(const Block& block) {
    if (block.base().rfind("ELEMENT_", 0) != 0 || block.base() == "ELEMENT_SOLID") return false;
    const std::string parts = parts_of_elements(block);
    low_.refuse(low_.deck.origin(low_.deck.place_of(block)),
                fmt::format("*{}: Kerf has solids only{}", block.written, parts));
    return true;
  }

  /// "; 12 elements of part 2 cannot be run", from cards that begin with the ids of an element and of its part.
  std::string parts_of_elements(const Block& block) const {
    std::map<std::int64_t, int> counts;
    for (std::size_t k = 0; k < block.n_cards; ++k) {
      const std::string_view card = low_.deck.cards_of(block)[k].view();
      const std::size_t comma = card.find(',');
      std::string_view text = card.size() > 8 ? card.substr(8, 8) : std::string_view();
      if (comma != card.npos) text = card.substr(comma + 1, card.find(',', comma + 1) - comma - 1);
      std::int64_t part = 0;
      if (decks::read_deck_integer(decks::without_blanks(text), part) && part > 0) ++counts[part];
    }
    std::string found;
    for (const auto& [part, n] : counts)
      found += fmt::format("{}{} element{} of part {}", found.empty() ? "; " : ", ", n, n == 1 ? "" : "s", part);
    return found.empty() ? found : found + " cannot be run";
  }

  /// "part 2", "parts 2 and 3": where a definition is used.
  std::string parts_with(std::int64_t decks::DeckPart::*member, std::int64_t id) const {
    std::string found;
    int n = 0;
    for (const decks::DeckPart& part : low_.mesh.parts)
      if (part.*member == id) found += fmt::format("{}{}", n++ == 0 ? "" : ", ", part.id);
    return (n == 1 ? "part " : "parts ") + found;
  }

  /// Definitions that no part with elements names.
  Fate of_unused(const Block& block) const {
    const std::string& base = block.base();
    if (base.rfind("MAT_", 0) == 0) return is_used(block, "mid", IdKind::material, used_.materials);
    if (base.rfind("EOS_", 0) == 0) return is_used(block, "eosid", IdKind::material, used_.equations);
    if (base.rfind("SECTION_", 0) == 0) return is_used(block, "secid", IdKind::other, used_.sections);
    if (base == "HOURGLASS") return is_used(block, "hgid", IdKind::other, used_.hourglass);
    return Fate::done;
  }

  Fate is_used(const Block& block, std::string_view field, IdKind kind, const std::set<std::int64_t>& used) const {
    bool found = false;
    if (block.name.spec && block.name.spec->card(1) && has_field(block, field))
      for (std::size_t r = 0; r < std::max<std::size_t>(low_.deck.n_repeats(block), 1); ++r)
        found = found || used.count(low_.row(block, r).id(field, kind).value) > 0;
    else
      found = used.count(low_.deck.transform_of(block).id(low_.deck.first_integer(block), kind)) > 0;
    return found ? Fate::done : Fate::without_effect;
  }

  static bool has_field(const Block& block, std::string_view field) {
    for (const CardSpec& card : block.name.spec->cards)
      if (card.field(field)) return true;
    return false;
  }

  Fate of_unruled(const Block& block, const Origin& here) {
    if (block.name.use == KeywordUse::noted) return Fate::noted;
    if (block.name.use == KeywordUse::read) return Fate::done;
    if (block.name.use == KeywordUse::unknown) return Fate::refused;  // the reader has complained
    low_.refuse(here, refusal(block));
    return Fate::refused;
  }

  static bool is_concrete(const std::string& base) {
    for (const char* word : {"CONCRETE", "CSCM", "WINFRITH", "RHT", "PSEUDO_TENSOR", "GEOLOGIC"})
      if (base.find(word) != std::string::npos) return true;
    return false;
  }

  std::string refusal(const Block& block) const {
    const std::string& base = block.base();
    const decks::Transform& transform = low_.deck.transform_of(block);
    const std::int64_t first = low_.deck.first_integer(block);
    if (base.rfind("MAT_", 0) == 0)
      return fmt::format("*{} of {} has no law in Kerf; {}", block.written,
                         parts_with(&decks::DeckPart::material, transform.id(first, IdKind::material)),
                         is_concrete(base)
                             ? "of laws of concrete it has *MAT_JOHNSON_HOLMQUIST_CONCRETE, and in its own "
                               "input holmquist_johnson_cook and drucker_prager"
                             : "doc/reference/decks.md lists the materials that have one");
    if (base.rfind("EOS_", 0) == 0)
      return fmt::format("*{} of {} has no equation of state in Kerf; doc/reference/decks.md lists those that have one",
                         block.written, parts_with(&decks::DeckPart::eos, transform.id(first, IdKind::material)));
    if (base.rfind("CONTACT_", 0) == 0) return fmt::format("*{}: Kerf has no contact of this kind", block.written);
    if (base == "CONSTRAINED_LAGRANGE_IN_SOLID" || base == "CONSTRAINED_BEAM_IN_SOLID")
      return fmt::format("*{}: the coupling of beams and shells with solids is not done by Kerf", block.written);
    if (base.rfind("LOAD_BLAST", 0) == 0)
      return fmt::format("*{}: blast loads of decks are not taken; Kerf's own input has load `air_blast`",
                         block.written);
    if (base.rfind("SECTION_", 0) == 0)
      return fmt::format("*{}: Kerf has solids only; {} cannot be run", block.written,
                         parts_with(&decks::DeckPart::section, transform.id(first, IdKind::other)));
    return fmt::format("*{} is not done by Kerf", block.written);
  }

  void check_fields(const Block& block, const KeywordRule& rule) {
    const std::size_t n_groups = low_.deck.n_repeats(block);
    for (const CardSpec& card : block.name.spec->cards) {
      const bool many = card.when == CardWhen::more;
      if (card.when == CardWhen::title || card.when == CardWhen::id) continue;
      for (std::size_t r = 0; r < (many ? n_groups : 1); ++r) {
        if (!low_.deck.card(block, card.number, r)) continue;
        for (const FieldSpec& field : card.fields) check_field(block, rule, card, field, r);
      }
    }
  }

  void check_field(const Block& block, const KeywordRule& keyword, const CardSpec& card, const FieldSpec& field,
                   std::size_t repeat) {
    const FieldRule& rule = rule_for(keyword, field.name);
    if (rule.how == Handling::no_effect || field.name == "unused") return;
    if (rule.how == Handling::used && rule.allowed.empty()) return;
    if (field.type == FieldType::text) return;
    const decks::Field<double> value = low_.deck.real(block, card.number, field.name, repeat);
    if (!value.given || is_allowed(value.value, field, rule)) return;
    // A keyword that changes nothing but for its values is refused as a whole.
    const bool refuses_all = keyword.fate != Fate::done;
    const std::string what = fmt::format(
        "*{} {} = {}: {}; expected {}", block.written, upper(field.name), value.value,
        rule.text.empty() || rule.how == Handling::used ? "this value is not known" : rule.text, listed(rule.allowed));
    if (rule.how == Handling::differs)
      low_.differ(low_.deck.origin(value.place),
                  fmt::format("*{} {} = {}: {}", block.written, upper(field.name), value.value, rule.text));
    else
      low_.refuse(low_.deck.origin(refuses_all ? low_.deck.place_of(block) : value.place), what);
  }

  static bool is_allowed(double value, const FieldSpec& field, const FieldRule& rule) {
    if (rule.how != Handling::differs && rule.fields.empty() && value == field.number) return true;
    const std::vector<std::string_view> all = words(rule.allowed);
    return std::any_of(all.begin(), all.end(), [&](std::string_view text) {
      double number = 0.0;
      return decks::read_deck_real(text, number) && number == value;
    });
  }

  Lowering& low_;
  const UsedIds& used_;
  std::map<std::string, KeywordLine> lines_;
};

}  // namespace

void check_handled(Lowering& lowering, const UsedIds& used) { Judge(lowering, used).judge(); }

}  // namespace kerf::lowering
