// Axis-aligned boxes of hexahedra: uniform, graded, or refined in intervals along each axis.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "kerf/mesh.hpp"

namespace kerf {

/// A stretch of cells along one axis, from where the one before it ended.
struct GradingInput {
  double to = 0.0;  // [m], from the box's corner
  std::int64_t cells = 0;
  double ratio = 1.0;
  static void describe(Schema<GradingInput>& s);
};

/// Fine cells in an interval of one axis.
struct RefineAxisInput {
  double from = 0.0, to = 0.0, size = 0.0;  // [m], from the box's corner
  double growth = 1.15;
  static void describe(Schema<RefineAxisInput>& s);
};

/// Fine cells in intervals of several axes at once.
struct RefineZoneInput {
  Vec3 center, size;  // [m], from the box's corner; a size of zero leaves that axis alone
  double factor = 2.0, growth = 1.15;
  static void describe(Schema<RefineZoneInput>& s);
};

/// A tensor product of mesh lines along x, y and z; x runs fastest in the numbering.
class BlockGenerator final : public MeshGenerator {
 public:
  Vec3 size, origin;  // [m]
  std::vector<std::int64_t> cells;  // empty where cell_size is given
  double cell_size = 0.0;  // [m], zero where absent
  std::vector<std::unique_ptr<GradingInput>> grading_x, grading_y, grading_z;
  std::unique_ptr<RefineAxisInput> refine_x, refine_y, refine_z;
  std::unique_ptr<RefineZoneInput> refine;

  static void describe(Schema<BlockGenerator>& s);

  std::vector<std::string> prepare() override;
  std::int64_t n_nodes() const override { return n_[0] * n_[1] * n_[2]; }
  std::int64_t n_elements() const override { return (n_[0] - 1) * (n_[1] - 1) * (n_[2] - 1); }
  Vec3 node(std::int64_t i) const override {
    const auto at = [this](std::size_t axis, std::int64_t j) { return lines_[axis][static_cast<std::size_t>(j)]; };
    return {at(0, i % n_[0]), at(1, i / n_[0] % n_[1]), at(2, i / (n_[0] * n_[1]))};
  }
  ElementNodeIds element(std::int64_t e) const override;
  std::vector<std::string> face_names() const override;
  bool on_face(std::int64_t i, int face) const override;
  /// Positions of the mesh lines along an axis [m].
  const std::vector<double>& lines(int axis) const { return lines_[static_cast<std::size_t>(axis)]; }

 private:
  using Grading = std::vector<std::unique_ptr<GradingInput>>;
  const Grading& grading(int axis) const { return axis == 0 ? grading_x : axis == 1 ? grading_y : grading_z; }
  const RefineAxisInput* refinement(int axis) const {
    return (axis == 0 ? refine_x : axis == 1 ? refine_y : refine_z).get();
  }
  std::vector<double> axis_lines(int axis, std::vector<std::string>& errors) const;
  std::vector<double> graded_axis(int axis, std::vector<std::string>& errors) const;
  std::vector<double> refined_axis(int axis, double coarse, const RefineAxisInput& zone,
                                   std::vector<std::string>& errors) const;
  std::vector<double> zone_axis(int axis, double coarse, std::vector<std::string>& errors) const;

  std::array<std::vector<double>, 3> lines_;
  std::array<std::int64_t, 3> n_{1, 1, 1};  // of lines
};

}  // namespace kerf
