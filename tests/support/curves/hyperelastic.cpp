// Files about rubber: deviators of Neo-Hooke and of Mooney and Rivlin at given deformations.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "support/curves.hpp"

namespace kerf::test {

namespace {

bool fits(const Oracle& o) { return o.name.starts_with("hyperelastic_"); }

/// The number after "NAME = " in the lines that begin with #.
double stated(const Oracle& o, const std::string& name) {
  for (const std::string& line : o.comments)
    if (const std::size_t at = line.find(" " + name + " = "); at != std::string::npos)
      return std::stod(line.substr(at + name.size() + 4));
  throw std::runtime_error(o.name + " does not say what " + name + " is");
}

/// Where the deformation of a row takes a point. `share` goes from 0, undeformed, to 1.
Vec3 placed(const std::string& path, double x, double volume, double share, Vec3 p) {
  const double stretch = 1.0 + share * (x - 1.0);
  if (path == "uniaxial_strain") return {stretch * p.x, p.y, p.z};
  if (path == "simple_shear") return {p.x + share * x * p.y, p.y, p.z};
  if (path == "isotropic") return {stretch * p.x, stretch * p.y, stretch * p.z};
  if (path == "shear_0.7_then_rotated_40_deg") {
    const double angle = 40.0 / 180.0 * 3.14159265358979323846 * std::max(2.0 * share - 1.0, 0.0);
    const double sheared = p.x + 0.7 * std::min(2.0 * share, 1.0) * p.y;
    return {std::cos(angle) * sheared - std::sin(angle) * p.y, std::sin(angle) * sheared + std::cos(angle) * p.y, p.z};
  }
  const double lateral = 1.0 + share * (std::sqrt(volume / x) - 1.0);
  return {stretch * p.x, lateral * p.y, lateral * p.z};
}

PartLaws laws_of(const Oracle& o) {
  PartLaws laws;
  laws.element = "{linear_viscosity: 0, quadratic_viscosity: 0}";
  laws.density = 1000.0;  // of no effect
  const double C10 = stated(o, "C10"), C01 = stated(o, "C01");
  laws.strength = C01 == 0.0 ? "neo_hookean" : "mooney_rivlin";
  laws.strength_parameters = C01 == 0.0 ? "{" + key_and_number("shear_modulus", 2.0 * C10) + "}"
                                        : "{" + key_and_number("C10", C10) + ", " + key_and_number("C01", C01) + "}";
  laws.eos_parameters = "{" + key_and_number("bulk_modulus", stated(o, "K")) + "}";
  return laws;
}

std::vector<CurveResult> check(const Oracle& o) {
  // The deformation gradients of steps are exact, so their number does not matter. Round-off, times the number of
  // steps; the pressure is the small difference of two densities.
  constexpr int steps = 20;
  constexpr double round_off = 1e-10;
  const std::vector<std::string> columns = {"deviator_xx_Pa", "deviator_yy_Pa", "deviator_zz_Pa", "deviator_xy_Pa",
                                            "p_linear_Pa"};
  std::vector<CurveResult> results;
  for (const std::string& column : columns) results.push_back({column, 0.0, round_off, 0});
  for (std::size_t row = 0; row < o.n_rows(); ++row) {
    const CellMesh mesh = distorted_block(1, 1, 1, 1e-3, 0.0, 1);
    OnePart part(mesh, laws_of(o));
    part.initialise();
    for (int i = 1; i <= steps; ++i) {
      std::vector<Vec3> target;
      for (const Vec3 p : mesh.x)
        target.push_back(placed(o.words.at("path")[row], o.column("x")[row], o.column("J")[row], i / double(steps), p));
      part.move_to(target, 1e-6);
    }
    const SymTensor s = part.deviator(0);
    const double seen[] = {s.xx, s.yy, s.zz, s.xy, part.pressure(0)};
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const std::vector<double>& values = o.column(columns[c]);
      double greatest = 0.0;
      for (const double v : values) greatest = std::max(greatest, std::fabs(v));
      const double error = std::fabs(seen[c] - values[row]) / greatest;
      if (!(error <= results[c].error)) results[c].error = error, results[c].row = row;
    }
  }
  return results;
}

const RegisterCurves registered({"hyperelastic", fits, check});

}  // namespace

}  // namespace kerf::test
