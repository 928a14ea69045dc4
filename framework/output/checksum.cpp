// Table-driven CRC-64, eight bytes at a time, and lookup3.
#include "output/checksum.hpp"

#include <array>
#include <bit>
#include <cstring>

namespace kerf {

namespace {

using Tables = std::array<std::array<std::uint64_t, 256>, 8>;

/// Table k holds the remainder of a byte with k zero bytes after it.
constexpr Tables make_tables() {
  constexpr std::uint64_t polynomial = 0xC96C5795D7870F42;  // ECMA-182, reflected
  Tables tables{};
  for (std::uint64_t byte = 0; byte < 256; ++byte) {
    std::uint64_t remainder = byte;
    for (int bit = 0; bit < 8; ++bit) remainder = (remainder >> 1) ^ ((remainder & 1) != 0 ? polynomial : 0);
    tables[0][byte] = remainder;
  }
  for (std::size_t k = 1; k < 8; ++k)
    for (std::size_t byte = 0; byte < 256; ++byte)
      tables[k][byte] = (tables[k - 1][byte] >> 8) ^ tables[0][tables[k - 1][byte] & 0xFF];
  return tables;
}

constexpr Tables tables = make_tables();

std::uint32_t word_at(const std::byte* bytes, std::size_t n) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes, n);
  return word;
}

}  // namespace

static_assert(std::endian::native == std::endian::little, "the files are little-endian and written as they are");

std::uint64_t crc64(std::span<const std::byte> bytes, std::uint64_t so_far) {
  std::uint64_t crc = ~so_far;
  const std::byte* at = bytes.data();
  std::size_t left = bytes.size();
  for (; left >= 8; left -= 8, at += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, at, 8);
    word ^= crc;
    crc = 0;
    for (std::size_t k = 0; k < 8; ++k) crc ^= tables[7 - k][(word >> (8 * k)) & 0xFF];
  }
  for (; left > 0; --left, ++at) crc = (crc >> 8) ^ tables[0][(crc ^ std::to_integer<std::uint64_t>(*at)) & 0xFF];
  return ~crc;
}

std::uint32_t lookup3(std::span<const std::byte> bytes) {
  using std::rotl;
  std::uint32_t a = 0xDEADBEEF + static_cast<std::uint32_t>(bytes.size()), b = a, c = a;
  const std::byte* at = bytes.data();
  std::size_t left = bytes.size();
  for (; left > 12; left -= 12, at += 12) {
    a += word_at(at, 4);
    b += word_at(at + 4, 4);
    c += word_at(at + 8, 4);
    a = (a - c) ^ rotl(c, 4), c += b;
    b = (b - a) ^ rotl(a, 6), a += c;
    c = (c - b) ^ rotl(b, 8), b += a;
    a = (a - c) ^ rotl(c, 16), c += b;
    b = (b - a) ^ rotl(a, 19), a += c;
    c = (c - b) ^ rotl(b, 4), b += a;
  }
  if (left == 0) return c;
  const auto rest = [&](std::size_t first) {
    return left > first ? word_at(at + first, left - first < 4 ? left - first : 4) : 0;
  };
  a += rest(0);
  b += rest(4);
  c += rest(8);
  c = (c ^ b) - rotl(b, 14);
  a = (a ^ c) - rotl(c, 11);
  b = (b ^ a) - rotl(a, 25);
  c = (c ^ b) - rotl(b, 16);
  a = (a ^ c) - rotl(c, 4);
  b = (b ^ a) - rotl(a, 14);
  c = (c ^ b) - rotl(b, 24);
  return c;
}

}  // namespace kerf
