// Reads the classic formats of netCDF: https://docs.unidata.ucar.edu/netcdf-c/current/file_format_specifications.html
#include <bit>
#include <cstring>
#include <map>
#include <type_traits>

#include "mesh/netcdf.hpp"

namespace kerf {
namespace {

/// Types of values by the number that the file gives them, from 1.
enum Type { byte = 1, letter, int16, int32, float32, float64, uint8, uint16, uint32, int64, uint64 };
constexpr std::int64_t sizes[] = {0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8};

/// Numbers of the header one after another, most significant byte first.
class Cursor {
 public:
  Cursor(std::string_view bytes, int version) : bytes_(bytes), version_(version) {}
  bool good() const { return good_; }
  void fail() { good_ = false; }
  std::int64_t left() const { return static_cast<std::int64_t>(bytes_.size()) - at_; }
  std::int64_t number(int n_bytes) {
    if (!good_ || left() < n_bytes) return good_ = false, 0;
    std::uint64_t value = 0;
    for (int i = 0; i < n_bytes; ++i)
      value = value << 8 | static_cast<unsigned char>(bytes_[static_cast<std::size_t>(at_ + i)]);
    at_ += n_bytes;
    return static_cast<std::int64_t>(value);
  }
  /// A count or a length: of eight bytes in CDF-5, else of four.
  std::int64_t count() {
    const std::int64_t n = number(version_ == 5 ? 8 : 4);
    if (n < 0) good_ = false;
    return good_ ? n : 0;
  }
  std::int64_t offset() { return number(version_ == 1 ? 4 : 8); }
  /// `n` bytes and what fills them up to a multiple of four.
  std::string text(std::int64_t n) {
    if (!good_ || n > left()) return good_ = false, std::string{};
    std::string out(bytes_.substr(static_cast<std::size_t>(at_), static_cast<std::size_t>(n)));
    at_ += n + (4 - n % 4) % 4;
    if (left() < 0) good_ = false;
    return out;
  }
  std::string name() { return text(count()); }
  /// How many entries a list has; an empty list is two zeros.
  std::int64_t list(std::int64_t tag) {
    const std::int64_t found = number(4), n = count();
    if (found != tag && !(found == 0 && n == 0)) good_ = false;
    return good_ ? n : 0;
  }

 private:
  std::string_view bytes_;
  std::int64_t at_ = 4;
  int version_;
  bool good_ = true;
};

struct Variable {
  std::vector<std::int64_t> shape;
  std::map<std::string, std::string> attributes;  // text only
  std::int64_t type = 0, begin = 0;
  bool over_time = false;  // its first dimension has no fixed length
};

class ClassicNetcdf final : public NetcdfFile {
 public:
  explicit ClassicNetcdf(std::string_view bytes) : bytes_(bytes) {}
  /// Reads the header; false where it is broken.
  bool open();
  const char* format() const override;
  bool has(const std::string& variable) const override { return variables_.contains(variable); }
  std::vector<std::int64_t> shape(const std::string& variable) const override {
    return has(variable) ? variables_.at(variable).shape : std::vector<std::int64_t>{};
  }
  bool read(const std::string& variable, std::vector<double>& values) const override {
    return read_as(variable, values);
  }
  bool read(const std::string& variable, std::vector<std::int64_t>& values) const override {
    return read_as(variable, values);
  }
  bool read(const std::string& variable, std::string& letters) const override;
  std::string attribute(const std::string& variable, const std::string& name) const override;

 private:
  bool read_variable(Cursor& cursor);
  std::map<std::string, std::string> read_attributes(Cursor& cursor);
  /// Number of values; -1 where the file does not hold them.
  std::int64_t n_values(const Variable& variable) const;
  template <class Value>
  bool read_as(const std::string& name, std::vector<Value>& values) const;

  std::string_view bytes_;
  int version_ = 0;
  std::vector<std::int64_t> dimensions_;
  std::map<std::string, Variable> variables_;
};

const char* ClassicNetcdf::format() const {
  return version_ == 1 ? "netCDF classic" : version_ == 2 ? "netCDF 64-bit offset" : "netCDF 64-bit data";
}

bool ClassicNetcdf::open() {
  if (bytes_.size() < 8 || !bytes_.starts_with("CDF")) return false;
  version_ = bytes_[3];
  if (version_ != 1 && version_ != 2 && version_ != 5) return false;
  Cursor cursor(bytes_, version_);
  cursor.number(version_ == 5 ? 8 : 4);  // how many steps in time there are
  const std::int64_t n_dimensions = cursor.list(10);
  for (std::int64_t i = 0; i < n_dimensions && cursor.good(); ++i) {
    cursor.name();
    dimensions_.push_back(cursor.count());
  }
  read_attributes(cursor);
  const std::int64_t n_variables = cursor.list(11);
  for (std::int64_t i = 0; i < n_variables; ++i)
    if (!read_variable(cursor)) return false;
  return cursor.good();
}

std::map<std::string, std::string> ClassicNetcdf::read_attributes(Cursor& cursor) {
  std::map<std::string, std::string> attributes;
  const std::int64_t n = cursor.list(12);
  for (std::int64_t i = 0; i < n && cursor.good(); ++i) {
    const std::string name = cursor.name();
    const std::int64_t type = cursor.number(4), count = cursor.count();
    if (type < byte || type > uint64 || count > cursor.left() / sizes[type]) return cursor.fail(), attributes;
    const std::string value = cursor.text(count * sizes[type]);
    if (type == letter) attributes[name] = value;
  }
  return attributes;
}

bool ClassicNetcdf::read_variable(Cursor& cursor) {
  Variable variable;
  const std::string name = cursor.name();
  const std::int64_t rank = cursor.count();
  for (std::int64_t i = 0; i < rank && cursor.good(); ++i) {
    const std::int64_t id = cursor.count();
    if (id >= static_cast<std::int64_t>(dimensions_.size())) return false;
    variable.shape.push_back(dimensions_[static_cast<std::size_t>(id)]);
    if (i == 0 && variable.shape[0] == 0) variable.over_time = true;
  }
  variable.attributes = read_attributes(cursor);
  variable.type = cursor.number(4);
  cursor.count();  // bytes of the variable, which the shape tells, too
  variable.begin = cursor.offset();
  if (!cursor.good() || variable.type < byte || variable.type > uint64) return false;
  variables_[name] = std::move(variable);
  return true;
}

std::int64_t ClassicNetcdf::n_values(const Variable& variable) const {
  const auto size = static_cast<std::int64_t>(bytes_.size());
  if (variable.over_time || variable.begin < 0 || variable.begin > size) return -1;
  const std::int64_t most = (size - variable.begin) / sizes[variable.type];
  std::int64_t n = 1;
  for (const std::int64_t length : variable.shape) {
    if (length > 0 && n > most / length) return -1;
    n *= length;
  }
  return n <= most ? n : -1;
}

template <class Stored, class Value>
void convert(const char* from, std::vector<Value>& to) {
  for (Value& value : to) {
    unsigned char bytes[sizeof(Stored)];
    for (std::size_t i = 0; i < sizeof(Stored); ++i)
      bytes[std::endian::native == std::endian::little ? sizeof(Stored) - 1 - i : i] =
          static_cast<unsigned char>(from[i]);
    Stored stored;
    std::memcpy(&stored, bytes, sizeof(Stored));
    value = static_cast<Value>(stored);
    from += sizeof(Stored);
  }
}

template <class Value>
bool ClassicNetcdf::read_as(const std::string& name, std::vector<Value>& values) const {
  constexpr bool real = std::is_floating_point_v<Value>;
  const auto found = variables_.find(name);
  const std::int64_t n = found == variables_.end() ? -1 : n_values(found->second);
  const std::int64_t type = n < 0 ? 0 : found->second.type;
  if (real ? type != float32 && type != float64 : type != int32 && type != int64) return false;
  values.resize(static_cast<std::size_t>(n));
  const char* from = bytes_.data() + found->second.begin;
  if constexpr (real)
    type == float32 ? convert<float>(from, values) : convert<double>(from, values);
  else
    type == int32 ? convert<std::int32_t>(from, values) : convert<std::int64_t>(from, values);
  return true;
}

bool ClassicNetcdf::read(const std::string& variable, std::string& letters) const {
  const auto found = variables_.find(variable);
  if (found == variables_.end() || found->second.type != letter) return false;
  const std::int64_t n = n_values(found->second);
  if (n < 0) return false;
  letters = bytes_.substr(static_cast<std::size_t>(found->second.begin), static_cast<std::size_t>(n));
  return true;
}

std::string ClassicNetcdf::attribute(const std::string& variable, const std::string& name) const {
  const auto found = variables_.find(variable);
  if (found == variables_.end()) return {};
  const auto value = found->second.attributes.find(name);
  return value == found->second.attributes.end() ? std::string{} : value->second;
}

}  // namespace

std::unique_ptr<NetcdfFile> open_classic_netcdf(std::string_view bytes, std::string& why) {
  auto file = std::make_unique<ClassicNetcdf>(bytes);
  if (file->open()) return file;
  why = "the header of the netCDF file is broken";
  return nullptr;
}

}  // namespace kerf
