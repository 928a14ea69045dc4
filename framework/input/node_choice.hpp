// Which nodes of a part a named set of the input takes.
#pragma once

#include <algorithm>

#include "input/model_input.hpp"

namespace kerf {

/// A set's conditions, resolved for one part.
class NodeChoice {
 public:
  NodeChoice(const SetInput& set, const PartInput& part) : set_(&set) {
    possible_ = set.parts.empty() || std::find(set.parts.begin(), set.parts.end(), part.name) != set.parts.end();
    if (!possible_ || set.face.empty()) return;
    face_ = part.mesh->find_face(set.face);
    possible_ = face_ >= 0;
  }
  /// Whether the set can hold nodes of this part at all.
  bool possible() const { return possible_; }
  /// Pre: possible(). `x` is the position of node `i` after placement.
  bool takes(const MeshGenerator& mesh, std::int64_t i, Vec3 x) const {
    if (face_ >= 0 && !mesh.on_face(i, face_)) return false;
    const auto& b = set_->box;
    return b.empty() || (x.x >= b[0] && x.y >= b[1] && x.z >= b[2] && x.x <= b[3] && x.y <= b[4] && x.z <= b[5]);
  }

 private:
  const SetInput* set_;
  int face_ = -1;
  bool possible_ = false;
};

}  // namespace kerf
