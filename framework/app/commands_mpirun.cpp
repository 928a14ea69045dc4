// Starts the program again under mpirun, so that `kerf run --ranks 4` is all a user has to type.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <thread>

#include "app/commands.hpp"

namespace kerf {

void print_warnings(const std::vector<std::string>& lines) {
  std::fflush(stdout);
  for (const std::string& line : lines) fmt::print(stderr, "{}\n", line);
}

void print_errors(const std::vector<std::string>& lines) {
  const char* rank = std::getenv("OMPI_COMM_WORLD_RANK");
  if (rank && std::strcmp(rank, "0") != 0) {
    // mpirun ends all ranks when the first one fails; rank 0 must have spoken by then.
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    return;
  }
  for (const std::string& line : lines) fmt::print(stderr, "{}\n", line);
}

namespace {

volatile pid_t mpirun_process = 0;
extern "C" void pass_on(int) {
  if (mpirun_process > 0) kill(mpirun_process, SIGUSR1);
}

/// Runs mpirun in a process group of its own and returns its exit code. Signals that should end a run with its state
/// saved reach the ranks as SIGUSR1: mpirun passes that one on, while at SIGTERM or SIGINT it kills its ranks.
int supervise(char** words) {
  const pid_t child = fork();
  if (child == 0) {
    setpgid(0, 0);
    // Nobody would pass on anything to ranks that outlive this process: they stop with their state saved.
    prctl(PR_SET_PDEATHSIG, SIGUSR1);
    // A background group must not read the terminal.
    if (const int nothing = open("/dev/null", O_RDONLY); nothing >= 0) dup2(nothing, STDIN_FILENO);
    execvp(words[0], words);
    fmt::print(stderr, "error: mpirun cannot be started: {}; install Open MPI (openmpi-bin) or leave out --ranks\n",
               std::strerror(errno));
    _exit(exit_other);
  }
  if (child < 0) throw std::runtime_error(fmt::format("mpirun cannot be started: {}", std::strerror(errno)));
  mpirun_process = child;
  for (const int number : {SIGINT, SIGTERM, SIGUSR1}) std::signal(number, &pass_on);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : static_cast<int>(exit_other);
}

}  // namespace

bool needs_mpirun(int ranks) { return ranks > 1 && !std::getenv("OMPI_COMM_WORLD_SIZE"); }

void relaunch_under_mpirun(int ranks, int argc, char** argv) {
  if (ranks <= 0) return;
  if (const char* size = std::getenv("OMPI_COMM_WORLD_SIZE")) {
    if (std::to_string(ranks) != size)
      throw std::runtime_error(
          fmt::format("mpirun started {} ranks, but --ranks asks for {}; leave one of them out", size, ranks));
    return;
  }
  if (!needs_mpirun(ranks)) return;
  std::vector<std::string> words = {"mpirun", "-n", std::to_string(ranks), "--oversubscribe", "--bind-to", "none"};
  if (geteuid() == 0) words.push_back("--allow-run-as-root");
  // Ranks that share a core must yield it while they wait, or each waits for the others' time slices.
  if (static_cast<unsigned>(ranks) > std::thread::hardware_concurrency())
    words.insert(words.end(), {"--mca", "mpi_yield_when_idle", "1"});
  // Its comment on a rank that ends with an exit code other than zero would bury our own message.
  words.push_back("--quiet");
  words.push_back(std::filesystem::read_symlink("/proc/self/exe").string());
  for (int i = 1; i < argc; ++i) words.emplace_back(argv[i]);
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  std::exit(supervise(pointers.data()));
}

}  // namespace kerf
