// Lists of numbers in one text.
#include "input/number_list.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <string_view>

#include "core/units.hpp"

namespace kerf {
namespace {

std::vector<std::string> split_at_commas(std::string_view text) {
  std::vector<std::string> parts;
  if (trimmed(text).empty()) return parts;
  while (true) {
    const std::size_t comma = text.find(',');
    parts.emplace_back(trimmed(text.substr(0, comma)));
    if (comma == text.npos) return parts;
    text.remove_prefix(comma + 1);
  }
}

QuantityList in_one_unit(const std::vector<std::string>& numbers, std::string_view unit, const std::string& si_unit) {
  QuantityList list;
  for (const std::string& number : numbers) {
    double bare = 0.0;
    if (!unit.empty() && !parse_number(number, bare))
      return {{}, fmt::format("\"{}\" is not a number; where a unit follows the list, its items take none", number)};
    const Quantity q = to_si(unit.empty() ? number : fmt::format("{} {}", number, unit), si_unit);
    if (!q.ok()) return {{}, q.error};
    list.values.push_back(q.value);
  }
  return list;
}

}  // namespace

QuantityList items_to_si(const std::vector<std::string>& items, const std::string& si_unit) {
  QuantityList list;
  bool some_unit = false, some_bare = false;
  for (const std::string& item : items) {
    const Quantity q = to_si(item, si_unit);
    if (!q.ok()) return {{}, q.error};
    double bare = 0.0;
    const bool is_bare = parse_number(item, bare);
    some_unit = some_unit || !is_bare;
    some_bare = some_bare || (is_bare && bare != 0.0);
    list.values.push_back(q.value);
  }
  // [1, 2, 3 mm] would otherwise be one metre, two metres and three millimetres.
  if (some_unit && some_bare)
    return {{}, "some numbers have a unit and others have none; expected a unit for each, or one after the whole list"};
  return list;
}

QuantityList list_to_si(const std::string& text, const std::string& si_unit) {
  std::string_view rest = trimmed(text);
  if (!rest.empty() && rest.front() == '[') {
    const std::size_t close = rest.find(']');
    if (close == rest.npos) return {{}, fmt::format("\"{}\" has no closing bracket", text)};
    const std::vector<std::string> items = split_at_commas(rest.substr(1, close - 1));
    const std::string_view unit = trimmed(rest.substr(close + 1));
    return unit.empty() ? items_to_si(items, si_unit) : in_one_unit(items, unit, si_unit);
  }
  // Numbers as long as there are any; what is left is the unit.
  std::vector<std::string> numbers;
  while (!rest.empty()) {
    const std::string_view word = rest.substr(0, rest.find_first_of(" ,\t\n"));
    double value = 0.0;
    if (!parse_number(word, value)) break;
    numbers.emplace_back(word);
    rest = trimmed(rest.substr(word.size()));
    if (!rest.empty() && rest.front() == ',') rest = trimmed(rest.substr(1));
  }
  if (numbers.empty()) return items_to_si({text}, si_unit);
  return in_one_unit(numbers, rest, si_unit);
}

bool parse_integer(const std::string& text, long long& value) {
  const std::string_view digits = trimmed(text);
  const auto [end, status] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (status == std::errc() && end == digits.data() + digits.size()) return true;
  double real = 0.0;
  if (!parse_number(digits, real) || real != std::floor(real) || std::fabs(real) > 9007199254740992.0) return false;
  value = static_cast<long long>(real);
  return true;
}

}  // namespace kerf
