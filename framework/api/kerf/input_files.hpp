// Files that an input names, as plugins get them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "kerf/file_mesh.hpp"
#include "kerf/sizes.hpp"

namespace kerf {

class InputFiles {
 public:
  virtual ~InputFiles() = default;
  /// The text of a file, named relative to the input file; the same on all ranks. Sets `path` to what messages call it.
  /// Where it cannot be read, sets `failure` to a sentence.
  virtual std::string read(const std::string& name, std::string& path, std::string& failure) const = 0;
  /// The mesh of a file, named relative to the input file; the same on all ranks, and one object for each file.
  /// Null where the file cannot be read: `complaints` gets the lines that say why, each with its place.
  virtual std::shared_ptr<const FileMesh> mesh(const std::string& name, std::vector<std::string>& complaints) const = 0;
  /// The sets of that mesh, one object for each file. Pre: mesh(name) is not null, and lives as long as the sets.
  virtual std::shared_ptr<const MeshSets> mesh_sets(const std::string& name) const = 0;
  /// One of a unit of length, such as "mm", in metres; or a number that is not finite where there is no such unit.
  virtual double metres(const std::string& unit) const = 0;
};

}  // namespace kerf

KERF_SIZES(input_files, KERF_SIZE(InputFiles))
