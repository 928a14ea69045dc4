// Laws that hand everything on to another law and remember the moduli that it returned for the first lane.
#pragma once

#include <memory>
#include <utility>

#include "conformance/samples.hpp"

namespace kerf {

struct ModuliSeen {
  double shear = 0.0, bulk = 0.0;  // [Pa]
};

template <class Base>
class WatchedLaw : public Base {
 public:
  WatchedLaw(std::unique_ptr<Base> inner, ModuliSeen& seen) : inner_(std::move(inner)), seen_(seen) {
    this->description = inner_->description;
    this->type = inner_->type;
  }
  std::vector<ReadVariable> reads() const override { return inner_->reads(); }
  unsigned asked_inputs() const override { return inner_->asked_inputs(); }
  double cost() const override { return inner_->cost(); }
  void initialise(const InitialPoint& point, double* state) const override { inner_->initialise(point, state); }

 protected:
  std::unique_ptr<Base> inner_;
  ModuliSeen& seen_;
};

class WatchedMaterial final : public WatchedLaw<Material> {
 public:
  using WatchedLaw::WatchedLaw;
  void update(const MaterialBatch& b) const override {
    inner_->update(b);
    seen_.shear = b.shear_modulus[0];
  }
  double viscosity() const override { return inner_->viscosity(); }
};

class WatchedEos final : public WatchedLaw<Eos> {
 public:
  using WatchedLaw::WatchedLaw;
  void evaluate(const EosBatch& b) const override {
    inner_->evaluate(b);
    seen_.bulk = b.bulk_modulus[0];
  }
  bool uses_energy() const override { return inner_->uses_energy(); }
  double initial_energy_density() const override { return inner_->initial_energy_density(); }
};

class WatchedSolid final : public WatchedLaw<Solid> {
 public:
  using WatchedLaw::WatchedLaw;
  void update(const SolidBatch& b) const override {
    inner_->update(b);
    seen_.shear = b.shear_modulus[0];
    seen_.bulk = b.bulk_modulus[0];
  }
  double initial_energy_density() const override { return inner_->initial_energy_density(); }
};

/// From now on the laws of the material tell their moduli. SampleLaws::law remains the law itself.
inline void watch(SampleLaws& laws, ModuliSeen& seen) {
  MaterialInput& m = laws.material;
  if (m.strength) m.strength = std::make_unique<WatchedMaterial>(std::move(m.strength), seen);
  if (m.eos) m.eos = std::make_unique<WatchedEos>(std::move(m.eos), seen);
  if (m.solid) m.solid = std::make_unique<WatchedSolid>(std::move(m.solid), seen);
}

}  // namespace kerf
