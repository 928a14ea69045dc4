// Lines of an Abaqus deck, and the fields between their commas.
#pragma once

#include <cctype>
#include <cstring>
#include <string>
#include <string_view>

#include "kerf/file_mesh.hpp"
#include "mesh/numbers.hpp"

namespace kerf::abaqus {

inline std::string_view trimmed(std::string_view text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front()))) text.remove_prefix(1);
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.remove_suffix(1);
  return text;
}

/// Lines that are neither comments nor empty.
class DeckLines {
 public:
  explicit DeckLines(std::string_view bytes) : p_(bytes.data()), end_(p_ + bytes.size()) {}
  /// Goes to the next line; false at the end of the file.
  bool next();
  std::string_view line() const { return line_; }
  std::int32_t number() const { return number_; }
  bool is_keyword() const { return line_.starts_with('*'); }
  bool goes_on() const { return line_.ends_with(','); }
  FilePlace place_of(const char* p) const { return {number_, static_cast<std::int32_t>(p - begin_) + 1}; }

 private:
  const char *p_, *end_, *begin_ = nullptr;
  std::string_view line_;
  std::int32_t number_ = 0;
};

inline bool DeckLines::next() {
  while (p_ != end_) {
    begin_ = p_;
    const void* newline = std::memchr(p_, '\n', static_cast<std::size_t>(end_ - p_));
    const char* stop = newline ? static_cast<const char*>(newline) : end_;
    p_ = newline ? stop + 1 : end_;
    ++number_;
    line_ = trimmed({begin_, static_cast<std::size_t>(stop - begin_)});
    if (!line_.empty() && !line_.starts_with("**")) return true;
  }
  return false;
}

/// Fields of a line between commas.
class Fields {
 public:
  explicit Fields(std::string_view line) : p_(line.data()), end_(p_ + line.size()) {}
  bool at_end() const { return p_ == end_; }
  const char* at() const { return p_; }
  std::string_view text() {
    const void* comma = std::memchr(p_, ',', static_cast<std::size_t>(end_ - p_));
    const char* stop = comma ? static_cast<const char*>(comma) : end_;
    const std::string_view field(p_, static_cast<std::size_t>(stop - p_));
    p_ = comma ? stop + 1 : end_;
    return trimmed(field);
  }
  bool integer(std::int64_t& value) { return number(&read_integer, value); }
  /// A field that is blank is zero.
  bool real(double& value) {
    value = 0.0;
    skip_blanks();
    if (p_ != end_ && *p_ == ',') return ++p_, true;
    return p_ == end_ || number(&read_real, value);
  }

 private:
  void skip_blanks() {
    while (p_ != end_ && (*p_ == ' ' || *p_ == '\t')) ++p_;
  }
  template <class Value>
  bool number(const char* (*read)(const char*, const char*, Value&), Value& value) {
    skip_blanks();
    const char* stop = read(p_, end_, value);
    if (!stop) return false;
    const char* before = p_;
    p_ = stop;
    skip_blanks();
    if (p_ == end_) return true;
    if (*p_ == ',') return ++p_, true;
    p_ = before;
    return false;
  }
  const char *p_, *end_;
};

}  // namespace kerf::abaqus
