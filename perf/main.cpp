// welkin_perf: throughput of the kernels relative to the machine's own limits.
//   welkin_perf [Google Benchmark options]
//   welkin_perf --irradiance-errors ENVIRONMENT...   the tables of docs/maths/irradiance.md
//   welkin_perf --block-errors [--size=N] ENVIRONMENT...   the table of docs/notes/textures.md
//   welkin_perf --prefilter-errors [--synthetic] [--texels=N] [--size=N] [--methods=A,B]
//     [--roughness=A,B] [--width=N] [--cubemap=N] LATLONG... docs/maths/reflections.md
//   welkin_perf --sky-errors [--radiance] [--methods] [--directions=N] [--altitude=M]   docs/maths/sky.md
//   welkin_perf --estimates [COUNT] [--seed=N] [--rms-error=X] [IMAGE...]   docs/maths/reflections.md
//   welkin_perf --bounds [--runs=N] LATLONG          docs/notes/speed.md, time by rms_error
//   welkin_perf --cold [--threads=1,2] [--runs=N] [--only=WORD] [--processor] [LATLONG]   docs/notes/speed.md
//   welkin_perf --page [--processor] [--before=PAGE] [--sse2=PAGE] [--avx2=PAGE] [Google Benchmark options]
//     every figure with a target, and its target: docs/notes/speed.md
#include "perf.h"

namespace welkin::perf {
namespace {

struct Mode {
  const char* option;
  int threads;  ///< for making its tables; 0: all
  std::function<std::string(const Paths& words)> make;
};

/// Returns the exit code.
int print_tables(const Mode& mode, const Paths& words) {
  try {
    std::string text;
    run_with_threads(mode.threads, [&] { text = mode.make(words); });
    std::cout << text;
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "welkin_perf: " << error.what() << '\n';
    return 1;
  }
}

}  // namespace
}  // namespace welkin::perf

int main(int argc, char** argv) {
  using namespace welkin;
  const std::string first = argc > 1 ? argv[1] : "";
  const perf::Mode modes[] = {
      {"--irradiance-errors", 0, perf::irradiance_error_tables},
      {"--prefilter-errors", 0, perf::prefilter_error_tables},
      {"--block-errors", 1, perf::block_error_table},
      {"--sky-errors", 0, perf::sky_error_tables},
      {"--estimates", 0, perf::estimate_table},
      {"--bounds", 1, perf::bounds_table},
      {"--cold-calls", 0, perf::cold_calls},
      {"--cold", 0, [&](const perf::Paths& words) { return perf::cold_tables(argv[0], words); }}};
  for (const perf::Mode& mode : modes) {
    if (first == mode.option) return perf::print_tables(mode, {argv + 2, argv + argc});
  }
  benchmark::AddCustomContext("welkin", WELKIN_VERSION_STRING);
  benchmark::AddCustomContext("instruction_set", name(active_instruction_set()));
  perf::add_read_bandwidth();
  perf::add_project_cubemap();
  perf::add_probes();
  perf::add_project_lat_long();
  perf::add_project_file();
  perf::add_resampling();
  perf::add_bc6h();
  perf::add_prefilter();
  perf::add_sky_specular();
  perf::add_harmonics();
  perf::add_importance();
  perf::add_sky_tables();
  perf::add_bakes();
#if WELKIN_TOOLS
  perf::add_previews();
#endif
  perf::add_result_cache();
  perf::add_worker_latency();
  perf::add_cancel_latency();
  const bool page = first == "--page";
  perf::PageOptions page_options;
  if (page) {  // the other options are Google Benchmark's
    const std::pair<std::string, const char*> pages[] = {
        {"--before=", "before"}, {"--sse2=", "SSE2"}, {"--avx2=", "AVX2"}};  // of WELKIN_ISA=sse2 welkin_perf --page
    std::vector<char*> rest{argv[0]};
    for (int i = 2; i < argc; ++i) {
      const std::string word = argv[i];
      const auto* const other = std::find_if(std::begin(pages), std::end(pages),
                                             [&](const auto& one) { return word.starts_with(one.first); });
      if (word == "--processor") {
        page_options.processor = true;
      } else if (other != std::end(pages)) {
        page_options.others.emplace_back(other->second, word.substr(other->first.size()));
      } else {
        rest.push_back(argv[i]);
      }
    }
    argc = static_cast<int>(rest.size());
    std::copy(rest.begin(), rest.end(), argv);
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  if (page) {
    try {
      std::cout << perf::speed_page(page_options);
      return 0;
    } catch (const std::exception& error) {
      std::cerr << "welkin_perf: " << error.what() << '\n';
      return 1;
    }
  }
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
