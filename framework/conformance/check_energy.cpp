// Closed cycles of strain from the virgin state: a law may take energy, or leave what it has taken, but make none.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "conformance/checks.hpp"
#include "conformance/law_path.hpp"
#include "kerf/law_use.hpp"

namespace kerf {

namespace {

/// Straight lines between stretches, the first and the last of which are none. Each is a symmetric strain.
struct Cycle {
  const char* name;
  std::vector<SymTensor> corners;
};

constexpr int steps_per_leg = 100;

std::vector<Cycle> cycles_of(double strain, double compression, bool volume_only) {
  const double c = compression / 3.0;
  const SymTensor none{}, shear{0, 0, 0, strain, 0, 0}, other{0, 0, 0, 0, strain, 0.5 * strain},
      tension{strain, -0.5 * strain, -0.5 * strain, 0, 0, 0}, pressed{-c, -c, -c, 0, 0, 0};
  const auto negative = [](SymTensor t) { return t * -1.0; };
  std::vector<Cycle> all = {{"compression and back", {none, pressed, none}},
                            {"expansion, compression and back", {none, negative(pressed), pressed, none}},
                            {"compression, expansion and back", {none, pressed, negative(pressed), none}}};
  if (volume_only) return all;
  all.insert(all.end(),
             {{"tension, compression along an axis and back", {none, tension, negative(tension), none}},
              {"shear to and fro", {none, shear, negative(shear), none}},
              {"shear, then tension, out of shear, out of tension", {none, shear, shear + tension, tension, none}},
              {"tension, then shear, out of tension, out of shear", {none, tension, shear + tension, shear, none}},
              {"compression, then shear, expansion, out of shear", {none, pressed, pressed + shear, shear, none}},
              {"shear, then compression, out of shear, expansion", {none, shear, pressed + shear, pressed, none}},
              {"two shears, one after the other", {none, shear, shear + other, other, none}}});
  return all;
}

struct Work {
  double left = 0.0, most = 0.0;  // at the end, and the greatest size on the way, per reference volume [J/m3]
};

/// Energy of the element, and of what the law has not yet set free, above that at the start.
Work work_of(const SampleLaws& laws, const Cycle& cycle, double duration, int steps) {
  const CellMesh mesh = distorted_block(1, 1, 1, 1e-3, 0.0, 1);
  CellPart<double> part(mesh, laws.material, *laws.element);
  set_initial_state(part, laws);
  part.initialise();
  const auto* holder = dynamic_cast<const EnergyHolder*>(laws.law);
  const double volume = 1e-9;
  const auto energy = [&] {
    double held = 0.0;
    if (holder) {
      std::vector<double> state;
      for (const StateVariable& v : laws.law->state_variables()) state.push_back(part.variable(v.name, 0));
      held = holder->energy_held(state);
    }
    // What is set free is in the pressure, but not in the work: the law has initial_energy_density() of it.
    return part.get(PartStore::internal_energy, 0) / volume - held;
  };
  const double start = energy();
  Work work;
  const double dt = duration / (static_cast<double>(cycle.corners.size() - 1) * steps);
  for (std::size_t leg = 1; leg < cycle.corners.size(); ++leg)
    for (int k = 1; k <= steps; ++k) {
      const double u = static_cast<double>(k) / steps;
      const SymTensor e = cycle.corners[leg - 1] * (1.0 - u) + cycle.corners[leg] * u;
      Deformation d;
      d.f[0][0] += e.xx, d.f[1][1] += e.yy, d.f[2][2] += e.zz;
      d.f[0][1] = d.f[1][0] = e.xy, d.f[1][2] = d.f[2][1] = e.yz, d.f[0][2] = d.f[2][0] = e.zx;
      std::vector<Vec3> nodes;
      for (const Vec3 x : mesh.x) nodes.push_back(d.place(x));
      part.move_to(nodes, dt);
      work.left = energy() - start;
      work.most = std::max(work.most, std::fabs(work.left));
    }
  return work;
}

/// The greatest strain of a cycle, of shape and of volume together.
double size_of(const Cycle& cycle) {
  double size = 0.0;
  for (const SymTensor& e : cycle.corners) size = std::max(size, std::sqrt(double_dot(e, e)) + std::fabs(e.trace()));
  return size;
}

struct Finding {
  double created = -1.0, allowed = 0.0, most = 0.0;
  std::string cycle;
  double share() const { return created / most; }
};

/// What a cycle creates, and what of that the steps and finite strain explain.
///
/// A rate law in Cauchy stress is not exactly elastic at finite strain: over a closed cycle it gains or loses about the
/// strain times what it stores (J.C. Simo & K.S. Pister, Comp. Meth. Appl. Mech. Eng. 46 (1984) 201-215). What the
/// steps do wrong is seen where they are halved.
Finding finding_of(const SampleLaws& laws, const Cycle& cycle) {
  const double duration = laws.sample.settings.duration;
  const Work coarse = work_of(laws, cycle, duration, steps_per_leg),
             fine = work_of(laws, cycle, duration, 2 * steps_per_leg);
  return {-fine.left, std::fabs(fine.left - coarse.left) + (size_of(cycle) + 1e-9) * fine.most + 1e-9, fine.most,
          fmt::format("{} at strains of {:.2g}", cycle.name, size_of(cycle))};
}

/// Where the shear modulus grows with pressure, the gain is (dG/dp)(K/G) times as large, which is up to 5 in metals and
/// a trait of these laws: it is of third order in the strain, so its share of what is stored halves with the strain. A
/// law that makes energy keeps its share.
constexpr double most_of_third_order = 5.0;
bool is_of_third_order(const SampleLaws& laws, const Finding& f, const Cycle& half, double size) {
  const Finding g = finding_of(laws, half);
  const double ratio = g.share() / f.share();
  return f.share() < most_of_third_order * size && ratio > 0.35 && ratio < 0.65;
}

/// The cycle that creates most beyond what is allowed, if one does. `excused` becomes the greatest share of what is
/// stored that is created in third order of the strain.
Finding worst_cycle(const SampleLaws& laws, double scale, bool volume_only, double& excused) {
  const SampleSettings& s = laws.sample.settings;
  const auto cycles = cycles_of(scale * s.strain, scale * s.compression, volume_only),
             halves = cycles_of(0.5 * scale * s.strain, 0.5 * scale * s.compression, volume_only);
  Finding worst;
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    const Finding f = finding_of(laws, cycles[i]);
    if (f.created <= f.allowed) continue;
    if (std::isfinite(f.created) && is_of_third_order(laws, f, halves[i], size_of(cycles[i]))) {
      excused = std::max(excused, f.share());
      continue;
    }
    if (!(f.created / f.allowed <= worst.created / std::max(worst.allowed, 1e-300))) worst = f;
  }
  return worst;
}

}  // namespace

void check_energy(const Registry& registry, const TypeSample& sample, Verdicts& out) {
  const char* check = "energy";
  if (!out.wants(check)) return;
  const SampleLaws laws(registry, sample, true);
  if (sample.kind == "erosion" && !laws.material.erosion->criteria.front()->softens()) {
    out.note(check, "not asked: the criterion leaves the stress alone");
    return;
  }
  double excused = 0.0;
  try {
    // Small ones, in which most laws are elastic, as well.
    for (const double scale : {0.02, 0.2, 1.0}) {
      const Finding f = worst_cycle(laws, scale, sample.kind == "eos", excused);
      if (f.created <= f.allowed) continue;
      out.fail(check, fmt::format("{} leaves {:.3g} J/m3 less than none, though the error of the steps and of finite "
                                  "strain is {:.2g} J/m3 (of {:.3g} J/m3 stored on the way): the law makes energy; "
                                  "unload with the moduli of loading, and let stress follow from a potential",
                                  f.cycle, f.created, f.allowed, f.most));
      return;
    }
  } catch (const std::exception& e) {
    out.fail(check, fmt::format("a cycle cannot be gone to its end: {}", sentence_of(e)));
    return;
  }
  out.pass(check, fmt::format("{} closed cycles of strains at three sizes make no energy{}",
                              cycles_of(1.0, 1.0, sample.kind == "eos").size(),
                              excused > 0.0 ? fmt::format(" but of third order in the strain: up to {:.1e} of what is "
                                                          "stored on the way",
                                                          excused)
                                            : ""));
}

}  // namespace kerf
