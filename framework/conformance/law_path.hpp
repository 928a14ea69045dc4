// Paths of deformation of one element, and what a law makes of them.
#pragma once

#include <string>
#include <vector>

#include "conformance/samples.hpp"
#include "drive/cell_part.hpp"
#include "drive/motion.hpp"

namespace kerf {

/// A smooth path that stretches and shears in changing directions, loads, unloads and reverses, compresses and expands;
/// with a rotation on top of it, if `angle` is not zero. Smooth, so that only the law limits the order of convergence.
struct StretchPath {
  double strain = 0.02, compression = 0.02, duration = 20e-6;  // [-], [-], [s]
  double angle = 0.0;  // at the end [rad]
  double from = 0.0;  // angle at the beginning [rad]

  Deformation stretch(double time) const;  // symmetric
  Rotation turn(double time) const;
};

Rotation rotation_about(Vec3 axis, double angle);
inline constexpr Vec3 turning_axis{0.48, -0.6, 0.64};  // a unit vector along no axis, nor in a plane of two

/// What a law has made of a path: a row of quantities per moment. Tensors are turned back with the path.
struct PathRecord {
  std::vector<std::string> names;
  std::vector<std::string> units;
  std::vector<std::vector<double>> rows;
};

/// Takes one element, or a cube of them with `cells` along each edge, along a path. The nodes of the reference are
/// turned by the path's first rotation.
template <class Real>
class PathDriver {
 public:
  PathDriver(const SampleLaws& laws, const StretchPath& path, int cells = 1);
  /// Goes on by `steps` steps of `dt`; `moments` > 0 records so many rows.
  PathRecord go(int steps, double dt, int moments);
  CellPart<Real>& part() { return part_; }
  /// Time at which the part stands; for one that takes over the state of another.
  void set_time(double time) { time_ = time; }
  double time() const { return time_; }

 private:
  std::vector<Vec3> nodes_at(double time) const;
  void record(PathRecord& out) const;

  const SampleLaws& laws_;
  StretchPath path_;
  CellMesh mesh_;
  CellPart<Real> part_;
  double time_ = 0.0;
};

/// The whole path in `steps` steps.
template <class Real = double>
PathRecord drive_path(const SampleLaws& laws, const StretchPath& path, int steps, int moments);

/// How far two records are apart, a number per quantity, over its greatest size. Components of a tensor have the same
/// size. The mean over the moments, or the greatest.
std::vector<double> differences(const PathRecord& a, const PathRecord& b, bool greatest);

/// The path of a sample.
StretchPath path_of(const TypeSample& sample);

/// Sets the state that the sample begins with.
template <class Real>
void set_initial_state(CellPart<Real>& part, const SampleLaws& laws);

}  // namespace kerf
