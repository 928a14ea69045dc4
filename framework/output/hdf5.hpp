// Thin owners around the C interface of parallel HDF5: handles that close themselves, errors that are sentences.
//
// Included by .cpp files of this room only, so that no other room has to find HDF5's headers.
#pragma once

#include <hdf5.h>
#include <mpi.h>

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace kerf::hdf5 {

/// Throws std::runtime_error: "cannot <what>: <what HDF5 says>".
[[noreturn]] void fail(const std::string& what);

/// Throws where `status` is negative. `what` completes "cannot ...".
void check(herr_t status, const std::string& what);

/// Owns one HDF5 identifier of any kind.
class Handle {
 public:
  using Closer = herr_t (*)(hid_t);
  Handle() = default;
  /// Throws where `id` is negative.
  Handle(hid_t id, Closer close, const std::string& what);
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~Handle() { reset(); }
  void reset() noexcept;
  hid_t id() const { return id_; }
  explicit operator bool() const { return id_ >= 0; }

 private:
  hid_t id_ = H5I_INVALID_HID;
  Closer close_ = nullptr;
};

/// The HDF5 type of a C++ type.
template <class T>
hid_t type_of();

/// Files opened by all ranks together. Collective. No metadata reaches the disk between two calls of flush(),
/// so a file that is cut off at any moment is the file of the last flush.
Handle create_file(MPI_Comm comm, const std::string& path);
Handle open_file(MPI_Comm comm, const std::string& path, bool writable);
/// A file opened for writing by the calling rank alone.
Handle open_file_alone(const std::string& path);
void flush(const Handle& file);

Handle create_group(const Handle& parent, const std::string& name);
Handle open_group(const Handle& parent, const std::string& name);
Handle open_dataset(const Handle& parent, const std::string& name);
bool has_link(const Handle& parent, const std::string& name);
/// Names in a group, in alphabetical order.
std::vector<std::string> names_in(const Handle& group);

/// A table of fixed size. `components` = 0 makes it one-dimensional. Collective.
Handle create_table(const Handle& parent, const std::string& name, hid_t type, std::int64_t rows, int components);
/// A table without rows that can be extended; storage is given out in chunks of `chunk_rows`. Collective.
Handle create_growing_table(const Handle& parent, const std::string& name, hid_t type, int components,
                            std::int64_t chunk_rows);
std::int64_t n_rows(const Handle& table);
/// Entries per row; 1 for a one-dimensional table.
int n_components(const Handle& table);
/// Whether the entries are stored as T, so that reading them converts nothing.
template <class T>
bool is_table_of(const Handle& table);
/// Changes the number of rows. Collective.
void set_rows(const Handle& table, std::int64_t rows);

/// Transfers whole rows, `values.size() / n_components` of them, beginning at row `begin`. Not collective: a rank
/// without rows does nothing. Independent transfers are used on purpose: each rank's rows are contiguous in the
/// file, so there is nothing for two-phase collective buffering to gather.
template <class T>
void write_rows(const Handle& table, std::int64_t begin, std::span<const T> values);
template <class T>
void read_rows(const Handle& table, std::int64_t begin, std::span<T> values);

/// Attributes; created or overwritten. Collective, with equal values on all ranks.
void write_attribute(const Handle& owner, const std::string& name, std::span<const std::int64_t> values, bool scalar);
void write_attribute(const Handle& owner, const std::string& name, const std::string& text);
bool has_attribute(const Handle& owner, const std::string& name);
/// First entry of an integer attribute.
std::int64_t read_attribute(const Handle& owner, const std::string& name);

/// A list of texts as a table of fixed-length strings, and one text as a scalar of any length. The transfer is
/// done by `is_writer` alone; creation is collective.
void write_texts(const Handle& parent, const std::string& name, const std::vector<std::string>& texts, bool is_writer);
void write_text(const Handle& parent, const std::string& name, const std::string& text, bool is_writer);
std::string read_text(const Handle& parent, const std::string& name);

}  // namespace kerf::hdf5
