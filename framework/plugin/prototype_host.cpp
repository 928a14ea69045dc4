// Starts Python, and frames requests: a length, JSON, a count, numbers. Answers: a status, a length, bytes.
#include "plugin/prototype_host.hpp"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "core/activity.hpp"
#include "core/shared_folder.hpp"
#include "kerf/math.hpp"

extern char** environ;

namespace kerf {

namespace {

std::string host_script() { return shared_folder("share/kerf/python", KERF_PYTHON_OF_SOURCES) + "/law_host.py"; }

std::string python_program() {
  if (const char* given = std::getenv("KERF_PYTHON"); given != nullptr && *given != '\0') return given;
  const std::filesystem::path own = folder_of_program() / ".." / "venv" / "bin" / "python";
  std::error_code none;
  return std::filesystem::exists(own, none) ? own.string() : "python3";
}

}  // namespace

PrototypeHost::PrototypeHost(const std::string& file) : file_(file), at_work_("a law of " + file) {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    throw std::runtime_error(fmt::format("{}: no socket to Python: {}", file, std::strerror(errno)));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], 3);
  std::string python = python_program(), script = host_script(), path = file;
  std::string no_cache = "-B";
  char* arguments[] = {python.data(), no_cache.data(), script.data(), path.data(), nullptr};
  const int status = posix_spawnp(&process_, python.c_str(), &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  socket_ = ends[0];
  if (status != 0) {
    close(socket_);
    throw std::runtime_error(
        fmt::format("{}: a law in Python needs Python, but {} cannot be started: {}; set KERF_PYTHON", file, python,
                    std::strerror(status)));
  }
  try {
    laws_ = nlohmann::json::parse(request({{"do", "describe"}, {"lanes", lane_width}}, {}));
  } catch (...) {
    end();
    throw;
  }
}

PrototypeHost::~PrototypeHost() { end(); }

/// Python has nothing that is to be saved.
void PrototypeHost::end() {
  close(socket_);
  if (process_ <= 0) return;
  kill(process_, SIGKILL);
  waitpid(process_, nullptr, 0);
}

void PrototypeHost::send_all(const void* data, std::size_t size) {
  for (const char* at = static_cast<const char*>(data); size > 0;) {
    const ssize_t n = send(socket_, at, size, MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) throw std::runtime_error(fmt::format("{}: the Python of this law has ended", file_));
    at += n;
    size -= static_cast<std::size_t>(n);
  }
}

void PrototypeHost::receive_all(void* data, std::size_t size) {
  for (char* at = static_cast<char*>(data); size > 0;) {
    const ssize_t n = recv(socket_, at, size, 0);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) throw std::runtime_error(fmt::format("{}: the Python of this law has ended", file_));
    at += n;
    size -= static_cast<std::size_t>(n);
  }
}

std::string PrototypeHost::request(const nlohmann::json& head, const std::vector<double>& numbers) {
  const activity::Phase phase(at_work_.c_str());
  const std::string text = head.dump();
  const std::uint64_t sizes[2] = {text.size(), numbers.size()};
  send_all(sizes, sizeof sizes);
  send_all(text.data(), text.size());
  send_all(numbers.data(), numbers.size() * sizeof(double));
  std::uint64_t answer[2];  // 0 for success, bytes
  receive_all(answer, sizeof answer);
  std::string bytes(answer[1], '\0');
  receive_all(bytes.data(), bytes.size());
  if (answer[0] != 0) throw std::runtime_error(bytes);
  return bytes;
}

int PrototypeHost::make(int law, const nlohmann::json& parameters) {
  return std::stoi(request({{"do", "make"}, {"law", law}, {"parameters", parameters}}, {}));
}

std::vector<double> PrototypeHost::compute(int object, const std::vector<double>& numbers) {
  const std::string bytes = request({{"do", "compute"}, {"object", object}}, numbers);
  std::vector<double> all(bytes.size() / sizeof(double));
  std::memcpy(all.data(), bytes.data(), all.size() * sizeof(double));
  return all;
}

}  // namespace kerf
