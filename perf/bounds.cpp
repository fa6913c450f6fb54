#include "perf.h"
#include "welkin/bake.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"
#include "welkin/image.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"

namespace welkin::perf {
namespace {

constexpr double kBounds[] = {1e-5, 1e-4, 1e-3, 3e-3, 1e-2, 3e-2};

struct Subject {
  std::string name;
  std::function<void(double)> call;  ///< within a bound
};

Subject chain_of(const Environment& image, bool cubemap, const std::string& name, PrefilterOptions options) {
  auto cube = std::make_shared<Cubemap>();
  if (cubemap) *cube = to_cubemap(image.lat_long(), options.size);
  return {name, [=, &image](double bound) mutable {
            options.rms_error = bound;
            static_cast<void>(cubemap ? prefilter_specular(cube->view(), options)
                                      : prefilter_specular(image.lat_long(), options));
          }};
}

Subject irradiance_of(const Environment& image, int size) {
  const auto cube = std::make_shared<Cubemap>(to_cubemap(image.lat_long(), size));
  BakeOptions options{.background = {}, .specular = {}, .brdf = {}};
  return {"cube " + std::to_string(size) + ", irradiance", [=](double bound) mutable {
            options.irradiance->rms_error = bound;
            static_cast<void>(bake(cube->view(), options));
          }};
}

Subject probes_of(const Environment& image, int mips) {
  constexpr int size = 64;
  constexpr std::size_t count = 64;
  const auto source =
      std::make_shared<report::FormattedCubemap>(to_cubemap(image.lat_long(), size), PixelFormat::rgba16f);
  const auto room = std::make_shared<const ProbeTargets>(count, size, mips);
  return {
      "64 probes of 64 halves, " + std::to_string(mips) + " mips", [=](double bound) {
        const std::vector<CubemapView> probes(count, source->view());
        std::vector<dvec3> light(9 * count);
        static_cast<void>(bake_many(probes, room->targets, light, {.size = size, .mips = mips, .rms_error = bound}, 3));
      }};
}

std::vector<Subject> subjects_of(const Environment& image) {
  std::vector<Subject> subjects;
  for (const int size : {64, 128, 256, 512}) {
    const int mips = size == 64 ? 3 : size == 128 ? 4 : size == 256 ? 5 : 6;  // down to 16 texels
    subjects.push_back(chain_of(image, true, "cube " + std::to_string(size) + ", " + std::to_string(mips) + " mips",
                                {.size = size, .mips = mips}));
    subjects.push_back(chain_of(image, true, "cube " + std::to_string(size), {.size = size}));
  }
  subjects.push_back(chain_of(image, false, "lat-long to 256, 5 mips", {.size = 256, .mips = 5}));
  for (const bool cubemap : {true, false}) {
    const std::string from = cubemap ? "cube 64" : "lat-long to 64";
    subjects.push_back(
        chain_of(image, cubemap, from + ", Charlie, 3 mips", {.size = 64, .mips = 3, .lobe = LobeFamily::charlie}));
    subjects.push_back(chain_of(image, cubemap, from + ", Lambert", {.size = 64, .lobe = LobeFamily::lambert}));
  }
  subjects.push_back(irradiance_of(image, 64));
  subjects.push_back(probes_of(image, 3));
  subjects.push_back(probes_of(image, 5));
  return subjects;
}

/// Milliseconds, the least of `runs` calls after a first one, which makes tables.
std::string best_of(const Subject& subject, double bound, int runs) {
  try {
    const report::Stopwatch stopwatch{.threads = 1, .budget_seconds = 60.0, .most_runs = runs + 1};
    return number("%.3g", 1e3 * stopwatch.seconds([&] { subject.call(bound); }));
  } catch (const Error&) {
    return "refused";
  }
}

}  // namespace

std::string bounds_table(const Paths& words) {
  const Arguments arguments(words, {"--runs"});
  if (arguments.files.size() != 1) throw Error(ErrorCode::invalid_argument, "--bounds: name one lat-long");
  const int runs = std::max(1, arguments.count("--runs", 20));
  const Environment image = read_environment(arguments.files.at(0));
  std::vector<std::string> heads{"ms within"};
  for (const double bound : kBounds) heads.push_back(number("%g", bound));
  Table table(heads);
  run_with_threads(1, [&] {
    for (const Subject& subject : subjects_of(image)) {
      std::vector<std::string> cells{subject.name};
      for (const double bound : kBounds) cells.push_back(best_of(subject, bound, bound < 5e-4 ? 2 : runs));
      table.add(cells);
    }
  });
  return table.text();
}

}  // namespace welkin::perf
