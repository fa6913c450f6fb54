#include "scenes.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <optional>

#include "scratch_files.h"
#include "welkin/bake_file.h"
#include "welkin/plan.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"
#include "welkin/sky_plan.h"
#include "welkin/texture_file.h"

namespace welkin::perf {
namespace {

/// Of the process: what other programs do at the same time hardly shows.
double processor_milliseconds() {
  return 1e3 / static_cast<double>(CLOCKS_PER_SEC) * static_cast<double>(std::clock());
}

template <class Result>
struct Measured {
  Result result;
  double milliseconds = std::numeric_limits<double>::infinity();
};

template <class Work>
auto measured(int runs, const Work& work) {
  Measured<decltype(work())> fastest;
  for (int run = 0; run < runs; ++run) {
    const double start = processor_milliseconds();
    auto result = work();
    const double time = processor_milliseconds() - start;
    if (time >= fastest.milliseconds) continue;
    fastest.milliseconds = time;
    fastest.result = std::move(result);
  }
  return fastest;
}

/// A sky over ground with clouds of a few sizes and a sun.
LatLongImage picture(int width) {
  LatLongImage image{width, width / 2, {}};
  std::uint32_t state = 1;
  for (int row = 0; row < image.height; ++row) {
    for (int column = 0; column < width; ++column) {
      const double x = 2.0 * M_PI * column / width;
      const double y = M_PI * row / image.height;
      state = state * 1664525U + 1013904223U;
      const double clouds = 0.3 * std::sin(5.0 * x) * std::sin(3.0 * y) + 0.15 * std::sin(23.0 * x + 11.0 * y);
      double value = (y < 0.5 * M_PI ? 1.0 : 0.3) + clouds * std::sin(y) + 1e-11 * state;
      if (std::hypot((x - 2.0) * std::sin(y), y - 1.0) < 0.01) value = 34'000.0;
      for (const double colour : {1.0, 0.9, 0.8}) image.pixels.push_back(static_cast<float>(colour * value));
    }
  }
  return image;
}

struct Row {
  std::string scene;
  double whole_milliseconds;
  double part_milliseconds;
  std::uint64_t whole_bytes;
  std::uint64_t part_bytes;
};

std::string row_text(const Row& row) {
  constexpr double kMebibyte = 1024.0 * 1024.0;
  char text[256];
  std::snprintf(text, sizeof text, "| %s | %.1f | %.1f | %.1f | %.1f |\n", row.scene.c_str(), row.whole_milliseconds,
                row.part_milliseconds, static_cast<double>(row.whole_bytes) / kMebibyte,
                static_cast<double>(row.part_bytes) / kMebibyte);
  return text;
}

class Scenes {
 public:
  explicit Scenes(const std::vector<std::filesystem::path>& arguments) {
    for (const std::filesystem::path& argument : arguments) {
      const std::string word = argument.string();
      if (word == "--explain") explain_ = true;
      if (word.starts_with("--runs=")) runs_ = std::max(1, std::atoi(word.c_str() + 7));
    }
  }

  std::string run() {
    panoramas();
    probes();
    files();
    skies();
    std::string text = "| scene | whole ms | planned ms | whole MiB | planned MiB |\n|---|---|---|---|---|\n";
    for (const Row& row : rows_) text += row_text(row);
    return explained_ + text;
  }

 private:
  static BakeOptions whole_bake() {
    BakeOptions options;
    options.specular = PrefilterOptions{.size = 256, .mips = 8};
    return options;
  }

  void explain(const std::string& scene, const std::string& plan) {
    if (explain_) explained_ += scene + '\n' + plan + '\n';
  }

  /// Both ways; whole bakes of the same source are measured once.
  template <class View>
  void add(const std::string& scene, const View& view, const SceneNeeds& needs, const Measured<BakeResult>& whole) {
    const Plan planned = plan(view, needs, whole_bake());
    const auto part = measured(runs_, [&] { return bake(view, planned); });
    explain(scene, plan_text(planned, part.result.diagnostics.passes));
    rows_.push_back({scene, whole.milliseconds, part.milliseconds, whole.result.peak_bytes, part.result.peak_bytes});
  }

  void panoramas() {
    const LatLongImage image = picture(1024);
    const LatLongView view = image.view();
    const auto whole = measured(runs_, [&] { return bake(view, whole_bake()); });
    const Plan all = plan(view, {}, whole_bake());
    explain("everything", plan_text(all, whole.result.diagnostics.passes));
    add("ambient-only mobile", view, {.diffuse_bands = 1, .glossy = std::nullopt, .background = false}, whole);
    add("coefficients alone", view, {.irradiance_cubemap = false, .glossy = std::nullopt, .background = false}, whole);
    add("no glossy materials", view, {.glossy = std::nullopt}, whole);
    add("roughness above 0.4 only", view, {.glossy = RoughnessRange{0.4, 1.0}}, whole);
    add("backdrop only", view, {.diffuse_bands = 0, .glossy = std::nullopt, .background_mips = false}, whole);
  }

  void probes() {
    const CubemapImage cube = to_cubemap(picture(512).view(), 128);
    const auto whole = measured(runs_, [&] { return bake(cube.view(), whole_bake()); });
    const SceneNeeds room{.glossy = RoughnessRange{0.3, 1.0}, .background = false, .brdf_table = false};
    add("probe of a static room, roughness above 0.3", cube.view(), room, whole);
  }

  void add_file(const std::string& scene, const StoredEnvironment& file, const SceneNeeds& needs) {
    SceneNeeds computed;
    computed.stored_results = false;
    const Plan everything = plan(file, computed, whole_bake());
    const auto whole = measured(runs_, [&] { return bake(file, everything); });
    const Plan planned = plan(file, needs, whole_bake());
    const auto part = measured(runs_, [&] { return bake(file, planned); });
    explain(scene, plan_text(planned, part.result.diagnostics.passes));
    rows_.push_back({scene, whole.milliseconds, part.milliseconds, whole.result.peak_bytes, part.result.peak_bytes});
  }

  void files() {
    const CubemapImage cube = to_cubemap(picture(512).view(), 128);
    PrefilterOptions babylon{.size = 128};
    babylon.roughness = roughness_of_mips(RoughnessSchedule::babylon, full_chain_levels(128), 128);
    const PrefilteredSpecular specular = prefilter_specular(cube.view(), babylon);
    const BabylonEnvironment stored = to_babylon(specular.cubemap, project(cube.view()).radiance);
    const StoredEnvironment env = probe_environment(
        scratch_file("scene.env", [&](const std::filesystem::path& path) { write_babylon_environment(path, stored); }));
    add_file(".env with all that is needed", env, {});
    add_file("light of an .env", env, {.glossy = std::nullopt, .background = false});
    const CubemapChain mips = build_mips(cube.view());
    const std::filesystem::path ktx2 =
        scratch_file("scene.ktx2", [&](const std::filesystem::path& path) { write_texture(path, mips.views()); });
    add_file("backdrop of a KTX2", probe_environment(ktx2), {.glossy = std::nullopt});
  }

  static std::uint64_t bytes_of(const SkyPlan& plan) { return plan.result_bytes; }

  void add_sky(const std::string& scene, const SkyPlan& planned, const SkyPlan& everything,
               const Measured<SkyBake>& whole) {
    const auto part = measured(1, [&] { return bake(planned, sun_direction(20.0, 30.0)); });
    explain(scene, plan_text(planned, part.result.passes));
    rows_.push_back({scene, whole.milliseconds, part.milliseconds, bytes_of(everything), bytes_of(planned)});
  }

  static SkyBakeOptions small_sky() {
    SkyBakeOptions options;
    options.tables.heights = 16;
    options.tables.view_zeniths = 32;
    options.tables.sun_zeniths = 32;
    options.tables.sun_angles = 4;
    return options;
  }

  void skies() {
    const SkyPlan everything = plan(earth_bruneton(), {}, small_sky());
    const auto whole = measured(1, [&] { return bake(everything, sun_direction(20.0, 30.0)); });
    explain("a sky, everything", plan_text(everything, whole.result.passes));
    add_sky("moving sky, no glossy materials",
            plan(earth_bruneton(), {.glossy = std::nullopt, .background = false}, small_sky()), everything, whole);
    add_sky("still sky, reflections", plan(earth_bruneton(), {.background = false, .sun_moves = false}, small_sky()),
            everything, whole);
    SkyBakeOptions once = small_sky();
    once.tables.orders = 1;
    Atmosphere bare = without_aerosol(earth_bruneton());
    bare.absorbers.clear();
    add_sky("a planet without aerosol and ozone, one order", plan(bare, {.glossy = std::nullopt}, once), everything,
            whole);
  }

  int runs_ = 3;
  bool explain_ = false;
  std::vector<Row> rows_;
  std::string explained_;
};

}  // namespace

std::string scene_table(const std::vector<std::filesystem::path>& arguments) { return Scenes(arguments).run(); }

}  // namespace welkin::perf
