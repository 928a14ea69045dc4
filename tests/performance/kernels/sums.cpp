// Benchmark of the sums that do not depend on the order of their terms.
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "core/fixed_sum.hpp"
#include "parallel/scene.hpp"

namespace {

void order_free_sums(benchmark::State& state) {
  std::vector<double> terms;
  for (std::int64_t i = 0; i < state.range(0); ++i) {
    const auto item = static_cast<std::uint64_t>(2 * i);
    terms.push_back((kerf::test::scatter(1, item) - 0.5) * std::exp2(-40.0 * kerf::test::scatter(1, item + 1)));
  }
  for (auto _ : state) benchmark::DoNotOptimize(kerf::order_free_sums(MPI_COMM_WORLD, {terms}));
  state.SetItemsProcessed(state.iterations() * state.range(0));
  state.SetBytesProcessed(state.iterations() * state.range(0) * 16);  // one reading for the bound, one for the sum
}
BENCHMARK(order_free_sums)->ArgName("terms")->Arg(4096)->Arg(1 << 20)->Unit(benchmark::kMicrosecond);

}  // namespace
