// Cuts cards into fields and reads their numbers.
#include "decks/card_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>

namespace kerf::decks {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v'; }

/// Length of the bytes of one UTF-8 character at the beginning of `text`; 0 where there is none.
std::size_t utf8_length(std::string_view text) {
  const auto first = static_cast<unsigned char>(text[0]);
  const std::size_t length = first < 0x80                    ? 1
                             : first >= 0xC2 && first < 0xE0 ? 2
                             : (first & 0xF0) == 0xE0        ? 3
                             : first >= 0xF0 && first < 0xF5 ? 4
                                                             : 0;
  if (length == 0 || length > text.size()) return 0;
  for (std::size_t k = 1; k < length; ++k)
    if ((static_cast<unsigned char>(text[k]) & 0xC0) != 0x80) return 0;
  return length;
}

/// Rewrites "1.d3" and "7.34-4" with an e. False where the text has not the form of a number.
bool with_plain_exponent(std::string_view text, char (&plain)[64], std::size_t& length) {
  if (text.size() > 48) return false;
  std::size_t at = 0;
  length = 0;
  if (text[at] == '+' || text[at] == '-') {
    if (text[at] == '-') plain[length++] = '-';
    ++at;
  }
  int n_digits = 0, n_points = 0;
  for (; at < text.size() && (is_digit(text[at]) || text[at] == '.'); ++at) {
    n_digits += is_digit(text[at]) ? 1 : 0;
    n_points += text[at] == '.' ? 1 : 0;
    plain[length++] = text[at];
  }
  if (n_digits == 0 || n_points > 1) return false;
  if (at == text.size()) return true;
  const bool letter = std::strchr("eEdD", text[at]) != nullptr;
  if (letter) ++at;
  const bool sign = at < text.size() && (text[at] == '+' || text[at] == '-');
  if (!letter && !sign) return false;
  plain[length++] = 'e';
  if (sign) plain[length++] = text[at++];
  if (at == text.size()) return false;
  for (; at < text.size(); ++at) {
    if (!is_digit(text[at])) return false;
    plain[length++] = text[at];
  }
  return true;
}

}  // namespace

std::string_view without_blanks(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

bool is_blank(std::string_view text) { return without_blanks(text).empty(); }

std::string upper_case(std::string_view text) {
  std::string upper(text);
  for (char& c : upper)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return upper;
}

std::int32_t tab_column(std::string_view card) {
  const std::size_t at = card.find('\t');
  return at == std::string_view::npos ? 0 : static_cast<std::int32_t>(at) + 1;
}

FieldText fixed_field(std::string_view card, std::int32_t column, std::int32_t width) {
  FieldText field{{}, column, width};
  const auto start = static_cast<std::size_t>(column - 1);
  if (start < card.size()) field.text = without_blanks(card.substr(start, static_cast<std::size_t>(width)));
  return field;
}

std::vector<FieldText> comma_fields(std::string_view card) {
  std::vector<FieldText> fields;
  std::size_t start = 0;
  for (;;) {
    const std::size_t comma = std::min(card.find(',', start), card.size());
    std::size_t first = start;
    while (first < comma && is_space(card[first])) ++first;
    const std::size_t shown = first < comma ? first : start;
    fields.push_back({without_blanks(card.substr(start, comma - start)),
                      static_cast<std::int32_t>(std::min(shown, card.size())) + 1, 0});
    if (comma == card.size()) return fields;
    start = comma + 1;
  }
}

bool read_deck_real(std::string_view text, double& value) {
  if (text.empty()) return false;
  const char* first = text.data();
  const char* last = first + text.size();
  if (is_digit(*first) || *first == '-' || *first == '.') {  // the usual case
    const auto [end, status] = std::from_chars(first, last, value);
    if (end == last && status == std::errc() && std::isfinite(value)) return true;
  }
  char plain[64];
  std::size_t length = 0;
  if (!with_plain_exponent(text, plain, length)) return false;
  const auto [end, status] = std::from_chars(plain, plain + length, value);
  return end == plain + length && status == std::errc() && std::isfinite(value);
}

bool read_deck_integer(std::string_view text, std::int64_t& value) {
  if (text.empty()) return false;
  const std::string_view digits = text.front() == '+' ? text.substr(1) : text;
  const auto [end, status] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (status == std::errc() && end == digits.data() + digits.size()) return true;
  double real = 0.0;
  if (!read_deck_real(text, real) || std::abs(real) > 9e15 || real != std::floor(real)) return false;
  value = static_cast<std::int64_t>(real);
  return true;
}

std::string to_utf8(std::string_view text) {
  std::string utf8;
  bool valid = true;
  for (std::size_t at = 0; at < text.size() && valid;) {
    const std::size_t length = utf8_length(text.substr(at));
    valid = length > 0;
    at += length;
  }
  if (valid) return std::string(text);
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80) {
      utf8 += c;
    } else {
      utf8 += static_cast<char>(0xC0 | (byte >> 6));
      utf8 += static_cast<char>(0x80 | (byte & 0x3F));
    }
  }
  return utf8;
}

std::string printable(std::string_view text) {
  std::string line = to_utf8(text);
  for (char& c : line)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = '?';
  return line;
}

std::string shortened(std::string_view text) { return printable(text.substr(0, 40)); }

std::string quoted(std::string_view text) { return "\"" + shortened(text) + "\""; }

}  // namespace kerf::decks
