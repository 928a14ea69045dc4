// Reads tables of results.vtkhdf.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <vector>

#include "core/diagnostics.hpp"
#include "partition/hdf5_handle.hpp"

namespace kerf {

/// A file of results, open for reading. Throws InputError where something is not as Kerf writes it.
class ResultsFile {
 public:
  using Handle = hdf5::Handle;
  explicit ResultsFile(const std::string& folder) : path_(folder + "/results.vtkhdf"), file_(open(path_), H5Fclose) {
    if (!file_.good()) refuse("there are no results of a run that can be read; expected the folder of its results");
  }

  std::int64_t n_frames() const { return size_of("VTKHDF/Steps/Values"); }
  std::int64_t size_of(const std::string& name) const {
    const Handle data(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
    if (!data.good()) refuse(fmt::format("`{}` is missing", name));
    const Handle space(H5Dget_space(data), H5Sclose);
    hsize_t rows[2] = {0, 0};
    if (H5Sget_simple_extent_ndims(space) > 2 || H5Sget_simple_extent_dims(space, rows, nullptr) < 0)
      refuse(fmt::format("`{}` is no table", name));
    return static_cast<std::int64_t>(rows[0]);
  }

  /// Rows from `first` on.
  template <class T>
  std::vector<T> rows(const std::string& name, std::int64_t first, std::int64_t n, std::int64_t n_columns,
                      hid_t type) const {
    const Handle data(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
    if (!data.good()) refuse(fmt::format("`{}` is missing", name));
    const Handle space(H5Dget_space(data), H5Sclose);
    const hsize_t start[2] = {static_cast<hsize_t>(first), 0};
    const hsize_t count[2] = {static_cast<hsize_t>(n), static_cast<hsize_t>(n_columns)};
    const Handle memory(H5Screate_simple(2, count, nullptr), H5Sclose);
    std::vector<T> values(static_cast<std::size_t>(n * n_columns));
    if (first + n > size_of(name) || H5Sselect_hyperslab(space, H5S_SELECT_SET, start, nullptr, count, nullptr) < 0 ||
        H5Dread(data, type, memory, space, H5P_DEFAULT, values.data()) < 0)
      refuse(fmt::format("`{}` cannot be read from row {} on", name, first));
    return values;
  }

  std::int64_t number(const std::string& name, std::int64_t row) const {
    return rows<std::int64_t>(name, row, 1, 1, H5T_NATIVE_INT64).front();
  }

  /// A list of texts of a fixed length.
  std::vector<std::string> texts(const std::string& name) const {
    const Handle data(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
    if (!data.good()) refuse(fmt::format("`{}` is missing", name));
    const Handle type(H5Dget_type(data), H5Tclose);
    const std::size_t length = H5Tget_size(type);
    std::string all(length * static_cast<std::size_t>(size_of(name)), ' ');
    if (H5Tis_variable_str(type) > 0 || H5Dread(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()) < 0)
      refuse(fmt::format("`{}` cannot be read", name));
    std::vector<std::string> list;
    for (std::size_t at = 0; at < all.size(); at += length) list.emplace_back(all.substr(at, length).c_str());
    return list;
  }

  [[noreturn]] void refuse(const std::string& sentence) const {
    throw InputError({fmt::format("{}: error: {}", path_, sentence)});
  }

 private:
  static hid_t open(const std::string& path) {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // messages are our own
    return H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  }

  std::string path_;
  Handle file_;
};

}  // namespace kerf
