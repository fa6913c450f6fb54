// What is no number, and what is below zero, under each policy.
#include <cmath>
#include <limits>

#include "report/stability/cases.h"
#include "report/stability/maps.h"
#include "report/stability/measures.h"
#include "welkin/irradiance.h"
#include "welkin/projection.h"
#include "welkin/specular.h"

namespace welkin::report::stability {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::size_t kTexel = 777;

/// A policy's case: what a texel holds, and what it must count as.
struct Replacement {
  const char* name;
  const char* promise;
  float bad;
  float instead;
  ProjectionOptions options;
};

ProjectionOptions clamped(float maximum) {
  ProjectionOptions options;
  options.clamp = RadianceClamp{maximum, false};
  return options;
}

ProjectionOptions with(NonFinitePolicy nan, NonFinitePolicy infinity, NegativePolicy negative) {
  ProjectionOptions options;
  options.nan = nan;
  options.infinity = infinity;
  options.negative = negative;
  return options;
}

constexpr NonFinitePolicy kReplace = NonFinitePolicy::replace;

std::vector<Replacement> replacements() {
  return {
      {"nan", "NaN counts as 0", kNaN, 0.0F, {}},
      {"infinity", "+infinity counts as 65504", kInfinity, 65504.0F, {}},
      {"infinity-clamped", "+infinity counts as the clamp's maximum", kInfinity, 100.0F, clamped(100.0F)},
      {"minus-infinity", "-infinity counts as 0", -kInfinity, 0.0F, {}},
      {"negative-kept", "a negative is taken as it is", -3.0F, -3.0F, {}},
      {"negative-replaced", "a negative counts as 0", -3.0F, 0.0F, with(kReplace, kReplace, NegativePolicy::replace)},
      {"minus-1e38", "a huge negative is taken as it is", -1e38F, -1e38F, {}}};
}

template <class Image>
double projected(const Image& map, const Replacement& r) {
  const Image bad = with_texel(map, kTexel, r.bad);
  const Image good = with_texel(map, kTexel, r.instead);
  return relative_error(project(bad.view(), r.options).radiance, project(good.view(), {}).radiance);
}

double irradiance_of(const Replacement& r) {
  const CubemapImage bad = with_texel(noise_cube(16, 1), kTexel, r.bad);
  const CubemapImage good = with_texel(noise_cube(16, 1), kTexel, r.instead);
  const std::vector<glm::dvec3> normals = spread_directions(8);
  return rms_error(direct_irradiance(bad.view(), normals, r.options), direct_irradiance(good.view(), normals));
}

double prefiltered(const Replacement& r) {
  PrefilterOptions options{.size = 8};
  options.roughness = {0.0, 0.5};
  const CubemapImage good = with_texel(noise_cube(16, 1), kTexel, r.instead);
  const PrefilteredSpecular wanted = prefilter_specular(good.view(), options);
  options.pixels = r.options;
  const PrefilteredSpecular found = prefilter_specular(with_texel(noise_cube(16, 1), kTexel, r.bad).view(), options);
  return worse(rms_error(texels(found.cubemap, 0), texels(wanted.cubemap, 0)),
               rms_error(texels(found.cubemap, 1), texels(wanted.cubemap, 1)));
}

double rejections() {
  constexpr NonFinitePolicy reject = NonFinitePolicy::reject;
  const auto refused = [](float value, const ProjectionOptions& options) {
    const CubemapImage cube = with_texel(noise_cube(16, 1), kTexel, value);
    const LatLongImage lat_long = with_texel(noise_lat_long(64, 32, 1), kTexel, value);
    const std::vector<glm::dvec3> normals = spread_directions(1);
    PrefilterOptions prefilter{.size = 4};
    prefilter.roughness = {0.5};
    prefilter.pixels = options;
    return wrong_unless_thrown(ErrorCode::rejected_pixel, [&] { (void)project(cube.view(), options); }) +
           wrong_unless_thrown(ErrorCode::rejected_pixel, [&] { (void)project(lat_long.view(), options); }) +
           wrong_unless_thrown(ErrorCode::rejected_pixel, [&] { (void)prefilter_specular(cube.view(), prefilter); }) +
           wrong_unless_thrown(ErrorCode::rejected_pixel,
                               [&] { (void)direct_irradiance(cube.view(), normals, options); });
  };
  return refused(kNaN, with(reject, kReplace, NegativePolicy::keep)) +
         refused(kInfinity, with(kReplace, reject, NegativePolicy::keep)) +
         refused(-kInfinity, with(kReplace, reject, NegativePolicy::keep)) +
         refused(-1e-40F, with(kReplace, kReplace, NegativePolicy::reject));
}

/// The counts of what was replaced.
double miscounts() {
  CubemapImage map = noise_cube(16, 1);
  const auto set = [&](std::size_t first, std::size_t count, float value) {
    for (std::size_t k = first; k < first + count; ++k) map.pixels[k] = value;
  };
  set(10, 5, kNaN);
  set(400, 7, kInfinity);
  set(900, 4, -kInfinity);
  set(1300, 9, -1.0F);
  const ProjectionDiagnostics found =
      project(map.view(), with(kReplace, kReplace, NegativePolicy::replace)).diagnostics;
  return wrong_if(found.nans_replaced != 5) + wrong_if(found.infinities_replaced != 11) +
         wrong_if(found.negatives_replaced != 9);
}

double all_nan() {
  const Projection found = project(uniform_cube(16, kNaN).view());
  const LatLongImage lat_long = uniform_lat_long(32, 16, kNaN);
  return norm(found.radiance) + norm(project(lat_long.view()).radiance) +
         wrong_if(found.diagnostics.nans_replaced != 18 * 256);
}

/// NaN in alpha, four channels.
double alpha_error() {
  const CubemapImage rgb = noise_cube(16, 1);
  std::vector<float> rgba;
  for (std::size_t texel = 0; texel < rgb.pixels.size() / 3; ++texel) {
    for (std::size_t c = 0; c < 3; ++c) rgba.push_back(rgb.pixels[3 * texel + c]);
    rgba.push_back(texel % 2 == 0 ? kNaN : kInfinity);
  }
  CubemapView view{{}, 16, 0, PixelFormat::rgba_f32};
  for (std::size_t face = 0; face < 6; ++face) view.faces[face] = rgba.data() + face * 1024;
  return relative_error(project(view).radiance, project(rgb.view()).radiance);
}

}  // namespace

void add_policy_cases(StabilityCases& cases) {
  for (const Replacement& r : replacements()) {
    const auto add = [&](const std::string& where, std::function<double()> measure) {
      cases.push_back({"policies/" + std::string(r.name) + "-" + where, std::string(r.promise) + " (" + where + ")",
                       "the same map with that value in its place", StabilityUnit::relative, 1e-6,
                       [measure](const Control&) { return measure(); }});
    };
    add("cube", [r] { return projected(noise_cube(32, 2), r); });
    add("lat-long", [r] { return projected(noise_lat_long(64, 32, 2), r); });
    add("irradiance", [r] { return irradiance_of(r); });
    add("prefilter", [r] { return prefiltered(r); });
  }
  const auto count = [&](const char* name, const char* promise, double (*measure)()) {
    cases.push_back({name, promise, "the error's code, the counts", StabilityUnit::count, 0.0,
                     [measure](const Control&) { return measure(); }});
  };
  count("policies/rejected", "what a policy rejects is refused by projection, prefilter and irradiance", rejections);
  count("policies/counted", "what was replaced is counted, by kind", miscounts);
  count("policies/all-nan", "a map of NaN alone is black, and all of it counted", all_nan);
  cases.push_back({"policies/alpha", "NaN and infinity in alpha change nothing", "the same map without alpha",
                   StabilityUnit::relative, 0.0, [](const Control&) { return alpha_error(); }});
}

}  // namespace welkin::report::stability
