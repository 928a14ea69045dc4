// The C calls behind hdf5.hpp, with the settings that make parallel HDF5 1.10 fast and safe against cut-offs.
#include "output/hdf5.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>

namespace kerf::hdf5 {

namespace {

herr_t note_innermost(unsigned, const H5E_error2_t* e, void* text) {
  // The walk goes from the interface down; the last one is nearest to the cause.
  if (e->desc != nullptr) *static_cast<std::string*>(text) = e->desc;
  return 0;
}

/// HDF5 prints a stack of forty lines on every error unless told not to; the sentence we throw says it all.
void silence() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

Handle access_for(MPI_Comm comm) {
  silence();
  Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "prepare parallel file access");
  check(H5Pset_fapl_mpio(access.id(), comm, MPI_INFO_NULL), "prepare parallel file access");
  // Large blocks begin on pages, so that two ranks rarely share one.
  check(H5Pset_alignment(access.id(), 64 * 1024, 4096), "set the file alignment");
  // Metadata leaves the cache at a flush and at no other time: see create_file().
  H5AC_cache_config_t cache{};
  cache.version = H5AC__CURR_CACHE_CONFIG_VERSION;
  check(H5Pget_mdc_config(access.id(), &cache), "read the metadata cache settings");
  cache.evictions_enabled = false;
  cache.incr_mode = H5C_incr__off;
  cache.flash_incr_mode = H5C_flash_incr__off;
  cache.decr_mode = H5C_decr__off;
  check(H5Pset_mdc_config(access.id(), &cache), "set the metadata cache");
  return access;
}

Handle create(const Handle& parent, const std::string& name, hid_t type, const Handle& space, const Handle& settings) {
  // Every row is written by somebody before it is read, so storage is not filled first.
  check(H5Pset_fill_time(settings.id(), H5D_FILL_TIME_NEVER), "switch filling off");
  check(H5Pset_alloc_time(settings.id(), H5D_ALLOC_TIME_EARLY), "ask for early allocation");
  return Handle(H5Dcreate2(parent.id(), name.c_str(), type, space.id(), H5P_DEFAULT, settings.id(), H5P_DEFAULT),
                H5Dclose, "create dataset \"" + name + "\"");
}

Handle creation_settings() { return Handle(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "prepare a dataset"); }

struct Shape {
  int rank = 0;
  std::array<hsize_t, 2> size{0, 1};
};

Shape shape_of(const Handle& table) {
  const Handle space(H5Dget_space(table.id()), H5Sclose, "read the shape of a dataset");
  Shape shape;
  shape.rank = H5Sget_simple_extent_ndims(space.id());
  if (shape.rank < 1 || shape.rank > 2) throw std::runtime_error("a dataset is not a table");
  check(H5Sget_simple_extent_dims(space.id(), shape.size.data(), nullptr), "read the shape of a dataset");
  if (shape.rank == 1) shape.size[1] = 1;
  return shape;
}

/// Calls transfer(memory space, file space, first entry) for pieces that fit MPI's int counts.
template <class Transfer>
void for_pieces(const Handle& table, std::int64_t begin, std::size_t n_values, std::size_t value_size,
                Transfer&& transfer) {
  if (n_values == 0) return;
  constexpr std::size_t piece_bytes = std::size_t{1} << 30;
  const Shape shape = shape_of(table);
  const hsize_t rows = n_values / shape.size[1];
  if (rows * shape.size[1] != n_values) throw std::invalid_argument("values are not whole rows of the dataset");
  const hsize_t piece = std::max<hsize_t>(1, piece_bytes / (shape.size[1] * value_size));
  const Handle file_space(H5Dget_space(table.id()), H5Sclose, "read the shape of a dataset");
  for (hsize_t done = 0; done < rows; done += piece) {
    const hsize_t start[2] = {static_cast<hsize_t>(begin) + done, 0};
    const hsize_t count[2] = {std::min(piece, rows - done), shape.size[1]};
    check(H5Sselect_hyperslab(file_space.id(), H5S_SELECT_SET, start, nullptr, count, nullptr), "select rows");
    const Handle memory_space(H5Screate_simple(shape.rank, count, nullptr), H5Sclose, "describe rows in memory");
    transfer(memory_space.id(), file_space.id(), done * shape.size[1]);
  }
}

Handle fixed_text_type(std::size_t length) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "describe a text");
  check(H5Tset_size(type.id(), std::max<std::size_t>(1, length)), "describe a text");
  check(H5Tset_strpad(type.id(), H5T_STR_NULLPAD), "describe a text");
  return type;
}

}  // namespace

void fail(const std::string& what) {
  std::string reason;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_DOWNWARD, note_innermost, &reason);
  throw std::runtime_error("cannot " + what + (reason.empty() ? "" : ": " + reason));
}

void check(herr_t status, const std::string& what) {
  if (status < 0) fail(what);
}

Handle::Handle(hid_t id, Closer close, const std::string& what) : id_(id), close_(close) {
  if (id < 0) fail(what);
}

void Handle::reset() noexcept {
  if (id_ >= 0 && close_ != nullptr) close_(id_);
  id_ = H5I_INVALID_HID;
}

template <>
hid_t type_of<double>() {
  return H5T_NATIVE_DOUBLE;
}
template <>
hid_t type_of<float>() {
  return H5T_NATIVE_FLOAT;
}
template <>
hid_t type_of<std::int64_t>() {
  return H5T_NATIVE_INT64;
}
template <>
hid_t type_of<std::int32_t>() {
  return H5T_NATIVE_INT32;
}
template <>
hid_t type_of<std::uint8_t>() {
  return H5T_NATIVE_UINT8;
}

Handle create_file(MPI_Comm comm, const std::string& path) {
  const Handle access = access_for(comm);
  // The oldest file layout is kept on purpose: the newer superblock marks a file as "open for writing", and a
  // file that a crash left with that mark is refused by readers.
  return Handle(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id()), H5Fclose, "create \"" + path + "\"");
}

Handle open_file(MPI_Comm comm, const std::string& path, bool writable) {
  const Handle access = access_for(comm);
  return Handle(H5Fopen(path.c_str(), writable ? H5F_ACC_RDWR : H5F_ACC_RDONLY, access.id()), H5Fclose,
                "open \"" + path + "\"");
}

Handle open_file_alone(const std::string& path) {
  silence();
  return Handle(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose, "open \"" + path + "\"");
}

void flush(const Handle& file) { check(H5Fflush(file.id(), H5F_SCOPE_GLOBAL), "flush a file to disk"); }

Handle create_group(const Handle& parent, const std::string& name) {
  return Handle(H5Gcreate2(parent.id(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose,
                "create group \"" + name + "\"");
}

Handle open_group(const Handle& parent, const std::string& name) {
  return Handle(H5Gopen2(parent.id(), name.c_str(), H5P_DEFAULT), H5Gclose, "open group \"" + name + "\"");
}

Handle open_dataset(const Handle& parent, const std::string& name) {
  return Handle(H5Dopen2(parent.id(), name.c_str(), H5P_DEFAULT), H5Dclose, "open dataset \"" + name + "\"");
}

bool has_link(const Handle& parent, const std::string& name) {
  return H5Lexists(parent.id(), name.c_str(), H5P_DEFAULT) > 0;
}

std::vector<std::string> names_in(const Handle& group) {
  H5G_info_t info{};
  check(H5Gget_info(group.id(), &info), "list a group");
  std::vector<std::string> names;
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    const auto name_of = [&](char* text, std::size_t size) {
      return H5Lget_name_by_idx(group.id(), ".", H5_INDEX_NAME, H5_ITER_INC, i, text, size, H5P_DEFAULT);
    };
    const ssize_t length = name_of(nullptr, 0);
    if (length < 0) fail("list a group");
    std::string name(static_cast<std::size_t>(length), '\0');
    name_of(name.data(), name.size() + 1);
    names.push_back(std::move(name));
  }
  return names;
}

Handle create_table(const Handle& parent, const std::string& name, hid_t type, std::int64_t rows, int components) {
  const hsize_t size[2] = {static_cast<hsize_t>(rows), static_cast<hsize_t>(components)};
  const Handle space(H5Screate_simple(components == 0 ? 1 : 2, size, nullptr), H5Sclose, "describe a dataset");
  return create(parent, name, type, space, creation_settings());
}

Handle create_growing_table(const Handle& parent, const std::string& name, hid_t type, int components,
                            std::int64_t chunk_rows) {
  const int rank = components == 0 ? 1 : 2;
  const hsize_t size[2] = {0, static_cast<hsize_t>(components)};
  const hsize_t largest[2] = {H5S_UNLIMITED, static_cast<hsize_t>(components)};
  const hsize_t chunk[2] = {static_cast<hsize_t>(chunk_rows), static_cast<hsize_t>(components)};
  const Handle space(H5Screate_simple(rank, size, largest), H5Sclose, "describe a dataset");
  const Handle settings = creation_settings();
  check(H5Pset_chunk(settings.id(), rank, chunk), "set the chunks of \"" + name + "\"");
  return create(parent, name, type, space, settings);
}

std::int64_t n_rows(const Handle& table) { return static_cast<std::int64_t>(shape_of(table).size[0]); }

int n_components(const Handle& table) { return static_cast<int>(shape_of(table).size[1]); }

template <class T>
bool is_table_of(const Handle& table) {
  const Handle type(H5Dget_type(table.id()), H5Tclose, "read the type of a dataset");
  return H5Tequal(type.id(), type_of<T>()) > 0;
}

void set_rows(const Handle& table, std::int64_t rows) {
  Shape shape = shape_of(table);
  shape.size[0] = static_cast<hsize_t>(rows);
  check(H5Dset_extent(table.id(), shape.size.data()), "change the size of a dataset");
}

template <class T>
void write_rows(const Handle& table, std::int64_t begin, std::span<const T> values) {
  for_pieces(table, begin, values.size(), sizeof(T), [&](hid_t memory, hid_t file, std::size_t first) {
    check(H5Dwrite(table.id(), type_of<T>(), memory, file, H5P_DEFAULT, values.data() + first), "write a dataset");
  });
}

template <class T>
void read_rows(const Handle& table, std::int64_t begin, std::span<T> values) {
  for_pieces(table, begin, values.size(), sizeof(T), [&](hid_t memory, hid_t file, std::size_t first) {
    check(H5Dread(table.id(), type_of<T>(), memory, file, H5P_DEFAULT, values.data() + first), "read a dataset");
  });
}

#define KERF_HDF5_ROWS(T)                                                       \
  template void write_rows<T>(const Handle&, std::int64_t, std::span<const T>); \
  template void read_rows<T>(const Handle&, std::int64_t, std::span<T>);        \
  template bool is_table_of<T>(const Handle&);
KERF_HDF5_ROWS(double)
KERF_HDF5_ROWS(float)
KERF_HDF5_ROWS(std::int64_t)
KERF_HDF5_ROWS(std::int32_t)
KERF_HDF5_ROWS(std::uint8_t)
#undef KERF_HDF5_ROWS

bool has_attribute(const Handle& owner, const std::string& name) { return H5Aexists(owner.id(), name.c_str()) > 0; }

void write_attribute(const Handle& owner, const std::string& name, std::span<const std::int64_t> values, bool scalar) {
  const hsize_t size = values.size();
  const Handle space(scalar ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &size, nullptr), H5Sclose,
                     "describe attribute \"" + name + "\"");
  const hid_t id = has_attribute(owner, name)
                       ? H5Aopen(owner.id(), name.c_str(), H5P_DEFAULT)
                       : H5Acreate2(owner.id(), name.c_str(), H5T_NATIVE_INT64, space.id(), H5P_DEFAULT, H5P_DEFAULT);
  const Handle attribute(id, H5Aclose, "create attribute \"" + name + "\"");
  check(H5Awrite(attribute.id(), H5T_NATIVE_INT64, values.data()), "write attribute \"" + name + "\"");
}

void write_attribute(const Handle& owner, const std::string& name, const std::string& text) {
  const Handle type = fixed_text_type(text.size());
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose, "describe attribute \"" + name + "\"");
  const Handle attribute(H5Acreate2(owner.id(), name.c_str(), type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose, "create attribute \"" + name + "\"");
  check(H5Awrite(attribute.id(), type.id(), text.c_str()), "write attribute \"" + name + "\"");
}

std::int64_t read_attribute(const Handle& owner, const std::string& name) {
  const Handle attribute(H5Aopen(owner.id(), name.c_str(), H5P_DEFAULT), H5Aclose, "open attribute \"" + name + "\"");
  const Handle space(H5Aget_space(attribute.id()), H5Sclose, "read attribute \"" + name + "\"");
  std::vector<std::int64_t> values(
      static_cast<std::size_t>(std::max<hssize_t>(1, H5Sget_simple_extent_npoints(space.id()))));
  check(H5Aread(attribute.id(), H5T_NATIVE_INT64, values.data()), "read attribute \"" + name + "\"");
  return values.front();
}

void write_texts(const Handle& parent, const std::string& name, const std::vector<std::string>& texts, bool is_writer) {
  std::size_t length = 1;
  for (const std::string& text : texts) length = std::max(length, text.size());
  const Handle type = fixed_text_type(length);
  const hsize_t size = texts.size();
  const Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose, "describe \"" + name + "\"");
  const Handle table = create(parent, name, type.id(), space, creation_settings());
  if (!is_writer || texts.empty()) return;
  std::vector<char> buffer(length * texts.size(), '\0');
  for (std::size_t i = 0; i < texts.size(); ++i)
    std::copy(texts[i].begin(), texts[i].end(), buffer.begin() + static_cast<std::ptrdiff_t>(i * length));
  check(H5Dwrite(table.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, buffer.data()), "write \"" + name + "\"");
}

void write_text(const Handle& parent, const std::string& name, const std::string& text, bool is_writer) {
  const Handle type = fixed_text_type(text.size());
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose, "describe \"" + name + "\"");
  const Handle table = create(parent, name, type.id(), space, creation_settings());
  if (!is_writer) return;
  check(H5Dwrite(table.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str()), "write \"" + name + "\"");
}

std::string read_text(const Handle& parent, const std::string& name) {
  const Handle table = open_dataset(parent, name);
  const Handle type(H5Dget_type(table.id()), H5Tclose, "read the type of \"" + name + "\"");
  if (H5Tget_class(type.id()) != H5T_STRING) throw std::runtime_error("\"" + name + "\" is not a text");
  std::string text(H5Tget_size(type.id()), '\0');
  check(H5Dread(table.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()), "read \"" + name + "\"");
  text.resize(text.find_last_not_of('\0') + 1);
  return text;
}

}  // namespace kerf::hdf5
