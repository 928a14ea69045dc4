// Benchmarks of the machine itself, on one core: the roofs over the other kernels.
#include <benchmark/benchmark.h>

#include <cstdint>
#include <vector>

#include "kerf/lanes.hpp"

namespace {

#if defined(__AVX512F__)
constexpr int register_bytes = 64;
#elif defined(__AVX__)
constexpr int register_bytes = 32;
#else
constexpr int register_bytes = 16;
#endif
typedef double Register __attribute__((vector_size(register_bytes)));

/// a = b + s c, in arrays of 64 MB. Bytes per second count three streams; where stores do not go past the caches, a is
/// read as well before it is written: `with_allocate` counts four.
void triad(benchmark::State& state) {
  constexpr std::size_t n = std::size_t{64} * 1024 * 1024 / sizeof(double);
  std::vector<double> a(n, 0.0), b(n, 1.0), c(n, 2.0);
  double s = 3.0;
  benchmark::DoNotOptimize(s);
  for (auto _ : state) {
    for (std::size_t i = 0; i < n; ++i) a[i] = b[i] + s * c[i];
    benchmark::DoNotOptimize(a.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(n));
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(3 * n * sizeof(double)));
  state.counters["with_allocate"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * 4.0 * n * sizeof(double),
                         benchmark::Counter::kIsRate, benchmark::Counter::kIs1024);
}
BENCHMARK(triad)->Unit(benchmark::kMillisecond);

/// Does the same to several registers over and over, enough of them to hide how long it takes for one. Items are
/// operations on one double, `n_operations` per turn.
template <class Vector, int n_chains, class Turn>
void turn_chains(benchmark::State& state, int n_operations, const Turn& turn) {
  constexpr int n_turns = 1000;
  Vector chain[n_chains];
  for (int k = 0; k < n_chains; ++k) chain[k] = Vector{} + (1.0 + 0.01 * k);
  for (auto _ : state) {
    for (int t = 0; t < n_turns; ++t)
#pragma GCC unroll 16
      for (int k = 0; k < n_chains; ++k) turn(chain[k]);
    Vector sum{};
    for (const Vector& v : chain) sum += v;
    benchmark::DoNotOptimize(sum);
  }
  constexpr auto n_lanes = static_cast<std::int64_t>(sizeof(Vector) / sizeof(double));
  state.SetItemsProcessed(state.iterations() * n_turns * n_chains * n_lanes * n_operations);
}

/// Floating-point operations per second, two per multiplication with addition.
void multiply_add(benchmark::State& state) {
  Register factor = Register{} + 0.999, term = Register{} + 1e-3;
  benchmark::DoNotOptimize(factor);
  benchmark::DoNotOptimize(term);
  const Register f = factor, t = term;
  turn_chains<Register, 12>(state, 2, [&](Register& v) { v = v * f + t; });
}
BENCHMARK(multiply_add);

/// Divisions per second, in the vectors of the element kernels.
void divide(benchmark::State& state) {
  double numerator = 1.7;
  benchmark::DoNotOptimize(numerator);
  const kerf::Lanes n = kerf::lanes(numerator);
  turn_chains<kerf::Lanes, 6>(state, 1, [&](kerf::Lanes& v) { v = n / v; });
}
BENCHMARK(divide);

/// Square roots per second, in the vectors of the element kernels; the addition hides behind them.
void square_root(benchmark::State& state) {
  double term = 0.7;
  benchmark::DoNotOptimize(term);
  const kerf::Lanes t = kerf::lanes(term);
  turn_chains<kerf::Lanes, 6>(state, 1, [&](kerf::Lanes& v) { v = kerf::sqrt_of(v + t); });
}
BENCHMARK(square_root);

}  // namespace
