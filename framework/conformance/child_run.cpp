// Starts this program again, with its output in a file.
#include "conformance/child_run.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <thread>

namespace kerf {

namespace {

/// Exit code of a program; it is ended where it takes longer than `seconds`.
int run_program(const std::vector<std::string>& words, const std::string& log, int seconds) {
  std::vector<char*> pointers;
  for (const std::string& word : words) pointers.push_back(const_cast<char*>(word.c_str()));
  pointers.push_back(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGTERM);  // nobody would read what it writes
    const int out = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    const int nothing = open("/dev/null", O_RDONLY);
    if (out < 0 || nothing < 0 || dup2(nothing, 0) < 0 || dup2(out, 1) < 0 || dup2(out, 2) < 0) _exit(126);
    setenv("OMPI_MCA_mpi_yield_when_idle", "1", 0);  // ranks that wait leave the cores to others
    execv(pointers[0], pointers.data());
    _exit(127);
  }
  if (child < 0) throw std::runtime_error(fmt::format("no process can be started: {}", std::strerror(errno)));
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(seconds);
  int status = 0;
  while (true) {
    const pid_t ended = waitpid(child, &status, WNOHANG);
    if (ended == child) break;
    if (ended < 0 && errno != EINTR) throw std::runtime_error("a child process is lost");
    if (std::chrono::steady_clock::now() > end) {
      kill(-child, SIGKILL);
      while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
      }
      break;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

std::string errors_in(const std::string& log) {
  std::ifstream file(log);
  std::string errors, last;
  for (std::string line; std::getline(file, line);) {
    if (line.find("error:") != std::string::npos) errors += (errors.empty() ? "" : "; ") + line;
    if (!line.empty()) last = line;
  }
  return errors.empty() ? last : errors;
}

}  // namespace

ChildRun run_child(const std::string& input, const std::string& folder, const std::vector<std::string>& words,
                   int seconds) {
  ChildRun run;
  run.folder = folder;
  std::vector<std::string> all = {std::filesystem::read_symlink("/proc/self/exe").string(), "run", input, "--output",
                                  folder};
  all.insert(all.end(), words.begin(), words.end());
  all.insert(all.end(), {"--set", "checks.stall_limit=120"});  // before its time is over: it names what loops
  run.code = run_program(all, folder + ".log", seconds);
  if (run.code != 0) run.errors = errors_in(folder + ".log");
  if (run.code == 128 + SIGSEGV) run.errors = "it reads or writes memory that is not its own";
  std::ifstream summary(folder + "/summary.json");
  if (summary) run.summary = nlohmann::json::parse(summary, nullptr, false);
  return run;
}

}  // namespace kerf
