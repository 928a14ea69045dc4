// Cuts files into blocks of cards, and does what the keywords of the form ask for.
#include "decks/deck_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>

namespace kerf::decks {
namespace {

int whole(std::string_view text) {
  int value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  return status == std::errc() && end == text.data() + text.size() && value > 0 ? value : 0;
}

/// The number that follows `key` in "MEMORY=20M CID=2", or 0. `text` is in upper case.
int number_after(std::string_view text, std::string_view key) {
  const std::size_t at = text.find(key);
  if (at == std::string_view::npos) return 0;
  std::size_t end = at + key.size();
  while (end < text.size() && text[end] >= '0' && text[end] <= '9') ++end;
  return whole(text.substr(at + key.size(), end - at - key.size()));
}

/// The number at the end of "CASE_BEGIN_2", or 0.
int number_at_end(const std::string& name) { return whole(std::string_view(name).substr(name.rfind('_') + 1)); }

}  // namespace

void DeckReader::read(const std::string& path) {
  if (options_.case_number > 0) active_cases_.insert(options_.case_number);
  const std::int32_t source = open(path, {}, -1);
  if (source < 0) return;
  read_source(source);
  if (open_case_ > 0)
    errors_.error(open_case_place_, "open cases",
                  fmt::format("*CASE_BEGIN_{} has no *CASE_END_{}", open_case_, open_case_));
  check_case();
}

void DeckReader::check_case() const {
  if (options_.case_number == 0 || seen_cases_.count(options_.case_number) > 0) return;
  std::string known;
  for (const int number : seen_cases_) known += (known.empty() ? "" : ", ") + std::to_string(number);
  errors_.error({0, 1, 1}, "cases",
                fmt::format("there is no case {}; {}", options_.case_number,
                            known.empty() ? "the deck has no cases" : "the cases are: " + known));
}

void DeckReader::read_source(std::int32_t source) {
  const std::shared_ptr<const std::string> bytes = deck_.sources_[static_cast<std::size_t>(source)].bytes;
  std::string_view rest(*bytes);
  if (is_blank(rest.substr(0, 4096)) && is_blank(rest)) {
    errors_.error({source, 1, 1}, "empty files", "the file is empty");
    return;
  }
  bool complained = false, ended = false;
  in_block_ = false;
  for (std::int32_t number = 1; !rest.empty() && !ended; ++number) {
    const std::size_t end = rest.find('\n');
    std::string_view line = rest.substr(0, end);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (!line.empty() && line.front() == '$') continue;
    if (!line.empty() && line.front() == '*') {
      if (in_block_) finish_block();
      ended = !start_block(source, line, number);
    } else if (in_block_) {
      deck_.cards_.push_back({line.data(), static_cast<std::uint32_t>(line.size()), number});
      ++deck_.blocks_.back().n_cards;
    } else if (!complained && !is_blank(line)) {
      complained = true;
      errors_.error({source, number, 1}, "text before keywords",
                    "text before the first keyword; is this a keyword deck?");
    }
  }
  if (in_block_) finish_block();
}

bool DeckReader::start_block(std::int32_t source, std::string_view line, std::int32_t number) {
  Block block;
  const std::size_t blank = std::min(line.find_first_of(" \t("), line.size());
  block.written = upper_case(printable(line.substr(1, blank - 1)));
  block.rest = upper_case(without_blanks(line.substr(blank)));
  block.source = source;
  block.line = number;
  block.order = order_++;
  block.first_card = deck_.cards_.size();
  block.format = deck_.sources_[static_cast<std::size_t>(source)].format;
  const auto take_sign = [&](std::string& text) {
    const char sign = text.empty() ? ' ' : text.back();
    if (sign != '+' && sign != '-' && sign != '%') return;
    block.format = sign == '+' ? CardFormat::wide : sign == '-' ? CardFormat::standard : CardFormat::i10;
    text.pop_back();
  };
  take_sign(block.written);
  if (block.rest.size() == 1) take_sign(block.rest);
  block.name = keyword_named(block.written);
  if (block.base() == "END") return false;
  deck_.blocks_.push_back(std::move(block));
  in_block_ = true;
  return true;
}

void DeckReader::finish_block() {
  in_block_ = false;
  deck_.arrange(deck_.blocks_.back());
  Block block = deck_.blocks_.back();
  const std::string& base = block.base();
  if (base == "CASE_BEGIN" || base == "CASE_END") return open_or_close_case(block);
  if (base == "CASE") return read_case(block);
  if (!is_active(block)) {
    deck_.cards_.resize(block.first_card);
    deck_.blocks_.pop_back();
    return;
  }
  ++deck_.counts_[block.written.substr(0, 80)];
  if (block.name.use == KeywordUse::unknown) {
    const std::string near = nearest_keyword(block.base()), physics = physics_of_group(block.base());
    const std::string message =
        fmt::format("unknown keyword *{}{}", shortened(block.written),
                    !physics.empty() ? fmt::format(": its group is about {}, which Kerf does not compute", physics)
                    : near.empty()   ? "; no keyword of this name is known"
                                     : "; did you mean *" + near + "?");
    if (!physics.empty() && options_.unknown_is_left_out)
      errors_.warning(deck_.place_of(block), "unknown keywords", message + "; left out");
    else
      errors_.error(deck_.place_of(block), "unknown keywords", message);
    return;
  }
  if (base == "KEYWORD") read_keyword(deck_.blocks_.back());
  if (base == "TITLE" && block.n_cards > 0) deck_.title_ = to_utf8(without_blanks(card_of(block, 0).view()));
  if (base == "PARAMETER" || base == "PARAMETER_LOCAL" || base == "PARAMETER_MUTABLE") read_parameters(block);
  if (base.rfind("PARAMETER_EXPRESSION", 0) == 0) read_expressions(block);
  if (base == "DEFINE_TRANSFORMATION") read_transformation(block);
  if (base == "INCLUDE") read_includes(block);
  if (base == "INCLUDE_PATH" || base == "INCLUDE_PATH_RELATIVE") read_include_path(block);
  if (base == "INCLUDE_TRANSFORM") read_include_transform(block);
  if (base.rfind("INCLUDE_", 0) == 0 && block.name.use == KeywordUse::foreign)
    errors_.error(deck_.place_of(block), "includes",
                  fmt::format("*{} is not read; *INCLUDE and *INCLUDE_TRANSFORM are", block.written));
}

void DeckReader::read_keyword(Block& block) {
  Source* source = source_of(block);
  const std::size_t at = block.rest.find("LONG=");
  if (at != std::string::npos && at + 5 < block.rest.size()) {
    const char value = block.rest[at + 5];
    source->format = value == 'Y' ? CardFormat::wide : CardFormat::standard;
    if (value != 'Y' && value != 'S' && value != 'K' && value != 'N')
      errors_.error(
          deck_.place_of(block), "formats",
          fmt::format("\"{}\" is no format of *KEYWORD; expected LONG=Y, LONG=S or LONG=K", shortened(block.rest)));
  }
  if (block.rest.find("I10=Y") != std::string::npos) source->format = CardFormat::i10;
}

bool DeckReader::is_active(const Block& block) const {
  const int of_block = number_after(block.rest, "CID=");
  return (open_case_ == 0 || active_cases_.count(open_case_) > 0) &&
         (of_block == 0 || active_cases_.count(of_block) > 0);
}

// A case has a number, the text of a command line, and the numbers of the subcases that *CASE_BEGIN_n opens.
void DeckReader::read_case(const Block& block) {
  if (block.n_cards == 0) return;
  const std::string_view first = card_of(block, 0).view();
  const std::string_view number = without_blanks(first.substr(0, std::min<std::size_t>(10, first.find(','))));
  const int id = whole(number);
  if (id == 0) {
    errors_.error({block.source, card_of(block, 0).line, 1}, "cases",
                  fmt::format("\"{}\" is no number of a case", shortened(number)));
    return;
  }
  seen_cases_.insert(id);
  if (id != options_.case_number) return;
  active_cases_.clear();
  for (std::size_t k = 2; k < block.n_cards; ++k) {
    const std::string_view text = card_of(block, k).view();
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t end = std::min(text.find_first_of(" ,\t", at), text.size());
      if (const int subcase = whole(text.substr(at, end - at)); subcase > 0) active_cases_.insert(subcase);
      at = end + 1;
    }
  }
}

void DeckReader::open_or_close_case(const Block& block) {
  const bool begins = block.base() == "CASE_BEGIN";
  const int number = number_at_end(block.written);
  const Place place = deck_.place_of(block);
  if (number == 0) return errors_.error(place, "cases", fmt::format("*{} has no number", shortened(block.written)));
  if (begins && open_case_ > 0)
    errors_.error(place, "cases", fmt::format("case {} begins within case {}", number, open_case_));
  if (!begins && open_case_ != number)
    errors_.error(place, "cases", fmt::format("case {} ends, but it has not begun", number));
  seen_cases_.insert(number);
  open_case_ = begins ? number : 0;
  open_case_place_ = place;
}

Deck read_deck(const std::string& path, const DeckOptions& options, Diagnostics& diagnostics) {
  Deck deck;
  DeckReader(deck, options, diagnostics).read(path);
  return deck;
}

}  // namespace kerf::decks
