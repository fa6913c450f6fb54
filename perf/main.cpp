// welkin_perf: throughput of the kernels beside the machine's own limits.
//   welkin_perf [Google Benchmark options]
//   welkin_perf --target-sizes LATLONG...            the table of error and time in docs/maths/projection.md
//   welkin_perf --irradiance-errors ENVIRONMENT...   the tables of docs/maths/irradiance.md
//   welkin_perf --block-errors [--size=N] ENVIRONMENT...   the table of docs/notes/textures.md
//   welkin_perf --prefilter-errors [--synthetic] [--texels=N] [--size=N] [--methods=A,B]
//     [--roughness=A,B] [--width=N] [--cubemap=N] LATLONG... docs/maths/reflections.md
//   welkin_perf --sky-errors [--radiance] [--orders] [--methods] [--directions=N] [--paths=N] [--altitude=M]  docs
//   welkin_perf --estimates [COUNT] [--seed=N] [--rms-error=X] [PICTURE...]   docs/maths/reflections.md
//   welkin_perf --bounds [--runs=N] LATLONG          docs/notes/speed.md, time by rms_error
//   welkin_perf --cold [--threads=1,2] [--runs=N] [--only=WORD] [--processor] [LATLONG]   docs/notes/speed.md
//   welkin_perf --page [Google Benchmark options]    every figure that Welkin is held to, beside its limit
#include <benchmark/benchmark.h>

#include <filesystem>
#include <functional>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks.h"
#include "ratio_reporter.h"
#include "welkin/core.h"

namespace welkin::perf {
namespace {

// Prints what `make` makes of the files, worked out on `threads` threads. The exit code.
int print_tables(int threads, const std::vector<std::filesystem::path>& files,
                 const std::function<std::string(const std::vector<std::filesystem::path>&)>& make) {
  try {
    std::string text;
    run_with_threads(threads, [&] { text = make(files); });
    std::cout << text;
    return 0;
  } catch (const Error& error) {
    std::cerr << "welkin_perf: " << error.what() << '\n';
    return 1;
  }
}

}  // namespace
}  // namespace welkin::perf

int main(int argc, char** argv) {
  using namespace welkin;
  const std::string first = argc > 2 ? argv[1] : "";
  if (first == "--target-sizes") return perf::print_tables(1, {argv + 2, argv + argc}, perf::target_size_table);
  if (first == "--irradiance-errors") {
    return perf::print_tables(0, {argv + 2, argv + argc}, perf::irradiance_error_tables);
  }
  if (first == "--prefilter-errors") {
    return perf::print_tables(0, {argv + 2, argv + argc}, perf::prefilter_error_tables);
  }
  if (first == "--block-errors") return perf::print_tables(1, {argv + 2, argv + argc}, perf::block_error_table);
  if (first == "--cold-calls") {
    std::cout << perf::cold_calls({argv + 2, argv + argc});
    return 0;
  }
  if (argc > 1 && std::string(argv[1]) == "--cold") {
    return perf::print_tables(0, {argv + 2, argv + argc},
                              [&](const auto& arguments) { return perf::cold_tables(argv[0], arguments); });
  }
  if (argc > 1 && std::string(argv[1]) == "--sky-errors") {
    return perf::print_tables(0, {argv + 2, argv + argc}, perf::sky_error_tables);
  }
  if (argc > 1 && std::string(argv[1]) == "--estimates") {
    return perf::print_tables(0, {argv + 2, argv + argc}, perf::estimate_table);
  }
  if (argc > 1 && std::string(argv[1]) == "--bounds") {
    return perf::print_tables(1, {argv + 2, argv + argc}, perf::bounds_table);
  }
  benchmark::AddCustomContext("welkin", WELKIN_VERSION_STRING);
  benchmark::AddCustomContext("instruction_set", name(active_instruction_set()));
  const std::vector<int> sizes{32, 64, 128, 256, 512, 1024, 2048};
  const std::vector<int> thread_counts{1, 2};
  perf::add_read_bandwidth(sizes, thread_counts);
  perf::add_project_cubemap(sizes, thread_counts);
  perf::add_probes(thread_counts);
  perf::add_project_lat_long(thread_counts);
  perf::add_project_file(thread_counts);
  perf::add_resampling(thread_counts);
  perf::add_bc6h(thread_counts);
  perf::add_prefilter(thread_counts);
  perf::add_sky_views(thread_counts);
  perf::add_importance(thread_counts);
  perf::add_sky_tables(thread_counts);
  perf::add_bakes(thread_counts);
#if WELKIN_TOOLS
  perf::add_previews(thread_counts);
  perf::add_command(thread_counts);
#endif
  perf::add_result_cache();
  perf::add_worker_latency(thread_counts);
  perf::add_cancel_latency(thread_counts);
  const bool page = argc > 1 && std::string(argv[1]) == "--page";
  if (page) {  // the rest is Google Benchmark's
    std::swap(argv[0], argv[1]);
    ++argv;
    --argc;
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  if (page) {
    std::cout << perf::speed_page();
    return 0;
  }
  perf::RatioReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  benchmark::Shutdown();
  return 0;
}
