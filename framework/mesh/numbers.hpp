// Numbers in the text of a file, read where they stand.
#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>

namespace kerf {

/// Reads an integer at `p`. Returns where it ends, or null where there is none.
inline const char* read_integer(const char* p, const char* end, std::int64_t& value) {
  if (p != end && *p == '+') ++p;
  const auto [stop, error] = std::from_chars(p, end, value);
  return error == std::errc{} ? stop : nullptr;
}

/// Reads a finite number at `p`; the exponent may follow a D, as Fortran writes it. Returns where it ends, or null.
inline const char* read_real(const char* p, const char* end, double& value) {
  if (p != end && *p == '+') ++p;
  auto [stop, error] = std::from_chars(p, end, value);
  if (error != std::errc{} || !std::isfinite(value)) return nullptr;
  if (stop == end || (*stop != 'd' && *stop != 'D')) return stop;
  std::int64_t exponent = 0;
  const char* last = read_integer(stop + 1, end, exponent);
  if (!last) return nullptr;
  const std::string text = std::string(p, stop) + "e" + std::to_string(exponent);
  const auto whole = std::from_chars(text.data(), text.data() + text.size(), value);
  return whole.ec == std::errc{} && whole.ptr == text.data() + text.size() ? last : nullptr;
}

}  // namespace kerf
