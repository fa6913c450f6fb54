#include "tools/sh_measure.h"

#include <cstdint>
#include <string>
#include <utility>

#include "tools/cache_option.h"
#include "tools/pixels.h"
#include "tools/progress_bar.h"
#include "tools/sky_model.h"
#include "welkin/environment_file.h"
#include "welkin/error.h"
#include "welkin/harmonic_transforms.h"

namespace welkin::tool {
namespace {

constexpr double kComputed = 0.8;  // of the progress, where the sky is computed first

// What `project` would put in an infinity's place.
float infinity_of(const ProjectionOptions& options) { return options.clamp ? options.clamp->maximum : 65504.0F; }

// Takes the sun out, if asked for, and projects what is left; measures the irradiance's error on the way.
void project_pixels(Pixels& pixels, const ShOptions& options, const Control& control, ShReport& report) {
  std::uint64_t infinities = 0;
  if (options.sun.take_out) {
    // A sun that overflowed would not be found.
    if (options.projection.infinity == NonFinitePolicy::replace) {
      infinities = replace_infinities(pixels, infinity_of(options.projection));
    }
    report.sun = take_out_sun(pixels, options.sun.options);
  }
  with_cache(options.common, report.source.notes, [&](ResultCache* cache) {
    report.projection = with_view(pixels, [&](const auto& view) {
      return cache != nullptr ? cache->project(view, options.projection, {}, control)
                              : project(view, options.projection, control);
    });
  });
  report.projection.diagnostics.infinities_replaced += infinities;
  if (options.irradiance_error) {
    constexpr int kNormals = 500;
    const SphericalHarmonics windowed =
        apply_window(report.projection.radiance, options.window, options.window_width).radiance;
    report.irradiance_errors = with_view(pixels, [&](const auto& view) {
      return irradiance_errors(view, windowed, kNormals, options.projection, control);
    });
  }
}

// Copied from the environment as it was read, so that it is held twice for a moment.
void require_memory_twice(const EnvironmentInfo& info, const ReadOptions& read) {
  const bool is_cross = info.layout == Layout::horizontal_cross || info.layout == Layout::vertical_cross;
  const std::uint64_t texels = static_cast<std::uint64_t>(info.width) * static_cast<std::uint64_t>(info.height);
  const std::uint64_t bytes = 2 * 12 * (is_cross ? texels / 2 : texels);
  if (bytes <= read.memory_limit_bytes) return;
  throw Error(ErrorCode::limit_exceeded,
              info.path.string() + ": " + std::to_string(info.width) + " x " + std::to_string(info.height) +
                  " texels, held twice for --take-out-sun and --irradiance-error, take " + std::to_string(bytes) +
                  " bytes, above the limit of " + std::to_string(read.memory_limit_bytes) +
                  "; raise --memory-limit, leave those options out, or reduce the picture");
}

bool is_cubemap(const EnvironmentInfo& info) { return info.layout != Layout::lat_long; }

// Fills in source, projection, sun; says whether the source was a cubemap.
bool project_source(const ShOptions& options, const Control& control, ShReport& report) {
  const bool in_memory = options.sun.take_out || options.irradiance_error;
  if (!options.input) {
    Pixels pixels;
    ComputedPicture sky = built_in_sky(part_of(control, 0.0, kComputed));
    pixels.lat_long = std::move(sky.image);
    report.source = sky.source;
    report.sky = sky.sky;
    project_pixels(pixels, options, part_of(control, kComputed, 1.0), report);
    return false;
  }
  const ReadOptions& read = options.common.read;
  if (in_memory) {
    require_memory_twice(inspect_environment(*options.input, read), read);
    Pixels pixels;
    {
      const Environment environment = read_environment(*options.input, read);
      report.source = source_of(*options.input, environment.info);
      pixels = pixels_of(environment);
    }
    project_pixels(pixels, options, control, report);
    return pixels.is_cubemap;
  }
  const EnvironmentInfo info = inspect_environment(*options.input, read);
  report.source = source_of(*options.input, info);
  with_cache(options.common, report.source.notes, [&](ResultCache* cache) {
    report.projection = cache != nullptr ? cache->project_file(*options.input, read, options.projection, control)
                                         : project_file(*options.input, read, options.projection, control);
  });
  return is_cubemap(info);
}

void turn(const glm::dmat3& matrix, ShReport& report) {
  if (matrix == glm::dmat3(1.0)) return;
  report.projection.radiance = transform(report.projection.radiance, matrix);
  if (report.sun) report.sun->direction = matrix * report.sun->direction;
}

}  // namespace

const char* quadrature_name(const ShReport& report) noexcept {
  if (report.sky && report.sky->quadrature) return name(report.sky->quadrature->quadrature);
  return report.options.quadrature == Quadrature::exact ? "exact" : "midpoint";
}

void complete(ShReport& report, const ShOptions& options) {
  report.window = options.window;
  report.engine = options.turn.to;
  report.axes = axes_text(options.turn);
  report.threads = thread_count(options.common);
  SphericalHarmonics& radiance = report.projection.radiance;
  report.dominant = dominant_light(radiance);  // of the light itself: a window damps the bands that it is fitted to
  report.windowed = apply_window(radiance, options.window, options.window_width);
  radiance = report.windowed.radiance;
  report.irradiance = irradiance_from_radiance(radiance);
  report.polynomial = babylon_polynomial(radiance);
  if (has_engine_light(report.engine)) report.engine_light = engine_light_in_place(radiance, report.engine);
}

ShReport measure_sh(const ShOptions& options) {
  ShReport report;
  report.options = options.projection;
  report.sun_wanted = options.sun.take_out;
  {
    ProgressBar bar;
    const bool cubemap = project_source(options, bar.control(), report);
    turn(turn_of_light(options.turn, cubemap), report);
  }
  complete(report, options);
  return report;
}

}  // namespace welkin::tool
