// Drives laws at single points: a block whose lanes all see the same, so that a test reads like the law.
#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "kerf/eos.hpp"
#include "kerf/erosion.hpp"
#include "kerf/material.hpp"
#include "kerf/solid_laws.hpp"
#include "model/aligned.hpp"
#include "support/make_law.hpp"

namespace kerf::test {

/// One material point with its deviator and state; a copy is a second point of the same law.
class MaterialPoint {
 public:
  explicit MaterialPoint(std::shared_ptr<const Material> law, double density = 7800.0)
      : law_(std::move(law)), density_(density), variables_(law_->state_variables()) {
    std::vector<double> one;
    for (const StateVariable& v : variables_) one.push_back(v.initial);
    law_->initialise({{}, 1.0, density}, one.data());
    for (const double value : one) state_.insert(state_.end(), lane_width, value);
    state_.resize(state_.size() + lane_width);  // never empty
  }

  /// Adds a strain increment in a step of `dt` and returns the deviator.
  SymTensor step(SymTensor increment, double dt = 1e-7) {
    double strain[6][lane_width], stress[6][lane_width], density[lane_width], zero[lane_width] = {};
    for (int l = 0; l < lane_width; ++l) {
      detail::set_tensor(strain, l, increment);
      detail::set_tensor(stress, l, deviator_);
      density[l] = density_;
    }
    MaterialBatch b;
    b.dt = dt;
    b.reference_density = density_;
    b.strain_increment = strain;
    b.density = density;
    b.specific_energy = b.pressure = zero;
    b.deviator = stress;
    b.state = state_.data();
    b.shear_modulus = shear_modulus_;
    law_->update(b);
    return deviator_ = detail::tensor_at(stress, lane_width - 1);
  }
  SymTensor deviator() const { return deviator_; }
  void set_deviator(SymTensor s) { deviator_ = s; }
  double shear_modulus() const { return shear_modulus_[0]; }
  double state(const std::string& name) const { return state_.at(row(name) * lane_width); }
  void set_state(const std::string& name, double value) {
    for (int l = 0; l < lane_width; ++l) state_.at(row(name) * lane_width + l) = value;
  }

 private:
  std::size_t row(const std::string& name) const {
    for (std::size_t i = 0; i < variables_.size(); ++i)
      if (variables_[i].name == name) return i;
    throw std::runtime_error("no state variable " + name);
  }

  std::shared_ptr<const Material> law_;
  double density_;
  std::vector<StateVariable> variables_;
  std::vector<double> state_;
  SymTensor deviator_;
  double shear_modulus_[lane_width] = {};
};

inline EosOutput evaluate(const Eos& eos, double reference_density, double density, double energy = 0.0) {
  double rho[lane_width], e[lane_width], p[lane_width], k[lane_width], state[lane_width] = {};
  for (int l = 0; l < lane_width; ++l) rho[l] = density, e[l] = energy;
  EosBatch b;
  b.reference_density = reference_density;
  b.density = rho;
  b.specific_energy = e;
  b.state = state;
  b.pressure = p;
  b.bulk_modulus = k;
  eos.evaluate(b);
  return {p[0], k[0]};
}

/// One point judged by one criterion, with its state.
class ErosionPoint {
 public:
  explicit ErosionPoint(std::unique_ptr<ErosionCriterion> law, double initial_length = 1e-3)
      : initial_length_(initial_length), law_(std::move(law)) {
    for (const StateVariable& v : law_->state_variables()) state_.insert(state_.end(), lane_width, v.initial);
    state_.resize(state_.size() + lane_width);
  }

  /// `read` is the value of the one variable that the criterion reads, if any.
  Verdict judge(const ErosionInputPoint& in, double read = 0.0) { return judge(in, std::vector<double>{read}); }
  Verdict judge(const ErosionInputPoint& in, const std::vector<double>& read) {
    alignas(64) double stress[6][lane_width], strain[6][lane_width], rotation[9][lane_width], rest[4][lane_width];
    double strength[lane_width], tension[lane_width], compression[lane_width], length[lane_width];
    for (double* factor : {strength, tension, compression}) std::fill_n(factor, lane_width, 1.0);
    std::fill_n(length, lane_width, initial_length_);
    std::vector<double> read_rows;
    for (const double value : read) read_rows.insert(read_rows.end(), lane_width, value);
    std::vector<const double*> reads;
    for (std::size_t r = 0; r < read.size(); ++r) reads.push_back(read_rows.data() + r * lane_width);
    double value[lane_width], failed[lane_width];
    const Rotation& r = in.rotation;
    const double turn[9] = {r.xx, r.xy, r.xz, r.yx, r.yy, r.yz, r.zx, r.zy, r.zz};
    const double scalars[4] = {in.pressure, in.density_ratio, in.volume_ratio, in.time_step};
    for (int l = 0; l < lane_width; ++l) {
      detail::set_tensor(stress, l, in.stress);
      detail::set_tensor(strain, l, in.strain_increment);
      for (int k = 0; k < 9; ++k) rotation[k][l] = turn[k];
      for (int k = 0; k < 4; ++k) rest[k][l] = scalars[k];
    }
    ErosionBatch b;
    b.dt = in.dt;
    b.time = in.time;
    b.strength = strength;
    b.tension = tension;
    b.compression = compression;
    b.initial_length = length;
    b.stress = stress;
    b.strain_increment = strain;
    b.rotation = rotation;
    b.pressure = rest[0];
    b.density_ratio = rest[1];
    b.volume_ratio = rest[2];
    b.time_step = rest[3];
    b.reads = reads.data();
    b.state = state_.data();
    b.value = value;
    b.failed = failed;
    std::vector<int> tensors;  // which the element rotates before it calls the law
    for (const StateVariable& v : law_->state_variables())
      if (v.begins_tensor) tensors.push_back(v.index);
    detail::rotate_tensors(tensors, rotation, state_.data());
    law_->judge(b);
    return {value[0], failed[0], strength[0], tension[0], compression[0]};
  }
  /// A state variable by name.
  double state(const std::string& name) const {
    for (const StateVariable& v : law_->state_variables())
      if (v.name == name) return state_[static_cast<std::size_t>(v.index) * lane_width];
    throw std::runtime_error("no state variable " + name);
  }

 private:
  double initial_length_;  // [m]
  std::unique_ptr<ErosionCriterion> law_;
  AlignedVector<double> state_;
};

}  // namespace kerf::test
