// The name of the folder of results, and making it.
#include "app/result_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "core/diagnostics.hpp"
#include "parallel/communicator.hpp"

namespace kerf {

std::string result_folder(const RunOptions& options, const std::string& ending) {
  if (!options.output.empty()) return options.output;
  return (std::filesystem::path("results") / std::filesystem::path(options.input).stem()).string() + ending;
}

void make_result_folder(MPI_Comm comm, const std::string& folder) {
  std::string failure;
  if (rank_of(comm) == 0) {
    std::error_code status;
    std::filesystem::create_directories(folder, status);
    if (status)
      failure = fmt::format("{}: error: the folder for the results cannot be made: {}; name another with --output",
                            folder, status.message());
    else if (access(folder.c_str(), W_OK) != 0)
      failure = fmt::format("{}: error: nothing can be written into this folder: {}; name another with --output",
                            folder, std::strerror(errno));
  }
  failure = broadcast(comm, failure);
  if (!failure.empty()) throw InputError({failure});
}

FolderLock::FolderLock(MPI_Comm comm, const std::string& folder) {
  std::string failure;
  if (rank_of(comm) == 0) {
    id_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (id_ >= 0 && ::flock(id_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
      failure = fmt::format(
          "{}: error: another run works in this folder; wait for its end, or name another folder "
          "with --output",
          folder);
  }
  failure = broadcast(comm, failure);
  if (failure.empty()) return;
  if (id_ >= 0) ::close(id_);
  throw InputError({failure});
}

FolderLock::~FolderLock() {
  if (id_ >= 0) ::close(id_);
}

void refuse_lone_ranks(MPI_Comm comm) {
  if (size_of(comm) > 1) return;
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"}) {
    const char* text = std::getenv(name);
    const long n = text ? std::strtol(text, nullptr, 10) : 1;
    if (n > 1)
      throw InputError(
          {fmt::format("{} is {}: error: {} processes were started, and MPI knows of one only; expected a "
                       "launcher of the MPI that Kerf is built with",
                       name, n, n)});
  }
}

}  // namespace kerf
