// Every dataset is one block of bytes with one checksum.
#include "output/hdf5_memory.hpp"

#include <algorithm>
#include <stdexcept>

#include "output/checksum.hpp"
#include "output/hdf5_front.hpp"

namespace kerf::hdf5 {

namespace {

void align(std::vector<std::byte>& bytes) { bytes.resize((bytes.size() + 7) / 8 * 8); }

[[noreturn]] void refuse(const std::string& what) { throw std::runtime_error("is damaged: " + what); }

/// Whether `size` bytes at `place` are within `all`.
bool fits(std::uint64_t place, std::uint64_t size, std::uint64_t all) { return place <= all && size <= all - place; }

}  // namespace

BytesWriter::BytesWriter() : bytes_(front_size) {}

void BytesWriter::store(Dataset& data, std::span<const std::byte> bytes) {
  if (bytes.empty()) return;
  align(bytes_);
  data.places = {bytes_.size()};
  data.pieces = {{bytes_.size(), bytes.size(), crc64(bytes)}};
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

void BytesWriter::put(Group& group, const std::string& name, const std::vector<std::string>& texts) {
  std::size_t length = 1;
  for (const std::string& text : texts) length = std::max(length, text.size());
  std::string all;
  for (const std::string& text : texts) all += text + std::string(length - text.size(), '\0');
  Dataset& data = group.datasets[name] = {};
  data.type = {Kind::text, static_cast<std::uint32_t>(length)};
  data.size = {texts.size()};
  store(data, std::as_bytes(std::span(all)));
}

std::vector<std::byte> BytesWriter::finish() {
  align(bytes_);
  Front front;
  front.image = bytes_.size();
  Image image = build_image(root, front.image);
  front.image_size = image.bytes.size();
  const std::vector<std::byte> index = pack(root);
  front.index = front.image + front.image_size;
  front.index_size = index.size();
  image.bytes.insert(image.bytes.end(), index.begin(), index.end());
  front.checksum = crc64(image.bytes);
  bytes_.insert(bytes_.end(), image.bytes.begin(), image.bytes.end());
  front.file_size = bytes_.size();
  const std::vector<std::byte> beginning = front_bytes(front, image.root);
  std::copy(beginning.begin(), beginning.end(), bytes_.begin());
  return std::move(bytes_);
}

BytesReader::BytesReader(std::span<const std::byte> bytes) : bytes_(bytes) {
  const Front front = front_of(bytes.first(std::min<std::size_t>(bytes.size(), front_size)));
  if (front.file_size != bytes.size())
    refuse("it has " + std::to_string(bytes.size()) + " bytes and should have " + std::to_string(front.file_size));
  if (!fits(front.image, front.image_size, bytes.size()) || front.index != front.image + front.image_size ||
      !fits(front.index, front.index_size, bytes.size()))
    refuse("its headers are beyond its end");
  if (crc64(bytes.subspan(front.image, front.image_size + front.index_size)) != front.checksum)
    refuse("its headers do not fit their checksum");
  try {
    root_ = unpack(bytes.subspan(front.index, front.index_size));
  } catch (const std::exception& e) {
    refuse(e.what());
  }
  check(root_);
}

void BytesReader::check(const Group& group) const {
  for (const auto& [name, data] : group.datasets) check(data);
  for (const auto& [name, child] : group.groups) check(child);
}

void BytesReader::check(const Dataset& data) const {
  std::uint64_t size = data.type.size;
  for (const std::uint64_t n : data.size) {
    if (size > 0 && n > bytes_.size() / size) refuse("a dataset is larger than the file");
    size *= n;
  }
  if (size == 0 && (!data.places.empty() || !data.pieces.empty())) refuse("a dataset of no size is stored somewhere");
  if (size == 0) return;
  if (data.chunk_rows != 0 || data.places.size() != 1 || data.pieces.size() != 1)
    refuse("a dataset is not stored in one piece");
  const Piece& piece = data.pieces.front();
  if (piece.place != data.places.front() || piece.size != size || !fits(piece.place, piece.size, bytes_.size()))
    refuse("a dataset is not where it should be");
  if (crc64(bytes_.subspan(piece.place, piece.size)) != piece.checksum)
    refuse("bytes " + std::to_string(piece.place) + " to " + std::to_string(piece.place + piece.size - 1) +
           " do not fit their checksum");
}

std::span<const std::byte> BytesReader::entries_of(const Group& group, const std::string& name, Type type,
                                                   std::size_t width) const {
  const auto found = group.datasets.find(name);
  if (found == group.datasets.end()) throw std::runtime_error("has no dataset \"" + name + "\"");
  const Dataset& data = found->second;
  const bool fits_type = type.kind == Kind::text ? data.type.kind == Kind::text : data.type == type;
  const bool fits_size = width > 0 ? data.size.size() == 2 && data.size[1] == width : data.size.size() == 1;
  if (!fits_type || !fits_size) throw std::runtime_error("has a dataset \"" + name + "\" of another kind");
  if (data.places.empty()) return {};
  return bytes_.subspan(data.places.front(), data.pieces.front().size);
}

std::vector<std::string> BytesReader::texts(const Group& group, const std::string& name) const {
  const std::span<const std::byte> entries = entries_of(group, name, {Kind::text, 0}, 0);
  const std::size_t length = entries.empty() ? 1 : group.datasets.at(name).type.size;
  std::vector<std::string> all;
  for (std::size_t at = 0; at < entries.size(); at += length) {
    std::string text(reinterpret_cast<const char*>(entries.data()) + at, length);
    text.resize(text.find_last_not_of('\0') + 1);
    all.push_back(std::move(text));
  }
  return all;
}

}  // namespace kerf::hdf5
