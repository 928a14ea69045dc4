// Laws that each break one promise of the contract. Every check of `kerf test-plugin` has one here that it finds.
#include <cstdlib>

#include <kerf/eos.hpp>
#include <kerf/erosion.hpp>
#include <kerf/material.hpp>
#include <kerf/solid.hpp>

namespace {

using namespace kerf;

constexpr double G = 80e9, K = 160e9;  // [Pa]

/// What is right about the materials below: linear elasticity without parameters.
template <class Law>
struct WrongMaterial : PointwiseMaterial<Law> {
  using State = NoVariables;
  static void describe(Schema<Law>&) {}
};

// ---- declarations

struct NoText final : WrongMaterial<NoText> {
  double factor = 1.0;
  static void describe(Schema<NoText>& s) { s.real(&NoText::factor, "factor", "-", positive, "").by_default("1"); }
  void update_point(const PointInput& in, SymTensor& s, State&, double& g) const {
    s = s + 2.0 * G * factor * deviator(in.strain_increment);
    g = G * factor;
  }
};

struct OddUnit final : WrongMaterial<OddUnit> {
  double factor = 1.0;
  static void describe(Schema<OddUnit>& s) {
    s.real(&OddUnit::factor, "Stiffness", "Pascals per dog", positive, "TODO say what it is").by_default("1");
  }
  void update_point(const PointInput& in, SymTensor& s, State&, double& g) const {
    s = s + 2.0 * G * deviator(in.strain_increment);
    g = G;
  }
};

struct BadDefault final : WrongMaterial<BadDefault> {
  double factor = 1.0;
  static void describe(Schema<BadDefault>& s) {
    s.real(&BadDefault::factor, "factor", "-", fraction, "share of the modulus").by_default("2");
  }
  void update_point(const PointInput& in, SymTensor& s, State&, double& g) const {
    s = s + 2.0 * G * deviator(in.strain_increment);
    g = G;
  }
};

struct WideRange final : WrongMaterial<WideRange> {
  double divisor = 1.0;
  static void describe(Schema<WideRange>& s) {
    s.real(&WideRange::divisor, "divisor", "-", non_negative, "what the modulus is divided by").by_default("1");
  }
  void update_point(const PointInput& in, SymTensor& s, State&, double& g) const {
    s = s + 2.0 * G / divisor * deviator(in.strain_increment);
    g = G / divisor;
  }
};

// ---- points

/// Stiffer by a hair in every lane than in the one before.
struct LaneDependent final : Material {
  static void describe(Schema<LaneDependent>&) {}
  void update(const MaterialBatch& b) const override {
    for (int l = 0; l < lane_width; ++l) {
      const double g = G * (1.0 + 1e-12 * l);
      const SymTensor e = deviator(detail::tensor_at(b.strain_increment, l));
      const double add[6] = {e.xx, e.yy, e.zz, e.xy, e.yz, e.zx};
      for (int i = 0; i < 6; ++i) b.deviator[i][l] += 2.0 * g * add[i];
      b.shear_modulus[l] = g;
    }
  }
};

/// The root of a negative number in strong compression.
struct NotFinite final : WrongMaterial<NotFinite> {
  void update_point(const PointInput& in, SymTensor& s, State&, double& g) const {
    g = G * (1.0 + 1e-3 * std::sqrt(1.045 - in.density / in.reference_density));
    s = s + 2.0 * G * deviator(in.strain_increment);
  }
};

// ---- frames

/// Stiffer along x.
struct FixedDirection final : WrongMaterial<FixedDirection> {
  void update_point(const PointInput& in, SymTensor& s, State&, double& g) const {
    const SymTensor e = deviator(in.strain_increment);
    s = s + 2.0 * G * e + deviator(SymTensor{0.5 * G * e.xx, 0, 0, 0, 0, 0});
    g = 1.5 * G;
  }
};

/// A back stress in six scalars, which nobody rotates.
struct Unrotated final : WrongMaterial<Unrotated> {
  struct State {
    double back[6];
  };
  static void describe(Schema<Unrotated>& s) {
    s.state(&State::back, "back_stress", "Pa", 0.0, "part of the stress that remembers");
  }
  void update_point(const PointInput& in, SymTensor& s, State& state, double& g) const {
    double(&b)[6] = state.back;
    const SymTensor e = deviator(in.strain_increment), old{b[0], b[1], b[2], b[3], b[4], b[5]}, now = old + G * e;
    s = s - old + 2.0 * G * e + now;
    const double c[6] = {now.xx, now.yy, now.zz, now.xy, now.yz, now.zx};
    for (int i = 0; i < 6; ++i) b[i] = c[i];
    g = 1.5 * G;
  }
};

// ---- time

/// Softer with every step, however short.
struct CountsSteps final : WrongMaterial<CountsSteps> {
  struct State {
    double calls;
  };
  static void describe(Schema<CountsSteps>& s) { s.state(&State::calls, "calls", "-", 0.0, "number of steps so far"); }
  void update_point(const PointInput& in, SymTensor& s, State& state, double& g) const {
    state.calls += 1.0;
    s = 0.999 * (s + 2.0 * G * deviator(in.strain_increment));
    g = G;
  }
};

/// Relaxes by Euler's explicit method, which is of first order; the sample says two.
struct FirstOrder final : WrongMaterial<FirstOrder> {
  void update_point(const PointInput& in, SymTensor& s, State&, double& g) const {
    s = (1.0 - in.dt / 20e-6) * s + 2.0 * G * deviator(in.strain_increment);
    g = G;
  }
};

// ---- energy and moduli

/// Stiff where it is loaded, soft where it is unloaded.
struct MakesEnergy final : WrongMaterial<MakesEnergy> {
  void update_point(const PointInput& in, SymTensor& s, State&, double& g) const {
    const SymTensor e = deviator(in.strain_increment);
    s = s + select(double_dot(s, e) >= 0.0, 2.0 * G, 1.6 * G) * e;
    g = G;
  }
};

struct LyingModulus final : WrongMaterial<LyingModulus> {
  void update_point(const PointInput& in, SymTensor& s, State&, double& g) const {
    s = s + 2.0 * G * deviator(in.strain_increment);
    g = 0.8 * G;
  }
};

struct NegativeModulus final : WrongMaterial<NegativeModulus> {
  void update_point(const PointInput&, SymTensor& s, State&, double& g) const {
    s = {};
    g = -1.0;
  }
};

/// Stiffer in compression than in expansion.
struct EosMakesEnergy final : PointwiseEos<EosMakesEnergy> {
  struct State {
    double density, pressure;
  };
  static void describe(Schema<EosMakesEnergy>& s) {
    s.state(&State::density, "last_density", "kg/m3", 0.0, "density of the last step, or zero");
    s.state(&State::pressure, "last_pressure", "Pa", 0.0, "pressure of the last step");
  }
  EosOutput evaluate_point(const EosInput& in, State& state) const {
    const double old = select(state.density > 0.0, state.density, in.reference_density);
    const double change = (in.density - old) / in.reference_density;
    state.pressure += select(state.pressure * change >= 0.0, K, 0.8 * K) * change;
    state.density = in.density;
    return {state.pressure, K * in.density / in.reference_density};
  }
};

struct LyingEos final : PointwiseEos<LyingEos> {
  using State = NoVariables;
  static void describe(Schema<LyingEos>&) {}
  bool uses_energy() const override { return false; }
  EosOutput evaluate_point(const EosInput& in, const State&) const {
    return {K * (in.density / in.reference_density - 1.0), 0.8 * K};
  }
};

struct LyingSolid final : PointwiseSolid<LyingSolid> {
  using State = NoVariables;
  static void describe(Schema<LyingSolid>&) {}
  void update_point(const SolidInput& in, SymTensor& stress, State&, SolidModuli& moduli) const {
    const SymTensor e = in.strain_increment;
    const double p = K * e.trace();
    stress = stress + 2.0 * G * deviator(e) + SymTensor{p, p, p, 0, 0, 0};
    moduli = {G, 0.7 * K};
  }
};

// ---- memory

/// Every object is a little stiffer than the one before.
struct CountsObjects final : WrongMaterial<CountsObjects> {
  double factor = 1.0 + 1e-9 * static_cast<double>(++n_objects());
  static int& n_objects() {
    static int n = 0;
    return n;
  }
  void update_point(const PointInput& in, SymTensor& s, State&, double& g) const {
    s = s + 2.0 * G * factor * deviator(in.strain_increment);
    g = G * factor;
  }
};

/// The stress of a point depends on the one that was computed before it.
struct Remembers final : WrongMaterial<Remembers> {
  mutable double last = 0.0;
  void update_point(const PointInput& in, SymTensor& s, State&, double& g) const {
    s = s + 2.0 * G * (1.0 + 1e-9 * last) * deviator(in.strain_increment);
    last = std::fabs(in.strain_increment.xx) > 1e-4 ? 1.0 : 0.0;
    g = G * 1.001;
  }
};

/// Numbers that floats cannot tell apart.
struct LosesDigits final : PointwiseMaterial<LosesDigits> {
  struct State {
    double strain;
  };
  static constexpr bool computes_in_single = true;
  static void describe(Schema<LosesDigits>& s) {
    s.state(&State::strain, "strain_sum", "-", 0.0, "sum of the sizes of the strains");
  }
  template <class Real>
  void update_point(const PointInputOf<Real>& in, SymTensorOf<Real>& s, State& state, Real& g) const {
    const Real step = std::sqrt(double_dot(in.strain_increment, in.strain_increment));
    state.strain += static_cast<double>((Real(1000.0) + step) - Real(1000.0));
    s = s + static_cast<Real>(2.0 * G) * deviator(in.strain_increment);
    g = static_cast<Real>(G);
  }
};

/// Stiffer where there are several ranks.
struct KnowsRanks final : WrongMaterial<KnowsRanks> {
  double factor = std::getenv("OMPI_COMM_WORLD_SIZE") ? 1.0 + 1e-9 : 1.0;
  void update_point(const PointInput& in, SymTensor& s, State&, double& g) const {
    s = s + 2.0 * G * factor * deviator(in.strain_increment);
    g = G * factor;
  }
};

/// Judges by the stress along x.
struct AlongX final : PointwiseErosion<AlongX> {
  struct State {
    double greatest;
  };
  struct Reads {};
  static void describe(Schema<AlongX>& s) {
    describe_interval(s);
    s.state(&State::greatest, "greatest_stress", "Pa", 0.0, "greatest stress along x so far");
  }
  Verdict judge_point(const ErosionInputPoint& in, const Reads&, State& state) const {
    state.greatest = max_of(state.greatest, in.stress.xx);
    return {state.greatest, select(state.greatest > 1e12, 1.0, 0.0)};
  }
};

/// Nothing is wrong with it, but it has no sample.
struct NoSample final : WrongMaterial<NoSample> {
  void update_point(const PointInput& in, SymTensor& s, State&, double& g) const {
    s = s + 2.0 * G * deviator(in.strain_increment);
    g = G;
  }
};

/// Nothing is wrong with it.
struct Right final : WrongMaterial<Right> {
  void update_point(const PointInput& in, SymTensor& s, State&, double& g) const {
    s = s + 2.0 * G * deviator(in.strain_increment);
    g = G;
  }
};

/// A loop over the points that cannot be vectorised.
struct Loops final : WrongMaterial<Loops> {
  void update_point(const PointInput& in, SymTensor& s, State&, double& g) const {
    double x = 1.0;
    while (x * x < 2.0 + std::fabs(in.strain_increment.trace())) x *= 1.5;
    s = s + 2.0 * G * deviator(in.strain_increment);
    g = x > 1.2 ? G * 1.001 : G;
  }
};

}  // namespace

KERF_REGISTER(
    KERF_TYPE(NoText, "material", "no_text", "a parameter without text") KERF_TYPE(
        OddUnit, "material", "odd_unit", "a unit that nobody knows") KERF_TYPE(BadDefault, "material", "bad_default",
                                                                               "a default outside of its range")
        KERF_TYPE(WideRange, "material", "wide_range", "a range that allows what the law cannot") KERF_TYPE(
            LaneDependent, "material", "lane_dependent",
            "another law in every lane") KERF_TYPE(NotFinite, "material", "not_finite", "the root of a negative number")
            KERF_TYPE(FixedDirection, "material", "fixed_direction",
                      "stiffer along x") KERF_TYPE(Unrotated, "material", "unrotated", "a tensor that is not rotated")
                KERF_TYPE(CountsSteps, "material", "counts_steps", "softer with every step")
                    KERF_TYPE(FirstOrder, "material", "first_order", "of lower order than it says")
                        KERF_TYPE(MakesEnergy, "material", "makes_energy", "stiff on the way up, soft on the way down")
                            KERF_TYPE(LyingModulus, "material", "lying_modulus", "stiffer than it says")
                                KERF_TYPE(NegativeModulus, "material", "negative_modulus",
                                          "a modulus below zero") KERF_TYPE(EosMakesEnergy, "eos", "eos_makes_energy",
                                                                            "stiffer in compression than in expansion")
                                    KERF_TYPE(LyingEos, "eos", "lying_eos", "stiffer than it says")
                                        KERF_TYPE(LyingSolid, "solid", "lying_solid", "stiffer than it says") KERF_TYPE(
                                            CountsObjects, "material", "counts_objects", "another law in every object")
                                            KERF_TYPE(Remembers, "material", "remembers", "a member that changes")
                                                KERF_TYPE(LosesDigits, "material", "loses_digits",
                                                          "floats that lose digits")
                                                    KERF_TYPE(KnowsRanks, "material", "knows_ranks",
                                                              "another law on several ranks")
                                                        KERF_TYPE(AlongX, "erosion", "along_x", "a direction in space")
                                                            KERF_TYPE(NoSample, "material", "no_sample",
                                                                      "a law without a sample")
                                                                KERF_TYPE(Right, "material", "right",
                                                                          "nothing is wrong with it")
                                                                    KERF_TYPE(Loops, "material", "loops",
                                                                              "a loop that cannot be vectorised"))
