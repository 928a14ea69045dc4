// Blocks of random points: no lane may differ from another, and single precision from double, by more than it must.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "conformance/checks.hpp"
#include "conformance/law_block.hpp"

namespace kerf {

namespace {

constexpr int n_rounds = 30;

/// The first row in which two lanes differ, and by what; empty where none does. NaN is NaN.
template <class Real>
std::string difference_of(LawBlock<Real>& a, int lane, LawBlock<Real>& b, int its_lane) {
  std::string found;
  a.each_row(b, [&](auto& mine, auto& theirs, const char* row) {
    const double x = mine[lane], y = theirs[its_lane];
    if (!(x == y || (x != x && y != y)) && found.empty())
      found = fmt::format("{}: {:.17g} in lane {}, {:.17g} in lane {}", row, x, lane, y, its_lane);
  });
  return found;
}

/// What a law makes of points in other lanes and in other company; empty where nothing differs.
template <class Real>
std::string lane_difference(const LawPoints& law, std::mt19937& random) {
  for (int round = 0; round < n_rounds; ++round) {
    LawBlock<Real> start = law.random_block<Real>(random), together = start;
    law.apply(together);
    for (int shift = 1; shift < lane_width; ++shift) {
      LawBlock<Real> shifted;
      for (int l = 0; l < lane_width; ++l) shifted.take((l + shift) % lane_width, start, l);
      law.apply(shifted);
      for (int l = 0; l < lane_width; ++l)
        if (auto d = difference_of(together, l, shifted, (l + shift) % lane_width); !d.empty()) return d;
    }
    for (int l = 0; l < lane_width; ++l) {
      LawBlock<Real> alike;
      for (int k = 0; k < lane_width; ++k) alike.take(k, start, l);
      law.apply(alike);
      for (int k = 0; k < lane_width; ++k)
        if (auto d = difference_of(together, l, alike, k); !d.empty()) return d;
    }
  }
  return "";
}

void check_lanes(const LawPoints& law, Verdicts& out) {
  std::mt19937 random(7);
  std::string found = lane_difference<double>(law, random);
  if (found.empty() && law.has_single()) {
    found = lane_difference<float>(law, random);
    if (!found.empty()) found += ", in single precision";
  }
  if (found.empty())
    out.pass("lanes", fmt::format("{} points give the same bits in every lane, in any company and order",
                                  n_rounds * lane_width));
  else
    out.fail("lanes", fmt::format("what a point becomes depends on its lane or on its neighbours ({}); compute each "
                                  "lane from its own rows alone, and keep nothing from one call to the next",
                                  found));
}

void check_finite(const LawPoints& law, Verdicts& out) {
  std::mt19937 random(11);
  bool changed = false;
  std::string bad;
  for (int round = 0; round < n_rounds; ++round) {
    LawBlock<double> before = law.random_block<double>(random);
    for (auto& row : before.outputs) std::fill(std::begin(row), std::end(row), 0.0);
    LawBlock<double> after = before;
    law.apply(after);
    after.each_row(before, [&](auto& now, auto& then, const char* row) {
      for (int l = 0; l < lane_width; ++l) {
        if (!std::isfinite(now[l]) && bad.empty()) bad = fmt::format("{} {}", row, now[l]);
        changed = changed || now[l] != then[l];
      }
    });
  }
  if (!bad.empty())
    out.fail("finite", fmt::format("a point that is compressed or expanded by up to 5 % gives {}; guard divisions, "
                                   "roots and logarithms",
                                   bad));
  else if (!changed)
    out.note("finite", "all numbers are finite, but the law changes nothing with this sample");
  else
    out.pass("finite", fmt::format("{} random points give finite numbers", n_rounds * lane_width));
}

}  // namespace

void check_blocks(const Registry& registry, const TypeSample& sample, Verdicts& out) {
  const SampleLaws laws(registry, sample);
  const LawPoints points(*laws.law, laws.material.density);
  if (out.wants("lanes")) check_lanes(points, out);
  if (out.wants("finite")) check_finite(points, out);
}

}  // namespace kerf
