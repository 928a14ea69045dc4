// Reads netCDF-4 files, which are HDF5 files: variables are datasets of the root group.
#include <hdf5.h>

#include <utility>

#include "mesh/netcdf.hpp"
#include "output/hdf5_handle.hpp"

namespace kerf {
namespace {

using hdf5::Handle;

/// HDF5 prints its errors unless it is told not to.
class Silence {
 public:
  Silence() {
    H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~Silence() { H5Eset_auto2(H5E_DEFAULT, print_, data_); }

 private:
  H5E_auto2_t print_ = nullptr;
  void* data_ = nullptr;
};

class Netcdf4 final : public NetcdfFile {
 public:
  Netcdf4(hid_t file, std::size_t n_bytes) : file_(file, &H5Fclose), n_bytes_(n_bytes) {}
  const char* format() const override { return "netCDF-4"; }
  bool has(const std::string& variable) const override {
    const Silence silence;
    return H5Lexists(file_, variable.c_str(), H5P_DEFAULT) > 0;
  }
  std::vector<std::int64_t> shape(const std::string& variable) const override;
  bool read(const std::string& variable, std::vector<double>& values) const override {
    return read_as(variable, H5T_FLOAT, H5T_NATIVE_DOUBLE, values);
  }
  bool read(const std::string& variable, std::vector<std::int64_t>& values) const override {
    return read_as(variable, H5T_INTEGER, H5T_NATIVE_INT64, values);
  }
  bool read(const std::string& variable, std::string& letters) const override;
  std::string attribute(const std::string& variable, const std::string& name) const override;

 private:
  template <class Values>
  bool read_as(const std::string& variable, H5T_class_t kind, hid_t type, Values& values) const;

  Handle file_;
  std::size_t n_bytes_;
};

std::vector<std::int64_t> Netcdf4::shape(const std::string& variable) const {
  if (!has(variable)) return {};
  const Silence silence;
  const Handle data(H5Dopen2(file_, variable.c_str(), H5P_DEFAULT), &H5Dclose);
  const Handle space(data < 0 ? -1 : H5Dget_space(data), &H5Sclose);
  const int rank = space < 0 ? 0 : H5Sget_simple_extent_ndims(space);
  if (rank <= 0 || rank > H5S_MAX_RANK) return {};
  std::vector<hsize_t> lengths(static_cast<std::size_t>(rank));
  H5Sget_simple_extent_dims(space, lengths.data(), nullptr);
  return {lengths.begin(), lengths.end()};
}

template <class Values>
bool Netcdf4::read_as(const std::string& variable, H5T_class_t kind, hid_t type, Values& values) const {
  if (!has(variable)) return false;
  const Silence silence;
  const Handle data(H5Dopen2(file_, variable.c_str(), H5P_DEFAULT), &H5Dclose);
  if (data < 0) return false;
  const Handle stored(H5Dget_type(data), &H5Tclose), space(H5Dget_space(data), &H5Sclose);
  if (stored < 0 || space < 0 || H5Tget_class(stored) != kind) return false;
  const hssize_t n = H5Sget_simple_extent_npoints(space);
  // Deflation makes data at most 1032 times smaller; the file cannot hold more.
  if (n < 0 || static_cast<std::size_t>(n) > 1032 * n_bytes_) return false;
  values.resize(static_cast<std::size_t>(n));
  return H5Dread(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >= 0;
}

bool Netcdf4::read(const std::string& variable, std::string& letters) const {
  const Handle one(H5Tcopy(H5T_C_S1), &H5Tclose);  // a letter
  return read_as(variable, H5T_STRING, one, letters);
}

std::string Netcdf4::attribute(const std::string& variable, const std::string& name) const {
  if (!has(variable)) return {};
  const Silence silence;
  const Handle data(H5Dopen2(file_, variable.c_str(), H5P_DEFAULT), &H5Dclose);
  const Handle attribute(data < 0 ? -1 : H5Aopen(data, name.c_str(), H5P_DEFAULT), &H5Aclose);
  const Handle type(attribute < 0 ? -1 : H5Aget_type(attribute), &H5Tclose);
  if (type < 0 || H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0) return {};
  const Handle space(H5Aget_space(attribute), &H5Sclose);
  const std::size_t size = H5Tget_size(type);
  if (H5Sget_simple_extent_npoints(space) != 1 || size == 0 || size > n_bytes_) return {};
  std::string text(size, '\0');
  if (H5Aread(attribute, type, text.data()) < 0) return {};
  return text;
}

}  // namespace

std::unique_ptr<NetcdfFile> open_netcdf4(std::string_view bytes, std::string& why) {
  const Silence silence;
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), &H5Pclose);
  H5Pset_fapl_core(access, 1 << 16, false);  // in memory, never written
  H5Pset_file_image(access, const_cast<char*>(bytes.data()), bytes.size());
  const hid_t file = H5Fopen("mesh", H5F_ACC_RDONLY, access);
  if (file >= 0) return std::make_unique<Netcdf4>(file, bytes.size());
  why = "HDF5 cannot open the file";
  return nullptr;
}

}  // namespace kerf
