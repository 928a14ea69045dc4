// Reads tables of results.vtkhdf.
#pragma once

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/diagnostics.hpp"
#include "output/hdf5_handle.hpp"

namespace kerf {

/// A file of results, open for reading. Throws InputError where something is not as Kerf writes it.
class ResultsFile {
 public:
  using Handle = hdf5::Handle;
  explicit ResultsFile(const std::string& folder) : path_(folder + "/results.vtkhdf"), file_(open(path_), H5Fclose) {
    if (!file_.good()) refuse("there are no results of a run that can be read; expected the folder of its results");
  }

  std::int64_t n_frames() const { return size_of("VTKHDF/Steps/Values"); }
  std::int64_t size_of(const std::string& name) const { return extent_of(name)[0]; }

  /// Rows from `first` on.
  template <class T>
  std::vector<T> rows(const std::string& name, std::int64_t first, std::int64_t n, std::int64_t n_columns,
                      hid_t type) const {
    const std::array<std::int64_t, 2> extent = extent_of(name);
    if (first < 0 || n < 0 || first + n > extent[0] || n_columns != extent[1])
      refuse(fmt::format("`{}` has {} rows of {} numbers; expected at least {} of {}, as many as the mesh has", name,
                         extent[0], extent[1], first + n, n_columns));
    const Handle data(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
    const Handle space(H5Dget_space(data), H5Sclose);
    const hsize_t start[2] = {static_cast<hsize_t>(first), 0};
    const hsize_t count[2] = {static_cast<hsize_t>(n), static_cast<hsize_t>(n_columns)};
    const Handle memory(H5Screate_simple(2, count, nullptr), H5Sclose);
    std::vector<T> values(static_cast<std::size_t>(n * n_columns));
    if (H5Sselect_hyperslab(space, H5S_SELECT_SET, start, nullptr, count, nullptr) < 0 ||
        H5Dread(data, type, memory, space, H5P_DEFAULT, values.data()) < 0)
      refuse(fmt::format("`{}` cannot be read from row {} on; expected numbers, as Kerf writes them", name, first));
    return values;
  }

  std::int64_t number(const std::string& name, std::int64_t row) const {
    return rows<std::int64_t>(name, row, 1, 1, H5T_NATIVE_INT64).front();
  }

  /// A list of texts of a fixed length.
  std::vector<std::string> texts(const std::string& name) const {
    const auto n = static_cast<std::size_t>(size_of(name));
    const Handle data(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
    const Handle type(H5Dget_type(data), H5Tclose);
    const std::size_t length = H5Tget_size(type);
    std::string all(length * n, ' ');
    if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0 ||
        H5Dread(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()) < 0)
      refuse(fmt::format("`{}` cannot be read; expected texts of one length, as Kerf writes them", name));
    std::vector<std::string> list;
    for (std::size_t at = 0; at < all.size(); at += length) list.emplace_back(all.substr(at, length).c_str());
    return list;
  }

  [[noreturn]] void refuse(const std::string& sentence) const {
    throw InputError({fmt::format("{}: error: {}", path_, sentence)});
  }

 private:
  /// Rows and columns.
  std::array<std::int64_t, 2> extent_of(const std::string& name) const {
    const Handle data(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
    if (!data.good()) refuse(fmt::format("`{}` is missing; expected a file of results that Kerf has written", name));
    const Handle space(H5Dget_space(data), H5Sclose);
    hsize_t extent[2] = {0, 1};
    const int n_dimensions = H5Sget_simple_extent_ndims(space);
    if (n_dimensions < 1 || n_dimensions > 2 || H5Sget_simple_extent_dims(space, extent, nullptr) < 0)
      refuse(fmt::format("`{}` is no table; expected a file of results that Kerf has written", name));
    return {static_cast<std::int64_t>(extent[0]), static_cast<std::int64_t>(extent[1])};
  }

  static hid_t open(const std::string& path) {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // messages are our own
    return H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  }

  std::string path_;
  Handle file_;
};

}  // namespace kerf
