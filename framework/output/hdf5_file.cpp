// Storage, states and checksums of a file that all ranks write.
#include "output/hdf5_file.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <stdexcept>

#include "output/checksum.hpp"
#include "output/collective.hpp"
#include "output/hdf5_front.hpp"

namespace kerf::hdf5 {

namespace {

Front read_front(const File& file) {
  std::array<std::byte, front_size> bytes{};
  const std::uint64_t n = std::min(file.size(), front_size);
  file.read_at(0, std::span(bytes).first(n));
  try {
    return front_of(std::span(bytes).first(n));
  } catch (const std::exception& e) {
    throw std::runtime_error("\"" + file.path() + "\" " + e.what());
  }
}

void broadcast(MPI_Comm comm, std::vector<std::byte>& bytes) {
  unsigned long long n = bytes.size();
  MPI_Bcast(&n, 1, MPI_UNSIGNED_LONG_LONG, 0, comm);
  bytes.resize(n);
  MPI_Bcast(bytes.data(), static_cast<int>(n), MPI_BYTE, 0, comm);
}

void for_all_datasets(const Group& group, const std::function<void(const Dataset&)>& use) {
  for (const auto& [name, dataset] : group.datasets) use(dataset);
  for (const auto& [name, child] : group.groups) for_all_datasets(child, use);
}

std::vector<std::byte> entries_of(const File& file, const Dataset& d) {
  if (d.places.empty()) return d.content;
  std::vector<std::byte> bytes(d.n_entries() * d.type.size);
  const std::uint64_t step = d.chunk_rows > 0 ? d.chunk_rows * d.row_bytes() : bytes.size();
  std::uint64_t at = 0;
  for (std::size_t c = 0; c < d.places.size() && at < bytes.size(); ++c) {
    const std::uint64_t n = std::min<std::uint64_t>(step, bytes.size() - at);
    file.read_at(d.places[c], std::span(bytes).subspan(at, n));
    at += n;
  }
  return bytes;
}

void add_entries(const File& file, const Group& group, const std::string& path,
                 std::map<std::string, std::vector<std::byte>>& all) {
  for (const auto& [name, dataset] : group.datasets) all[path + name] = entries_of(file, dataset);
  for (const auto& [name, child] : group.groups) add_entries(file, child, path + name + "/", all);
}

constexpr std::uint64_t index_node_size(const Dataset& d) { return 24 + 65 * (8 + 8 * (d.size.size() + 1)) + 64 * 8; }

}  // namespace

Hdf5File Hdf5File::create(MPI_Comm comm, const std::string& path) {
  Hdf5File result;
  result.comm_ = comm;
  result.file_ = SharedFile(comm, path, File::Mode::create);
  result.end_ = front_size;
  return result;
}

Hdf5File Hdf5File::open(MPI_Comm comm, const std::string& path, bool writable, bool whole) {
  Hdf5File result;
  result.comm_ = comm;
  result.file_ = SharedFile(comm, path, writable ? File::Mode::update : File::Mode::read);
  std::vector<std::byte> index;
  on_root(comm, [&] { result.open_on_root(index, whole); });
  broadcast(comm, index);
  MPI_Bcast(&result.end_, 1, MPI_UINT64_T, 0, comm);
  std::string failure;
  try {
    result.root = unpack(index);
  } catch (const std::exception& e) {
    failure = "\"" + path + "\" is damaged: " + e.what();
  }
  kerf::agree(comm, failure);
  if (whole) result.compare_pieces();
  return result;
}

void Hdf5File::open_on_root(std::vector<std::byte>& index, bool exact_size) {
  const File& file = file_.local();
  const Front front = read_front(file);
  const std::uint64_t size = file.size();
  const auto damaged = [&](const std::string& what) {
    throw std::runtime_error("\"" + file.path() + "\" is damaged: " + what);
  };
  if (size < front.file_size || (exact_size && size != front.file_size))
    damaged("it has " + std::to_string(size) + " bytes and should have " + std::to_string(front.file_size));
  std::vector<std::byte> bytes(front.index + front.index_size - front.image);
  file.read_at(front.image, bytes);
  if (crc64(bytes) != front.checksum) damaged("its headers do not fit their checksum");
  index.assign(bytes.end() - static_cast<std::ptrdiff_t>(front.index_size), bytes.end());
  end_ = front.file_size;
}

/// Every rank reads its share of the pieces.
void Hdf5File::compare_pieces() {
  int rank = 0, n_ranks = 1;
  MPI_Comm_rank(comm_, &rank);
  MPI_Comm_size(comm_, &n_ranks);
  std::vector<std::byte> bytes;
  std::string failure;
  int number = 0;
  for_all_datasets(root, [&](const Dataset& dataset) {
    for (const Piece& piece : dataset.pieces) {
      if (number++ % n_ranks != rank || !failure.empty()) continue;
      bytes.resize(piece.size);
      try {
        file_.local().read_at(piece.place, bytes);
        if (crc64(bytes) != piece.checksum)
          failure = "\"" + file_.path() + "\" is damaged: bytes " + std::to_string(piece.place) + " to " +
                    std::to_string(piece.place + piece.size - 1) + " do not fit their checksum";
      } catch (const std::exception& e) {
        failure = e.what();
      }
    }
  });
  kerf::agree(comm_, failure);
}

std::uint64_t Hdf5File::allocate(std::uint64_t n_bytes) {
  // Large blocks begin on pages, so that two ranks rarely share one.
  const std::uint64_t alignment = n_bytes >= 64 * 1024 ? 4096 : 8;
  const std::uint64_t place = (end_ + alignment - 1) / alignment * alignment;
  end_ = place + n_bytes;
  return place;
}

/// Where the next image does not touch the present one.
std::uint64_t Hdf5File::place_of_image() {
  if (!takes_turns_) return allocate(0);
  const std::uint64_t size = build_image(root, 0).bytes.size() + pack(root).size();
  if (size > turn_size_) {
    turn_size_ = 2 * size;
    for (std::uint64_t& place : turns_) place = allocate(turn_size_);
  }
  turn_ = 1 - turn_;
  return turns_[turn_];
}

void Hdf5File::commit() {
  Front front;
  front.image = place_of_image();
  Image image = build_image(root, front.image);
  front.image_size = image.bytes.size();
  const std::vector<std::byte> index = pack(root);
  front.index = front.image + image.bytes.size();
  front.index_size = index.size();
  image.bytes.insert(image.bytes.end(), index.begin(), index.end());
  front.checksum = crc64(image.bytes);
  end_ = std::max(end_, front.image + image.bytes.size());
  front.file_size = end_;

  int rank = 0;
  MPI_Comm_rank(comm_, &rank);
  if (rank == 0) file_.write_at(front.image, image.bytes);
  if (rank == 0 && takes_turns_) file_.reach(end_);  // storage may not have been written to its end
  file_.sync();
  file_.agree();  // all that the new state needs is on the disk
  if (rank == 0) {
    file_.write_at(0, front_bytes(front, image.root));
    file_.sync();
  }
  file_.agree();
}

std::uint64_t Hdf5File::end_of_contents() const {
  std::uint64_t end = front_size;
  for_all_datasets(root, [&](const Dataset& d) {
    const std::uint64_t block = (d.chunk_rows > 0 ? d.chunk_rows * d.row_bytes() : d.n_entries() * d.type.size);
    for (const std::uint64_t place : d.places) end = std::max(end, place + block);
    for (const std::uint64_t place : d.full_nodes) end = std::max(end, place + index_node_size(d));
  });
  return end;
}

void Hdf5File::shorten() {
  const std::uint64_t contents = end_of_contents(), image_size = build_image(root, 0).bytes.size() + pack(root).size();
  // The headers of the present state stand at the end; the new ones must not touch them.
  if (contents + 2 * image_size + 4096 > end_ - image_size) return;
  end_ = contents;
  commit();
  on_root(comm_, [&] { file_.local().cut(end_); });
}

std::map<std::string, std::vector<std::byte>> entries_of_file(const std::string& path) {
  const File file(path, File::Mode::read);
  const Front front = read_front(file);
  std::vector<std::byte> index(front.index_size);
  file.read_at(front.index, index);
  std::map<std::string, std::vector<std::byte>> all;
  add_entries(file, unpack(index), "", all);
  return all;
}

}  // namespace kerf::hdf5
