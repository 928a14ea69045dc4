// Arrays of a netCDF file by name, whichever of its formats it has.
//
// The classic formats are read here, byte by byte: libexodus and the netCDF library below it stop the program or loop
// for seconds on some files with broken bytes. NetCDF-4 files are HDF5 files and read with HDF5.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace kerf {

class NetcdfFile {
 public:
  virtual ~NetcdfFile() = default;
  virtual const char* format() const = 0;
  virtual bool has(const std::string& variable) const = 0;
  /// Lengths of the dimensions, the slowest first; empty for scalars and for what is not there.
  virtual std::vector<std::int64_t> shape(const std::string& variable) const = 0;
  /// All values; false where they are not in the file, or of another kind.
  virtual bool read(const std::string& variable, std::vector<double>& values) const = 0;
  virtual bool read(const std::string& variable, std::vector<std::int64_t>& values) const = 0;
  virtual bool read(const std::string& variable, std::string& letters) const = 0;
  /// Text of an attribute, empty where there is none.
  virtual std::string attribute(const std::string& variable, const std::string& name) const = 0;
};

/// Classic, 64-bit offset and 64-bit data (CDF-1, CDF-2, CDF-5). Null, and a sentence why, where the header is broken.
/// The bytes must outlive what is returned.
std::unique_ptr<NetcdfFile> open_classic_netcdf(std::string_view bytes, std::string& why);

/// NetCDF-4. Null, and a sentence why, where HDF5 cannot open it.
std::unique_ptr<NetcdfFile> open_netcdf4(std::string_view bytes, std::string& why);

}  // namespace kerf
