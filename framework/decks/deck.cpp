// Finds cards and fields of blocks, and reads their values.
#include "decks/deck.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/assert.hpp"

namespace kerf::decks {
namespace {

constexpr int most_errors_of_a_kind = 20;

bool is_parameter_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_'; }

/// Whether a field stands for a value that is defined elsewhere: "&name", "-&name", "<expression>".
bool is_reference(std::string_view text) {
  if (!text.empty() && text.front() == '<') return true;
  if (!text.empty() && text.front() == '-') text.remove_prefix(1);
  return text.size() > 1 && text[0] == '&' && is_parameter_letter(text[1]);
}

FieldMistake no_number(std::string_view text) {
  if (text.find(' ') == std::string_view::npos)
    return {FieldMistake::Kind::of_value, fmt::format("{} is no number", quoted(text))};
  return {FieldMistake::Kind::two_values,
          fmt::format("holds two values, {}: values stand in fixed columns or are separated by commas", quoted(text))};
}

}  // namespace

std::string FieldMistake::message_about(std::string_view field, const FieldText& text) const {
  if (kind == Kind::of_parameter) return message;
  const std::string columns =
      text.width > 0 ? fmt::format(" (columns {}-{})", text.column, text.column + text.width - 1) : "";
  return fmt::format("field {}{}{} {}", upper_case(field), columns, kind == Kind::of_value ? ":" : "", message);
}

bool Block::has_option(std::string_view option) const {
  return std::find(name.options.begin(), name.options.end(), option) != name.options.end();
}

Origin Deck::origin(const Place& place) const {
  if (place.source < 0 || at(place.source) >= sources_.size()) return {};
  return {sources_[at(place.source)].name, place.line, place.column};
}

CardLayout Deck::layout_of(const Block& block) const {
  CardLayout layout;
  if (!block.name.spec) return layout;
  const KeywordSpec& spec = *block.name.spec;
  const bool titled = block.has_option("TITLE") && spec.has(CardWhen::title);
  const bool numbered = block.has_option("ID") || (block.has_option("TITLE") && !titled);
  const bool all_repeat = !spec.has(CardWhen::always);
  std::vector<const CardSpec*>& first = all_repeat ? layout.group : layout.top;
  const auto add = [&](CardWhen when, std::vector<const CardSpec*>& to) {
    for (const CardSpec& card : spec.cards) {
      if (card.when != when) continue;
      // The second card of _MPP is there only where it begins with an ampersand.
      if (when == CardWhen::mpp && card.fields.front().name == "mpp2" &&
          (to.size() >= block.n_cards || without_blanks(cards_of(block)[to.size()].view()).substr(0, 1) != "&"))
        continue;
      to.push_back(&card);
    }
  };
  if (titled) add(CardWhen::title, first);
  if (numbered) add(CardWhen::id, first);
  if (block.has_option("MPP")) add(CardWhen::mpp, first);
  add(CardWhen::always, layout.top);
  add(CardWhen::more, layout.group);
  add(CardWhen::optional, layout.top);
  return layout;
}

void Deck::arrange(Block& block) const {
  block.layout = layout_of(block);
  block.n_repeats = 0;
  const std::size_t n_top = block.layout.top.size(), n_group = block.layout.group.size();
  if (n_group == 0) return;
  std::size_t n = block.n_cards;
  while (n > n_top && is_blank(cards_of(block)[n - 1].view())) --n;
  if (n > n_top) block.n_repeats = (n - n_top + n_group - 1) / n_group;
}

const Card* Deck::card(const Block& block, int number, std::size_t repeat) const {
  const CardLayout& l = block.layout;
  const auto is_it = [&](const CardSpec* card) { return card->number == number; };
  const auto in_top = std::find_if(l.top.begin(), l.top.end(), is_it);
  auto index = static_cast<std::size_t>(in_top - l.top.begin());
  if (in_top == l.top.end()) {
    const auto in_group = std::find_if(l.group.begin(), l.group.end(), is_it);
    if (in_group == l.group.end()) return nullptr;
    index += repeat * l.group.size() + static_cast<std::size_t>(in_group - l.group.begin());
  }
  return index < block.n_cards ? cards_of(block) + index : nullptr;
}

FieldText Deck::field_text(const Block& block, int number, std::string_view name, std::size_t repeat,
                           const FieldSpec** spec) const {
  KERF_ASSERT(block.name.spec, "a field of a keyword that is not in the table");
  const CardSpec* card_spec = block.name.spec->card(number);
  KERF_ASSERT(card_spec, "a card that is not in the table");
  *spec = card_spec->field(name);
  KERF_ASSERT(*spec, "a field that is not in the table");
  const Card* raw = card(block, number, repeat);
  if (!raw) return {{}, (*spec)->column, 0};
  return card_spec->text_of(**spec, raw->view(), block.format);
}

namespace {

/// The place of a field, or of its keyword where its card is missing.
Place place_of_field(const Deck& deck, const Block& block, int number, std::size_t repeat, const FieldText& text) {
  const Card* raw = deck.card(block, number, repeat);
  return raw ? Place{block.source, raw->line, text.column} : deck.place_of(block);
}

}  // namespace

template <class Value>
Field<Value> Deck::number(const Block& block, int number, std::string_view name, std::size_t repeat) const {
  const FieldSpec* spec = nullptr;
  const FieldText text = field_text(block, number, name, repeat, &spec);
  Field<Value> field{static_cast<Value>(spec->number), false, place_of_field(*this, block, number, repeat, text)};
  Value value{};
  if (!text.text.empty() && !read(block, text, value, field.place)) {
    field.value = value;
    field.given = true;
  }
  return field;
}

Field<double> Deck::real(const Block& block, int card, std::string_view field, std::size_t repeat) const {
  return number<double>(block, card, field, repeat);
}

Field<std::int64_t> Deck::integer(const Block& block, int card, std::string_view field, std::size_t repeat) const {
  return number<std::int64_t>(block, card, field, repeat);
}

Field<std::string> Deck::text(const Block& block, int number, std::string_view name, std::size_t repeat) const {
  const FieldSpec* spec = nullptr;
  const FieldText text = field_text(block, number, name, repeat, &spec);
  Field<std::string> field{spec->text, !text.text.empty(), place_of_field(*this, block, number, repeat, text)};
  if (!field.given) return field;
  field.value = to_utf8(text.text);
  if (text.text.front() == '&') {
    const Parameter* parameter = parameters_.find(text.text.substr(1), asker(block));
    if (parameter && parameter->type == 'C') field.value = parameter->text;
  }
  return field;
}

Field<std::int64_t> Deck::first_field(const Block& block) const {
  Field<std::int64_t> id{0, false, place_of(block)};
  const std::size_t first = block.has_option("TITLE") || block.written.ends_with("_TITLE") ? 1 : 0;
  if (first >= block.n_cards) return id;
  const Card& card = cards_of(block)[first];
  const bool commas = card.view().find(',') != std::string_view::npos;
  const FieldText field =
      commas ? comma_fields(card.view())[0] : fixed_field(card.view(), 1, block.format == CardFormat::wide ? 20 : 10);
  Place place{block.source, card.line, field.column};
  if (field.text.empty() || read(block, field, id.value, place)) return {0, false, place};
  return {id.value, true, place};
}

std::string Deck::heading(const Block& block, std::size_t repeat) const {
  if (!block.name.spec) return {};
  for (const CardSpec& spec : block.name.spec->cards) {
    if (spec.when != CardWhen::title && spec.when != CardWhen::id) continue;
    const Card* raw = card(block, spec.number, repeat);
    if (raw) return to_utf8(spec.text_of(spec.fields.back(), raw->view(), block.format).text);
  }
  return {};
}

Asker Deck::asker(const Block& block) const {
  Asker asker{block.order, {}};
  for (std::int32_t s = block.source; s >= 0; s = sources_[at(s)].parent) asker.sources.push_back(s);
  return asker;
}

FieldMistake Deck::read_reference(const Block& block, const FieldText& text, DeckNumber& value, Place& place) const {
  std::string_view inner = text.text;
  std::int32_t skipped = 0;
  if (inner.front() == '<') {
    if (inner.back() != '>')
      return {FieldMistake::Kind::of_value, fmt::format("{} begins an expression that no `>` ends", quoted(inner))};
    inner = inner.substr(1, inner.size() - 2);
    skipped = 1;
  }
  const DeckExpression result = evaluate(inner, parameters_, asker(block));
  value = result.value;
  if (result.ok()) return {};
  // The place within the line: where the text of the field begins, and then the place in it.
  for (std::size_t k = 0; k < block.n_cards; ++k) {
    const Card& card = cards_of(block)[k];
    if (text.text.data() < card.text || text.text.data() >= card.text + card.length) continue;
    place.column = static_cast<std::int32_t>(text.text.data() - card.text) + 1 + skipped + result.offset;
  }
  return {FieldMistake::Kind::of_parameter, result.error};
}

FieldMistake Deck::read(const Block& block, const FieldText& text, double& value, Place& place) const {
  if (read_deck_real(text.text, value)) return {};
  if (!is_reference(text.text)) return no_number(text.text);
  DeckNumber number;
  const FieldMistake mistake = read_reference(block, text, number, place);
  value = number.real;
  return mistake;
}

FieldMistake Deck::read(const Block& block, const FieldText& text, std::int64_t& value, Place& place) const {
  if (read_deck_integer(text.text, value)) return {};
  DeckNumber number;
  if (is_reference(text.text)) {
    if (const FieldMistake mistake = read_reference(block, text, number, place)) return mistake;
  } else if (!read_deck_real(text.text, number.real)) {
    return no_number(text.text);
  }
  value = static_cast<std::int64_t>(std::clamp(number.real, -9e15, 9e15));
  if (static_cast<double>(value) == number.real) return {};
  return {FieldMistake::Kind::of_value, fmt::format("{} is {}, not an integer", quoted(text.text), number.real)};
}

DeckErrors::~DeckErrors() {
  for (const auto& [kind, count] : errors_)
    if (count.n > most_errors_of_a_kind)
      diagnostics_.error(deck_.origin(count.last), fmt::format("and {} more errors of this kind, the last one here: {}",
                                                               count.n - most_errors_of_a_kind, kind));
  for (const auto& [kind, count] : warnings_)
    if (count.n > most_errors_of_a_kind)
      diagnostics_.warning(deck_.origin(count.last), fmt::format("and {} more of this kind, the last one here: {}",
                                                                 count.n - most_errors_of_a_kind, kind));
}

void DeckErrors::error(const Place& place, std::string_view kind, const std::string& message) {
  Count& count = errors_[kind];
  count.last = place;
  if (++count.n <= most_errors_of_a_kind) diagnostics_.error(deck_.origin(place), printable(message));
}

void DeckErrors::warning(const Place& place, std::string_view kind, const std::string& message) {
  Count& count = warnings_[kind];
  count.last = place;
  if (++count.n <= most_errors_of_a_kind) diagnostics_.warning(deck_.origin(place), printable(message));
}

}  // namespace kerf::decks
