// What plugins get of the files that an input names; meshes are read once, however many parts are taken from them.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "input/curve_table.hpp"
#include "kerf/input_files.hpp"

namespace kerf {

/// The meshes of files that an input has named so far, by path.
struct MeshCache {
  struct Entry {
    std::shared_ptr<const FileMesh> mesh;  // null where the file is no mesh
    std::vector<std::string> complaints;
    std::string digest;  // of the mesh, whatever its form
    std::shared_ptr<const MeshSets> sets = nullptr;  // until somebody asks for them
  };
  std::map<std::string, Entry> entries;
  std::map<std::string, std::string> digests;  // by the name in the input; several where it names several files
  std::vector<std::string> warnings;  // about all files, each file once
  /// A mesh that another reader has made.
  void add(const std::string& path, std::shared_ptr<const FileMesh> mesh);
};

/// A file named in the input is relative to the input's folder, one named on the command line to the present one.
std::string path_from(const std::string& origin, const std::string& folder, const std::string& name);

class FilesOfInput final : public InputFiles {
 public:
  /// `origin` is where the input names the files, `folder` that of the input.
  FilesOfInput(std::string origin, std::string folder, const FileReader& read, MeshCache& meshes)
      : origin_(std::move(origin)), folder_(std::move(folder)), read_(read), meshes_(meshes) {}
  std::string read(const std::string& name, std::string& path, std::string& failure) const override;
  std::shared_ptr<const FileMesh> mesh(const std::string& name, std::vector<std::string>& complaints) const override;
  std::shared_ptr<const MeshSets> mesh_sets(const std::string& name) const override;
  double metres(const std::string& unit) const override;

 private:
  std::string origin_, folder_;
  const FileReader& read_;
  MeshCache& meshes_;
};

}  // namespace kerf
