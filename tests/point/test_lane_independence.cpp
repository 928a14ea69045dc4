// For every registered law, with its sample of tests/data/sample_laws.yaml: what it makes of a point must not depend on
// the lane that the point stands in, nor on who stands in the others: which elements share a block is a matter of the
// partition. Compilers break that where they peel lanes off a loop. And: a model of single precision gets the same.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "support/make_law.hpp"
#include "support/sample_laws.hpp"

namespace {

using namespace kerf;
using kerf::test::builtin_plugins;
using kerf::test::LawBlock;
using kerf::test::SampleLaw;

using KindAndName = std::pair<std::string, std::string>;

std::vector<KindAndName> all_laws() {
  std::vector<KindAndName> all;
  for (const char* kind : kerf::test::law_kinds)
    for (const std::string& name : builtin_plugins().names(kind)) all.emplace_back(kind, name);
  return all;
}

std::string test_name(const testing::TestParamInfo<KindAndName>& info) {
  return info.param.first + "_" + info.param.second;
}

class EveryLaw : public testing::TestWithParam<KindAndName> {};

INSTANTIATE_TEST_SUITE_P(registered, EveryLaw, testing::ValuesIn(all_laws()), test_name);

template <class Real>
void expect_same(LawBlock<Real>& a, int lane, LawBlock<Real>& b, int its_lane, const std::string& what) {
  a.each_row(b, [&](auto& mine, auto& theirs, const char* row) {
    // The bits, so that NaN is NaN.
    EXPECT_TRUE(mine[lane] == theirs[its_lane] || (mine[lane] != mine[lane] && theirs[its_lane] != theirs[its_lane]))
        << what << ", " << row << ": " << mine[lane] << " and " << theirs[its_lane];
  });
}

/// Runs blocks through a law, and the same points in other lanes and in other company.
template <class Real>
void expect_lanes_alike(const SampleLaw& sample, const std::string& name) {
  std::mt19937 random(7);
  for (int round = 0; round < 100; ++round) {
    LawBlock<Real> start = sample.random_block<Real>(random), together = start;
    sample.apply(together);
    for (int shift = 1; shift < lane_width; ++shift) {
      LawBlock<Real> shifted;
      for (int l = 0; l < lane_width; ++l) shifted.take((l + shift) % lane_width, start, l);
      sample.apply(shifted);
      for (int l = 0; l < lane_width; ++l) expect_same(together, l, shifted, (l + shift) % lane_width, name);
    }
    for (int l = 0; l < lane_width; ++l) {
      LawBlock<Real> alike;
      for (int k = 0; k < lane_width; ++k) alike.take(k, start, l);
      sample.apply(alike);
      for (int k = 0; k < lane_width; ++k) expect_same(together, l, alike, k, name);
    }
    if (testing::Test::HasFailure()) return;
  }
}

TEST_P(EveryLaw, treats_all_lanes_alike) {
  const auto& [kind, name] = GetParam();
  const SampleLaw sample(kind, name);
  expect_lanes_alike<double>(sample, name);
  if (sample.has_single()) expect_lanes_alike<float>(sample, name + ", single");
}

TEST_P(EveryLaw, gives_finite_numbers_and_does_something) {
  const auto& [kind, name] = GetParam();
  const SampleLaw sample(kind, name);
  std::mt19937 random(11);
  bool changed = false;
  for (int round = 0; round < 100; ++round) {
    LawBlock<double> before = sample.random_block<double>(random);
    for (auto& row : before.outputs) std::fill(std::begin(row), std::end(row), 0.0);
    LawBlock<double> after = before;
    sample.apply(after);
    after.each_row(before, [&](auto& now, auto& then, const char* row) {
      for (int l = 0; l < lane_width; ++l) {
        EXPECT_TRUE(std::isfinite(now[l])) << name << ", " << row;
        changed = changed || now[l] != then[l];
      }
    });
  }
  EXPECT_TRUE(changed || name == "hydrodynamic") << "the sample shows nothing of the law";
}

/// The same points for both precisions: doubles that are floats exactly.
LawBlock<double> widened(LawBlock<float>& single) {
  LawBlock<double> exact;
  exact.each_row(single, [](auto& wide, auto& narrow, const char*) {
    for (int l = 0; l < lane_width; ++l) wide[l] = narrow[l];
  });
  return exact;
}

/// How far a state variable may be off, given the trial stress, of which a few units are lost [Pa].
double scale_of(const StateVariable& variable, bool is_first, double before, double after, double trial, double G) {
  if (variable.unit == "Pa") return trial;
  // A plastic increment is known to that over the modulus; of what it heats and of its rate, the same share.
  if (is_first && G > 0.0) return trial / G;
  return std::fabs(after) + std::fabs(after - before);
}

TEST_P(EveryLaw, gives_the_same_in_single_precision_to_round_off) {
  const auto& [kind, name] = GetParam();
  const SampleLaw sample(kind, name);
  if (!sample.has_single()) GTEST_SKIP() << "elements of single precision call it with doubles";
  std::mt19937 random(3);
  for (int round = 0; round < 200; ++round) {
    LawBlock<float> single = sample.random_block<float>(random);
    LawBlock<double> exact = widened(single);
    const LawBlock<double> before = exact;
    sample.apply(exact);
    sample.apply(single);
    for (int l = 0; l < lane_width; ++l) {
      const double G = exact.outputs[0][l];
      // The stress before, 2 G times a strain increment, and the stress after, of which a few units are lost.
      double trial = 0.0;
      for (int i = 0; i < 6; ++i)
        trial = std::max({trial, std::fabs(before.deviator[i][l]), 2.0 * G * std::fabs(before.strain[i][l]),
                          std::fabs(exact.deviator[i][l])});
      for (int i = 0; i < 6; ++i)
        EXPECT_NEAR(single.deviator[i][l], exact.deviator[i][l], 20.0 * 0x1p-24 * trial) << name;
      for (int v = 0; v < sample.n_state(); ++v) {
        const StateVariable& variable = sample.law().state_variables()[static_cast<std::size_t>(v)];
        const double scale = scale_of(variable, v == 0, before.state[v][l], exact.state[v][l], trial, G);
        EXPECT_NEAR(single.state[v][l], exact.state[v][l], 20.0 * 0x1p-24 * scale) << name << ", " << variable.name;
      }
      EXPECT_NEAR(single.outputs[0][l], G, 0x1p-23 * G) << name;
    }
    if (HasFailure()) return;
  }
}

}  // namespace
