// *PARAMETER and *PARAMETER_EXPRESSION.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "decks/deck_reader.hpp"

namespace kerf::decks {
namespace {

bool is_name(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_';
  });
}

}  // namespace

// Pairs of a name with its type and a value, four of them in a card.
void DeckReader::read_parameters(const Block& block) {
  const std::int32_t width = block.format == CardFormat::wide ? 20 : 10;
  for (std::size_t k = 0; k < block.n_cards; ++k) {
    const Card card = card_of(block, k);
    std::vector<FieldText> fields;
    if (card.view().find(',') != std::string_view::npos) {
      fields = comma_fields(card.view());
    } else if (const std::int32_t tab = tab_column(card.view()); tab > 0) {
      errors_.error({block.source, card.line, tab}, "tabs",
                    "a tab character in a card of fixed columns; blanks or commas are needed");
      continue;
    } else {
      for (std::int32_t f = 0; f < 8; ++f) fields.push_back(fixed_field(card.view(), 1 + f * width, width));
    }
    for (std::size_t f = 0; f < fields.size(); f += 2)
      if (!fields[f].text.empty())
        define(block, fields[f], f + 1 < fields.size() ? fields[f + 1] : FieldText{}, card.line, false);
  }
}

// A name in the first ten columns or before a comma, and an expression. A card without a name goes on with the
// expression of the card above.
void DeckReader::read_expressions(const Block& block) {
  const std::size_t width = block.format == CardFormat::wide ? 20 : 10;
  for (std::size_t k = 0; k < block.n_cards; ++k) {
    const Card card = card_of(block, k);
    const std::string_view text = card.view();
    if (is_blank(text)) continue;
    const std::size_t comma = text.find(',');
    const bool free = comma != std::string_view::npos && comma <= width;
    const std::size_t split = std::min(free ? comma : width, text.size());
    const std::string_view value = without_blanks(text.substr(std::min(split + (free ? 1 : 0), text.size())));
    FieldText expression{value, static_cast<std::int32_t>(value.empty() ? split : value.data() - text.data()) + 1, 0};
    std::string joined(value);
    while (k + 1 < block.n_cards && !is_blank(card_of(block, k + 1).view()) &&
           is_blank(card_of(block, k + 1).view().substr(0, width)))
      joined += without_blanks(card_of(block, ++k).view());
    expression.text = joined;
    define(block, {without_blanks(text.substr(0, split)), 1, 0}, expression, card.line, true);
  }
}

void DeckReader::define(const Block& block, const FieldText& name, const FieldText& value, std::int32_t line,
                        bool expression) {
  const std::string_view kind = "parameters";
  const Place at_name{block.source, line, name.column};
  Place at_value{block.source, line, std::max(value.column, 1)};
  Parameter parameter;
  parameter.type = name.text.empty() ? ' ' : upper_case(name.text.substr(0, 1))[0];
  const std::string_view bare = name.text.empty() ? name.text : without_blanks(name.text.substr(1));
  if ((parameter.type != 'R' && parameter.type != 'I' && parameter.type != 'C') || !is_name(bare))
    return errors_.error(at_name, kind,
                         fmt::format("\"{}\" is no parameter; expected R, I or C and a name of letters and digits",
                                     shortened(name.text)));
  if (value.text.empty()) return errors_.error(at_name, kind, fmt::format("parameter {} has no value", bare));
  Block asking = block;
  asking.order = order_;  // it sees the definitions above in the same block
  std::string wrong;
  if (parameter.type == 'C') {
    parameter.text = to_utf8(value.text);
  } else if (expression) {
    const DeckExpression result = evaluate(value.text, deck_.parameters_, deck_.asker(asking));
    parameter.value = result.value;
    wrong = result.error;
    at_value.column += result.offset;
  } else {
    wrong = deck_.read(asking, value, parameter.value.real, at_value).message;
  }
  if (!wrong.empty()) return errors_.error(at_value, kind, fmt::format("parameter {}: {}", bare, wrong));
  if (parameter.type == 'I' && expression) parameter.value.real = std::trunc(parameter.value.real);
  if (parameter.type == 'I' && parameter.value.real != std::floor(parameter.value.real))
    return errors_.error(at_value, kind,
                         fmt::format("parameter {} is an integer, but its value is {}", bare, parameter.value.real));
  parameter.value.integer = parameter.type == 'I';
  const bool local = block.base().find("LOCAL") != std::string::npos;
  parameter.source = local ? block.source : -1;
  parameter.order = order_++;
  if (!deck_.parameters_.define(std::string(bare), parameter))
    errors_.warning(at_name, kind,
                    fmt::format("parameter {} is defined again; from here on it has the new value", bare));
}

}  // namespace kerf::decks
