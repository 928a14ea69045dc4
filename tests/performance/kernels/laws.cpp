// What one point of every registered law costs, with its sample of tests/data/sample_laws.yaml: laws/material/elastic
// and so on. Items are points. For the table of doc/developers/performance.md:
//   kerf_kernels --benchmark_filter=laws --benchmark_format=json | tests/performance/law_table.py
#include <benchmark/benchmark.h>

#include <random>
#include <string>
#include <vector>

#include "support/make_law.hpp"
#include "support/sample_laws.hpp"

namespace {

using namespace kerf;

/// Steps of one law over blocks of 8 points that stay in the caches. Every step begins with the same points, so that
/// nothing runs away; putting back what the law has changed takes about 1 ns a point and is part of the time.
template <class Real>
void law(benchmark::State& state, const std::string& kind, const std::string& name) {
  const test::SampleLaw sample(kind, name);
  std::mt19937 random(5);
  constexpr int n_blocks = 16;
  std::vector<test::LawBlock<Real>> start, now;
  for (int b = 0; b < n_blocks; ++b) start.push_back(sample.random_block<Real>(random));
  now = start;
  for (auto _ : state) {
    // The deviator and the state are what laws change of their input.
    for (int b = 0; b < n_blocks; ++b) {
      auto& block = now[static_cast<std::size_t>(b)];
      const auto& from = start[static_cast<std::size_t>(b)];
      for (int r = 0; r < 6; ++r)
        for (int l = 0; l < lane_width; ++l) block.deviator[r][l] = from.deviator[r][l];
      for (int l = 0; l < lane_width; ++l) block.rest[2][l] = from.rest[2][l];
      for (int r = 0; r < sample.n_state(); ++r)
        for (int l = 0; l < lane_width; ++l) block.state[r][l] = from.state[r][l];
      sample.apply(block);
    }
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * n_blocks * lane_width);
}

/// Every law that is registered when the program starts.
const bool registered = [] {
  for (const char* kind : test::law_kinds)
    for (const std::string& name : test::builtin_plugins().names(kind)) {
      const std::string title = std::string("laws/") + kind + "/" + name;
      benchmark::RegisterBenchmark(title.c_str(), [=](benchmark::State& state) { law<double>(state, kind, name); });
      if (std::string(kind) == "material")
        benchmark::RegisterBenchmark((title + "/single").c_str(),
                                     [=](benchmark::State& state) { law<float>(state, kind, name); });
    }
  return true;
}();

}  // namespace
