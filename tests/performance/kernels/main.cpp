// Runs the benchmarks of single kernels on one process: what each phase of a step costs on its own, beside what the
// machine can do. Options are those of Google Benchmark, --benchmark_filter=internal_forces for example. It prints
// bytes per second in powers of 1024, everything else in powers of 1000.
#include <benchmark/benchmark.h>

#include "parallel/runtime.hpp"

int main(int argc, char** argv) {
  const kerf::ParallelRuntime runtime(argc, argv);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
