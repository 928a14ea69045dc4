// One element along smooth paths.
#include "conformance/law_path.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "drive/initial_value.hpp"

namespace kerf {

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double edge = 1e-3;  // of the element [m]

Rotation transposed(const Rotation& r) { return {r.xx, r.yx, r.zx, r.xy, r.yy, r.zy, r.xz, r.yz, r.zz}; }
Vec3 turned(const Rotation& r, Vec3 x) {
  return {r.xx * x.x + r.xy * x.y + r.xz * x.z, r.yx * x.x + r.yy * x.y + r.yz * x.z,
          r.zx * x.x + r.zy * x.y + r.zz * x.z};
}

void add_tensor(PathRecord& record, const std::string& name, const std::string& unit) {
  for (const char* c : {"xx", "yy", "zz", "xy", "yz", "zx"}) {
    record.names.push_back(name + "_" + c);
    record.units.push_back(unit);
  }
}

void push(std::vector<double>& row, SymTensor t) { row.insert(row.end(), {t.xx, t.yy, t.zz, t.xy, t.yz, t.zx}); }

bool is_component(const std::string& name) {
  if (name.size() < 4 || name[name.size() - 3] != '_') return false;
  const std::string end = name.substr(name.size() - 2);
  return end == "xx" || end == "yy" || end == "zz" || end == "xy" || end == "yz" || end == "zx";
}

/// The size against which a quantity is measured.
double size_of_quantity(const PathRecord& r, std::size_t q) {
  const std::string stem = is_component(r.names[q]) ? r.names[q].substr(0, r.names[q].size() - 3) : "";
  double size = 0.0, stress = 0.0;
  for (std::size_t k = 0; k < r.names.size(); ++k) {
    const bool mine =
        k == q || (!stem.empty() && is_component(r.names[k]) && r.names[k].substr(0, r.names[k].size() - 3) == stem);
    for (const std::vector<double>& row : r.rows) {
      if (mine) size = std::max(size, std::fabs(row[k]));
      if (k < 7) stress = std::max(stress, std::fabs(row[k]));
    }
  }
  // A stress far below the others, or a number that is nothing, is round-off.
  return std::max(size, r.units[q] == "Pa" ? 1e-6 * stress : 1e-12);
}

}  // namespace

Rotation rotation_about(Vec3 n, double angle) {
  const double c = kerf::cos(angle), s = kerf::sin(angle), d = 1.0 - c;
  return {c + d * n.x * n.x,       d * n.x * n.y - s * n.z, d * n.x * n.z + s * n.y,
          d * n.y * n.x + s * n.z, c + d * n.y * n.y,       d * n.y * n.z - s * n.x,
          d * n.z * n.x - s * n.y, d * n.z * n.y + s * n.x, c + d * n.z * n.z};
}

Deformation StretchPath::stretch(double time) const {
  const double u = time / duration;
  const double a = strain * kerf::sin(2.0 * pi * u);  // loads, unloads, reverses
  const double half_wave = kerf::sin(pi * u), hill = half_wave * half_wave;
  const double b = strain * hill * (1.0 - 0.5 * u);
  const double c = compression * (0.3 * kerf::sin(2.0 * pi * u) - hill) / 3.0;
  Deformation d;
  d.f[0][0] += a + c;
  d.f[1][1] += -0.5 * a + 0.4 * b + c;
  d.f[2][2] += -0.5 * a - 0.4 * b + c;
  d.f[0][1] = d.f[1][0] = 0.5 * a - 0.3 * b;
  d.f[1][2] = d.f[2][1] = 0.6 * b;
  d.f[0][2] = d.f[2][0] = 0.3 * b + 0.2 * a;
  return d;
}

Rotation StretchPath::turn(double time) const {
  const double u = time / duration;
  return rotation_about(turning_axis, from + angle * u * u * (3.0 - 2.0 * u));
}

StretchPath path_of(const TypeSample& sample) {
  return {sample.settings.strain, sample.settings.compression, sample.settings.duration};
}

template <class Real>
void set_initial_state(CellPart<Real>& part, const SampleLaws& laws) {
  for (const auto& [name, text] : laws.sample.settings.initial_state) {
    const double value = initial_value({laws.law}, laws.sample.type(), name, text);
    for (int e = 0; e < part.n_elements(); ++e) part.set_variable(name, e, value);
  }
}

template <class Real>
PathDriver<Real>::PathDriver(const SampleLaws& laws, const StretchPath& path, int cells)
    : laws_(laws),
      path_(path),
      mesh_([&] {
        CellMesh mesh = distorted_block(cells, cells, cells, edge / cells, 0.0, 1);
        for (Vec3& x : mesh.x) x = turned(path.turn(0.0), x);
        return mesh;
      }()),
      part_(mesh_, laws.material, *laws.element) {
  set_initial_state(part_, laws);
  part_.initialise();
}

template <class Real>
std::vector<Vec3> PathDriver<Real>::nodes_at(double time) const {
  const Deformation stretch = path_.stretch(time);
  const Rotation back = transposed(path_.turn(0.0)), turn = path_.turn(time);
  std::vector<Vec3> nodes;
  for (const Vec3 x : mesh_.x) nodes.push_back(turned(turn, stretch.place(turned(back, x))));
  return nodes;
}

template <class Real>
void PathDriver<Real>::record(PathRecord& out) const {
  const Rotation back = transposed(path_.turn(time_));
  std::vector<double> row;
  push(row, rotate(part_.stress(0), back));
  row.push_back(part_.pressure(0));
  row.push_back(part_.get(PartStore::internal_energy, 0) / part_.element_mass(0));
  const std::vector<StateVariable>& state = laws_.law->state_variables();
  for (std::size_t v = 0; v < state.size(); ++v) {
    if (!state[v].begins_tensor) {
      row.push_back(part_.variable(state[v].name, 0));
      continue;
    }
    double c[6];
    for (int i = 0; i < 6; ++i) c[i] = part_.variable(state[v + static_cast<std::size_t>(i)].name, 0);
    push(row, rotate({c[0], c[1], c[2], c[3], c[4], c[5]}, back));
    v += 5;
  }
  if (out.names.empty()) {
    add_tensor(out, "stress", "Pa");
    out.names.insert(out.names.end(), {"pressure", "specific_energy"});
    out.units.insert(out.units.end(), {"Pa", "J/kg"});
    for (const StateVariable& v : state) {
      out.names.push_back(v.name);
      out.units.push_back(v.unit);
    }
  }
  out.rows.push_back(std::move(row));
}

template <class Real>
PathRecord PathDriver<Real>::go(int steps, double dt, int moments) {
  PathRecord out;
  const double start = time_;
  for (int k = 1; k <= steps; ++k) {
    time_ = start + k * dt;
    part_.move_to(nodes_at(time_), dt);
    if (moments > 0 && k % (steps / moments) == 0) record(out);
  }
  return out;
}

template <class Real>
PathRecord drive_path(const SampleLaws& laws, const StretchPath& path, int steps, int moments) {
  PathDriver<Real> driver(laws, path);
  return driver.go(steps, path.duration / steps, moments);
}

std::vector<double> differences(const PathRecord& a, const PathRecord& b, bool greatest) {
  std::vector<double> all(a.names.size(), 0.0);
  for (std::size_t q = 0; q < all.size(); ++q) {
    const double size = std::max(size_of_quantity(a, q), size_of_quantity(b, q));
    for (std::size_t r = 0; r < a.rows.size(); ++r) {
      const double d = std::fabs(a.rows[r][q] - b.rows[r][q]) / size;
      // NaN wins.
      if (greatest)
        all[q] = d <= all[q] ? all[q] : d;
      else
        all[q] += d / static_cast<double>(a.rows.size());
    }
  }
  return all;
}

template class PathDriver<double>;
template class PathDriver<float>;
template PathRecord drive_path<double>(const SampleLaws&, const StretchPath&, int, int);
template PathRecord drive_path<float>(const SampleLaws&, const StretchPath&, int, int);
template void set_initial_state(CellPart<double>&, const SampleLaws&);
template void set_initial_state(CellPart<float>&, const SampleLaws&);

}  // namespace kerf
