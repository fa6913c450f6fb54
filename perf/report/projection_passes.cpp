#include "perf/report/passes.h"
#include "reference/reference_projection.h"
#include "welkin/environment_file.h"
#include "welkin/projection.h"
#include "welkin/resampling.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::report {
namespace {

constexpr const char* kErrors =
    "rms: |c - c*| / |c*| of the 27 coefficients of radiance. Maximum: the largest error of the irradiance over "
    "normals, over its root mean square.";
constexpr const char* kTruth = "projection of all texels in double";

/// Returns 8, 16, ... below `size`, and 0.
std::vector<int> targets_below(int size) {
  std::vector<int> targets;
  for (int target = 8; target < size; target *= 2) targets.push_back(target);
  targets.push_back(0);
  return targets;
}

struct ErrorsOfHarmonics {
  SphericalHarmonics truth;

  ErrorNorms operator()(const SphericalHarmonics& found) const { return harmonic_errors(found, truth); }
};

Cubemap cubemap_of(const PassContext& context) {
  return to_cubemap(context.environment.image.view(), context.scale.cube_size);
}

ProjectionOptions options_of(Quadrature quadrature, int target) {
  ProjectionOptions options;
  options.quadrature = quadrature;
  if (target > 0) options.target_size = target;
  return options;
}

/// Measures three bands by each way, at 8, 16, ... texels below the full size and at that.
std::vector<Measurement> by_target(const PassContext& context) {
  struct Way {
    const char* name;
    Quadrature quadrature;
    bool from_chain;  ///< of plain 2 x 2 boxes, as engines make them
  };
  constexpr Way ways[] = {{"exact", Quadrature::exact, false},
                          {"midpoint (as Babylon.js)", Quadrature::midpoint, false},
                          {"exact, from mips", Quadrature::exact, true}};
  const Cubemap cube = cubemap_of(context);
  const Cubemap chain = build_mips(cube.view(), MipFilter::box);
  const std::vector<CubemapView> levels = chain.views();
  const ErrorsOfHarmonics errors{reference_projection(cube.view())};
  std::vector<Measurement> all;
  for (const Way& way : ways) {
    for (const int target : targets_below(cube.size())) {
      const ProjectionOptions options = options_of(way.quadrature, target);
      const auto call = [&] {
        return (way.from_chain ? project(levels, options) : project(levels[0], options)).radiance;
      };
      all.push_back(measured(way.name, target_words(target), context.stopwatch, kTruth, call, errors));
    }
  }
  progress(context, 1, 2);
  add_peers(all, context.peers.project(cube, {0, 64}), kTruth, errors);
  return all;
}

std::vector<Measurement> by_format(const PassContext& context) {
  const Cubemap cube = cubemap_of(context);
  const ErrorsOfHarmonics errors{reference_projection(cube.view())};
  constexpr PixelFormat formats[] = {PixelFormat::rgb32f,  PixelFormat::rgba32f, PixelFormat::rgb16f,
                                     PixelFormat::rgba16f, PixelFormat::rgb8,    PixelFormat::rgba8,
                                     PixelFormat::srgb8,   PixelFormat::srgba8};
  std::vector<Measurement> all;
  for (const PixelFormat format : formats) {
    const FormattedCubemap pixels(cube, format);
    const char* const channels = name(format).rfind("rgba", 0) == 0 ? "RGBA" : "RGB";
    const auto call = [&] { return project(pixels.view()).radiance; };
    all.push_back(measured(channels, name(format), context.stopwatch, kTruth, call, errors));
    progress(context, all.size(), std::size(formats));
  }
  return all;
}

std::vector<Measurement> from_lat_long(const PassContext& context) {
  const LatLongView view = context.environment.image.view();
  const ErrorsOfHarmonics errors{reference_projection(view)};
  const std::vector<int> targets = targets_below(view.height / 2);
  std::vector<Measurement> all;
  for (const Quadrature quadrature : {Quadrature::exact, Quadrature::midpoint}) {
    const std::string method = quadrature == Quadrature::exact ? "direct, exact" : "direct, midpoint";
    for (const int target : targets) {
      const ProjectionOptions options = options_of(quadrature, target);
      const auto call = [&] { return project(view, options).radiance; };
      all.push_back(measured(method, target_words(target), context.stopwatch, kTruth, call, errors));
    }
  }
  progress(context, 1, 2);
  for (const ResampleFilter filter : {ResampleFilter::area, ResampleFilter::bilinear}) {
    const std::string method = filter == ResampleFilter::area ? "via a cubemap by area" : "via a bilinear cubemap";
    for (int size = 16; size <= view.height; size *= 2) {
      const auto call = [&] { return project(to_cubemap(view, size, glm::dmat3(1.0), filter).view()).radiance; };
      all.push_back(measured(method, "faces of " + std::to_string(size), context.stopwatch, kTruth, call, errors));
    }
  }
  return all;
}

std::vector<Measurement> from_file(const PassContext& context) {
  const Environment environment = read_environment(context.file);
  const ErrorsOfHarmonics errors{reference_projection(environment.lat_long())};
  std::vector<Measurement> all;
  for (const int target : {16, 64, 0}) {
    const auto streamed = [&] {
      return project_file(context.file, {}, options_of(Quadrature::exact, target)).radiance;
    };
    all.push_back(measured("streamed, exact", target_words(target), context.stopwatch, kTruth, streamed, errors));
  }
  const auto read = [&] { return project(read_environment(context.file).lat_long()).radiance; };
  all.push_back(measured("read, then exact", "full size", context.stopwatch, kTruth, read, errors));
  progress(context, 1, 2);
  add_peers(all, context.peers.project_file(context.file), kTruth, errors);
  return all;
}

}  // namespace

std::string target_words(int target) { return target > 0 ? "target " + std::to_string(target) : "full size"; }

std::vector<PassRunner> projection_passes() {
  return {{{"project-cubemap", "Cubemap to harmonics",
            "Three bands of a cubemap of RGB floats in memory, at its full size or reduced to a target size first. The "
            "mip chain of 'from mips' exists beforehand.",
            kErrors},
           3.0,
           by_target},
          {{"project-format", "Pixel formats",
            "Three bands of the same cubemap in each pixel format, full size. The error includes what the format "
            "cannot hold (8 bits end at 1).",
            kErrors},
           1.0,
           by_format},
          {{"project-lat-long", "Lat-long to harmonics",
            "Three bands of a lat-long of RGB floats in memory: directly, or by way of a cubemap, which is timed too.",
            kErrors},
           3.0,
           from_lat_long},
          {{"project-file", "File to harmonics",
            "Three bands of a Radiance .hdr file, reading included. For cmgen, the time is that of the process: "
            "start, reading, a cubemap, its projection and writing a text file.",
            kErrors},
           2.0,
           from_file}};
}

namespace {

constexpr int kNormals = 200;
constexpr const char* kIrradianceTruth = "direct cosine integral over all texels in double, 200 normals";

ProjectionOptions resized(int bands) {
  ProjectionOptions options;
  options.bands = bands;
  return options;
}

std::string band_words(int bands) { return std::to_string(bands) + (bands == 1 ? " band" : " bands"); }

ErrorNorms norms_of(const IrradianceError& error, double share = 1.0) {
  return {share * error.rms, share * error.maximum};
}

/// Measures the errors of the light without the sun, which a separate light reproduces exactly, over the whole's.
std::vector<Measurement> with_sun_extracted(const PassContext& context, const SphericalHarmonics& whole) {
  const LatLongImage& image = context.environment.image;
  LatLongImage rest = image;
  if (!extract_sun(rest)) return {};
  const SphericalHarmonics rest_light = project(rest.view(), resized(context.scale.most_bands)).radiance;
  const double share = rms_of_irradiance(rest_light) / rms_of_irradiance(whole);
  const std::vector<IrradianceError> errors = irradiance_errors(rest.view(), rest_light, kNormals);
  std::vector<Measurement> all;
  for (int bands = 1; bands <= std::min(5, context.scale.most_bands); ++bands) {
    if (bands == 4) continue;
    const double seconds = context.stopwatch.seconds([&] {
      LatLongImage copy = image;
      if (extract_sun(copy)) rest = std::move(copy);
      (void)project(rest.view(), resized(bands));
    });
    all.push_back(measurement("harmonics and the sun extracted", band_words(bands),
                              norms_of(errors[static_cast<std::size_t>(bands - 1)], share), seconds, kIrradianceTruth));
  }
  return all;
}

std::vector<Measurement> by_bands(const PassContext& context) {
  const LatLongView view = context.environment.image.view();
  const SphericalHarmonics radiance = project(view, resized(context.scale.most_bands)).radiance;
  const std::vector<IrradianceError> errors = irradiance_errors(view, radiance, kNormals);
  std::vector<Measurement> all;
  for (const IrradianceError& error : errors) {
    if (error.bands > 3 && error.bands % 2 == 0) continue;  // the cosine lobe has no odd bands above the first
    const double seconds = context.stopwatch.seconds([&] { (void)project(view, resized(error.bands)); });
    all.push_back(measurement("harmonics", band_words(error.bands), norms_of(error), seconds, kIrradianceTruth));
  }
  progress(context, 1, 3);
  for (const Window window : {Window::hanning, Window::lanczos, Window::min_laplacian}) {
    const SphericalHarmonics three = project(view).radiance;
    const std::vector<IrradianceError> windowed =
        irradiance_errors(view, apply_window(three, window).radiance, kNormals);
    const double seconds = context.stopwatch.seconds([&] { (void)apply_window(project(view).radiance, window); });
    all.push_back(measurement("harmonics, windowed", std::string("3 bands, ") + name(window), norms_of(windowed.back()),
                              seconds, kIrradianceTruth));
  }
  progress(context, 2, 3);
  const std::vector<Measurement> extracted = with_sun_extracted(context, radiance);
  all.insert(all.end(), extracted.begin(), extracted.end());
  return all;
}

}  // namespace

std::vector<PassRunner> irradiance_passes() {
  return {{{"irradiance", "Irradiance by bands",
            "Harmonics of a lat-long in memory, as diffuse light: few bands omit part of it. Where the sun is "
            "extracted, it is first moved from a copy to a directional light.",
            "Over normals: root mean square of the difference over that of the true irradiance; the largest difference "
            "over the same."},
           2.0,
           by_bands}};
}

}  // namespace welkin::report
