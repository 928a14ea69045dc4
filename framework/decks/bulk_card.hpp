// Cards of nodes and elements: read a million times, so without an allocation per field.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "decks/deck.hpp"

namespace kerf::decks {

/// The fields of one card after another, all with the same columns.
class BulkCard {
 public:
  static constexpr std::size_t most_fields = 12;
  /// `names` are for messages.
  BulkCard(const Deck& deck, const Block& block, DeckErrors& errors, std::vector<std::string> names,
           const std::vector<std::int32_t>& widths);

  /// Turns to a card. False, with an error, where it holds a tab between fixed columns.
  bool take(const Card& card);
  bool is_blank(std::size_t field) const { return text_[field].text.empty(); }
  /// The value of a field, 0 where it is blank. Text that is none is an error, and `bad` from then on.
  std::int64_t integer(std::size_t field);
  double real(std::size_t field);
  Place place(std::size_t field) const { return {block_.source, line_, text_[field].column}; }
  Place place() const { return {block_.source, line_, 1}; }
  bool bad() const { return bad_; }
  /// Whether all fields from this one on are blank.
  bool is_blank_from(std::size_t field) const;

 private:
  /// Reads what is no plain number.
  template <class Value>
  Value value_of(std::size_t field);
  void complain(const Place& place, const std::string& message);

  const Deck& deck_;
  const Block& block_;
  DeckErrors& errors_;
  const std::vector<std::string> names_;
  std::array<std::int32_t, most_fields> column_ = {}, width_ = {};
  std::array<FieldText, most_fields> text_ = {};
  std::int32_t line_ = 0;
  bool bad_ = false;
};

}  // namespace kerf::decks
