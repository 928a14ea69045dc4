// Checksums: a 64-bit one that guards what Kerf reads back, and the 32-bit one that HDF5 asks for in its headers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace kerf {

/// CRC-64 with the polynomial of ECMA-182, bits reflected. It sees every error within 64 neighbouring bits for certain
/// and misses one in 2^64 of all others. `so_far` is the checksum of what comes before.
std::uint64_t crc64(std::span<const std::byte> bytes, std::uint64_t so_far = 0);

/// Bob Jenkins' hash "lookup3" of a text of bytes, from the initial value 0.
std::uint32_t lookup3(std::span<const std::byte> bytes);

}  // namespace kerf
