// Random points for laws.
#include "conformance/law_block.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

namespace kerf {

namespace {

/// A value that a law may find in a variable of another law.
double likely_value(const std::string& variable, double u) {
  if (variable.find("temperature") != std::string::npos) return 300.0 + 900.0 * u;
  if (variable.find("rate") != std::string::npos) return 1e5 * u;
  return u;
}

/// The rows that the batches of materials, in both precisions, and of solids have in common.
template <class Batch, class Real>
void fill_stress_rows(Batch& m, LawBlock<Real>& b, double density) {
  m.reference_density = density;
  m.strain_increment = b.strain;
  m.density = b.rest[0];
  m.specific_energy = b.rest[1];
  m.pressure = b.rest[2];
  m.deviator = b.deviator;
  m.state = b.state[0];
  m.shear_modulus = b.outputs[0];
}

}  // namespace

LawPoints::LawPoints(const Law& law, double density)
    : law_(&law),
      material_(dynamic_cast<const Material*>(law_)),
      eos_(dynamic_cast<const Eos*>(law_)),
      solid_(dynamic_cast<const Solid*>(law_)),
      criterion_(dynamic_cast<const ErosionCriterion*>(law_)),
      density_(density) {
  if (n_state() > LawBlock<double>::most_state || law_->reads().size() > LawBlock<double>::most_reads)
    throw std::runtime_error(law_->type + " keeps or reads more variables than LawBlock has rows");
}

template <class Real>
LawBlock<Real> LawPoints::start(std::mt19937& random) const {
  std::uniform_real_distribution<double> u(0.0, 1.0);
  LawBlock<Real> b;
  std::vector<double> state;
  for (const StateVariable& v : law_->state_variables()) state.push_back(v.initial);
  state.push_back(0.0);  // never empty
  const std::vector<ReadVariable> reads = law_->reads();
  for (int l = 0; l < lane_width; ++l) {
    for (int d = 0; d < 3; ++d) b.place[d][l] = 0.01 * u(random);
    for (int d = 0; d < 9; ++d) b.rotation[d][l] = d % 4 == 0 ? 1.0 : 0.0;
    b.lengths[0][l] = b.lengths[1][l] = 1e-3 * (0.5 + u(random));
    std::vector<double> of_lane = state;
    law_->initialise({{b.place[0][l], b.place[1][l], b.place[2][l]}, b.lengths[1][l], density_}, of_lane.data());
    for (int v = 0; v < n_state(); ++v) b.state[v][l] = of_lane[static_cast<std::size_t>(v)];
    for (std::size_t r = 0; r < reads.size(); ++r) b.reads[r][l] = likely_value(reads[r].name, u(random));
  }
  shake(b, random);
  return b;
}

template <class Real>
void LawPoints::shake(LawBlock<Real>& b, std::mt19937& random) const {
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  const std::vector<ReadVariable> reads = law_->reads();
  for (int l = 0; l < lane_width; ++l) {
    // What accumulates must not fall.
    for (std::size_t r = 0; r < reads.size(); ++r)
      b.reads[r][l] += 0.05 * likely_value(reads[r].name, 0.5 * (1.0 + u(random)));
    const double amount = kerf::pow(10.0, -4.0 + 2.5 * u(random));  // 3e-7 to 0.03: elastic to far beyond yield
    for (int i = 0; i < 6; ++i) b.strain[i][l] = static_cast<Real>(amount * u(random));
    b.rest[0][l] = static_cast<Real>(density_ * (1.0 + 0.05 * u(random)));
    b.rest[1][l] = static_cast<Real>(1e5 * (1.0 + u(random)));
    if (solid_ == nullptr) b.rest[2][l] = static_cast<Real>(1e9 * u(random));
    if (criterion_ != nullptr)
      for (int i = 0; i < 6; ++i) b.deviator[i][l] = static_cast<Real>(1e9 * u(random));
  }
}

template <class Real>
void LawPoints::fill(LawRows& rows, LawBlock<Real>& b,
                     std::array<const double*, LawBlock<Real>::most_reads>& reads) const {
  for (int r = 0; r < LawBlock<Real>::most_reads; ++r) reads[static_cast<std::size_t>(r)] = b.reads[r];
  rows.dt = 1e-7;
  rows.time = 2e-6;
  rows.length = b.lengths[0];
  rows.initial_length = b.lengths[1];
  rows.reference_position = b.place;
  rows.rotation = b.rotation;
  rows.reads = reads.data();
}

template <>
void LawPoints::apply(LawBlock<float>& b) const {
  SingleMaterialBatch m;
  std::array<const double*, LawBlock<float>::most_reads> reads;
  fill(m, b, reads);
  fill_stress_rows(m, b, density_);
  material_->update_single(m);
}

template <>
void LawPoints::apply(LawBlock<double>& b) const {
  std::array<const double*, LawBlock<double>::most_reads> reads;
  if (material_ != nullptr) {
    MaterialBatch m;
    fill(m, b, reads);
    fill_stress_rows(m, b, density_);
    material_->update(m);
  } else if (solid_ != nullptr) {
    SolidBatch m;
    fill(m, b, reads);
    fill_stress_rows(m, b, density_);
    m.bulk_modulus = b.outputs[1];
    solid_->update(m);
  } else if (eos_ != nullptr) {
    EosBatch e;
    fill(e, b, reads);
    e.state = b.state[0];
    e.reference_density = density_;
    e.density = b.rest[0];
    e.specific_energy = b.rest[1];
    e.new_state = b.state[0];
    e.pressure = b.outputs[0];
    e.bulk_modulus = b.outputs[1];
    eos_->evaluate(e);
  } else {
    ErosionBatch e;
    fill(e, b, reads);
    e.state = b.state[0];
    alignas(64) double ratio[lane_width], volume[lane_width], time_step[lane_width];
    for (int l = 0; l < lane_width; ++l) {
      ratio[l] = b.rest[0][l] / density_;
      volume[l] = 1.0 / ratio[l];
      time_step[l] = 1e-7;
    }
    e.stress = b.deviator;
    e.strain_increment = b.strain;
    e.pressure = b.rest[2];
    e.density_ratio = ratio;
    e.volume_ratio = volume;
    e.time_step = time_step;
    e.value = b.outputs[0];
    e.failed = b.outputs[1];
    e.strength = b.outputs[2];
    e.tension = b.outputs[3];
    e.compression = b.outputs[4];
    criterion_->judge(e);
  }
}

template LawBlock<double> LawPoints::start(std::mt19937&) const;
template LawBlock<float> LawPoints::start(std::mt19937&) const;
template void LawPoints::shake(LawBlock<double>&, std::mt19937&) const;
template void LawPoints::shake(LawBlock<float>&, std::mt19937&) const;

}  // namespace kerf
