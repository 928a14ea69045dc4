// Where the files are that come with Kerf beside the program: the material library, templates of plugins, headers.
#pragma once

#include <filesystem>
#include <string>

namespace kerf {

/// Where the running program is; empty where the system does not say.
std::filesystem::path folder_of_program();

/// The folder `place`, such as "share/kerf/library", of the installation that the running program belongs to;
/// `of_sources` where there is no such folder, as in a build tree.
std::string shared_folder(const std::string& place, const std::string& of_sources);

}  // namespace kerf
