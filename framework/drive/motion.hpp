// The deformation that a path prescribes, as a function of time.
#pragma once

#include <string>
#include <vector>

#include "drive/drive_input.hpp"
#include "kerf/math.hpp"

namespace kerf {

/// Components of the deformation gradient: x_i = f[i][j] X_j.
struct Deformation {
  double f[3][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};

  Vec3 place(Vec3 x) const {
    return {f[0][0] * x.x + f[0][1] * x.y + f[0][2] * x.z, f[1][0] * x.x + f[1][1] * x.y + f[1][2] * x.z,
            f[2][0] * x.x + f[2][1] * x.y + f[2][2] * x.z};
  }
  double determinant() const;
};

class Motion {
 public:
  /// `file` has the history where the path is one. Throws std::runtime_error where the history cannot be: no time,
  /// times that do not ascend from 0, no component, a determinant that is not positive.
  Motion(const PathInput& path, const std::string& file_text, const std::string& file_name);

  /// Moments at which straight lines of strain meet, 0 and the end among them [s].
  std::vector<double> moments() const;
  double end() const { return times_.back(); }
  /// The deformation at a time; of a path that keeps a lateral stress, the lateral stretches are those given.
  Deformation at(double time, double lateral_stretch = 1.0) const;
  /// What comes before the strains: times and axial strains are counted from there.
  void begin_after(double time, double strain) {
    time_before_ = time;
    strain_before_ = strain;
  }
  double begin() const { return time_before_; }

 private:
  void read_history(const std::string& text, const std::string& name);
  /// Straight lines between values, and the integral of straight lines between rates.
  double along(const std::vector<double>& values, double time) const;
  double way(const std::vector<double>& rates, double time) const;

  const PathInput& path_;
  std::vector<double> times_;
  std::vector<double> components_[9];  // of a history
  double time_before_ = 0.0, strain_before_ = 0.0;
};

}  // namespace kerf
