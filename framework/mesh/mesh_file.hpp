// The readers of files of meshes.
//
// A reader keeps what Kerf can compute, the solids, and counts the rest by name, so that nothing is left out unseen.
#pragma once

#include <string>
#include <string_view>

#include "core/diagnostics.hpp"
#include "kerf/file_mesh.hpp"

namespace kerf {

/// What a reader is given: the bytes of the file and what messages call it.
struct MeshFileText {
  std::string_view bytes;
  std::string name;
};

/// Gmsh 2.2 and 4.1, as text or binary, of either byte order. Blocks are physical volumes, or, where there are none,
/// the volumes themselves; node sets are physical points, curves, surfaces and volumes; face sets physical surfaces. A
/// physical group without a name is called by its number. Mistakes go to `diagnostics`, at "name:line:column" in text
/// and "name" in binary files. Local.
FileMesh read_gmsh(const MeshFileText& file, Diagnostics& diagnostics);

/// Abaqus input decks: *NODE, *ELEMENT of types C3D8, C3D8R, C3D6, C3D4 and their kin, *NSET and *ELSET with GENERATE,
/// *SURFACE of elements' faces, *PART, *INSTANCE with translation and rotation, *ASSEMBLY, *INCLUDE refused. Blocks
/// are sets of elements that a *SOLID SECTION names, or else all elements of one *ELEMENT with ELSET; instances stand
/// before names as "instance.set". Other keywords are left alone, materials and steps among them. Local.
FileMesh read_abaqus(const MeshFileText& file, Diagnostics& diagnostics);

/// Exodus II in any netCDF format, classic ones and netCDF-4. Blocks are element blocks of HEX8, WEDGE6, PYRAMID5 and
/// TETRA4 that have elements; node sets and side sets keep their names. Messages name no line. Local.
FileMesh read_exodus(const MeshFileText& file, Diagnostics& diagnostics);

/// Kerf's own form, of which every byte is compared with a checksum, and the mesh with its digest. Local.
FileMesh read_kerf_mesh(const MeshFileText& file, Diagnostics& diagnostics);
/// A mesh in this form: all that a FileMesh holds, to the bit. Local.
std::string kerf_mesh_bytes(const FileMesh& mesh);
/// Writes it to a file, by convention NAME.h5, which is complete or not there. Throws std::runtime_error. Local.
void write_mesh(const FileMesh& mesh, const std::string& path);

/// Whichever of the above the ending of the name and the first bytes tell: .msh, .inp, .exo, .e, .g, .ex2, .h5. Where
/// the reader finds no mistake, check_mesh looks for more, and a warning tells what is left out. Post: the mesh is
/// sound where `diagnostics` has no new errors. Local.
FileMesh read_mesh(const MeshFileText& file, Diagnostics& diagnostics);
/// The same for a file of this machine. Local.
FileMesh read_mesh_file(const std::string& path, Diagnostics& diagnostics);

/// What no reader can have meant: cells with nodes that do not exist, labels that occur twice, cells in two blocks or
/// in none, cells of the same nodes, blocks without cells. Added to `diagnostics`, at most twenty of each kind. Local.
void check_mesh(const FileMesh& mesh, const std::string& name, Diagnostics& diagnostics);

}  // namespace kerf
