// What readers of meshes find wrong: collected with the place in the file, and no flood where one mistake repeats.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "mesh/mesh_file.hpp"

namespace kerf {

/// Errors and warnings of one file. The first few of each kind are written out, the rest is counted and told at the
/// end.
class MeshErrors {
 public:
  MeshErrors(const std::string& file, Diagnostics& diagnostics)
      : file_(std::make_shared<const std::string>(file)), diagnostics_(diagnostics) {}
  MeshErrors(const MeshErrors&) = delete;
  MeshErrors& operator=(const MeshErrors&) = delete;
  ~MeshErrors();

  /// Says `message` at `place` unless `most` of this kind have been said.
  void at(FilePlace place, const std::string& kind, const std::string& message, std::int64_t most = 20);
  void warn(FilePlace place, const std::string& message);
  std::int64_t count() const { return count_; }

 private:
  struct Kind {
    std::int64_t n = 0, most = 0;
  };
  std::shared_ptr<const std::string> file_;
  Diagnostics& diagnostics_;
  std::map<std::string, Kind, std::less<>> kinds_;
  std::int64_t count_ = 0, warnings_ = 0;
};

/// A piece of a file for a message: in quotes, without what cannot be printed, at most forty letters.
std::string in_quotes(std::string_view text);

}  // namespace kerf
