// One element on its way along a path, and what can be seen of it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "drive/cell_part.hpp"
#include "drive/motion.hpp"

namespace kerf {

/// A quantity that the driver shows.
struct DrivenColumn {
  std::string name, unit;
};

class DrivenCell {
 public:
  /// All must outlive this. Throws std::runtime_error where the path's initial state cannot be.
  DrivenCell(const DriveInput& input, const MaterialInput& material, Element& element, const PathInput& path,
             Motion& motion);

  /// Compresses all axes alike up to the confinement, if the path has one. Throws std::runtime_error where the pressure
  /// does not get there.
  void confine();
  /// One step. Throws std::runtime_error where no lateral strain gives the lateral stress, or the stress is no number.
  void advance(double time);
  double time() const { return time_; }
  const CellPart<double>& part() const { return part_; }
  /// Whether the criteria of erosion would delete the element.
  bool has_failed() const { return material_.erosion != nullptr && part_.failed(0); }

  /// Columns in the order of row(): what all have, then the state variables of the laws.
  std::vector<DrivenColumn> columns() const;
  std::vector<double> row() const;

 private:
  void set_initial_state();
  void move(const Deformation& to, double dt);
  double change_for_lateral_stress(double time, double dt);
  void require_lateral_stress(double time) const;
  void isotropic(double stretch, double dt);
  void check() const;
  std::vector<const StateVariable*> variables() const;  // of all laws; of two with the same name the first

  const MaterialInput& material_;
  const PathInput& path_;
  Motion& motion_;
  CellMesh mesh_;
  CellPart<double> part_;
  Deformation now_;
  double time_ = 0.0, lateral_ = 1.0, change_ = 0.0, target_ = 0.0;
};

}  // namespace kerf
