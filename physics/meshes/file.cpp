// The mesh of a file: of Gmsh, Abaqus or Exodus, one block for each part.
//
// Parts of one file share the nodes of the file. Elements and nodes keep the order of the file. Wedges, pyramids and
// tetrahedra are hexahedra with corners that coincide; their corners are turned to the order of CellKind.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>

#include "kerf/collapsed_cell.hpp"
#include "kerf/mesh.hpp"
#include "kerf/plugin.hpp"
#include "part_nodes.hpp"

namespace kerf {
namespace {

class MeshOfFile final : public MeshGenerator {
 public:
  std::string file, block, unit;

  static void describe(Schema<MeshOfFile>& s) {
    s.text(&MeshOfFile::file, "file",
           "file of Gmsh (.msh, 2.2 or 4.1), Abaqus (.inp), Exodus II (.exo, .e, .g) or Kerf (.h5), named relative to "
           "the input file");
    s.text(&MeshOfFile::unit, "unit", "unit of length of the file, such as mm");
    s.text(&MeshOfFile::block, "block", "block of the file that is the part; not needed where the file has one only")
        .optional();
  }

  std::vector<std::string> load(const InputFiles& files) override {
    std::vector<std::string> complaints;
    mesh_ = files.mesh(file, complaints);
    if (mesh_) sets_ = files.mesh_sets(file);
    scale_ = files.metres(unit);
    if (!(std::isfinite(scale_) && scale_ > 0.0))
      complaints.push_back(
          fmt::format("{}: error: `unit` is \"{}\"; expected a unit of length, such as mm", origin, unit));
    return complaints;
  }

  std::vector<std::string> prepare() override {
    if (!mesh_) return {fmt::format("the mesh \"{}\" cannot be used; expected a file without mistakes", file)};
    const MeshBlock* taken = chosen();
    if (!taken) return {no_block()};
    cells_ = &taken->cells;
    if (cells_->empty())
      return {fmt::format("the block \"{}\" of \"{}\" is empty; expected elements", taken->name, file)};
    for (const std::int32_t c : *cells_)
      if (kind_of_cell(in_order_of_kind(mesh_->cells[static_cast<std::size_t>(c)])) == CellKind::unknown)
        return {fmt::format(
            "element {} of \"{}\" has corners that coincide in another way than those of a wedge, a pyramid or a "
            "tetrahedron; expected eight different nodes, or one of these cells",
            mesh_->cell_labels[static_cast<std::size_t>(c)], file)};
    nodes_ = PartNodes(mesh_->cells, *cells_);
    return {};
  }

  std::int64_t n_nodes() const override { return static_cast<std::int64_t>(nodes_.size()); }
  std::int64_t n_elements() const override { return static_cast<std::int64_t>(cells_->size()); }
  Vec3 node(std::int64_t i) const override {
    const auto& x = mesh_->points[whole(i)];
    return {x[0] * scale_, x[1] * scale_, x[2] * scale_};
  }
  ElementNodeIds element(std::int64_t e) const override {
    ElementNodeIds ids{};
    const auto cell = in_order_of_kind(mesh_->cells[whole_cell(e)]);
    for (std::size_t k = 0; k < 8; ++k) ids[k] = nodes_.local(cell[k]);
    return ids;
  }
  std::vector<std::string> face_names() const override { return sets_->names(); }
  int find_face(const std::string& name) const override { return sets_->find(name); }
  bool on_face(std::int64_t i, int face) const override {
    const std::span<const std::int32_t> nodes = sets_->nodes(face);
    return std::binary_search(nodes.begin(), nodes.end(), nodes_.whole(static_cast<std::size_t>(i)));
  }

  const void* whole_mesh() const override { return mesh_.get(); }
  std::int64_t node_of_whole(std::int64_t i) const override { return nodes_.whole(static_cast<std::size_t>(i)); }
  std::int64_t node_label(std::int64_t i) const override { return mesh_->node_labels[whole(i)]; }
  std::int64_t element_label(std::int64_t e) const override { return mesh_->cell_labels[whole_cell(e)]; }

 private:
  std::size_t whole(std::int64_t i) const {
    return static_cast<std::size_t>(nodes_.whole(static_cast<std::size_t>(i)));
  }
  std::size_t whole_cell(std::int64_t e) const {
    return static_cast<std::size_t>((*cells_)[static_cast<std::size_t>(e)]);
  }

  const MeshBlock* chosen() const {
    if (!block.empty()) return mesh_->block(block);
    return mesh_->blocks.size() == 1 ? &mesh_->blocks.front() : nullptr;
  }

  std::string no_block() const {
    std::string all, meant;
    for (const MeshBlock& b : mesh_->blocks) {
      const std::string called = mesh_->call(b);
      all += (all.empty() ? "\"" : ", \"") + called + "\"";
      if (b.name == block) meant += (meant.empty() ? "\"" : " or \"") + called + "\"";
    }
    if (!meant.empty())
      return fmt::format("\"{}\" has more than one block \"{}\"; expected `block` to be {}", file, block, meant);
    return fmt::format("{}; expected `block` to be one of {}",
                       block.empty() ? fmt::format("\"{}\" has {} blocks", file, mesh_->blocks.size())
                                     : fmt::format("\"{}\" has no block \"{}\"", file, block),
                       all.empty() ? "none: the file has no solid elements" : all);
  }

  std::shared_ptr<const FileMesh> mesh_;
  std::shared_ptr<const MeshSets> sets_;  // of the whole mesh
  double scale_ = 1.0;  // of the unit [m]
  const std::vector<std::int32_t>* cells_ = nullptr;  // of the block
  PartNodes nodes_;  // of the block
};

}  // namespace
}  // namespace kerf

KERF_MESH(kerf::MeshOfFile, "file", "mesh of a file of Gmsh, Abaqus or Exodus: one block for each part")
