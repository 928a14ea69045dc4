// Blocks of random points that go through any law in the way its kind is called by elements.
#pragma once

#include <array>
#include <cmath>
#include <random>

#include "kerf/eos.hpp"
#include "kerf/erosion.hpp"
#include "kerf/material.hpp"
#include "kerf/solid.hpp"

namespace kerf {

/// Everything that a law reads and writes of one block, of an element that computes with numbers of type `Real`.
template <class Real>
struct LawBlock {
  static constexpr int most_state = 40, most_reads = 8;
  using Row = Real[lane_width];
  using DoubleRow = double[lane_width];
  // Strain increment, deviator; density, energy, pressure; what the law makes of them: two moduli, or pressure and
  // modulus, or value and failure.
  alignas(64) Real strain[6][lane_width] = {}, deviator[6][lane_width] = {}, rest[3][lane_width] = {},
                   outputs[5][lane_width] = {};
  alignas(64) double state[most_state][lane_width] = {}, reads[most_reads][lane_width] = {};
  alignas(64) double lengths[2][lane_width] = {}, place[3][lane_width] = {}, rotation[9][lane_width] = {};

  /// Calls `take` with each row of this block and the same row of another, and with a name of the group.
  template <class Other, class Take>
  void each_row(Other& other, const Take& take) {
    for (int r = 0; r < 6; ++r) take(strain[r], other.strain[r], "strain");
    for (int r = 0; r < 6; ++r) take(deviator[r], other.deviator[r], "deviator");
    for (int r = 0; r < 3; ++r) take(rest[r], other.rest[r], "density, energy, pressure");
    for (int r = 0; r < 5; ++r) take(outputs[r], other.outputs[r], "outputs");
    for (int r = 0; r < most_state; ++r) take(state[r], other.state[r], "state");
    for (int r = 0; r < most_reads; ++r) take(reads[r], other.reads[r], "reads");
    for (int r = 0; r < 2; ++r) take(lengths[r], other.lengths[r], "lengths");
    for (int r = 0; r < 3; ++r) take(place[r], other.place[r], "place");
    for (int r = 0; r < 9; ++r) take(rotation[r], other.rotation[r], "rotation");
  }
  /// The point of one lane of another block takes a lane of this one.
  void take(int lane, LawBlock& from, int its_lane) {
    each_row(from, [&](auto& mine, auto& theirs, const char*) { mine[lane] = theirs[its_lane]; });
  }
};

/// Random points for a law.
class LawPoints {
 public:
  /// `density` is that of the undeformed material [kg/m3]. Throws std::runtime_error where the law keeps or reads more
  /// than a block has rows for. The law must outlive this.
  LawPoints(const Law& law, double density);

  const Law& law() const { return *law_; }
  int n_state() const { return static_cast<int>(law_->state_variables().size()); }
  double density() const { return density_; }  // [kg/m3] of the undeformed material
  /// Whether elements of single precision call it with rows of theirs.
  bool has_single() const { return material_ != nullptr; }

  /// Points in motion, compressed and expanded, cold and warm, with different rates; with the state that the law begins
  /// with, and a few steps of the law behind them, so that some have yielded.
  template <class Real>
  LawBlock<Real> random_block(std::mt19937& random) const {
    LawBlock<Real> block = start<Real>(random);
    for (int step = 0; step < 3; ++step) {
      apply(block);
      shake(block, random);
    }
    return block;
  }
  /// One step.
  template <class Real>
  void apply(LawBlock<Real>& block) const;

 private:
  template <class Real>
  LawBlock<Real> start(std::mt19937& random) const;
  /// New strain increments, densities and energies; for criteria new stresses, too.
  template <class Real>
  void shake(LawBlock<Real>& block, std::mt19937& random) const;
  template <class Real>
  void fill(LawRows& rows, LawBlock<Real>& block, std::array<const double*, LawBlock<Real>::most_reads>& reads) const;

  const Law* law_;
  const Material* material_ = nullptr;
  const Eos* eos_ = nullptr;
  const Solid* solid_ = nullptr;
  const ErosionCriterion* criterion_ = nullptr;
  double density_;
};

}  // namespace kerf
