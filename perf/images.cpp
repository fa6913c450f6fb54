#include "image/pixels.h"
#include "perf.h"
#include "perf/report/passes.h"
#include "support/chains.h"
#include "tools/preview_light.h"
#include "welkin/bake.h"
#include "welkin/bake_file.h"
#include "welkin/environment_file.h"
#include "welkin/image.h"
#include "welkin/importance.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::perf {
namespace {

/// Adds a cubemap of `size` from a lat-long twice as wide.
void add_lat_long_to_cubemap(int size) {
  constexpr double kTexelBytes = 12.0;
  const double texels = 6.0 * size * size;
  const double bytes = kTexelBytes * (texels + 2.0 * size * size);
  const std::string shape = std::to_string(2 * size) + "x" + std::to_string(size) + "-" + std::to_string(size);
  add_benchmark("LatLongToCubemap", "area", shape, kThreadCounts, texels, bytes, [=] {
    const LatLongView view = noise_lat_long(PixelFormat::rgb32f, 2 * size, size);
    const auto chain = std::make_shared<Cubemap>(size, 1);
    return [=] { image::fill_cubemap(view, *chain, 0, ResampleFilter::area, {}); };
  });
}

}  // namespace

void add_resampling() {
  for (const int size : {256, 512}) add_lat_long_to_cubemap(size);
}

namespace {

struct NamedEffort {
  const char* name;
  Bc6hEffort effort;
};
constexpr std::array kEfforts{NamedEffort{"fast", Bc6hEffort::fast}, NamedEffort{"normal", Bc6hEffort::normal},
                              NamedEffort{"slow", Bc6hEffort::slow}};

Cubemap whole_chain(const LatLongView& image, int size) {
  PrefilterOptions options;
  options.size = size;
  options.mips = full_chain_levels(size);
  return prefilter_specular(image, options).cubemap;
}

double texels_of(const Cubemap& chain) { return static_cast<double>(chain.bytes()) / (3.0 * sizeof(float)); }

std::string percent(double share) { return number("%.2f", 100.0 * share); }

void add_row(Table& table, const std::string& name, const Cubemap& chain, const report::BlockWay& way) {
  const auto bytes = report::texture_bytes(chain, way.options);
  if (!bytes) return;
  const Cubemap decoded = read_texture({*bytes, "chain.ktx2"}).cubemap;
  std::string mips;
  double squares = 0.0;
  double bias = 0.0;
  for (int level = 0; level < chain.levels(); ++level) {
    const double error =
        report::relative_errors(test::level_values(decoded, level), test::level_values(chain, level)).rms;
    mips += (level == 0 ? "" : ", ") + percent(error);
    squares += error * error * std::pow(chain.level_size(level), 2);
    if (chain.level_size(level) < 16) continue;
    bias = std::max(bias, test::largest_bias(decoded, chain, level));
  }
  table.add({name, std::string(way.format) + ' ' + way.effort, percent(std::sqrt(squares / (texels_of(chain) / 6.0))),
             mips, percent(bias)});
}

}  // namespace

void add_bc6h() {
  const auto chain = [](int size) {
    return std::make_shared<const Cubemap>(whole_chain(sky_image({.grain = 0.3, .sun = 500.0})->view(), size));
  };
  for (const int size : {256, 512}) {
    const double texels = 6.0 * (4.0 * size * size - 1.0) / 3.0;
    for (const NamedEffort& effort : kEfforts) {
      add_benchmark("EncodeBc6h", effort.name, std::to_string(size), kThreadCounts, texels, 0.0, [=] {
        return
            [given = chain(size), effort] { benchmark::DoNotOptimize(encode_bc6h(given->views(), {effort.effort})); };
      });
    }
  }
}

std::string block_error_table(const Paths& words) {
  const Arguments arguments(words, {"--size"});
  Table table({"environment", "format, effort", "rms error, %", "by mip",
               "largest bias of a channel's mean over a mip from 16 texels on, %"});
  for (const std::filesystem::path& file : arguments.files) {
    const Environment environment = read_environment(file);
    if (environment.info.layout != Layout::lat_long) continue;
    const Cubemap chain = whole_chain(environment.lat_long(), arguments.count("--size", 256));
    for (const report::BlockWay& way : report::block_ways()) add_row(table, file.stem().string(), chain, way);
  }
  return table.text();
}

void add_importance() {
  // Read once; a function and a cumulative distribution written.
  constexpr double texels = 4096.0 * 2048.0;
  add_benchmark("ImportanceTable", "rgb32f", "4096x2048", kThreadCounts, texels, 20.0 * texels, [=] {
    const LatLongView view = noise_lat_long(PixelFormat::rgb32f, 4096, 2048);
    const auto table = std::make_shared<ImportanceTable>(importance_table(view));
    return [=] {
      benchmark::DoNotOptimize(importance_table(view, {table->function, table->row_cdf, table->column_cdf}));
    };
  });
}

#if WELKIN_TOOLS  // previews are the command's
namespace {

BakeOptions all_that_previews_show() {
  BakeOptions options;
  options.specular = PrefilterOptions{};
  options.irradiance = IrradianceOptions{};
  options.brdf = BrdfTableOptions{};
  return options;
}

}  // namespace

void add_previews() {
  constexpr double kPixels = 1792.0 * 640.0 + 1024.0 * 512.0 + 1000.0 * 350.0;
  add_benchmark("Previews", "spheres-256", "256", kThreadCounts, kPixels, 0.0, [] {
    const auto folder = scratch_file("previews", [](const auto& path) { std::filesystem::create_directory(path); });
    auto light = std::make_shared<BakeResult>(bake(sky_image({.grain = 0.1})->view(), all_that_previews_show()));
    return [light, folder] {
      const tool::PreviewOptions options{tool::ToneMap{exposure_of(light->background->view(3))}};
      benchmark::DoNotOptimize(tool::write_previews(*light, options, folder));
    };
  });
}
#endif

}  // namespace welkin::perf
