// Radial return for J2 laws whose flow stress depends on plastic strain, its rate and the temperature: the law says its
// flow stress, this finds the plastic increment, returns the stress, and heats the material.
//
// Source: J.C. Simo & T.J.R. Hughes, Computational Inelasticity (1998), box 3.1.
#pragma once

#include "kerf/material.hpp"

namespace kerf {

/// What a flow stress depends on at the end of a step.
struct FlowPoint {
  double plastic_strain = 0.0;  // [-]
  double increment = 0.0;  // of the plastic strain in this step [-]
  double rate = 0.0;  // increment over step [1/s]
  double temperature = 0.0;  // at the start of the step [K]
};
/// A flow stress, and its derivative by the logarithm of the increment, to which strain and rate both contribute [Pa].
struct FlowStress {
  double value = 0.0, slope = 0.0;
};

/// Base of a law that adds
///   FlowStress flow_stress(const FlowPoint&) const   grows with the increment; has to hold for a rate of zero
///   static void describe_flow(Schema<LawType>&)      its parameters
/// and gets the shear modulus, plastic strain, its rate, and adiabatic heating by the share `taylor_quinney` of the
/// plastic work.
template <class LawType>
class RadialReturn : public Material {
 public:
  double G = 0.0;  // [Pa]
  double initial_temperature = 0.0, specific_heat = 0.0, taylor_quinney = 0.9;  // [K], [J/(kg K)], [-]

  struct State {
    double effective_plastic_strain, temperature, plastic_strain_rate;
  };

  static void describe(Schema<LawType>& s) {
    using M = LawType;
    s.real(&M::G, "shear_modulus", "Pa", positive, "elastic shear modulus");
    M::describe_flow(s);
    s.real(&M::initial_temperature, "initial_temperature", "K", positive, "temperature at the start")
        .by_default("293.15")
        .usual(between(100.0, 3000.0));
    s.real(&M::specific_heat, "specific_heat", "J/(kg K)", positive, "specific heat capacity");
    s.real(&M::taylor_quinney, "taylor_quinney", "-", fraction, "share of the plastic work that heats")
        .by_default("0.9");
    s.state(&State::effective_plastic_strain, "effective_plastic_strain", "-", 0.0,
            "equivalent plastic strain, the time integral of sqrt(2/3 Dp:Dp)")
        .within(non_negative);
    s.state(&State::temperature, "temperature", "K", 293.15, "temperature from adiabatic plastic heating")
        .within(positive);
    s.state(&State::plastic_strain_rate, "plastic_strain_rate", "1/s", 0.0, "equivalent plastic strain rate");
  }
  void initialise(const InitialPoint&, double* state) const override { state[1] = initial_temperature; }
  double cost() const override { return 5.0; }

  void update(const MaterialBatch& b) const override { update_rows(b); }
  void update_single(const SingleMaterialBatch& b) const override { update_rows(b); }

 private:
  struct alignas(64) Block {
    double strain[6][lane_width], stress[6][lane_width], density[lane_width];
    double q[lane_width];  // trial equivalent stress [Pa]
    double bound[lane_width];  // increment if the flow stress did not grow with it; not positive: elastic
    double d[lane_width];  // plastic increment
  };
  const LawType& law() const { return static_cast<const LawType&>(*this); }

  template <class Real>
  void update_rows(const MaterialRows<Real>& b) const {
    Block k;
    detail::LaneVariables<State> state;
    state.read(b.state);
    for (int l = 0; l < lane_width; ++l) k.density[l] = b.density[l];
    for (int i = 0; i < 6; ++i)
      for (int l = 0; l < lane_width; ++l) {
        k.strain[i][l] = b.strain_increment[i][l];
        k.stress[i][l] = b.deviator[i][l];
      }
    detail::LaneErrors errors;
#pragma omp simd
    for (int l = 0; l < lane_width; ++l) predict(k, state.values, l, errors);
    errors.throw_first();
    solve(k, state.values, b.dt);
#pragma omp simd
    for (int l = 0; l < lane_width; ++l) flow(k, state.values, b.dt, l);
    for (int i = 0; i < 6; ++i)
      for (int l = 0; l < lane_width; ++l) b.deviator[i][l] = static_cast<Real>(k.stress[i][l]);
    for (int l = 0; l < lane_width; ++l) b.shear_modulus[l] = static_cast<Real>(G);
    state.write(b.state);
  }

  using StateRows = double[n_doubles<State>][lane_width];

  /// Elastic predictor. The whole strain increment is the first guess of the plastic one.
  [[gnu::always_inline]] void predict(Block& k, const StateRows& state, int l, detail::LaneErrors& errors) const {
    const SymTensor increment = deviator(detail::tensor_at(k.strain, l));
    const SymTensor trial = detail::tensor_at(k.stress, l) + (2.0 * G) * increment;
    const double q = von_mises(trial);
    FlowStress at_rest{};
    errors.guard(
        l, [&]() __attribute__((always_inline)) {
          at_rest = law().flow_stress({state[0][l], 0.0, 0.0, state[1][l]});
        });
    const double bound = (q - at_rest.value) / (3.0 * G);
    detail::set_tensor(k.stress, l, trial);
    k.q[l] = q;
    k.bound[l] = bound;
    k.d[l] = select(bound > 0.0, max_of(min_of(equivalent_strain(increment), bound), 1e-6 * bound), 0.0);
  }

  /// Roots d of 3 G d + Y(ep + d, d/dt) - q by Newton's method for ln d, whose steps are held to a factor of e^2. The
  /// root is not right of `bound`. A point that has converged is not touched again, whatever its neighbours need.
  void solve(Block& k, const StateRows& state, double dt) const {
    const double per_dt = 1.0 / (dt + 1e-300);
    alignas(64) double moving[lane_width];
    double any = 0.0;
    for (int l = 0; l < lane_width; ++l) any += moving[l] = select(k.bound[l] > 0.0, 1.0, 0.0);
    for (int i = 0; i < max_iterations && any > 0.0; ++i) {
      detail::LaneErrors errors;
#pragma omp simd
      for (int l = 0; l < lane_width; ++l) {
        const double d = max_of(k.d[l], 1e-60);
        FlowStress y{};
        errors.guard(
            l, [&]() __attribute__((always_inline)) {
              y = law().flow_stress({state[0][l] + d, d, d * per_dt, state[1][l]});
            });
        const double slope = 3.0 * G * d + y.slope, residual = 3.0 * G * d + y.value - k.q[l];
        const double s = clamp_to(residual / (slope + 1e-300), -2.0, 2.0);
        const bool moves = moving[l] > 0.0;
        k.d[l] = select(moves, min_of(d * kerf::exp(-s), k.bound[l]), k.d[l]);
        moving[l] = select(moves & (std::fabs(s) > tolerance), 1.0, 0.0);
      }
      errors.throw_first();
      any = 0.0;
      for (int l = 0; l < lane_width; ++l) any += moving[l];
    }
    for (int l = 0; any > 0.0 && l < lane_width; ++l)
      if (moving[l] > 0.0) k.d[l] = bisected(k, state, per_dt, l);
  }

  /// By bisection, where Newton's method has not converged: halvings until round-off.
  double bisected(const Block& k, const StateRows& state, double per_dt, int l) const {
    double low = 0.0, high = k.bound[l];
    for (int i = 0; i < 1100 && low < high; ++i) {
      const double d = 0.5 * (low + high);
      if (d == low || d == high) break;
      const FlowStress y = law().flow_stress({state[0][l] + d, d, d * per_dt, state[1][l]});
      (3.0 * G * d + y.value > k.q[l] ? high : low) = d;
    }
    return low;
  }

  [[gnu::always_inline]] void flow(Block& k, StateRows& state, double dt, int l) const {
    const double d = k.d[l], stress = k.q[l] - 3.0 * G * d;
    detail::set_tensor(k.stress, l, (stress / (k.q[l] + 1e-300)) * detail::tensor_at(k.stress, l));
    state[0][l] += d;
    state[2][l] = d / (dt + 1e-300);
    state[1][l] += taylor_quinney * stress * d / (k.density[l] * specific_heat);
  }

  static constexpr double tolerance = 1e-7;  // relative change of d in the last iteration; its square remains
  static constexpr int max_iterations = 80;  // by factors of e^2, from the bound down to 1e-60 of it
};

}  // namespace kerf
