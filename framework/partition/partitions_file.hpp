// Writes the HDF5 file with the part of every element, for `partitioner: {type: file}` and for other programs.
//
// Layout: doc/users/partition.md.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace kerf {

/// One file, written by one rank; until close() it has another name. Failures throw std::runtime_error.
class PartitionsFile {
 public:
  /// Begins the file. One that is there stays until close(), so that it may be an input of the same call.
  PartitionsFile(const std::string& path, const std::string& input, std::int64_t n_elements);
  ~PartitionsFile();
  PartitionsFile(const PartitionsFile&) = delete;
  PartitionsFile& operator=(const PartitionsFile&) = delete;

  /// Adds the numbers that the user knows the elements by, by element id.
  void name_elements(const std::vector<std::int64_t>& labels);
  /// Begins the group of a state of the model; `frame` is -1 for the initial one.
  void begin_state(const std::string& state, std::int64_t frame, double time);
  /// Adds the partition of the last state; `parts` by element id, -1 for dead elements.
  void add(const std::string& method, const std::string& type, int n_parts, const std::vector<std::int32_t>& parts,
           double seconds);
  /// Takes the place of a file of the same name.
  void close();

 private:
  std::string unfinished() const { return path_ + ".part"; }
  void expect(bool good) const;

  std::string path_, state_;
  std::int64_t file_ = -1;  // HDF5's handle
  std::int64_t n_elements_ = 0;
};

}  // namespace kerf
