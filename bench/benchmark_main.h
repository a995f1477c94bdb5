#pragma once

#include <benchmark/benchmark.h>

namespace kerf {

/// What main() of a program of benchmarks returns: `add_all` registers them once the arguments are understood.
inline int run_benchmarks(int argc, char** argv, void (*add_all)()) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  add_all();
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}

}  // namespace kerf
