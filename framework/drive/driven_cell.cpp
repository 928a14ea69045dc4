// Motion of the element, with the lateral strain that keeps the lateral stress.
#include "drive/driven_cell.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/units.hpp"
#include "drive/initial_value.hpp"

namespace kerf {

namespace {

constexpr const char* axes[6] = {"xx", "yy", "zz", "xy", "yz", "zx"};

/// Between two changes of stretch whose excesses of stress have opposite signs, by the method of Illinois, until the
/// stress or the stretch is met to round-off. The last call of `excess` is that of the result.
template <class Excess>
double root_between(double low, double f_low, double high, double f_high, double exact, const Excess& excess) {
  double last = high;
  for (int i = 0, side = 0; i < 100 && high - low > 1e-16 && f_high != f_low; ++i) {
    last = (low * f_high - high * f_low) / (f_high - f_low);
    const double f = excess(last);
    if (std::fabs(f) < exact) return last;
    if (f > 0.0) {
      high = last, f_high = f;
      if (side == 1) f_low *= 0.5;
      side = 1;
    } else {
      low = last, f_low = f;
      if (side == -1) f_high *= 0.5;
      side = -1;
    }
  }
  excess(last);
  return last;
}

constexpr double exact_stress = 1e-6;  // [Pa] far below what any law resolves

}  // namespace

DrivenCell::DrivenCell(const DriveInput& input, const MaterialInput& material, Element& element, const PathInput& path,
                       Motion& motion)
    : material_(material),
      path_(path),
      motion_(motion),
      mesh_(distorted_block(1, 1, 1, input.size, 0.0, 1)),
      part_(mesh_, material, element),
      target_(path.lateral_stress) {
  set_initial_state();
  part_.initialise();
  check();
}

void DrivenCell::set_initial_state() {
  static const std::string energy = "specific_energy";
  for (const auto& [name, text] : path_.initial_state) {
    if (name != energy) {
      part_.set_variable(name, 0, initial_value(material_.laws(), "material " + material_.name, name, text, {energy}));
      continue;
    }
    const Quantity value = to_si(text, "J/kg");
    if (!value.ok()) throw std::runtime_error(fmt::format("initial_state: `{}`: {}", name, value.error));
    part_.set(PartStore::internal_energy, 0, 0, value.value * part_.element_mass(0));
  }
}

void DrivenCell::check() const {
  const SymTensor s = part_.stress(0);
  for (const double v : {s.xx, s.yy, s.zz, s.xy, s.yz, s.zx})
    if (!std::isfinite(v)) throw std::runtime_error(fmt::format("the stress is no number at {:.6g} s", time_));
  for (const StateVariable* v : variables())
    if (std::isnan(part_.variable(v->name, 0)))
      throw std::runtime_error(fmt::format("the state variable {} is no number at {:.6g} s", v->name, time_));
  if (!std::isfinite(part_.get(PartStore::internal_energy, 0)))
    throw std::runtime_error(fmt::format("the internal energy is no number at {:.6g} s", time_));
}

void DrivenCell::move(const Deformation& to, double dt) {
  const bool mirrors = path_.type != "history" && !(to.f[0][0] > 0.0 && to.f[1][1] > 0.0);
  if (mirrors || !(to.determinant() > 0.0))
    throw std::runtime_error(
        fmt::format("nothing is left of the element: the determinant of its deformation is {:.6g}", to.determinant()));
  std::vector<Vec3> target;
  for (const Vec3 x : mesh_.x) target.push_back(to.place(x));
  part_.move_to(target, dt);
  now_ = to;
}

void DrivenCell::isotropic(double stretch, double dt) {
  Deformation d;
  for (int i = 0; i < 3; ++i) d.f[i][i] = stretch;
  move(d, dt);
  lateral_ = stretch;
}

void DrivenCell::confine() {
  if (path_.confinement == 0.0) return;
  // A bulk modulus from a tiny compression tells how large the steps may be.
  const double rate = path_.rate > 0.0 ? path_.rate : 1.0 / motion_.end(), tiny_strain = 1e-8;
  const CellPart<double>::Snapshot start = part_.save();
  const double before = part_.pressure(0);
  isotropic(1.0 - tiny_strain, tiny_strain / rate);
  const double modulus = (part_.pressure(0) - before) / tiny_strain;
  part_.restore(start);
  if (!(modulus > 0.0)) throw std::runtime_error("the material does not resist compression: it cannot be confined");
  const double step = std::min(0.02 * path_.confinement / modulus, 0.01), dt = step / rate;
  double stretch = 1.0;
  const auto missing = [&] { return path_.confinement - part_.pressure(0); };
  while (missing() > 0.0) {
    const CellPart<double>::Snapshot old = part_.save();
    const double from = stretch, f_from = missing();
    stretch -= step;
    if (stretch < 0.05)
      throw std::runtime_error(
          fmt::format("the confinement of {:.6g} Pa is not reached: the pressure is {:.6g} Pa where "
                      "all axes are compressed to a twentieth",
                      path_.confinement, part_.pressure(0)));
    isotropic(stretch, dt);
    time_ += dt;
    if (!(missing() < 0.0)) continue;
    const auto at = [&](double change) {
      part_.restore(old);
      isotropic(from - change, dt);
      return -missing();
    };
    stretch = from - root_between(0.0, -f_from, step, -missing(), 1e-9 * path_.confinement, at);
    break;
  }
  check();
  target_ = part_.stress(0).yy;
  motion_.begin_after(time_, stretch - 1.0);
}

double DrivenCell::change_for_lateral_stress(double time, double dt) {
  const CellPart<double>::Snapshot before = part_.save();
  const double old_axial = now_.f[0][0];
  const auto excess = [&](double change) {
    part_.restore(before);
    move(motion_.at(time, lateral_ + change), dt);
    return part_.stress(0).yy - target_;
  };
  const double least = 1e-12, guess = change_;
  double low = guess, high = guess, f_low = excess(guess), f_high = f_low;
  double reach = std::max(0.05 * std::fabs(now_.f[0][0] - old_axial), least);
  for (int i = 0; f_low > 0.0 && i < 60; ++i, reach *= 2.0) {
    high = low, f_high = f_low;
    f_low = excess(low = guess - reach);
  }
  for (int i = 0; f_high < 0.0 && i < 60; ++i, reach *= 2.0) {
    low = high, f_low = f_high;
    f_high = excess(high = guess + reach);
  }
  if (!(f_low <= 0.0 && f_high >= 0.0))
    throw std::runtime_error(
        fmt::format("no lateral strain gives the lateral stress {:.6g} Pa at {:.6g} s", target_, time));
  return root_between(low, f_low, high, f_high, exact_stress, excess);
}

/// Throws where the stress that was to be kept is not, as where a law's stress jumps, and where it is kept along one
/// axis only. A unit in the last place of the stretch changes the stress of a stiff solid by 1e-15 of it; a millionth
/// is far above that, and far below what anybody reads.
void DrivenCell::require_lateral_stress(double time) const {
  const SymTensor s = part_.stress(0);
  const double allowed = 1e-6 * (std::fabs(s.xx) + std::fabs(s.yy) + std::fabs(s.zz)) + 1.0;
  if (std::fabs(s.zz - s.yy) > allowed)
    throw std::runtime_error(fmt::format(
        "the lateral stresses are {:.6g} and {:.6g} Pa at {:.6g} s: the law is not isotropic, and {} keeps one "
        "of them only; expected a path of strains, or a history",
        s.yy, s.zz, time, path_.type));
  if (!(std::fabs(s.yy - target_) <= allowed))
    throw std::runtime_error(fmt::format(
        "the lateral stress jumps between {:.6g} Pa and beyond {:.6g} Pa at {:.6g} s, so that no strain keeps "
        "it; expected a path of strains, or shorter steps",
        s.yy, target_, time));
}

void DrivenCell::advance(double time) {
  const double dt = time - time_;
  const bool isotropic_still = path_.isotropic_until > 0.0 && time <= path_.isotropic_until * (1.0 + 1e-9);
  if (isotropic_still) {
    isotropic(motion_.at(time).f[0][0], dt);
    target_ = part_.stress(0).yy;
  } else if (path_.keeps_lateral_stress()) {
    change_ = change_for_lateral_stress(time, dt);
    lateral_ += change_;
    require_lateral_stress(time);
  } else {
    move(motion_.at(time), dt);
  }
  time_ = time;
  check();
}

std::vector<const StateVariable*> DrivenCell::variables() const {
  std::vector<const StateVariable*> all;
  for (const Law* law : material_.laws())
    for (const StateVariable& v : law->state_variables())
      if (std::none_of(all.begin(), all.end(), [&](const StateVariable* known) { return known->name == v.name; }))
        all.push_back(&v);
  return all;
}

std::vector<DrivenColumn> DrivenCell::columns() const {
  std::vector<DrivenColumn> all = {{"time", "s"}, {"strain", "-"}};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) all.push_back({fmt::format("F_{}{}", "xyz"[i], "xyz"[j]), "-"});
  for (const char* axis : axes) all.push_back({fmt::format("stress_{}", axis), "Pa"});
  all.insert(
      all.end(),
      {{"pressure", "Pa"}, {"von_mises", "Pa"}, {"density", "kg/m3"}, {"specific_energy", "J/kg"}, {"failed", "-"}});
  for (const StateVariable* v : variables()) all.push_back({v->name, v->unit});
  return all;
}

std::vector<double> DrivenCell::row() const {
  const bool shears = path_.type == "simple_shear";
  std::vector<double> all = {time_, shears ? now_.f[0][1] : now_.f[0][0] - 1.0};
  for (const auto& line : now_.f) all.insert(all.end(), line, line + 3);
  const SymTensor s = part_.stress(0);
  all.insert(all.end(), {s.xx, s.yy, s.zz, s.xy, s.yz, s.zx, part_.pressure(0), von_mises(part_.deviator(0))});
  all.push_back(part_.element_mass(0) / part_.get(PartStore::volume, 0));
  all.push_back(part_.get(PartStore::internal_energy, 0) / part_.element_mass(0));
  all.push_back(has_failed() ? 1.0 : 0.0);
  for (const StateVariable* v : variables()) all.push_back(part_.variable(v->name, 0));
  return all;
}

}  // namespace kerf
