#include <algorithm>
#include <cstdint>
#include <cstdio>

#include "benchmarks.h"
#include "image/image_kernels.h"
#include "perf/report/passes.h"
#include "perf/report/stopwatch.h"
#include "reference/reference_projection.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"
#include "welkin/projection.h"
#include "welkin/resampling.h"

namespace welkin::perf {
namespace {

constexpr int kSize = 1024;
constexpr int kTargets[] = {8, 16, 32, 64, 128, 256, 512, 0};
constexpr report::Stopwatch kStopwatch{.threads = 1, .budget_seconds = 0.5, .most_runs = 7};

std::string number(const char* format, double value) {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string header() {
  std::string text = "| environment | method |";
  std::string rule = "|---|---|";
  for (const int target : kTargets) {
    text += target > 0 ? " " + std::to_string(target) + " |" : std::string(" full |");
    rule += "---|";
  }
  return text + "\n" + rule + "\n";
}

}  // namespace

std::string target_size_table(const std::vector<std::filesystem::path>& files) {
  std::string errors = header();
  constexpr std::size_t columns = std::size(kTargets);
  const auto ways = report::projection_ways();
  std::vector<double> times(ways.size() * columns, 1e300);
  double reading = 1e300;
  for (const std::filesystem::path& file : files) {
    std::fprintf(stderr, "%s\n", file.filename().string().c_str());
    const Cubemap cube = to_cubemap(read_environment(file).lat_long(), kSize);
    const Cubemap chain = build_mips(cube.view(), MipFilter::box);
    const auto groups = static_cast<std::int64_t>(cube.pixels().size() / 16);
    volatile float sum = 0.0F;
    reading =
        std::min(reading, kStopwatch.seconds([&] { sum = image::image_kernels().read_all(cube.face(0), groups); }));
    const std::vector<report::Measurement> found =
        report::projections_by_target(chain, kTargets, reference_projection(cube.view()), kStopwatch);
    for (std::size_t k = 0; k < found.size(); ++k) {
      if (k % columns == 0) errors += "| " + file.stem().string() + " | " + found[k].method + " |";
      times[k] = std::min(times[k], found[k].seconds);
      errors += " " + number("%.0e", found[k].error_rms) + " |";
      if (k % columns + 1 == columns) errors += "\n";
    }
  }
  std::string text = "Relative error of the 27 coefficients\n\n" + errors +
                     "\nTime, as a multiple of reading the cubemap once (" + number("%.2f", 1e3 * reading) +
                     " ms, one thread, " + name(active_instruction_set()) + ")\n\n" + header();
  for (std::size_t way = 0; way < ways.size(); ++way) {
    text += std::string("| all | ") + ways[way].name + " |";
    for (std::size_t k = 0; k < columns; ++k) text += " " + number("%.3g", times[way * columns + k] / reading) + " |";
    text += "\n";
  }
  return text;
}

}  // namespace welkin::perf
