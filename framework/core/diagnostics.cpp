// Formatting of error lines, and the search for the name that a user may have meant.
#include "core/diagnostics.hpp"

#include <algorithm>
#include <cctype>
#include <utility>

namespace kerf {
namespace {

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += (text.empty() ? "" : "\n") + line;
  return text;
}

std::string line_of(const std::string& where, const char* severity, const std::string& message) {
  return (where.empty() ? "" : where + ": ") + severity + ": " + message;
}

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

// Insertions, deletions, replacements and swaps of neighbours that turn `a` into `b`.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i)
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, replaced});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  return d[a.size()][b.size()];
}

}  // namespace

std::string Origin::text() const {
  if (!file) return {};
  return line > 0 ? *file + ":" + std::to_string(line) + ":" + std::to_string(column) : *file;
}

InputError::InputError(std::vector<std::string> lines) : std::runtime_error(joined(lines)), lines_(std::move(lines)) {}

void Diagnostics::error(const Origin& where, const std::string& message) { error(where.text(), message); }

void Diagnostics::error(const std::string& where, const std::string& message) {
  errors_.push_back(line_of(where, "error", message));
}

void Diagnostics::warning(const Origin& where, const std::string& message) {
  warnings_.push_back(line_of(where.text(), "warning", message));
}

void Diagnostics::throw_if_errors() const {
  if (has_errors()) throw InputError(errors_);
}

std::string nearest_name(const std::string& name, const std::vector<std::string>& candidates) {
  const std::string wanted = lower(name);
  std::string nearest;
  std::size_t least = std::max<std::size_t>(1, wanted.size() / 3) + 1;  // a third of the letters may be wrong
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(wanted, lower(candidate));
    if (distance < least) {
      least = distance;
      nearest = candidate;
    }
  }
  if (!nearest.empty() || wanted.size() < 3) return nearest;
  for (const std::string& candidate : candidates)  // an abbreviation
    if (lower(candidate).rfind(wanted, 0) == 0) return candidate;
  return {};
}

}  // namespace kerf
