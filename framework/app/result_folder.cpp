// The name of the folder of results, and making it.
#include "app/result_folder.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
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

}  // namespace kerf
