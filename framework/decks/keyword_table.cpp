// Reads the table of keywords that is compiled in, keyword_cards.csv.
#include "decks/keyword_table.hpp"

#include <algorithm>
#include <charconv>
#include <map>

#include "core/assert.hpp"

namespace kerf::decks {

/// The text of keyword_cards.csv; CMake makes the file that defines it.
extern const char* const keyword_cards_text;

namespace {

constexpr std::size_t n_columns = 9;  // keyword,card,when,field,type,column,width,default,names

std::int32_t whole(std::string_view text) {
  std::int32_t value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

CardWhen when_named(std::string_view name) {
  constexpr std::string_view names[] = {"always", "more", "title", "id", "mpp", "optional"};
  const auto* const found = std::find(std::begin(names), std::end(names), name);
  KERF_ASSERT(found != std::end(names), "keyword_cards.csv: the column `when` holds an unknown word");
  return static_cast<CardWhen>(found - std::begin(names));
}

FieldReference reference_of(std::string_view text) {
  FieldReference reference;
  while (!text.empty()) {
    const std::string_view word = text.substr(0, text.find(' '));
    text = without_blanks(text.substr(word.size()));
    if (word == "required") {
      reference.required = true;
    } else if (word.front() == '-') {
      reference.may_be_negative = true;
      reference.negative_kind = word.substr(1);
    } else {
      KERF_ASSERT(reference.kind.empty(), "keyword_cards.csv: the column `names` holds two kinds");
      reference.kind = word;
    }
  }
  return reference;
}

FieldSpec field_of(const std::vector<FieldText>& row) {
  FieldSpec field;
  field.name = row[3].text;
  field.type = row[4].text == "real"      ? FieldType::real
               : row[4].text == "integer" ? FieldType::integer
                                          : FieldType::text;
  field.column = whole(row[5].text);
  field.width = whole(row[6].text);
  field.text = row[7].text;
  if (field.type != FieldType::text) read_deck_real(field.text, field.number);
  field.reference = reference_of(row[8].text);
  return field;
}

using Table = std::map<std::string, KeywordSpec, std::less<>>;

Table read_table() {
  Table table;
  std::string_view rest(keyword_cards_text);
  rest.remove_prefix(rest.find('\n') + 1);  // the names of the columns
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::vector<FieldText> row = comma_fields(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (row.size() != n_columns) continue;
    KeywordSpec& keyword = table[std::string(row[0].text)];
    keyword.name = row[0].text;
    const int number = whole(row[1].text);
    if (keyword.cards.empty() || keyword.cards.back().number != number)
      keyword.cards.push_back({number, when_named(row[2].text), {}});
    keyword.cards.back().fields.push_back(field_of(row));
  }
  for (auto& [name, keyword] : table)
    for (CardSpec& card : keyword.cards)
      for (FieldSpec& field : card.fields)  // by column, so that a gap in the table counts
        field.place = card.fields.size() > 1 ? (field.column - 1) / card.fields.front().width : 0;
  return table;
}

const Table& table() {
  static const Table table = read_table();
  return table;
}

}  // namespace

const FieldSpec* CardSpec::field(std::string_view name) const {
  for (const FieldSpec& field : fields)
    if (field.name == name) return &field;
  return nullptr;
}

bool CardSpec::has_commas(std::string_view card) const {
  const std::size_t comma = card.find(',');
  if (comma == std::string_view::npos) return false;
  if (fields.size() == 1 && fields.front().type == FieldType::text) return false;  // a title
  // A heading may hold commas itself: only one that ends the number before it separates fields.
  const bool heading = fields.size() == 2 && fields.back().type == FieldType::text;
  return !heading || comma <= static_cast<std::size_t>(fields.front().width);
}

FieldText CardSpec::text_of(const FieldSpec& field, std::string_view card, CardFormat format) const {
  if (fields.size() == 1 && field.type == FieldType::text) return {without_blanks(card), 1, 0};
  const bool heading = fields.size() == 2 && fields.back().type == FieldType::text && field.place > 0;
  if (heading && has_commas(card)) {  // the rest of the card, with the commas in it
    const std::size_t comma = card.find(',');
    return {without_blanks(card.substr(comma + 1)), static_cast<std::int32_t>(comma) + 2, 0};
  }
  if (has_commas(card)) {
    const std::vector<FieldText> pieces = comma_fields(card);
    const auto place = static_cast<std::size_t>(field.place);
    return place < pieces.size() ? pieces[place] : FieldText{{}, static_cast<std::int32_t>(card.size()) + 1, 0};
  }
  if (format == CardFormat::wide) return fixed_field(card, 20 * field.place + 1, heading ? 80 : 20);
  return fixed_field(card, field.column, field.width);
}

const CardSpec* KeywordSpec::card(int number) const {
  for (const CardSpec& card : cards)
    if (card.number == number) return &card;
  return nullptr;
}

bool KeywordSpec::has(CardWhen when) const {
  return std::any_of(cards.begin(), cards.end(), [&](const CardSpec& card) { return card.when == when; });
}

const KeywordSpec* keyword_spec(std::string_view base) {
  const auto found = table().find(base);
  return found == table().end() ? nullptr : &found->second;
}

std::vector<std::string> tabled_keywords() {
  std::vector<std::string> names;
  for (const auto& [name, spec] : table()) names.push_back(name);
  return names;
}

}  // namespace kerf::decks
