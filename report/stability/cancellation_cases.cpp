// Cancellation: sums whose terms are large and whose result is small.
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "report/stability/cases.h"
#include "report/stability/maps.h"
#include "report/stability/measures.h"
#include "welkin/directional_light.h"
#include "welkin/irradiance.h"
#include "welkin/projection.h"

namespace welkin::report::stability {
namespace {

constexpr double kProjectionError = 5e-7;       ///< projection.h, of the whole vector
constexpr double kSphere = 3.5449077018110318;  ///< sqrt(4 pi): band 0 of 1 everywhere

ProjectionOptions bands(int count) {
  ProjectionOptions options;
  options.bands = count;
  return options;
}

/// What is above band 0, over band 0.
double leak(const SphericalHarmonics& c) { return norm(c, 1) / glm::length(c.at(0, 0)); }

double uniform_leak(int size, int band_count) {
  return leak(project(uniform_cube(size, 1.0F).view(), bands(band_count)).radiance);
}

double uniform_lat_long_leak(int height, int band_count) {
  return leak(project(uniform_lat_long(2 * height, height, 1.0F).view(), bands(band_count)).radiance);
}

/// 1 + amplitude * noise, which is a map of floats like any other: truth and result read the same ones.
CubemapImage nearly_uniform(int size, float amplitude) {
  CubemapImage map = noise_cube(size, 5);
  for (float& value : map.pixels) value = 1.0F + amplitude * value;
  return map;
}

/// Bands above the first against their own size.
double upper_band_error(float amplitude) {
  const CubemapImage map = nearly_uniform(32, amplitude);
  return relative_error(project(map.view()).radiance, reference_projection(map.view()), 1);
}

/// Error over what the map's magnitude projects to.
template <class Image>
double checkerboard_error(const Image& map, double amplitude) {
  return distance(project(map.view()).radiance, reference_projection(map.view())) /
         (std::sqrt(3.0) * kSphere * amplitude);
}

/// Normals of a board's irradiance against that of the map read in mirrored order: E(map) + E(-map) = 0.
double checkerboard_irradiance() {
  const CubemapImage plus = checkerboard_cube(33, 1.0F);
  const CubemapImage minus = checkerboard_cube(33, -1.0F);
  double worst = 0.0;
  for (const glm::dvec3& normal : spread_directions(20)) {
    const glm::dvec3 sum = reference_irradiance(plus.view(), normal) + reference_irradiance(minus.view(), normal);
    worst = worse(worst, std::abs(sum.x) / std::numbers::pi);
  }
  return worst;
}

double directions_from_nothing() {
  double wrong = 0.0;
  for (const int size : {1, 2, 3, 16, 31, 64, 128}) {
    wrong += wrong_if(dominant_light(project(uniform_cube(size, 0.7F).view()).radiance).has_value());
    wrong += wrong_if(dominant_light(project(uniform_lat_long(2 * size, size, 0.7F).view()).radiance).has_value());
  }
  return wrong;
}

void add_uniform(StabilityCases& cases) {
  for (const int size : {1, 2, 7, 64, 257}) {
    cases.push_back(
        {"cancellation/uniform-cube-" + std::to_string(size),
         "a uniform cubemap of " + std::to_string(size) + " has nothing above band 0 (3 bands), over band 0",
         "closed form: 0", StabilityUnit::relative, 2e-7, [size](const Control&) { return uniform_leak(size, 3); }});
  }
  cases.push_back({"cancellation/uniform-cube-64-bands-16", "the same with 16 bands, face size 64", "closed form: 0",
                   StabilityUnit::relative, 1e-6, [](const Control&) { return uniform_leak(64, 16); }});
  cases.push_back({"cancellation/uniform-lat-long-128", "a uniform lat-long of 256 x 128, 3 bands, over band 0",
                   "closed form: 0", StabilityUnit::relative, 2e-7,
                   [](const Control&) { return uniform_lat_long_leak(128, 3); }});
  cases.push_back({"cancellation/uniform-lat-long-128-bands-16", "the same with 16 bands", "closed form: 0",
                   StabilityUnit::relative, 1e-6, [](const Control&) { return uniform_lat_long_leak(128, 16); }});
  cases.push_back({"cancellation/no-direction-from-rounding",
                   "dominant_light finds no light in uniform maps of any size: rounding is no direction",
                   "there is none", StabilityUnit::count, 0.0,
                   [](const Control&) { return directions_from_nothing(); }});
}

void add_nearly_uniform(StabilityCases& cases) {
  const std::string advice =
      "Rounding leaves some 1e-7 of band 0 in every band. Below that bands have no digits of their own: treat l > 0 as "
      "zero under 1e-6 of band 0 (dominant_light does), or subtract the mean from the map before projecting.";
  const auto add = [&](const char* text, float amplitude, const std::string& remedy) {
    cases.push_back({std::string("cancellation/nearly-uniform-") + text,
                     "bands 1 and 2 of 1 + " + std::string(text) + " x noise are right to 1 % of themselves",
                     "reference_projection (double)", StabilityUnit::relative, 1e-2,
                     [amplitude](const Control&) { return upper_band_error(amplitude); }, remedy});
  };
  add("1e-1", 1e-1F, "");
  add("1e-2", 1e-2F, "");
  add("1e-3", 1e-3F, "");
  add("1e-6", 1e-6F, advice);
}

void add_boards(StabilityCases& cases) {
  for (const int size : {2, 3, 32, 63}) {
    cases.push_back(
        {"cancellation/checkerboard-cube-" + std::to_string(size),
         "+1 and -1 by turns, face size " + std::to_string(size) + ": error over the light of its magnitude",
         "reference_projection (double)", StabilityUnit::relative, kProjectionError,
         [size](const Control&) { return checkerboard_error(checkerboard_cube(size, 1.0F), 1.0); }});
  }
  cases.push_back({"cancellation/checkerboard-lat-long-64x32", "the same on a lat-long of 64 x 32",
                   "reference_projection (double)", StabilityUnit::relative, kProjectionError,
                   [](const Control&) { return checkerboard_error(checkerboard_lat_long(64, 32, 1.0F), 1.0); }});
  cases.push_back({"cancellation/checkerboard-1e38", "+1e38 and -1e38 by turns: no infinities meet",
                   "reference_projection (double)", StabilityUnit::relative, kProjectionError,
                   [](const Control&) { return checkerboard_error(checkerboard_cube(32, 1e38F), 1e38F); }});
  cases.push_back({"cancellation/checkerboard-irradiance",
                   "direct irradiance of a board and of its negative add up to nothing, over pi", "closed form: 0",
                   StabilityUnit::relative, 1e-12, [](const Control&) { return checkerboard_irradiance(); }});
}

}  // namespace

void add_cancellation_cases(StabilityCases& cases) {
  add_uniform(cases);
  add_nearly_uniform(cases);
  add_boards(cases);
}

}  // namespace welkin::report::stability
