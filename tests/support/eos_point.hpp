// A point of an equation of state that is carried from step to step, without an element.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "kerf/eos.hpp"
#include "support/make_law.hpp"

namespace kerf::test {

class EosPoint {
 public:
  EosPoint(const std::string& name, const std::string& parameters, double reference_density, Vec3 place = {})
      : law_(make_law<Eos>("eos", name, parameters)), reference_density_(reference_density) {
    for (const StateVariable& v : law_->state_variables()) state_.push_back(v.initial);
    law_->initialise({place, 1e-3, reference_density}, state_.data());
  }
  /// Evaluates the law; with `is_last`, the state follows.
  EosOutput evaluate(double density, double energy, bool is_last, double time = 0.0, double length = 1e-3) {
    double rho[lane_width], e[lane_width], h[lane_width], p[lane_width], k[lane_width];
    std::vector<double> rows, left;
    for (const double value : state_) rows.insert(rows.end(), lane_width, value);
    left = rows;
    for (int l = 0; l < lane_width; ++l) rho[l] = density, e[l] = energy, h[l] = length;
    EosBatch b;
    b.reference_density = reference_density_;
    b.density = rho;
    b.specific_energy = e;
    b.time = time;
    b.dt = dt_;
    b.length = h;
    b.state = rows.data();
    if (is_last) b.new_state = left.data();
    b.pressure = p;
    b.bulk_modulus = k;
    law_->evaluate(b);
    for (std::size_t v = 0; v < state_.size(); ++v) state_[v] = left[v * lane_width];
    return {p[0], k[0]};
  }
  void set_step(double dt) { dt_ = dt; }
  const Eos& law() const { return *law_; }
  double state(std::size_t v) const { return state_[v]; }
  void set_state(std::size_t v, double value) { state_[v] = value; }

 private:
  std::unique_ptr<Eos> law_;
  double reference_density_, dt_ = 0.0;  // the latter [s]
  std::vector<double> state_;
};

}  // namespace kerf::test
