// The moduli that a law returns set the stable step: none may be below the tangent of the law.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "conformance/checks.hpp"
#include "conformance/law_path.hpp"
#include "conformance/watched_laws.hpp"

namespace kerf {

namespace {

constexpr int steps = 256, looks = 32;
// The step is 0.9 of the stable one: the modulus may be 0.81 of the tangent before a step is too large. 2 % is for the
// change of moduli over the increments that tell the tangent.
constexpr double slack = 0.02;

struct Direction {
  Vec3 n, m;  // m is zero for a normal strain
};

std::vector<Direction> directions() {
  const double a = std::sqrt(0.5), b = std::sqrt(1.0 / 3.0);
  return {{{1, 0, 0}, {}},         {{0, 1, 0}, {}},        {{0, 0, 1}, {}},        {{a, a, 0}, {}},
          {{b, b, b}, {}},         {{1, 0, 0}, {0, 1, 0}}, {{0, 1, 0}, {0, 0, 1}}, {{0, 0, 1}, {1, 0, 0}},
          {{a, a, 0}, {a, -a, 0}}, {{a, 0, a}, {0, 1, 0}}};
}

/// A strain of size `e` in the direction, as a deformation of what there is.
Deformation strained(const Direction& d, double e) {
  Deformation f;
  const bool normal = norm(d.m) == 0.0;
  const Vec3 m = normal ? d.n : d.m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) f.f[i][j] += 0.5 * e * (d.n[i] * m[j] + m[i] * d.n[j]);
  return f;
}

double along(SymTensor s, Vec3 n, Vec3 m) {
  const Vec3 t{s.xx * m.x + s.xy * m.y + s.zx * m.z, s.xy * m.x + s.yy * m.y + s.yz * m.z,
               s.zx * m.x + s.yz * m.y + s.zz * m.z};
  return dot(n, t);
}

struct Worst {
  double tangent = 0.0, modulus = 0.0, over = -1e300;  // [Pa]
  std::string what;
};

class TangentTest {
 public:
  TangentTest(const Registry& registry, const TypeSample& sample) : laws_(registry, sample, true) {
    watch(laws_, seen_);
    if (laws_.material.strength) viscosity_ = laws_.material.strength->viscosity();
  }

  Worst worst;
  std::string bad_modulus;
  double most_excess = 0.0;

  void run() {
    StretchPath path = path_of(laws_.sample);
    PathDriver<double> driver(laws_, path);
    const double dt = path.duration / steps;
    const double size = 0.2 * std::max(path.strain, path.compression) * 6.0 / steps;  // a fifth of a step's strain
    for (int look = 0; look < looks; ++look) {
      const auto before = driver.part().save();
      for (const Direction& d : directions()) look_at(driver.part(), before, d, size, dt);
      driver.part().restore(before);
      driver.go(steps / looks, dt, 0);
      note_moduli(driver.time());
    }
  }

 private:
  void note_moduli(double time) {
    if (bad_modulus.empty() && !(seen_.shear >= 0.0 && seen_.bulk >= 0.0 && std::isfinite(seen_.shear + seen_.bulk)))
      bad_modulus =
          fmt::format("shear modulus {:.4g} Pa, bulk modulus {:.4g} Pa at {:.3g} s", seen_.shear, seen_.bulk, time);
  }

  struct Answer {
    SymTensor deviator;
    double pressure;
    ModuliSeen moduli;
  };
  Answer answer(CellPart<double>& part, const CellPart<double>::Snapshot& before, const Direction& d, double e,
                double dt) {
    part.restore(before);
    const Deformation f = strained(d, e);
    std::vector<Vec3> nodes;
    for (const Vec3 x : before.x) nodes.push_back(f.place(x));
    part.move_to(nodes, dt);
    return {part.deviator(0), part.pressure(0), seen_};
  }

  /// Half the difference of an increment and its opposite: at the same rate, so that what relaxes cancels out.
  void look_at(CellPart<double>& part, const CellPart<double>::Snapshot& before, const Direction& d, double size,
               double dt) {
    const Answer there = answer(part, before, d, size, dt), back = answer(part, before, d, -size, dt);
    const double shear = std::max(there.moduli.shear, back.moduli.shear) + viscosity_ / dt,
                 bulk = std::max(there.moduli.bulk, back.moduli.bulk);
    const SymTensor change = there.deviator - back.deviator;
    const double deviatoric = along(change, d.n, norm(d.m) == 0.0 ? d.n : d.m) / (2.0 * size);
    const double pressing = (back.pressure - there.pressure) / (2.0 * size);
    // The stress itself turns with the increments, and the density changes.
    const double stress = von_mises(there.deviator) + std::fabs(there.pressure);
    const std::string& kind = laws_.sample.kind;
    if (norm(d.m) > 0.0) {
      if (kind != "eos") judge("shear", deviatoric, shear, stress);
    } else if (kind == "material") {
      judge("stretch without change of pressure", deviatoric, 4.0 / 3.0 * shear, stress);
    } else if (kind == "eos") {
      judge("compression", pressing, bulk, stress);
    } else {
      judge("stretch along an axis", deviatoric + pressing, bulk + 4.0 / 3.0 * shear, stress);
    }
  }
  void judge(const char* what, double tangent, double modulus, double stress) {
    const double excess = laws_.sample.settings.tangent_excess;
    const double over = tangent - (1.0 + slack) * excess * modulus - stress;
    most_excess = std::max(most_excess, (tangent - stress) / modulus);
    if (over > worst.over || !std::isfinite(over)) worst = {tangent, modulus, over, what};
  }

  ModuliSeen seen_;
  SampleLaws laws_;
  double viscosity_ = 0.0;
};

}  // namespace

void check_moduli(const Registry& registry, const TypeSample& sample, Verdicts& out) {
  const char* check = "moduli";
  if (!out.wants(check) || sample.kind == "erosion") return;
  TangentTest test(registry, sample);
  try {
    test.run();
  } catch (const std::exception& e) {
    out.fail(check, fmt::format("the path cannot be gone to its end: {}", sentence_of(e)));
    return;
  }
  const Worst& w = test.worst;
  if (!test.bad_modulus.empty())
    out.fail(check, fmt::format("{}: moduli have to be zero or more; return the elastic ones", test.bad_modulus));
  else if (!(w.over <= 0.0))
    out.fail(check, fmt::format("the tangent in {} is {:.4g} Pa, but the law returns moduli that make it {:.4g} Pa: "
                                "steps would be too large and the run unstable; return the stiffest tangent",
                                w.what, w.tangent, w.modulus));
  else
    out.pass(check, fmt::format("{} states and {} directions: no tangent exceeds what the moduli say{}", looks,
                                directions().size(),
                                sample.settings.tangent_excess > 1.0
                                    ? fmt::format(" {:g} times, which the sample allows; the stiffest is {:.2f} times",
                                                  sample.settings.tangent_excess, test.most_excess)
                                    : ""));
}

}  // namespace kerf
