// The beginning of a file of Kerf's: HDF5's superblock, and behind it Kerf's own record of 80 bytes.
//
//   0  superblock (48 bytes)        72 place of the packed description    104 checksum of image and description
//  48  "KerfFile"                   80 its size                           112 0
//  56  place of the image           88 size of the file                   120 checksum of all bytes before
//  64  size of the image            96 0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace kerf::hdf5 {

constexpr std::uint64_t front_size = 128;

/// What the record behind the superblock says.
struct Front {
  std::uint64_t image = 0, image_size = 0, index = 0, index_size = 0, file_size = 0, checksum = 0;
};

/// The first 128 bytes of a file whose outermost group has its header at `root`.
std::vector<std::byte> front_bytes(const Front& front, std::uint64_t root);

/// Whether bytes begin as a file of Kerf's.
bool has_front(std::span<const std::byte> bytes);

/// The record in the first 128 bytes. Throws std::runtime_error where they are damaged or none of Kerf's: the end of a
/// sentence that begins with the name of the file.
Front front_of(std::span<const std::byte> bytes);

}  // namespace kerf::hdf5
