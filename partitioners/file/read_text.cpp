// Reads the parts of elements from lines of text, and tells every line that is wrong.
#include <algorithm>
#include <charconv>
#include <fstream>
#include <map>
#include <numeric>

#include "division.hpp"

namespace kerf {
namespace {

constexpr std::size_t most_complaints = 20;

struct Line {
  std::int64_t number, element, part;
};

/// Reads one whole number from the front of a text and moves on; false where there is none.
bool take_number(std::string_view& text, std::int64_t& value) {
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc()) return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return true;
}

std::string_view without_blanks(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t' || text.front() == '\r')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r')) text.remove_suffix(1);
  return text;
}

/// "element part" or "element, part".
bool parse(std::string_view text, Line& line) {
  if (!take_number(text, line.element)) return false;
  const std::size_t before = text.size();
  text = without_blanks(text);
  const bool comma = !text.empty() && text.front() == ',';
  if (comma) text = without_blanks(text.substr(1));
  if (!comma && text.size() == before) return false;  // nothing between the numbers
  return take_number(text, line.part) && text.empty();
}

class TextReader {
 public:
  explicit TextReader(const DivisionRequest& request) : request_(request) {}

  FoundDivision read() {
    std::ifstream file(request_.path);
    if (!file) {
      found_.complaints.push_back(request_.path + ": error: the file with the parts of elements cannot be read");
      return found_;
    }
    std::string text;
    for (std::int64_t number = 1; std::getline(file, text); ++number) take(number, text);
    if (lines_.empty() && found_.complaints.empty())
      found_.complaints.push_back(request_.path + ": error: no line has an element and its part");
    refuse_twice();
    if (found_.complaints.empty()) finish();
    if (n_complaints_ > most_complaints)
      found_.complaints.push_back(request_.path + ": error: " + std::to_string(n_complaints_ - most_complaints) +
                                  " more lines are wrong");
    return found_;
  }

 private:
  void complain(std::int64_t number, const std::string& sentence) {
    if (++n_complaints_ <= most_complaints)
      found_.complaints.push_back(request_.path + ":" + std::to_string(number) + ": error: " + sentence);
  }

  void take(std::int64_t number, const std::string& whole) {
    const std::string_view text = without_blanks(std::string_view(whole).substr(0, whole.find('#')));
    if (text.empty()) return;
    Line line{number, 0, 0};
    if (!parse(text, line))
      complain(number, "\"" + std::string(text) + "\" is no element and its part; expected two whole numbers");
    else if (line.element < 0 || line.element >= request_.n_elements)
      complain(number, "there is no element " + std::to_string(line.element) + "; expected a number from 0 to " +
                           std::to_string(request_.n_elements - 1));
    else if (line.part < 0 || line.part > 0x7ffffffe)
      complain(number, "part " + std::to_string(line.part) + " is out of range; expected a number from 0 on");
    else
      lines_.push_back(line);
  }

  void refuse_twice() {
    const auto before = [](const Line& a, const Line& b) {
      return a.element != b.element ? a.element < b.element : a.number < b.number;
    };
    std::sort(lines_.begin(), lines_.end(), before);
    for (std::size_t i = 1; i < lines_.size(); ++i)
      if (lines_[i].element == lines_[i - 1].element)
        complain(lines_[i].number, "element " + std::to_string(lines_[i].element) + " has a part already, in line " +
                                       std::to_string(lines_[i - 1].number));
  }

  void finish() {
    Division& d = found_.division;
    for (const Line& line : lines_) {
      d.ids.push_back(line.element);
      d.parts.push_back(static_cast<std::int32_t>(line.part));
      d.n_parts = std::max(d.n_parts, static_cast<int>(line.part) + 1);
      std::int64_t& first = found_.line_beyond;
      if (line.part >= request_.n_parts && (first == 0 || line.number < first)) first = line.number;
    }
    found_.found = d.n_parts == request_.n_parts;
    if (!found_.found) found_.other_counts.push_back(d.n_parts);
  }

  const DivisionRequest& request_;
  FoundDivision found_;
  std::vector<Line> lines_;
  std::size_t n_complaints_ = 0;
};

}  // namespace

FoundDivision read_text_division(const DivisionRequest& request) { return TextReader(request).read(); }

}  // namespace kerf
