// Cuts cards of nodes and elements.
#include "decks/bulk_card.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/assert.hpp"

namespace kerf::decks {

BulkCard::BulkCard(const Deck& deck, const Block& block, DeckErrors& errors, std::vector<std::string> names,
                   const std::vector<std::int32_t>& widths)
    : deck_(deck), block_(block), errors_(errors), names_(std::move(names)) {
  KERF_ASSERT(names_.size() <= most_fields && names_.size() == widths.size(), "fields of a card of nodes or elements");
  std::int32_t column = 1;
  for (std::size_t k = 0; k < names_.size(); ++k) {
    column_[k] = column;
    width_[k] = widths[k];
    column += widths[k];
  }
}

bool BulkCard::take(const Card& card) {
  line_ = card.line;
  bad_ = false;
  const std::string_view text = card.view();
  if (text.find(',') != std::string_view::npos) {
    std::size_t start = 0;
    for (std::size_t k = 0; k < names_.size(); ++k) {
      const std::size_t end = std::min(text.find(',', start), text.size());
      const std::string_view piece = start < end ? text.substr(start, end - start) : std::string_view();
      const std::string_view value = without_blanks(piece);
      const std::size_t at =
          value.empty() ? std::min(start, text.size()) : static_cast<std::size_t>(value.data() - card.text);
      text_[k] = {value, static_cast<std::int32_t>(at) + 1, 0};
      start = end + 1;
    }
    if (start < text.size() && !kerf::decks::is_blank(text.substr(start)))
      complain({block_.source, line_, static_cast<std::int32_t>(start) + 1},
               fmt::format("this card takes {} values; here is one more", names_.size()));
    return !bad_;
  }
  if (const std::int32_t tab = tab_column(text); tab > 0) {
    complain({block_.source, line_, tab}, "a tab character in a card of fixed columns; blanks or commas are needed");
    return false;
  }
  for (std::size_t k = 0; k < names_.size(); ++k) text_[k] = fixed_field(text, column_[k], width_[k]);
  return true;
}

template <class Value>
Value BulkCard::value_of(std::size_t field) {
  Value value{};
  Place where = place(field);
  if (const FieldMistake mistake = deck_.read(block_, text_[field], value, where))
    complain(where, mistake.message_about(names_[field], text_[field]));
  return value;
}

std::int64_t BulkCard::integer(std::size_t field) {
  const std::string_view text = text_[field].text;
  if (text.empty()) return 0;
  std::int64_t value = 0;
  bool plain = text.size() < 18;
  for (const char c : text) {
    plain = plain && c >= '0' && c <= '9';
    value = 10 * (plain ? value : 0) + (c - '0');
  }
  if (plain) return value;
  return value_of<std::int64_t>(field);
}

double BulkCard::real(std::size_t field) {
  double value = 0.0;
  if (text_[field].text.empty() || read_deck_real(text_[field].text, value)) return value;
  return value_of<double>(field);
}

bool BulkCard::is_blank_from(std::size_t field) const {
  for (std::size_t k = field; k < names_.size(); ++k)
    if (!text_[k].text.empty()) return false;
  return true;
}

void BulkCard::complain(const Place& place, const std::string& message) {
  bad_ = true;
  errors_.error(place, "values of nodes and elements", message);
}

}  // namespace kerf::decks
