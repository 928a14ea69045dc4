// The contract of erosion criteria: laws that say when an element has failed.
#pragma once

#include <cstdint>
#include <string>

#include "kerf/law.hpp"
#include "kerf/math.hpp"
#include "kerf/plugin.hpp"

namespace kerf {

struct ErosionInputPoint {
  SymTensor stress;  // Cauchy stress, tension positive [Pa]
  double pressure = 0.0;  // positive in compression [Pa]
  double density_ratio = 1.0;  // density / reference density [-]
  double volume_ratio = 1.0;  // volume / initial volume, not positive where the element is inverted [-]
  double time_step = 0.0;  // stable time step of the element, without safety factor [s]
  SymTensor strain_increment;  // midpoint [-]
  Rotation rotation;  // rotation of the step
  double dt = 0.0;  // [s]
  double time = 0.0;  // at the end of the step [s]
};
/// With what a law has asked for: `ErosionInputWith<inputs>`, see Inputs.
template <unsigned inputs>
struct ErosionInputWith : ErosionInputPoint, detail::AskedInputs<(inputs & ~with_rotation)> {};

/// What a criterion says of a point: the value it looked at, and 1 where the element has failed, else 0. Anything else,
/// and shares that are not from 0 to 1, stop the run.
struct Verdict {
  double value = 0.0;
  double failed = 0.0;
  // What is left of the deviator, of tensile and of compressive pressures in the next step, 0 to 1; of criteria with
  // `softens` only.
  double strength = 1.0, tension = 1.0, compression = 1.0;
};

/// One block of `lane_width` points; see MaterialBatch.
struct ErosionBatch : LawRows {
  const double (*stress)[lane_width] = nullptr;  // [6][lane]
  const double (*strain_increment)[lane_width] = nullptr;  // [6][lane]
  const double *pressure = nullptr, *density_ratio = nullptr, *volume_ratio = nullptr, *time_step = nullptr;
  double* state = nullptr;  // [variable][lane]
  double *value = nullptr, *failed = nullptr;
  double *strength = nullptr, *tension = nullptr, *compression = nullptr;  // written by criteria that soften
};

/// How the engine spreads what a criterion adds up over the neighbourhood of an element. In each step the criterion
/// leaves its increment in one state variable; the engine takes the average f = sum w V f / sum w V over the elements
/// of the part that live, V their initial volumes and w a function of the distance r of their initial centres, and adds
/// it to another state variable before the next step.
struct NonLocalAverage {
  double radius = 0.0;  // L [m]; zero: nothing is averaged
  bool bell = false;  // w = (1 - r^2/L^2)^2, else 1 / (1 + (r/L)^p)^q; both zero beyond L
  double p = 8.0, q = 2.0;
  int increment = 0, sum = 0;  // places of the two in the criterion's State
};

class ErosionCriterion : public Law {
 public:
  virtual void judge(const ErosionBatch& batch) const = 0;
  /// Whether an element that fails may lose its stress over some steps before it is deleted, where the user asks for
  /// that. False for criteria of elements that cannot be computed any longer.
  virtual bool can_fade() const { return true; }
  /// Whether the criterion weakens the stress before the element fails.
  virtual bool softens() const { return false; }
  /// What the engine averages for the criterion. A law that gives a radius asks for `with_reference_position`.
  virtual NonLocalAverage nonlocal() const { return {}; }
  /// Cycles between two looks. A criterion that keeps state is updated every cycle all the same.
  std::int64_t check_interval = 1;
  /// What becomes of an element that fails: "erosion" deletes it; "no_tension" keeps it, without deviator and without
  /// tension for ever.
  std::string then = "erosion";

 protected:
  /// Declares what every criterion takes: the check interval, and what becomes of an element that fails.
  template <class S>
  static void describe_interval(S& s) {
    s.integer(&ErosionCriterion::check_interval, "check_interval", positive, "cycles between two looks")
        .by_default("1");
    s.choice(&ErosionCriterion::then, "then", {"erosion", "no_tension"},
             "what becomes of an element that fails: it is deleted, or it stays and resists compression only")
        .by_default("erosion");
  }
};

/// A criterion whose law is `Verdict judge_point(const ErosionInputPoint&, const Reads&, State&) const`. One that
/// weakens the stress declares `static constexpr bool can_soften = true` and sets the verdict's `strength`, `tension`
/// and `compression`; it may have `bool softens() const` where that depends on its parameters. A law whose parameters
/// choose between several ways to compute may have `with_form(work)`, which calls `work(Form{})` once with a type that
/// tells the way, and `judge_point<Form>`: what a loop asks of its parameters for every point keeps it from
/// vectorising.
template <class LawType>
class PointwiseErosion : public detail::PointwiseLaw<LawType, ErosionCriterion> {
 public:
  bool softens() const override { return may_soften(); }
  void judge(const ErosionBatch& b) const final {
    const auto& law = static_cast<const LawType&>(*this);
    if constexpr (requires { law.with_form([](auto) {}); })
      law.with_form([&]<class Form>(Form) { judge_rows<Form>(b); });
    else
      judge_rows<void>(b);
  }

 private:
  template <class Form>
  void judge_rows(const ErosionBatch& b) const {
    using State = typename LawType::State;
    using Reads = typename LawType::Reads;
    alignas(64) double stress[6][lane_width], strain[6][lane_width], rotation[9][lane_width], rest[4][lane_width];
    alignas(64) double value[lane_width], failed[lane_width];
    [[maybe_unused]] alignas(64) double strength[lane_width], tension[lane_width], compression[lane_width];
    [[maybe_unused]] alignas(64) double ignored[lane_width];
    constexpr unsigned inputs = detail::inputs_of<LawType>();
    const double dt = b.dt, time = b.time;
    detail::LaneVariables<State> state;
    detail::LaneVariables<Reads> reads;
    for (int l = 0; l < lane_width; ++l) {
      for (int k = 0; k < 6; ++k) {
        stress[k][l] = b.stress[k][l];
        strain[k][l] = b.strain_increment[k][l];
      }
      for (int k = 0; k < 9; ++k) rotation[k][l] = b.rotation[k][l];
      rest[0][l] = b.pressure[l];
      rest[1][l] = b.density_ratio[l];
      rest[2][l] = b.volume_ratio[l];
      rest[3][l] = b.time_step[l];
    }
    state.read(b.state);
    reads.read(b.reads);
    const auto& law = static_cast<const LawType&>(*this);
    detail::LaneErrors errors;
    // A function of its own: locals of a simd loop's body whose address is taken would become arrays in memory.
    const auto one_point = [&](int l) __attribute__((always_inline)) {
      ErosionInputWith<inputs> in;
      detail::set_asked<(inputs & ~with_rotation)>(in, b, l);
      in.dt = dt;
      in.time = time;
      in.stress = detail::tensor_at(stress, l);
      in.strain_increment = detail::tensor_at(strain, l);
      in.rotation = {rotation[0][l], rotation[1][l], rotation[2][l], rotation[3][l], rotation[4][l],
                     rotation[5][l], rotation[6][l], rotation[7][l], rotation[8][l]};
      in.pressure = rest[0][l];
      in.density_ratio = rest[1][l];
      in.volume_ratio = rest[2][l];
      in.time_step = rest[3][l];
      State point = state.at(l);
      Verdict verdict;
      errors.guard(
          l, [&]() __attribute__((always_inline)) {
            if constexpr (std::is_void_v<Form>)
              verdict = law.judge_point(in, reads.at(l), point);
            else
              verdict = law.template judge_point<Form>(in, reads.at(l), point);
          });
      state.set(l, point);
      value[l] = verdict.value;
      failed[l] = verdict.failed;
      if constexpr (may_soften()) {
        strength[l] = verdict.strength;
        tension[l] = verdict.tension;
        compression[l] = verdict.compression;
      } else {
        ignored[l] = verdict.strength != 1.0 || verdict.tension != 1.0 || verdict.compression != 1.0 ? 1.0 : 0.0;
      }
    };
#pragma omp simd
    for (int l = 0; l < lane_width; ++l) one_point(l);
    errors.throw_first();
    if constexpr (!may_soften())
      for (const double of_lane : ignored)
        if (of_lane != 0.0)
          throw std::runtime_error(
              "it sets what is left of the stress, which nobody would heed; declare `static constexpr bool can_soften "
              "= "
              "true`");
    state.write(b.state);
    for (int l = 0; l < lane_width; ++l) {
      b.value[l] = value[l];
      b.failed[l] = failed[l];
    }
    if constexpr (may_soften())
      if (this->softens())
        for (int l = 0; l < lane_width; ++l) {
          b.strength[l] = strength[l];
          b.tension[l] = tension[l];
          b.compression[l] = compression[l];
        }
  }

  static constexpr bool may_soften() {
    return requires { requires LawType::can_soften; };
  }
};

}  // namespace kerf

KERF_SIZES(erosion, KERF_SIZE(ErosionInputPoint), KERF_SIZE(Verdict), KERF_SIZE(ErosionBatch),
           KERF_SIZE(NonLocalAverage), KERF_SIZE(ErosionCriterion))
