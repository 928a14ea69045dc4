// The system calls behind file.hpp.
#include "output/file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <system_error>

#include "core/activity.hpp"
#include "output/collective.hpp"

namespace kerf {

namespace {

[[noreturn]] void fail_on(const std::string& what, const std::string& path) {
  throw std::runtime_error("cannot " + what + " \"" + path + "\": " + std::strerror(errno));
}

/// Repeats a call that a signal interrupts.
template <class Call>
auto unbroken(Call&& call) {
  auto result = call();
  while (result < 0 && errno == EINTR) result = call();
  return result;
}

/// Waits until the disk knows what is in a folder. Some file systems cannot do this and say so; that is no failure.
void sync_folder(const std::string& path) {
  std::string folder = std::filesystem::path(path).parent_path().string();
  if (folder.empty()) folder = ".";
  const int id = unbroken([&] { return ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); });
  if (id < 0) fail_on("open the folder", folder);
  const bool synced = unbroken([&] { return ::fsync(id); }) == 0 || errno == EINVAL || errno == ENOTSUP;
  const int reason = errno;
  const bool closed = ::close(id) == 0 || errno == EINTR;
  if (!synced) errno = reason;
  if (!synced || !closed) fail_on("write the folder", folder);
}

/// Another machine may see a file somewhat later than the one that made it.
int open_patiently(const std::string& path, int flags) {
  constexpr int patience = 20;  // tenths of a second
  int id = -1;
  for (int i = 0; i < patience; ++i) {
    id = unbroken([&] { return ::open(path.c_str(), flags | O_CLOEXEC); });
    if (id >= 0 || errno != ENOENT) break;
    ::usleep(100000);
  }
  return id;
}

}  // namespace

File::File(const std::string& path, Mode mode) : path_(path) {
  switch (mode) {
    case Mode::read:
      id_ = unbroken([&] { return ::open(path.c_str(), O_RDONLY | O_CLOEXEC); });
      break;
    case Mode::update:
      id_ = open_patiently(path, O_RDWR);
      break;
    case Mode::create:
      id_ = unbroken([&] { return ::open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666); });
      break;
    case Mode::append:
      id_ = unbroken([&] { return ::open(path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC); });
      break;
  }
  if (id_ < 0) fail(mode == Mode::create ? "create" : "open");
}

File::~File() {
  if (id_ >= 0) ::close(id_);
}

void File::fail(const char* what) const { fail_on(what, path_); }

void File::write_at(std::uint64_t place, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    activity::beat();
    const ssize_t n = unbroken([&] { return ::pwrite(id_, bytes.data(), bytes.size(), static_cast<off_t>(place)); });
    if (n == 0) errno = ENOSPC;
    if (n <= 0) fail("write");
    bytes = bytes.subspan(static_cast<std::size_t>(n));
    place += static_cast<std::uint64_t>(n);
  }
}

/// A file without a name takes all that is written and is gone at the end of the run.
void File::require_name() const {
  struct stat state {};
  if (::fstat(id_, &state) != 0) fail("look at");
  if (state.st_nlink == 0) throw std::runtime_error("cannot write \"" + path_ + "\": somebody has removed it");
}

void File::append(const std::string& text) {
  require_name();
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t n = unbroken([&] { return ::write(id_, text.data() + done, text.size() - done); });
    if (n == 0) errno = ENOSPC;
    if (n <= 0) fail("write");
    done += static_cast<std::size_t>(n);
  }
}

void File::read_at(std::uint64_t place, std::span<std::byte> bytes) const {
  while (!bytes.empty()) {
    activity::beat();
    const ssize_t n = unbroken([&] { return ::pread(id_, bytes.data(), bytes.size(), static_cast<off_t>(place)); });
    if (n < 0) fail("read");
    if (n == 0) throw std::runtime_error("cannot read \"" + path_ + "\": it ends too early");
    bytes = bytes.subspan(static_cast<std::size_t>(n));
    place += static_cast<std::uint64_t>(n);
  }
}

std::uint64_t File::size() const {
  struct stat state {};
  if (::fstat(id_, &state) != 0) fail("look at");
  return static_cast<std::uint64_t>(state.st_size);
}

void File::cut(std::uint64_t size) {
  if (unbroken([&] { return ::ftruncate(id_, static_cast<off_t>(size)); }) != 0) fail("shorten");
}

void File::sync() {
  require_name();
  if (unbroken([&] { return ::fdatasync(id_); }) != 0 && errno != EINVAL && errno != ENOTSUP) fail("write");
}

void File::close() {
  // The descriptor is free whatever close() says; a second call could close another file.
  if (id_ >= 0 && ::close(std::exchange(id_, -1)) != 0 && errno != EINTR) fail("close");
}

void make_folder(const std::string& path) {
  std::error_code status;
  std::filesystem::create_directories(path, status);
  if (status) throw std::runtime_error("cannot make the folder \"" + path + "\": " + status.message());
}

void publish(const std::string& from, const std::string& to) {
  if (std::rename(from.c_str(), to.c_str()) != 0) fail_on("replace", to);
  sync_folder(to);
}

void rename_if_there(const std::string& from, const std::string& to) {
  if (std::rename(from.c_str(), to.c_str()) != 0 && errno != ENOENT) fail_on("rename", from);
}

void remove_if_there(const std::string& path) {
  if (::unlink(path.c_str()) != 0 && errno != ENOENT) fail_on("remove", path);
}

void replace_file(const std::string& path, const std::string& text) {
  const std::string unfinished = path + ".part";
  File file(unfinished, File::Mode::create);
  file.append(text);
  file.sync();
  file.close();
  publish(unfinished, path);
}

void print_now(const std::string& text) {
  std::fflush(stdout);  // what others have left there comes first
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t n = unbroken([&] { return ::write(STDOUT_FILENO, text.data() + done, text.size() - done); });
    if (n < 0) throw std::runtime_error(std::string("cannot write to the standard output: ") + std::strerror(errno));
    done += static_cast<std::size_t>(n);
  }
}

// ---------------------------------------------------------------------------------------------------------
// A file of all ranks

SharedFile::SharedFile(MPI_Comm comm, const std::string& path, File::Mode mode) : comm_(comm) {
  on_root(comm, [&] { file_ = File(path, mode); });
  if (!file_.is_open()) attempt([&] { file_ = File(path, mode == File::Mode::create ? File::Mode::update : mode); });
  agree();
}

template <class Call>
void SharedFile::attempt(Call&& call) {
  if (!failure_.empty()) return;
  try {
    call();
  } catch (const std::exception& e) {
    failure_ = e.what();
  }
}

void SharedFile::write_at(std::uint64_t place, std::span<const std::byte> bytes) {
  attempt([&] { file_.write_at(place, bytes); });
}
void SharedFile::read_at(std::uint64_t place, std::span<std::byte> bytes) {
  attempt([&] { file_.read_at(place, bytes); });
}
void SharedFile::reach(std::uint64_t size) {
  attempt([&] {
    if (file_.size() < size) file_.cut(size);
  });
}
void SharedFile::sync() {
  attempt([&] { file_.sync(); });
}
void SharedFile::agree() { kerf::agree(comm_, std::exchange(failure_, {})); }
void SharedFile::publish(const std::string& path) {
  on_root(comm_, [&] { kerf::publish(file_.path(), path); });
  file_.call(path);
}
void SharedFile::close() {
  attempt([&] { file_.close(); });
  agree();
}

}  // namespace kerf
