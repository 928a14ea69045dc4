// Records of a Gmsh file, read the same way from text and from binary files of either byte order.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "mesh/mesh_file.hpp"
#include "mesh/numbers.hpp"

namespace kerf {

/// Walks through the sections of a file. In text a record is a line, in binary files it is what its fields fill.
class GmshSource {
 public:
  explicit GmshSource(std::string_view bytes)
      : begin_(bytes.data()), p_(begin_), end_(p_ + bytes.size()), line_begin_(p_) {}

  bool binary = false, swapped = false;
  int size_bytes = 8;  // of what Gmsh calls size_t

  /// Goes to the next line that begins with '$' and takes it; what follows the '$', or empty at the end of the file.
  std::string_view next_section();
  /// Goes behind the line "$End<name>"; false where there is none.
  bool leave_section(std::string_view name);
  /// Whether the next record is the end of a section or of the file.
  bool at_section_end();

  /// Starts a record; false where there is none before the end of the section.
  bool begin_record() { return binary ? p_ < end_ : !at_section_end(); }
  /// Starts a record that is text in binary files, too.
  bool begin_text_record() { return !at_section_end(); }
  /// Ends a record; false where something is left on its line.
  bool end_record() { return binary || end_text_record(); }
  bool end_text_record();
  /// Goes to the end of the line; true.
  bool skip_line() {
    p_ += rest_of_line().size();
    return true;
  }
  /// What is left of the line; the record must still be ended.
  std::string_view rest_of_line() const;

  bool text_integer(std::int64_t& value) { return field(&read_integer, value); }
  bool text_real(double& value) { return field(&read_real, value); }
  /// A number of four bytes in binary files.
  bool integer(std::int64_t& value) { return binary ? number<std::int32_t>(value) : text_integer(value); }
  /// A number of `size_bytes` bytes in binary files.
  bool size(std::int64_t& value) {
    if (!binary) return text_integer(value);
    return size_bytes == 4 ? number<std::int32_t>(value) : number<std::int64_t>(value);
  }
  bool real(double& value) { return binary ? number<double>(value) && std::isfinite(value) : text_real(value); }

  /// Bytes that are left: no count can be larger, for everything that is counted takes a byte.
  std::int64_t bytes_left() const { return end_ - p_; }
  FilePlace place() const {
    if (binary) return {};
    return {line_, static_cast<std::int32_t>(p_ - line_begin_) + 1};
  }

 private:
  void skip_blanks() {
    while (p_ != end_ && (*p_ == ' ' || *p_ == '\t')) ++p_;
  }
  void to_next_line();

  template <class Value>
  bool field(const char* (*read)(const char*, const char*, Value&), Value& value) {
    skip_blanks();
    const char* stop = read(p_, end_, value);
    if (!stop || (stop != end_ && *stop != ' ' && *stop != '\t' && *stop != '\n' && *stop != '\r')) return false;
    p_ = stop;
    return true;
  }

  template <class Stored, class Value>
  bool number(Value& value) {
    if (bytes_left() < static_cast<std::int64_t>(sizeof(Stored))) return false;
    unsigned char bytes[sizeof(Stored)];
    for (std::size_t i = 0; i < sizeof(Stored); ++i)
      bytes[swapped ? sizeof(Stored) - 1 - i : i] = static_cast<unsigned char>(p_[i]);
    Stored stored;
    std::memcpy(&stored, bytes, sizeof(Stored));
    p_ += sizeof(Stored);
    value = stored;
    return true;
  }

  const char *begin_, *p_, *end_, *line_begin_;
  std::int32_t line_ = 1;
};

inline void GmshSource::to_next_line() {
  const void* newline = std::memchr(p_, '\n', static_cast<std::size_t>(end_ - p_));
  p_ = newline ? static_cast<const char*>(newline) + 1 : end_;
  line_begin_ = p_;
  ++line_;
}

inline bool GmshSource::at_section_end() {
  for (;;) {
    while (p_ != end_ && (*p_ == ' ' || *p_ == '\t' || *p_ == '\r')) ++p_;
    if (p_ == end_ || *p_ != '\n') return p_ == end_ || *p_ == '$';
    to_next_line();
  }
}

inline std::string_view GmshSource::rest_of_line() const {
  const char* stop = p_;
  while (stop != end_ && *stop != '\n') ++stop;
  while (stop != p_ && (stop[-1] == '\r' || stop[-1] == ' ' || stop[-1] == '\t')) --stop;
  return {p_, stop};
}

inline bool GmshSource::end_text_record() {
  skip_blanks();
  const bool complete = p_ == end_ || *p_ == '\n' || *p_ == '\r';
  to_next_line();
  return complete;
}

inline std::string_view GmshSource::next_section() {
  while (!at_section_end()) to_next_line();
  if (p_ == end_) return {};
  ++p_;
  const std::string_view name = rest_of_line();
  to_next_line();
  return name;
}

inline bool GmshSource::leave_section(std::string_view name) {
  const std::string_view rest(p_, static_cast<std::size_t>(end_ - p_));
  const std::string mark = "$End" + std::string(name);
  const std::size_t at = rest.find(mark);
  if (at == std::string_view::npos) return false;
  if (binary)
    p_ += at;
  else
    while (rest.data() + at >= p_) to_next_line();
  if (binary) to_next_line();
  return true;
}

}  // namespace kerf
