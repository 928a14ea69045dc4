// Files by the system calls themselves: every call that fails is noticed and becomes a sentence with its cause.
#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

namespace kerf {

/// Owns the descriptor of an open file. All functions throw std::runtime_error: "cannot write "results.vtkhdf": No
/// space left on device".
class File {
 public:
  enum class Mode { read, update, create, append };
  File() = default;
  /// `create` empties a file that is there; `append` and `update` need one that is there.
  File(const std::string& path, Mode mode);
  File(File&& other) noexcept : path_(std::move(other.path_)), id_(std::exchange(other.id_, -1)) {}
  File& operator=(File&& other) noexcept {
    std::swap(path_, other.path_);
    std::swap(id_, other.id_);
    return *this;
  }
  /// Closes without a word; close() reports.
  ~File();

  bool is_open() const { return id_ >= 0; }
  const std::string& path() const { return path_; }
  /// What messages call the file from now on, after it was renamed.
  void call(const std::string& path) { path_ = path; }
  /// Writes all bytes at a place of the file, or at its end.
  void write_at(std::uint64_t place, std::span<const std::byte> bytes);
  void append(const std::string& text);
  /// Reads exactly this many bytes; fewer in the file are a failure.
  void read_at(std::uint64_t place, std::span<std::byte> bytes) const;
  std::uint64_t size() const;
  void cut(std::uint64_t size);
  /// Waits until the contents are on the disk. A file that somebody has removed is a failure, here and in append().
  void sync();
  void close();

 private:
  [[noreturn]] void fail(const char* what) const;
  void require_name() const;
  std::string path_;
  int id_ = -1;
};

/// Makes a folder and those around it, or does nothing where it is there. Throws std::runtime_error.
void make_folder(const std::string& path);
/// Renames a file that is complete and waits until the disk knows its name. Throws std::runtime_error.
void publish(const std::string& from, const std::string& to);
/// Renames, or does nothing where `from` does not exist. Throws std::runtime_error.
void rename_if_there(const std::string& from, const std::string& to);
/// Removes, or does nothing where there is no such file. Throws std::runtime_error.
void remove_if_there(const std::string& path);
/// Writes a small file so that a reader finds the old one or the new one and never half of one.
void replace_file(const std::string& path, const std::string& text);
/// Writes to the standard output at once. Throws std::runtime_error.
void print_now(const std::string& text);

/// A file that all ranks write and read, each at places of its own. The transfers are not collective: a rank keeps
/// its first failure until agree() or another collective call makes it known to all.
class SharedFile {
 public:
  SharedFile() = default;
  /// Rank 0 opens first and, with Mode::create, makes the file. Collective; throws OutputError.
  SharedFile(MPI_Comm comm, const std::string& path, File::Mode mode);

  void write_at(std::uint64_t place, std::span<const std::byte> bytes);
  void read_at(std::uint64_t place, std::span<std::byte> bytes);
  /// Makes the file this long where it is shorter.
  void reach(std::uint64_t size);
  /// Waits until what this rank wrote is on the disk.
  void sync();
  /// Throws OutputError on all ranks where a transfer of any rank has failed. Collective.
  void agree();
  /// Gives the file, which is complete on the disk, another name. Collective; throws OutputError.
  void publish(const std::string& path);
  /// Collective; throws OutputError.
  void close();
  File& local() { return file_; }
  const std::string& path() const { return file_.path(); }

 private:
  template <class Call>
  void attempt(Call&& call);
  MPI_Comm comm_ = MPI_COMM_NULL;
  File file_;
  std::string failure_;
};

}  // namespace kerf
