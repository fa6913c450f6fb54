// Hazes whose lobe is far narrower than what a solver of few bands can hold.

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "reference/sky_monte_carlo.h"
#include "reference/sky_reference.h"
#include "support/catch.h"
#include "welkin/sky.h"

namespace welkin::test {

// Promise: the sky of a haze of Henyey and Greenstein's lobe of g = 0.95 and depth 0.3 is that of paths, in the sun's
// own direction too.

namespace {

using glm::dvec3;
using std::numbers::pi;

Atmosphere haze() {
  Atmosphere air;
  air.aerosol.density = exponential_profile(2000.0);
  air.aerosol.scattering_per_m.assign(3, 0.3 / 2000.0);
  air.aerosol_phase = AerosolPhase::henyey_greenstein;
  air.aerosol_asymmetry = 0.95;
  air.solar_irradiance = {1.0, 1.0, 1.0};
  return air;
}

const SkyView& view() {
  static const SkyView made = [] {
    SkyTableOptions options;
    options.heights = 16;
    options.orders = 24;
    options.until_change = 1e-4;
    return SkyView(std::make_shared<const SkyTables>(precompute_sky(haze(), options)), 0.0);
  }();
  return made;
}

/// Radiance by `reference_sky_radiance` and, orders 2 to 20, `trace_sky_radiance` with 60 000 to 240 000 paths, seed 1:
/// up to a minute each.
struct Traced {
  double sun;      ///< degrees of elevation
  double up;       ///< the direction's
  double azimuth;  ///< degrees from the sun's
  double radiance;
  double standard_error;
};

const std::vector<Traced> kTraced{
    {45, 45, 0, 18.23, 0.0078},       {45, 48, 0, 6.348, 0.005},         {45, 51, 0, 1.677, 0.0021},
    {45, 59, 0, 0.1789, 0.00027},     {45, 65, 0, 0.06253, 0.00014},     {45, 80, 0, 0.01165, 5.9e-05},
    {45, 90, 0, 0.005615, 6.7e-06},   {45, 45, 10, 1.256, 0.0018},       {45, 45, 20, 0.2119, 0.00034},
    {45, 45, 35, 0.04471, 0.00011},   {45, 45, 70, 0.006761, 4.1e-05},   {45, 45, 120, 0.001997, 2.4e-06},
    {45, 45, 180, 0.001303, 1.7e-06}, {45, 0.5, 180, 0.003867, 1.1e-05}, {45, 2, 180, 0.004465, 1.1e-05},
    {45, 5, 180, 0.004167, 1.2e-05},  {45, 20, 180, 0.001673, 2.5e-06},  {45, 0.5, 0, 0.05828, 0.00015},
    {45, 5, 0, 0.07083, 0.00071},     {45, 20, 0, 0.08644, 0.00022},     {45, 30, 0, 0.2493, 0.00047},
    {45, 30, 40, 0.02391, 9e-05},     {45, 60, 40, 0.02518, 7.7e-05},    {45, 2, 90, 0.01028, 2.9e-05},
    {10, 10, 0, 25.03, 0.015},        {10, 11, 0, 21.25, 0.036},         {10, 13, 0, 9.684, 0.024},
    {10, 16, 0, 2.965, 0.0099},       {10, 20, 0, 0.8671, 0.0027},       {10, 24, 0, 0.3281, 0.0015},
    {10, 30, 0, 0.1054, 0.00034},     {10, 45, 0, 0.01613, 0.00012},     {10, 55, 0, 0.006877, 2.5e-05},
    {10, 10, 5, 5.66, 0.02},          {10, 10, 10, 1.636, 0.0052},       {10, 10, 20, 0.3451, 0.0011},
    {10, 10, 35, 0.08194, 0.00038},   {10, 10, 70, 0.0124, 4.8e-05},     {10, 10, 120, 0.00351, 1.2e-05},
    {10, 10, 180, 0.002269, 1e-05},   {10, 2, 180, 0.003479, 1.3e-05},   {10, 5, 180, 0.003327, 1.2e-05},
    {10, 20, 180, 0.001214, 5e-06},   {10, 2, 0, 3.647, 0.014},          {10, 5, 0, 7.071, 0.047},
    {10, 30, 40, 0.01457, 0.00011},   {10, 3, 40, 0.09178, 0.00041}};

TracedLight traced_now(const Traced& place, std::int64_t paths) {
  const dvec3 sun = sun_direction(place.sun, 0.0);
  const dvec3 direction = sun_direction(place.up, place.azimuth);
  TracedLight light =
      trace_sky_radiance(haze(), 0.0, direction, sun, {.lowest_order = 2, .highest_order = 20, .paths = paths});
  light.value[1] += reference_sky_radiance(haze(), 0.0, direction, sun, {1e-5, true})[1];
  return light;
}

/// Over the sky, of radiance times a weight of the elevation's sine: nodes closer together about the sun's azimuth.
template <class Weight>
double integral_of_radiance(const dvec3& sun, const Weight& weight) {
  constexpr int zeniths = 180;
  constexpr int azimuths = 120;
  double sum = 0.0;
  for (int i = 0; i < zeniths; ++i) {
    const double up = 90.0 * (i + 0.5) / zeniths;
    const double sine = std::sin(up * pi / 180.0);
    const double ring = 0.5 * pi / zeniths * std::sqrt(1.0 - sine * sine) * weight(sine);
    for (int k = 0; k < azimuths; ++k) {
      const double u = (k + 0.5) / azimuths;
      sum += 4.0 * pi * u / azimuths * ring * view().radiance(sun_direction(up, 180.0 * u * u), sun)[1];
    }
  }
  return sum;
}

}  // namespace

TEST_CASE("haze: radiance of a narrow lobe is that of paths to 5 % in all directions", "[sky][haze][truth]") {
  for (const Traced& place : kTraced) {
    const double found = view().radiance(sun_direction(place.up, place.azimuth), sun_direction(place.sun, 0.0))[1];
    CAPTURE(place.sun, place.up, place.azimuth, found / place.radiance, place.standard_error / place.radiance);
    CHECK(std::abs(found - place.radiance) < 0.05 * place.radiance + 2.0 * place.standard_error);
  }
}

TEST_CASE("haze: irradiance of a narrow lobe is that of paths to 1 %, and of its own radiances", "[sky][haze][truth]") {
  struct Irradiance {
    double sun, value, standard_error;
  };
  // `trace_sky_irradiance`, orders 1 to 20, 1.2 million paths
  for (const Irradiance& traced : {Irradiance{45.0, 0.23882, 0.00031}, Irradiance{10.0, 0.11845, 0.00082}}) {
    const dvec3 sun = sun_direction(traced.sun, 0.0);
    const double found = view().irradiance(sun)[1];
    CAPTURE(traced.sun, found / traced.value);
    CHECK(std::abs(found - traced.value) < 0.01 * traced.value + 2.0 * traced.standard_error);
    const double sum = integral_of_radiance(sun, [](double sine) { return sine; });
    CAPTURE(sum / found);
    CHECK(std::abs(sum / found - 1.0) < 0.015);
  }
}

TEST_CASE("haze: the recorded paths are those of the oracle", "[sky][haze][truth]") {
  for (const std::size_t k : {std::size_t{1}, std::size_t{9}}) {
    const TracedLight now = traced_now(kTraced[k], 4'000);
    CAPTURE(k, now.value[1] / kTraced[k].radiance, now.standard_error[1] / now.value[1]);
    CHECK(std::abs(now.value[1] - kTraced[k].radiance) < 3.0 * now.standard_error[1] + 3.0 * kTraced[k].standard_error);
  }
}

TEST_CASE("haze: harmonics of a narrow lobe hold the mean of its radiance to 1.5 %", "[sky][haze][truth]") {
  const SkyProjector projector(view());
  for (const double elevation : {90.0, 75.0, 60.0, 45.0, 30.0, 20.0, 10.0, 4.0}) {
    const dvec3 sun = sun_direction(elevation, 0.0);
    const double mean = projector.project(sun).coefficients()[0].y * std::sqrt(4.0 * pi);
    const double integral = integral_of_radiance(sun, [](double) { return 1.0; });
    CAPTURE(elevation, mean / integral);
    CHECK(std::abs(mean / integral - 1.0) < 0.015);
  }
}

}  // namespace welkin::test
