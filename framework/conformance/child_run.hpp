// Runs of this program as child processes, in a folder of their own.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace kerf {

struct ChildRun {
  int code = 0;  // exit code; 128 and the number of the signal where one ended it
  std::string errors;  // the lines with "error:", or the last line
  nlohmann::json summary;  // null where there is none
  std::string folder;
};

/// `kerf run INPUT --output FOLDER WORDS`, for at most `seconds`. Throws std::runtime_error where no process can be
/// started.
ChildRun run_child(const std::string& input, const std::string& folder, const std::vector<std::string>& words,
                   int seconds = 300);

}  // namespace kerf
