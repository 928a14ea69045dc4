// A whole HDF5 file of Kerf's in memory: made of datasets, or read back from its bytes. No MPI, and no file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "output/hdf5_image.hpp"

namespace kerf::hdf5 {

/// Gathers the datasets of a file, and then makes its bytes.
class BytesWriter {
 public:
  BytesWriter();

  Group root;

  /// A list of values or, with `width`, a table of rows of so many.
  template <class T>
  void put(Group& group, const std::string& name, std::span<const T> values, std::size_t width = 0) {
    Dataset& data = group.datasets[name] = {};
    data.type = type_of<T>();
    data.size = {width > 0 ? values.size() / width : values.size()};
    if (width > 0) data.size.push_back(width);
    store(data, std::as_bytes(values));
  }
  void put(Group& group, const std::string& name, const std::vector<std::string>& texts);
  /// The file. Once, and last.
  std::vector<std::byte> finish();

 private:
  void store(Dataset& data, std::span<const std::byte> bytes);

  std::vector<std::byte> bytes_;
};

/// The file that some bytes are. All that is read has been compared with its checksum.
class BytesReader {
 public:
  /// Throws std::runtime_error where the bytes are no file of Kerf's, or damaged anywhere: the end of a sentence that
  /// begins with the name of the file. The bytes must outlive this.
  explicit BytesReader(std::span<const std::byte> bytes);

  const Group& root() const { return root_; }
  /// The values of a dataset; rows of `width` values, or a list where `width` is 0. Throws std::runtime_error where
  /// there is none of this kind.
  template <class T>
  std::vector<T> values(const Group& group, const std::string& name, std::size_t width = 0) const {
    const std::span<const std::byte> entries = entries_of(group, name, type_of<T>(), width);
    std::vector<T> all(entries.size() / sizeof(T));
    if (!all.empty()) std::memcpy(all.data(), entries.data(), entries.size());
    return all;
  }
  std::vector<std::string> texts(const Group& group, const std::string& name) const;

 private:
  std::span<const std::byte> entries_of(const Group& group, const std::string& name, Type type,
                                        std::size_t width) const;
  void check(const Group& group) const;
  void check(const Dataset& data) const;

  std::span<const std::byte> bytes_;
  Group root_;
};

}  // namespace kerf::hdf5
