// Text of cards: lines of a deck cut into fields, and the numbers that decks write.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace kerf::decks {

/// How wide the fields of a card are: as the tables say; twenty columns each; or as the tables say but with ids of
/// nodes and elements in ten columns instead of eight.
enum class CardFormat : std::uint8_t { standard, wide, i10 };

/// One line of a deck without its end. The text lives in the file that was read.
struct Card {
  const char* text = nullptr;
  std::uint32_t length = 0;
  std::int32_t line = 0;  // from 1

  std::string_view view() const { return {text, length}; }
};

/// A piece of a card. Columns count bytes from 1.
struct FieldText {
  std::string_view text;  // without blanks round it
  std::int32_t column = 0;  // where the field begins in a fixed card; where its value begins in a comma card
  std::int32_t width = 0;  // of the field; 0 in a comma card
};

std::string_view without_blanks(std::string_view text);
bool is_blank(std::string_view text);
std::string upper_case(std::string_view text);

/// The column of the first tab character, or 0.
std::int32_t tab_column(std::string_view card);

/// Columns `column` to `column + width - 1` of a card.
FieldText fixed_field(std::string_view card, std::int32_t column, std::int32_t width);

/// The pieces between the commas of a card.
std::vector<FieldText> comma_fields(std::string_view card);

/// A real number as decks write it: "7850.", "1.d3", "7.34-4" for 7.34e-4. False where the text is no number or does
/// not fit.
bool read_deck_real(std::string_view text, double& value);

/// An integer, or a real number without a fraction ("3.0").
bool read_deck_integer(std::string_view text, std::int64_t& value);

/// The text as UTF-8: bytes that are no UTF-8 are taken for Latin-1.
std::string to_utf8(std::string_view text);

/// Text of a deck for a message: one line of UTF-8 without control characters.
std::string printable(std::string_view text);
/// The first forty bytes of it, and the same in quotes.
std::string shortened(std::string_view text);
std::string quoted(std::string_view text);

}  // namespace kerf::decks
