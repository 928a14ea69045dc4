// Fields of a CSV text with their places.
#include "input/csv_table.hpp"

#include <fmt/format.h>

#include <array>
#include <memory>
#include <string_view>

#include "core/units.hpp"
#include "input/number_list.hpp"
#include "input/parameter_text.hpp"

namespace kerf {

namespace {

struct Field {
  std::string_view text;  // without spaces at its ends
  int column = 1;  // of its first character, from one
};

std::vector<Field> fields_of(std::string_view line) {
  std::vector<Field> fields;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    const std::string_view whole = line.substr(begin, end - begin), text = trimmed(whole);
    const std::size_t blanks = text.empty() ? 0 : static_cast<std::size_t>(text.data() - whole.data());
    fields.push_back({text, static_cast<int>(begin + blanks) + 1});
    begin = end + 1;
  }
  return fields;
}

/// Lines that hold data or the heading, with their numbers from one.
struct Line {
  std::string_view text;
  int number = 0;
};

std::vector<Line> lines_of(std::string_view text) {
  std::vector<Line> lines;
  int number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string_view line = text.substr(begin, end - begin);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    ++number;
    if (const std::string_view content = trimmed(line); !content.empty() && content.front() != '#')
      lines.push_back({line, number});
    begin = end + 1;
  }
  return lines;
}

/// The position of a chosen column, from zero; -1, with an error, where there is none.
int position_of(const std::string& chosen, const std::vector<Field>& heading, const Origin& where,
                Diagnostics& diagnostics) {
  std::vector<std::string> names;
  for (const Field& f : heading) names.emplace_back(f.text);
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == chosen) return static_cast<int>(i);
  long long number = 0;
  if (parse_integer(chosen, number)) {
    if (number >= 1 && number <= static_cast<long long>(names.size())) return static_cast<int>(number) - 1;
    diagnostics.error(where, fmt::format("there is no column {}; this line has {} field{}", chosen, names.size(),
                                         names.size() == 1 ? "" : "s"));
  } else {
    diagnostics.error(where, fmt::format("there is no column \"{}\"{}", chosen,
                                         suggestion(chosen, names, "the fields of the heading")));
  }
  return -1;
}

}  // namespace

CsvColumns read_csv_columns(const std::string& text, const std::string& file, const std::vector<std::string>& chosen,
                            Diagnostics& diagnostics) {
  const auto name = std::make_shared<const std::string>(file);
  CsvColumns columns;
  const std::vector<Line> lines = lines_of(text);
  if (lines.empty()) {
    diagnostics.error(Origin{name, 1, 1}, "the file holds no numbers; expected at least one line of them");
    return columns;
  }
  const std::vector<Field> first = fields_of(lines.front().text);
  std::array<int, 2> position{};
  bool is_heading = false;
  for (std::size_t k = 0; k < 2; ++k) {
    position[k] = position_of(chosen[k], first, Origin{name, lines.front().number, 1}, diagnostics);
    if (position[k] < 0) return columns;
    double unused = 0.0;
    is_heading = is_heading || !parse_number(first[static_cast<std::size_t>(position[k])].text, unused);
  }
  for (std::size_t l = is_heading ? 1 : 0; l < lines.size(); ++l) {
    const std::vector<Field> fields = fields_of(lines[l].text);
    std::array<double, 2> value{};
    for (std::size_t k = 0; k < 2; ++k) {
      const auto i = static_cast<std::size_t>(position[k]);
      if (i >= fields.size()) {
        diagnostics.error(Origin{name, lines[l].number, 1},
                          fmt::format("the line has {} field{}, and column {} is asked for; expected a number there",
                                      fields.size(), fields.size() == 1 ? "" : "s", chosen[k]));
        return columns;
      }
      if (!parse_number(fields[i].text, value[k])) {
        diagnostics.error(
            Origin{name, lines[l].number, fields[i].column},
            fmt::format("\"{}\" is not a number; expected one without unit, for example 2.5e-6", fields[i].text));
        return columns;
      }
    }
    columns.first.push_back(value[0]);
    columns.second.push_back(value[1]);
    columns.line.push_back(lines[l].number);
    columns.column.push_back(fields[static_cast<std::size_t>(position[0])].column);
  }
  if (columns.first.empty())
    diagnostics.error(Origin{name, lines.front().number, 1},
                      "no line of numbers follows the heading; expected at least one");
  return columns;
}

CsvTable read_csv_table(const std::string& text, const std::string& file, Diagnostics& diagnostics) {
  const auto name = std::make_shared<const std::string>(file);
  CsvTable table;
  const std::vector<Line> lines = lines_of(text);
  if (lines.size() < 2) {
    diagnostics.error(Origin{name, 1, 1},
                      "the file holds no table; expected a heading and at least one line of numbers");
    return table;
  }
  for (const Field& f : fields_of(lines.front().text)) table.headings.emplace_back(f.text);
  table.n_rows = lines.size() - 1;
  std::vector<std::vector<double>> values(table.headings.size());
  for (std::size_t l = 1; l < lines.size(); ++l) {
    const std::vector<Field> fields = fields_of(lines[l].text);
    if (fields.size() != table.headings.size()) {
      diagnostics.error(Origin{name, lines[l].number, 1},
                        fmt::format("the line has {} field{}; expected {}, as many as the heading", fields.size(),
                                    fields.size() == 1 ? "" : "s", table.headings.size()));
      return table;
    }
    for (std::size_t c = 0; c < fields.size(); ++c)
      if (double value = 0.0; parse_number(fields[c].text, value)) values[c].push_back(value);
  }
  for (std::size_t c = 0; c < values.size(); ++c)
    if (values[c].size() == table.n_rows) table.columns[table.headings[c]] = std::move(values[c]);
  return table;
}

}  // namespace kerf
