// One checksum goes through all arrays, each after its length.
#include "mesh/mesh_digest.hpp"

#include <fmt/format.h>

#include <span>
#include <type_traits>

#include "output/checksum.hpp"

namespace kerf {
namespace {

class MeshDigest {
 public:
  template <class T>
  void add(const std::vector<T>& values) {
    static_assert(std::has_unique_object_representations_v<T> || std::is_same_v<T, std::array<double, 3>>);
    add(static_cast<std::int64_t>(values.size()));
    value_ = crc64(std::as_bytes(std::span(values)), value_);
  }
  void add(std::int64_t number) { value_ = crc64(std::as_bytes(std::span(&number, 1)), value_); }
  void add(const std::string& text) {
    add(static_cast<std::int64_t>(text.size()));
    value_ = crc64(std::as_bytes(std::span(text)), value_);
  }
  template <class Set, class Member>
  void add(const std::vector<Set>& sets, std::vector<Member> Set::*members) {
    add(static_cast<std::int64_t>(sets.size()));
    for (const Set& set : sets) {
      add(set.name);
      add(set.label);
      add(set.*members);
    }
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0;
};

}  // namespace

std::uint64_t digest_of(const FileMesh& mesh) {
  MeshDigest digest;
  digest.add(mesh.points);
  digest.add(mesh.node_labels);
  digest.add(mesh.cells);
  digest.add(mesh.cell_labels);
  digest.add(mesh.blocks, &MeshBlock::cells);
  digest.add(mesh.cell_sets, &MeshBlock::cells);
  digest.add(mesh.node_sets, &MeshNodeSet::nodes);
  digest.add(mesh.face_sets, &MeshFaceSet::faces);
  return digest.value();
}

std::string digest_text(const FileMesh& mesh) { return fmt::format("{:016x}", digest_of(mesh)); }

}  // namespace kerf
