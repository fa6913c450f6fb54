#include "report/irradiance_passes.h"

#include <algorithm>
#include <cmath>

#include "report/error_norms.h"
#include "welkin/directional_light.h"
#include "welkin/irradiance.h"
#include "welkin/projection.h"
#include "welkin/windowing.h"

namespace welkin::report {
namespace {

constexpr int kNormals = 200;
constexpr const char* kTruth = "direct cosine integral over all texels in double, 200 normals";

ProjectionOptions with_bands(int bands) {
  ProjectionOptions options;
  options.bands = bands;
  return options;
}

std::string band_words(int bands) { return std::to_string(bands) + (bands == 1 ? " band" : " bands"); }

Measurement row(const std::string& method, const std::string& setting, const IrradianceError& error, double seconds,
                double share = 1.0) {
  return {"", method, setting, share * error.rms, share * error.maximum, seconds, kTruth};
}

/// The errors of what is left without the sun, which a light of its own gives back exactly, over the whole's.
std::vector<Measurement> with_sun_apart(const PassContext& context, const SphericalHarmonics& whole) {
  const LatLongImage& image = context.environment.image;
  LatLongImage rest = image;
  if (!take_out_sun(rest)) return {};
  const SphericalHarmonics rest_light = project(rest.view(), with_bands(context.scale.most_bands)).radiance;
  const double share = rms_of_irradiance(rest_light) / rms_of_irradiance(whole);
  const std::vector<IrradianceError> errors = irradiance_errors(rest.view(), rest_light, kNormals);
  std::vector<Measurement> all;
  for (int bands = 1; bands <= std::min(5, context.scale.most_bands); ++bands) {
    if (bands == 4) continue;
    const double seconds = context.stopwatch.seconds([&] {
      LatLongImage copy = image;
      if (take_out_sun(copy)) rest = std::move(copy);
      (void)project(rest.view(), with_bands(bands));
    });
    all.push_back(row("harmonics and the sun apart", band_words(bands), errors[static_cast<std::size_t>(bands - 1)],
                      seconds, share));
  }
  return all;
}

std::vector<Measurement> by_bands(const PassContext& context) {
  const LatLongView view = context.environment.image.view();
  const SphericalHarmonics radiance = project(view, with_bands(context.scale.most_bands)).radiance;
  const std::vector<IrradianceError> errors = irradiance_errors(view, radiance, kNormals);
  std::vector<Measurement> all;
  for (const IrradianceError& error : errors) {
    if (error.bands > 3 && error.bands % 2 == 0) continue;  // the cosine lobe has no odd bands above the first
    const double seconds = context.stopwatch.seconds([&] { (void)project(view, with_bands(error.bands)); });
    all.push_back(row("harmonics", band_words(error.bands), error, seconds));
  }
  progress(context, 1, 3);
  for (const Window window : {Window::hanning, Window::lanczos, Window::least}) {
    const SphericalHarmonics three = project(view).radiance;
    const std::vector<IrradianceError> windowed =
        irradiance_errors(view, apply_window(three, window).radiance, kNormals);
    const double seconds = context.stopwatch.seconds([&] { (void)apply_window(project(view).radiance, window); });
    all.push_back(row("harmonics, windowed", std::string("3 bands, ") + name(window), windowed.back(), seconds));
  }
  progress(context, 2, 3);
  const std::vector<Measurement> apart = with_sun_apart(context, radiance);
  all.insert(all.end(), apart.begin(), apart.end());
  return all;
}

}  // namespace

std::vector<PassRunner> irradiance_passes() {
  return {{{"irradiance", "Irradiance by bands",
            "Harmonics of a lat-long in memory, as diffuse light: few bands leave some of it out. With the sun apart "
            "it is found, taken out of a copy and given to a directional light first.",
            "Over normals: root mean square of the difference over that of the true irradiance; the largest difference "
            "over the same."},
           2.0,
           by_bands}};
}

}  // namespace welkin::report
