// Finds files that come with Kerf from where the running program is.
#include "core/shared_folder.hpp"

#include <system_error>

namespace kerf {

std::filesystem::path folder_of_program() {
  std::error_code unknown;
  return std::filesystem::read_symlink("/proc/self/exe", unknown).parent_path();
}

std::string shared_folder(const std::string& place, const std::string& of_sources) {
  const std::filesystem::path installed = folder_of_program() / ".." / place;
  std::error_code none;
  if (!std::filesystem::is_directory(installed, none)) return of_sources;
  return std::filesystem::weakly_canonical(installed, none).string();
}

}  // namespace kerf
