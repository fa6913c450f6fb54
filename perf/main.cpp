// welkin_perf: throughput of the kernels beside the machine's own limits.
//   welkin_perf [Google Benchmark options]
//   welkin_perf --target-sizes LATLONG...    the table of error and time in docs/projection.md
#include <benchmark/benchmark.h>

#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "project_cubemap.h"
#include "project_lat_long.h"
#include "ratio_reporter.h"
#include "read_bandwidth.h"
#include "tables.h"
#include "target_sizes.h"
#include "welkin/control.h"
#include "welkin/error.h"
#include "welkin/instruction_set.h"
#include "welkin/version.h"

int main(int argc, char** argv) {
  using namespace welkin;
  if (argc > 2 && std::string(argv[1]) == "--target-sizes") {
    try {
      std::string table;
      run_with_threads(1, [&] { table = perf::target_size_table({argv + 2, argv + argc}); });
      std::cout << table;
      return 0;
    } catch (const Error& error) {
      std::cerr << "welkin_perf: " << error.what() << '\n';
      return 1;
    }
  }
  benchmark::AddCustomContext("welkin", WELKIN_VERSION_STRING);
  benchmark::AddCustomContext("instruction_set", name(active_instruction_set()));
  const std::vector<int> sizes{32, 64, 128, 256, 512, 1024, 2048};
  const std::vector<int> thread_counts{1, 2};
  perf::add_read_bandwidth(sizes, thread_counts);
  perf::add_project_cubemap(sizes, thread_counts);
  perf::add_project_lat_long(thread_counts);
  perf::add_tables();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  perf::RatioReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  benchmark::Shutdown();
  return 0;
}
