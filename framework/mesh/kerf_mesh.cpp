// Kerf's own form of a mesh, mesh.h5: an HDF5 file that any HDF5 library reads. doc/users/mesh_files.md has the layout.
#include <cstring>
#include <stdexcept>
#include <string>

#include "mesh/mesh_digest.hpp"
#include "mesh/mesh_errors.hpp"
#include "mesh/mesh_file.hpp"
#include "output/file.hpp"
#include "output/hdf5_memory.hpp"

namespace kerf {
namespace {

using hdf5::BytesReader;
using hdf5::BytesWriter;
using hdf5::Group;

constexpr std::int64_t version = 1;

/// The numbers of rows of fixed length, one after another.
template <class T, std::size_t width>
std::span<const T> flat(const std::vector<std::array<T, width>>& rows) {
  return {rows.empty() ? nullptr : rows.front().data(), rows.size() * width};
}

template <class T, std::size_t width>
void unflatten(const std::vector<T>& numbers, std::vector<std::array<T, width>>& rows) {
  rows.resize(numbers.size() / width);
  if (!rows.empty()) std::memcpy(rows.data(), numbers.data(), rows.size() * sizeof rows.front());
}

std::vector<std::int32_t> numbers_of(const std::vector<FilePlace>& places) {
  std::vector<std::int32_t> numbers;
  numbers.reserve(2 * places.size());
  for (const FilePlace& p : places) numbers.insert(numbers.end(), {p.line, p.column});
  return numbers;
}

std::vector<FilePlace> places_of(const std::vector<std::int32_t>& numbers) {
  std::vector<FilePlace> places;
  places.reserve(numbers.size() / 2);
  for (std::size_t i = 0; i + 1 < numbers.size(); i += 2) places.push_back({numbers[i], numbers[i + 1]});
  return places;
}

[[noreturn]] void refuse(const std::string& what) { throw std::runtime_error("is damaged: " + what); }

// ---- Sets: their names and numbers, where the members of each begin, and all members

const std::vector<std::int32_t>& members_of(const MeshBlock& block) { return block.cells; }
const std::vector<std::int32_t>& members_of(const MeshNodeSet& set) { return set.nodes; }
std::span<const std::int32_t> members_of(const MeshFaceSet& set) { return flat(set.faces); }
void take(MeshBlock& block, std::vector<std::int32_t> members) { block.cells = std::move(members); }
void take(MeshNodeSet& set, std::vector<std::int32_t> members) { set.nodes = std::move(members); }
void take(MeshFaceSet& set, const std::vector<std::int32_t>& members) { unflatten(members, set.faces); }

template <class Set>
void put_sets(BytesWriter& writer, const std::string& name, const std::vector<Set>& sets, std::size_t width) {
  std::vector<std::string> names;
  std::vector<std::int64_t> labels, first{0};
  std::vector<std::int32_t> members;
  for (const Set& set : sets) {
    names.push_back(set.name);
    labels.push_back(set.label);
    const auto& of_set = members_of(set);
    members.insert(members.end(), of_set.begin(), of_set.end());
    first.push_back(static_cast<std::int64_t>(members.size() / std::max<std::size_t>(width, 1)));
  }
  Group& group = writer.root.groups[name];
  writer.put(group, "name", names);
  writer.put<std::int64_t>(group, "label", labels);
  writer.put<std::int64_t>(group, "first", first);
  writer.put<std::int32_t>(group, "members", members, width);
}

void put_places(BytesWriter& writer, const std::string& name, const std::vector<MeshBlock>& blocks) {
  std::vector<FilePlace> places;
  for (const MeshBlock& block : blocks) places.push_back(block.place);
  writer.put<std::int32_t>(writer.root.groups[name], "place", numbers_of(places), 2);
}

template <class Set>
std::vector<Set> sets_in(const BytesReader& file, const std::string& name, std::size_t width, std::size_t n_things) {
  const auto found = file.root().groups.find(name);
  if (found == file.root().groups.end()) throw std::runtime_error("has no group \"" + name + "\"");
  const Group& group = found->second;
  const std::vector<std::string> names = file.texts(group, "name");
  const auto labels = file.values<std::int64_t>(group, "label"), first = file.values<std::int64_t>(group, "first");
  const auto members = file.values<std::int32_t>(group, "members", width);
  const std::size_t row = std::max<std::size_t>(width, 1);
  if (labels.size() != names.size() || first.size() != names.size() + 1 || first.front() != 0 ||
      static_cast<std::size_t>(first.back()) != members.size() / row)
    refuse("the lists of \"" + name + "\" differ in length");
  for (const std::int32_t m : members)
    if (m < 0 || static_cast<std::size_t>(m) >= n_things) refuse("\"" + name + "\" has a member that does not exist");
  std::vector<Set> sets(names.size());
  for (std::size_t k = 0; k < sets.size(); ++k) {
    if (first[k] > first[k + 1]) refuse("\"" + name + "\" has members out of order");
    sets[k].name = names[k];
    sets[k].label = labels[k];
    const auto at = [&](std::size_t i) { return members.begin() + static_cast<std::ptrdiff_t>(row) * first[i]; };
    take(sets[k], {at(k), at(k + 1)});
  }
  return sets;
}

std::vector<MeshBlock> blocks_in(const BytesReader& file, const std::string& name, std::size_t n_cells) {
  std::vector<MeshBlock> blocks = sets_in<MeshBlock>(file, name, 0, n_cells);
  const std::vector<FilePlace> places = places_of(file.values<std::int32_t>(file.root().groups.at(name), "place", 2));
  if (places.size() != blocks.size()) refuse("the lists of \"" + name + "\" differ in length");
  for (std::size_t k = 0; k < blocks.size(); ++k) blocks[k].place = places[k];
  return blocks;
}

// ---- The file

std::string text_attribute(const Group& group, const std::string& name) {
  for (const hdf5::Attribute& a : group.attributes)
    if (a.name == name && a.type.kind == hdf5::Kind::text) {
      std::string text(reinterpret_cast<const char*>(a.content.data()), a.content.size());
      text.resize(text.find_last_not_of('\0') + 1);
      return text;
    }
  throw std::runtime_error("has no text \"" + name + "\"");
}

/// Throws std::runtime_error with the end of a sentence.
FileMesh mesh_in(const BytesReader& file) {
  const Group& root = file.root();
  std::int64_t found = 0;
  try {
    found = root.integer("kerf_mesh");
  } catch (const std::exception&) {
    throw std::runtime_error("is a file of Kerf's, but no mesh");
  }
  if (found != version)
    throw std::runtime_error("has version " + std::to_string(found) + " of the form, and this Kerf reads version " +
                             std::to_string(version));
  FileMesh mesh;
  unflatten(file.values<double>(root, "points", 3), mesh.points);
  mesh.node_labels = file.values<std::int64_t>(root, "node_id");
  unflatten(file.values<std::int32_t>(root, "cells", 8), mesh.cells);
  mesh.cell_labels = file.values<std::int64_t>(root, "element_id");
  mesh.cell_places = places_of(file.values<std::int32_t>(root, "place", 2));
  if (mesh.node_labels.size() != mesh.points.size() || mesh.cell_labels.size() != mesh.cells.size() ||
      !(mesh.cell_places.empty() || mesh.cell_places.size() == mesh.cells.size()))
    refuse("its lists differ in length");
  mesh.blocks = blocks_in(file, "blocks", mesh.cells.size());
  mesh.cell_sets = blocks_in(file, "element_sets", mesh.cells.size());
  mesh.node_sets = sets_in<MeshNodeSet>(file, "node_sets", 0, mesh.points.size());
  mesh.face_sets = sets_in<MeshFaceSet>(file, "face_sets", 4, mesh.points.size());
  const std::vector<std::string> kinds = file.texts(root, "left_out");
  const auto counts = file.values<std::int64_t>(root, "n_left_out");
  if (kinds.size() != counts.size()) refuse("its lists differ in length");
  for (std::size_t k = 0; k < kinds.size(); ++k) mesh.left_out[kinds[k]] = counts[k];
  mesh.labels_repeat = root.integer("ids_repeat") != 0;
  mesh.format = text_attribute(root, "format");
  if (text_attribute(root, "digest") != digest_text(mesh)) refuse("the mesh does not fit its digest");
  return mesh;
}

}  // namespace

std::string kerf_mesh_bytes(const FileMesh& mesh) {
  BytesWriter writer;
  writer.root.set("kerf_mesh", version);
  writer.root.set("digest", digest_text(mesh));
  writer.root.set("format", mesh.format);
  writer.root.set("ids_repeat", mesh.labels_repeat ? 1 : 0);
  writer.put(writer.root, "points", flat(mesh.points), 3);
  writer.put<std::int64_t>(writer.root, "node_id", mesh.node_labels);
  writer.put(writer.root, "cells", flat(mesh.cells), 8);
  writer.put<std::int64_t>(writer.root, "element_id", mesh.cell_labels);
  writer.put<std::int32_t>(writer.root, "place", numbers_of(mesh.cell_places), 2);
  put_sets(writer, "blocks", mesh.blocks, 0);
  put_places(writer, "blocks", mesh.blocks);
  put_sets(writer, "element_sets", mesh.cell_sets, 0);
  put_places(writer, "element_sets", mesh.cell_sets);
  put_sets(writer, "node_sets", mesh.node_sets, 0);
  put_sets(writer, "face_sets", mesh.face_sets, 4);
  std::vector<std::string> kinds;
  std::vector<std::int64_t> counts;
  for (const auto& [kind, n] : mesh.left_out) {
    kinds.push_back(kind);
    counts.push_back(n);
  }
  writer.put(writer.root, "left_out", kinds);
  writer.put<std::int64_t>(writer.root, "n_left_out", counts);
  const std::vector<std::byte> bytes = writer.finish();
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void write_mesh(const FileMesh& mesh, const std::string& path) {
  const std::string bytes = kerf_mesh_bytes(mesh), unfinished = path + ".part";
  File file(unfinished, File::Mode::create);
  file.write_at(0, std::as_bytes(std::span(bytes)));
  file.sync();
  file.close();
  publish(unfinished, path);
}

FileMesh read_kerf_mesh(const MeshFileText& file, Diagnostics& diagnostics) {
  try {
    return mesh_in(BytesReader(std::as_bytes(std::span(file.bytes))));
  } catch (const std::runtime_error& e) {
    MeshErrors errors(file.name, diagnostics);
    errors.at({}, "file", std::string("the file ") + e.what() + "; expected a mesh that Kerf has written");
    return {};
  }
}

}  // namespace kerf
