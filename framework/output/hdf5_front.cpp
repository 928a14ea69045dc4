// Packs and checks the first 128 bytes of a file of Kerf's.
#include "output/hdf5_front.hpp"

#include <cstring>
#include <stdexcept>

#include "output/checksum.hpp"
#include "output/hdf5_image.hpp"

namespace kerf::hdf5 {

namespace {

constexpr char magic[] = "KerfFile";
constexpr std::size_t place_of_magic = 48, place_of_numbers = 56, place_of_checksum = front_size - 8;

}  // namespace

std::vector<std::byte> front_bytes(const Front& front, std::uint64_t root) {
  std::vector<std::byte> bytes = superblock(root, front.file_size);
  bytes.resize(front_size);
  std::memcpy(&bytes[place_of_magic], magic, 8);
  const std::uint64_t numbers[] = {
      front.image, front.image_size, front.index, front.index_size, front.file_size, 0, front.checksum, 0};
  std::memcpy(&bytes[place_of_numbers], numbers, sizeof numbers);
  const std::uint64_t checksum = crc64(std::span(bytes).first(place_of_checksum));
  std::memcpy(&bytes[place_of_checksum], &checksum, 8);
  return bytes;
}

bool has_front(std::span<const std::byte> bytes) {
  return bytes.size() >= front_size && std::memcmp(&bytes[place_of_magic], magic, 8) == 0;
}

Front front_of(std::span<const std::byte> bytes) {
  if (bytes.size() < front_size) throw std::runtime_error("is no file of Kerf's: too short");
  if (!has_front(bytes)) throw std::runtime_error("was not written by this version of Kerf, or is damaged");
  std::uint64_t checksum = 0, numbers[7] = {};
  std::memcpy(&checksum, &bytes[place_of_checksum], 8);
  if (checksum != crc64(bytes.first(place_of_checksum)))
    throw std::runtime_error("is damaged: its beginning does not fit its checksum");
  std::memcpy(numbers, &bytes[place_of_numbers], sizeof numbers);
  return {numbers[0], numbers[1], numbers[2], numbers[3], numbers[4], numbers[6]};
}

}  // namespace kerf::hdf5
