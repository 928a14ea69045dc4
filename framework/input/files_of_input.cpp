// Reads files through the reader of the input, which gives the same bytes on all ranks.
#include "input/files_of_input.hpp"

#include <filesystem>
#include <limits>

#include "core/diagnostics.hpp"
#include "core/units.hpp"
#include "mesh/mesh_digest.hpp"
#include "mesh/mesh_file.hpp"

namespace kerf {

namespace {

MeshCache::Entry read_entry(const std::string& path, const FileReader& read, std::vector<std::string>& warnings) {
  std::string failure;
  const std::string bytes = read(path, failure);
  if (!failure.empty())
    return {nullptr, {path + ": error: the file cannot be read: " + failure + "; expected a mesh"}, {}};
  Diagnostics diagnostics;
  FileMesh mesh = read_mesh({bytes, path}, diagnostics);
  warnings.insert(warnings.end(), diagnostics.warnings().begin(), diagnostics.warnings().end());
  if (diagnostics.has_errors()) return {nullptr, diagnostics.errors(), {}};
  std::string digest = digest_text(mesh);
  return {std::make_shared<const FileMesh>(std::move(mesh)), {}, std::move(digest)};
}

}  // namespace

void MeshCache::add(const std::string& path, std::shared_ptr<const FileMesh> mesh) {
  std::string digest = digest_text(*mesh);
  entries[path] = {std::move(mesh), {}, std::move(digest)};
}

std::string path_from(const std::string& origin, const std::string& folder, const std::string& name) {
  return (std::filesystem::path(origin.starts_with("--") ? "" : folder) / name).lexically_normal().string();
}

std::string FilesOfInput::read(const std::string& name, std::string& path, std::string& failure) const {
  path = path_from(origin_, folder_, name);
  return read_(path, failure);
}

std::shared_ptr<const FileMesh> FilesOfInput::mesh(const std::string& name,
                                                   std::vector<std::string>& complaints) const {
  const std::string path = path_from(origin_, folder_, name);
  auto at = meshes_.entries.find(path);
  if (at == meshes_.entries.end()) {
    at = meshes_.entries.emplace(path, read_entry(path, read_, meshes_.warnings)).first;
    complaints.insert(complaints.end(), at->second.complaints.begin(), at->second.complaints.end());
  }
  std::string& digests = meshes_.digests[name];
  if (digests.find(at->second.digest) == std::string::npos) digests += at->second.digest;
  return at->second.mesh;
}

std::shared_ptr<const MeshSets> FilesOfInput::mesh_sets(const std::string& name) const {
  MeshCache::Entry& entry = meshes_.entries.at(path_from(origin_, folder_, name));
  if (!entry.sets) entry.sets = std::make_shared<const MeshSets>(*entry.mesh);
  return entry.sets;
}

double FilesOfInput::metres(const std::string& unit) const {
  const Quantity one = to_si("1 " + unit, "m");
  return one.ok() ? one.value : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace kerf
