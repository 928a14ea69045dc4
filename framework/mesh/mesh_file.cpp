// Chooses the reader of a mesh file, and looks for what no reader can have meant.
#include "mesh/mesh_file.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>

#include "mesh/label_map.hpp"
#include "mesh/mesh_errors.hpp"
#include "output/hdf5_front.hpp"

namespace kerf {
namespace {

bool read_bytes(const std::string& path, std::string& bytes) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return false;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  std::ifstream in(path, std::ios::binary);
  if (error || !in) return false;
  bytes.resize(size);
  in.read(bytes.data(), static_cast<std::streamsize>(size));
  return in.gcount() == static_cast<std::streamsize>(size);
}

std::string ending_of(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending;
}

bool begins_exodus(std::string_view bytes) {
  return bytes.starts_with("CDF") || bytes.starts_with("\x89HDF\r\n\x1a\n");
}

FileMesh read_by_kind(const MeshFileText& file, Diagnostics& diagnostics) {
  const std::string ending = ending_of(file.name);
  if (ending == ".h5" || hdf5::has_front(std::as_bytes(std::span(file.bytes))))
    return read_kerf_mesh(file, diagnostics);
  if (begins_exodus(file.bytes)) return read_exodus(file, diagnostics);
  if (ending == ".msh" || file.bytes.starts_with("$MeshFormat")) return read_gmsh(file, diagnostics);
  if (ending == ".inp") return read_abaqus(file, diagnostics);
  MeshErrors errors(file.name, diagnostics);
  errors.at({}, "file",
            "neither the name nor the first bytes tell what this is; expected a mesh of Gmsh (.msh), Abaqus "
            "(.inp), Exodus (.exo, .ex2, .e, .g) or Kerf (.h5)");
  return {};
}

FilePlace place_of(const FileMesh& mesh, std::size_t cell) {
  return cell < mesh.cell_places.size() ? mesh.cell_places[cell] : FilePlace{};
}

std::string cell_name(const FileMesh& mesh, std::size_t cell) {
  return "element " + std::to_string(mesh.cell_labels[cell]);
}

void check_sizes(const FileMesh& mesh, MeshErrors& errors) {
  const auto n_nodes = static_cast<std::int32_t>(mesh.points.size());
  if (mesh.cells.empty())
    errors.at({}, "empty", "the mesh has no solid elements; expected hexahedra, wedges, pyramids or tetrahedra");
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (const std::int32_t node : mesh.cells[c])
      if (node < 0 || node >= n_nodes)
        errors.at(place_of(mesh, c), "unknown node", cell_name(mesh, c) + " has a node that does not exist");
}

void check_labels(const FileMesh& mesh, MeshErrors& errors) {
  if (mesh.labels_repeat) return;
  const LabelMap nodes(mesh.node_labels), cells(mesh.cell_labels);
  for (const std::int32_t i : nodes.repeated())
    errors.at({}, "repeated node",
              "node " + std::to_string(mesh.node_labels[static_cast<std::size_t>(i)]) +
                  " is there twice; expected different numbers");
  for (const std::int32_t i : cells.repeated()) {
    const auto cell = static_cast<std::size_t>(i);
    errors.at(place_of(mesh, cell), "repeated element",
              cell_name(mesh, cell) + " is there twice; expected different numbers");
  }
}

void check_blocks(const FileMesh& mesh, MeshErrors& errors) {
  constexpr std::int32_t none = -1;
  std::vector<std::int32_t> block_of(mesh.cells.size(), none);
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const MeshBlock& block = mesh.blocks[b];
    if (block.cells.empty())
      errors.at(block.place, "empty block", "block " + in_quotes(block.name) + " has no solid elements");
    for (const std::int32_t cell : block.cells) {
      const auto c = static_cast<std::size_t>(cell);
      if (cell < 0 || c >= block_of.size()) {
        errors.at(block.place, "unknown element",
                  "block " + in_quotes(block.name) + " has an element that does not exist");
        continue;
      }
      if (block_of[c] != none)
        errors.at(place_of(mesh, c), "two blocks",
                  cell_name(mesh, c) + " is in the blocks " +
                      in_quotes(mesh.blocks[static_cast<std::size_t>(block_of[c])].name) + " and " +
                      in_quotes(block.name) + "; expected one");
      block_of[c] = static_cast<std::int32_t>(b);
    }
  }
  for (std::size_t c = 0; c < block_of.size(); ++c)
    if (block_of[c] == none)
      errors.at(place_of(mesh, c), "no block", cell_name(mesh, c) + " is in no block; expected one");
}

/// The corners of a cell, ascending; the last one stands where others repeat.
std::array<std::int32_t, 8> corners_of(std::array<std::int32_t, 8> nodes) {
  std::sort(nodes.begin(), nodes.end());
  const auto end = std::unique(nodes.begin(), nodes.end());
  std::fill(end, nodes.end(), end[-1]);
  return nodes;
}

std::uint64_t hash_of(const std::array<std::int32_t, 8>& corners) {
  std::uint64_t hash = 0;
  for (const std::int32_t node : corners) {
    hash = (hash ^ static_cast<std::uint64_t>(node)) * 0x9e3779b97f4a7c15u;
    hash ^= hash >> 29;
  }
  return hash;
}

/// Cells that stand in the same place. They would share all nodes and the mass would count twice.
void check_doubles(const FileMesh& mesh, MeshErrors& errors) {
  std::vector<std::pair<std::uint64_t, std::int32_t>> hashes;
  hashes.reserve(mesh.cells.size());
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    hashes.emplace_back(hash_of(corners_of(mesh.cells[c])), static_cast<std::int32_t>(c));
  std::sort(hashes.begin(), hashes.end());
  const auto corners = [&](std::size_t i) {
    return corners_of(mesh.cells[static_cast<std::size_t>(hashes[i].second)]);
  };
  for (std::size_t i = 1; i < hashes.size(); ++i) {
    if (hashes[i].first != hashes[i - 1].first || corners(i) != corners(i - 1)) continue;
    const auto first = static_cast<std::size_t>(hashes[i - 1].second),
               cell = static_cast<std::size_t>(hashes[i].second);
    errors.at(place_of(mesh, cell), "same nodes",
              cell_name(mesh, cell) + " has the nodes of " + cell_name(mesh, first) + "; expected one of them");
  }
}

/// A plate of shells in the middle of a model must not be missed in silence.
void tell_left_out(const FileMesh& mesh, const std::string& name, Diagnostics& diagnostics) {
  std::int64_t all = 0;
  std::string kinds;
  for (const auto& [kind, n] : mesh.left_out) {
    all += n;
    kinds += (kinds.empty() ? "" : ", ") + std::to_string(n) + " " + in_quotes(kind);
  }
  if (all == 0) return;
  MeshErrors(name, diagnostics)
      .warn({}, std::to_string(all) + (all == 1 ? " element that is no solid is" : " elements that are no solids are") +
                    " left out, by kind: " + kinds);
}

}  // namespace

FileMesh read_mesh(const MeshFileText& file, Diagnostics& diagnostics) {
  const std::size_t before = diagnostics.errors().size();
  FileMesh mesh = read_by_kind(file, diagnostics);
  if (diagnostics.errors().size() == before) check_mesh(mesh, file.name, diagnostics);
  if (diagnostics.errors().size() == before) tell_left_out(mesh, file.name, diagnostics);
  return mesh;
}

FileMesh read_mesh_file(const std::string& path, Diagnostics& diagnostics) {
  std::string bytes;
  if (read_bytes(path, bytes)) return read_mesh({bytes, path}, diagnostics);
  MeshErrors errors(path, diagnostics);
  errors.at({}, "file", "the file cannot be read; expected a mesh of Gmsh, Abaqus, Exodus or Kerf");
  return {};
}

void check_mesh(const FileMesh& mesh, const std::string& name, Diagnostics& diagnostics) {
  MeshErrors errors(name, diagnostics);
  check_sizes(mesh, errors);
  check_labels(mesh, errors);
  check_blocks(mesh, errors);
  check_doubles(mesh, errors);
}

}  // namespace kerf
