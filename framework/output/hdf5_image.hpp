// The headers of an HDF5 file, built in memory from a description of its groups and datasets.
//
// Kerf writes HDF5 by itself, since HDF5's own library changes headers in place, in several steps: a run that is killed
// between them leaves a file that readers choke on. Here all headers of a state of the file are one block of bytes that
// is written to a place of its own. See doc/developers/files.md for the format and for what is used of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace kerf::hdf5 {

enum class Kind : std::uint8_t { real, integer, unsigned_integer, text };

/// What the entries of a dataset or an attribute are.
struct Type {
  Kind kind = Kind::integer;
  std::uint32_t size = 8;  // bytes of an entry
  bool operator==(const Type&) const = default;
};

/// The type of double, float, int64_t, int32_t or uint8_t.
template <class T>
Type type_of();

struct Attribute {
  std::string name;
  Type type;
  std::vector<std::uint64_t> size;  // empty for a single value
  std::vector<std::byte> content;
};

/// Bytes of a dataset that one rank wrote, and their checksum.
struct Piece {
  std::uint64_t place = 0, size = 0;  // in the file
  std::uint64_t checksum = 0;
};

struct Dataset {
  Type type;
  std::vector<std::uint64_t> size;  // rows and, for tables, components; empty for a single value
  std::vector<std::byte> content;  // of a small dataset, which is stored along with the headers
  std::uint64_t chunk_rows = 0;  // 0 where all rows are one block
  std::vector<std::uint64_t> places;  // in the file: of the block, or of each chunk
  std::vector<std::uint64_t> full_nodes;  // places of the index nodes that never change again
  std::vector<Piece> pieces;

  std::uint64_t row_bytes() const { return type.size * (size.size() > 1 ? size[1] : 1); }
  std::uint64_t n_entries() const;
};

struct Group {
  std::map<std::string, Group> groups;
  std::map<std::string, Dataset> datasets;
  std::vector<Attribute> attributes;

  /// Sets an attribute, new or there already.
  void set(const std::string& name, std::int64_t value);
  void set(const std::string& name, const std::vector<std::int64_t>& values);
  void set(const std::string& name, const std::string& text);
  void set_real(const std::string& name, double value);
  /// The first value of an integer attribute; throws std::runtime_error where there is none.
  std::int64_t integer(const std::string& name) const;
  /// The same of an attribute that set_real() has set.
  double real(const std::string& name) const;
};

/// All headers of a file, and its small datasets.
struct Image {
  std::vector<std::byte> bytes;
  std::uint64_t root = 0;  // place of the header of the outermost group
};

/// Builds the image of a file that is going to stand at `place`. Notes in the datasets which nodes of the index are
/// full and where; those are part of this image and not of the next.
Image build_image(Group& root, std::uint64_t place);

/// The 48 bytes at the beginning of an HDF5 file, which say where everything else is.
std::vector<std::byte> superblock(std::uint64_t root, std::uint64_t file_size);

/// The description as bytes, for Kerf to read back, and back again. unpack() throws std::runtime_error where the bytes
/// are no such description.
std::vector<std::byte> pack(const Group& root);
Group unpack(std::span<const std::byte> bytes);

}  // namespace kerf::hdf5
