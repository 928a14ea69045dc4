// Checks the values of all cards that the table describes.
#include <fmt/format.h>

#include "decks/deck.hpp"

namespace kerf::decks {
namespace {

/// Checks the cards of one block against its table.
class BlockCheck {
 public:
  BlockCheck(const Deck& deck, const Block& block, DeckErrors& errors) : deck_(deck), block_(block), errors_(errors) {}

  void check() {
    const CardLayout& layout = block_.layout;
    if (block_.n_cards == 0) {
      errors_.error(deck_.place_of(block_), "keywords without cards",
                    fmt::format("*{} needs a card; the next keyword follows at once", block_.written));
      return;
    }
    for (std::size_t k = 0; k < block_.n_cards; ++k) {
      const Card& card = deck_.cards_of(block_)[k];
      if (k < layout.top.size()) {
        check_card(*layout.top[k], card);
      } else if (!layout.group.empty()) {
        check_card(*layout.group[(k - layout.top.size()) % layout.group.size()], card);
      } else if (!is_blank(card.view())) {
        errors_.error({block_.source, card.line, 1}, "cards too many",
                      fmt::format("*{} takes at most {} card{} here; this is one more", block_.written,
                                  layout.top.size(), layout.top.size() == 1 ? "" : "s"));
        return;
      }
    }
  }

 private:
  void check_card(const CardSpec& spec, const Card& card) {
    const bool is_text = spec.fields.size() == 1 && spec.fields.front().type == FieldType::text;
    if (is_text) return;
    const bool commas = spec.has_commas(card.view());
    if (const std::int32_t tab = tab_column(card.view()); tab > 0 && !commas) {
      const FieldSpec& last = spec.fields.back();
      if (last.type == FieldType::text && tab >= last.column) return;
      errors_.error({block_.source, card.line, tab}, "tabs",
                    "a tab character in a card of fixed columns; blanks or commas are needed");
      return;
    }
    for (const FieldSpec& field : spec.fields)
      if (!check_field(spec, field, card)) return;
    if (commas && spec.fields.back().type != FieldType::text) check_end(spec, card);
  }

  /// False where the rest of the card cannot be trusted.
  bool check_field(const CardSpec& spec, const FieldSpec& field, const Card& card) {
    if (field.type == FieldType::text || field.name == "unused") return true;
    const FieldText text = spec.text_of(field, card.view(), block_.format);
    if (text.text.empty()) return true;
    Place place{block_.source, card.line, text.column};
    double real = 0.0;
    std::int64_t integer = 0;
    const FieldMistake mistake = field.type == FieldType::real ? deck_.read(block_, text, real, place)
                                                               : deck_.read(block_, text, integer, place);
    if (!mistake) return true;
    errors_.error(place, "values that are no numbers", mistake.message_about(field.name, text));
    return mistake.kind != FieldMistake::Kind::two_values;
  }

  /// Values beyond the fields of a comma card would be lost.
  void check_end(const CardSpec& spec, const Card& card) {
    const std::vector<FieldText> pieces = comma_fields(card.view());
    for (auto k = static_cast<std::size_t>(spec.fields.back().place) + 1; k < pieces.size(); ++k) {
      std::int64_t integer = 1;
      if (pieces[k].text.empty() || (read_deck_integer(pieces[k].text, integer) && integer == 0)) continue;
      errors_.error({block_.source, card.line, pieces[k].column}, "values too many",
                    fmt::format("this card of *{} takes {} values; this is number {}", block_.written,
                                spec.fields.back().place + 1, k + 1));
      return;
    }
  }

  const Deck& deck_;
  const Block& block_;
  DeckErrors& errors_;
};

}  // namespace

void check_fields(const Deck& deck, Diagnostics& diagnostics) {
  DeckErrors errors(deck, diagnostics);
  for (const Block& block : deck.blocks()) {
    if (block.name.use != KeywordUse::tabled || block.base() == "INCLUDE_TRANSFORM" || block.base() == "TITLE")
      continue;
    BlockCheck(deck, block, errors).check();
  }
}

}  // namespace kerf::decks
