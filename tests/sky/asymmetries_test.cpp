// Aerosols whose lobe differs from wavelength to wavelength, and the blue aureole that it gives Mars.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

#include "reference/sky_monte_carlo.h"
#include "reference/sky_reference.h"
#include "sky/sky_projection.h"
#include "sky/sky_tables_for_tests.h"
#include "sky/vertical_harmonics.h"
#include "support/catch.h"
#include "welkin/sky.h"

namespace welkin::test {

// Promise: a table of wavelengths with lobes of their own has in each the light of an atmosphere that has that one
// lobe.

namespace {

using glm::dvec3;

const std::vector<double> kAsymmetries{0.2, 0.55, 0.78};

Atmosphere haze(AerosolPhase phase = AerosolPhase::henyey_greenstein) {
  Atmosphere air = with_aerosol(earth(), {.optical_depth = 0.4});
  air.aerosol_phase = phase;
  air.aerosol_asymmetries = kAsymmetries;
  return air;
}

Atmosphere with_one(Atmosphere air, double asymmetry) {
  air.aerosol_asymmetries.clear();
  air.aerosol_asymmetry = asymmetry;
  return air;
}

std::shared_ptr<const SkyTables> tables_of(const Atmosphere& air, int orders) {
  SkyTableOptions options;
  options.heights = 12;
  options.view_zeniths = 32;
  options.sun_zeniths = 24;
  options.orders = orders;
  return std::make_shared<const SkyTables>(precompute_sky(air, options));
}

const std::vector<double> kElevations{60.0, 20.0, 5.0, 0.0, -4.0};

/// The largest difference of a channel between two views, as a share of what the second sees.
double largest_difference(const SkyView& found, const SkyView& wanted, int channel) {
  double worst = 0.0;
  for (const double elevation : kElevations) {
    const dvec3 sun = sun_direction(elevation, 0.0);
    for (const double up : {1.0, 10.0, 30.0, 60.0, 90.0}) {
      for (const double azimuth : {0.0, 5.0, 60.0, 180.0}) {
        const dvec3 direction = sun_direction(up, azimuth);
        const double truth = wanted.radiance(direction, sun)[channel];
        worst = std::max(worst, std::abs(found.radiance(direction, sun)[channel] - truth) / truth);
      }
    }
  }
  return worst;
}

double largest_harmonic_difference(const SkyView& found, const SkyView& wanted, int channel) {
  const SkyProjector first(found);
  const SkyProjector second(wanted);
  double worst = 0.0;
  for (const double elevation : kElevations) {
    const SphericalHarmonics a = first.project(sun_direction(elevation, 40.0));
    const SphericalHarmonics b = second.project(sun_direction(elevation, 40.0));
    for (std::size_t k = 0; k < a.coefficients().size(); ++k) {
      const double difference = std::abs(a.coefficients()[k][channel] - b.coefficients()[k][channel]);
      worst = std::max(worst, difference / b.coefficients()[0][channel]);
    }
  }
  return worst;
}

}  // namespace

TEST_CASE("asymmetries: the same at all wavelengths is the bits of one", "[sky][asymmetries]") {
  Atmosphere all = with_one(haze(), 0.7);
  const std::shared_ptr<const SkyTables> wanted = small_tables(all);
  all.aerosol_asymmetries.assign(3, 0.7);
  all.aerosol_asymmetry = 0.1;
  const std::shared_ptr<const SkyTables> found = small_tables(all);
  CHECK(found->scattering == wanted->scattering);
  CHECK(found->single_mie == wanted->single_mie);
  CHECK(found->irradiance == wanted->irradiance);
  const dvec3 sun = sun_direction(12.0, 30.0);
  const dvec3 direction = sun_direction(25.0, 50.0);
  CHECK(SkyView(found, 100.0).radiance(direction, sun) == SkyView(wanted, 100.0).radiance(direction, sun));
  const SphericalHarmonics wanted_light = SkyProjector(SkyView(wanted, 100.0)).project(sun);
  const SphericalHarmonics found_light = SkyProjector(SkyView(found, 100.0)).project(sun);
  CHECK(std::ranges::equal(found_light.coefficients(), wanted_light.coefficients()));
}

// Wavelengths share the places where rays are cut and the brightness that they are read by between suns, which leaves
// 0.2 % on the light of one order, and on that of four what nodes so few leave undetermined.
TEST_CASE("asymmetries: each wavelength has the sky of its own", "[sky][asymmetries][truth]") {
  for (const AerosolPhase phase : {AerosolPhase::henyey_greenstein, AerosolPhase::cornette_shanks}) {
    for (const int orders : {1, 4}) {
      const SkyView all(tables_of(haze(phase), orders), 0.0);
      for (int c = 0; c < 3; ++c) {
        const Atmosphere one = with_one(haze(phase), kAsymmetries[static_cast<std::size_t>(c)]);
        const SkyView wanted(tables_of(one, orders), 0.0);
        CAPTURE(static_cast<int>(phase), orders, c);
        CHECK(largest_difference(all, wanted, c) < (orders == 1 ? 2e-3 : 2.5e-2));
        CHECK(largest_harmonic_difference(all, wanted, c) < (orders == 1 ? 1e-3 : 3e-3));
      }
    }
  }
}

TEST_CASE("asymmetries: kernels agree with their twin in double, also where some scatter back", "[sky][asymmetries]") {
  for (const std::vector<double>& asymmetries :
       {std::vector<double>{0.3, 0.7, 0.84}, std::vector<double>{-0.7, 0.2, 0.8},
        std::vector<double>{-0.2, -0.5, -0.8}}) {
    Atmosphere air = haze();
    air.aerosol_asymmetries = asymmetries;
    const SkyView view(small_tables(air), 0.0);
    const sky::SkyProjection projection(view, {.bands = 4});
    const dvec3 sun = sun_direction(25.0, 0.0);
    const sky::SunAngles angles = sky::sun_angles(sun);
    std::vector<dvec3> found(sky::even_count(4));
    std::vector<dvec3> plain(sky::even_count(4));
    projection.project(angles, found);
    projection.project_plainly(angles, plain);
    for (std::size_t k = 0; k < found.size(); ++k) {
      for (int c = 0; c < 3; ++c) {
        CAPTURE(asymmetries[0], k, c);
        CHECK(std::abs(found[k][c] - plain[k][c]) < 2e-5 * plain[0][c]);
      }
    }
  }
}

TEST_CASE("asymmetries: light scattered once and often is that of paths", "[sky][asymmetries][truth]") {
  const SkyView view(std::make_shared<const SkyTables>(precompute_sky(haze(), {.exact_orders = true})), 0.0);
  const dvec3 sun = sun_direction(30.0, 0.0);
  for (const dvec3& direction : {sun, sun_direction(36.0, 3.0), sun_direction(12.0, 120.0), sun_direction(90.0, 0.0)}) {
    const std::vector<double> once = reference_sky_radiance(haze(), 0.0, direction, sun, {1e-5, true});
    const TracedLight often =
        trace_sky_radiance(haze(), 0.0, direction, sun, {.lowest_order = 2, .highest_order = 4, .paths = 12'000});
    const dvec3 found = view.radiance(direction, sun);
    for (int c = 0; c < 3; ++c) {
      const auto k = static_cast<std::size_t>(c);
      const double truth = once[k] + often.value[k];
      CAPTURE(direction.y, c, found[c] / truth, often.standard_error[k] / truth);
      CHECK(std::abs(found[c] - truth) < 0.02 * truth + 2.5 * often.standard_error[k]);
    }
  }
}

TEST_CASE("asymmetries: folded channels have the mean of their wavelengths", "[sky][asymmetries][truth]") {
  std::vector<double> wavelengths;
  for (int i = 0; i < 15; ++i) wavelengths.push_back(400.0 + 20.0 * i);
  Atmosphere air = with_aerosol(earth(wavelengths), {.optical_depth = 0.4});
  for (int i = 0; i < 15; ++i) air.aerosol_asymmetries.push_back(0.85 - 0.015 * i);
  const sky::ColourFold fold(air, SkyColour::linear_srgb);
  CHECK(fold.asymmetries()[2] > fold.asymmetries()[1] + 0.02);
  CHECK(fold.asymmetries()[1] > fold.asymmetries()[0] + 0.02);
  const SkyView view(small_tables(air, ScatteringLayout::full, SkyColour::linear_srgb), 0.0);
  const dvec3 sun = sun_direction(30.0, 0.0);
  const dvec3 near = view.radiance(sun_direction(32.0, 0.0), sun);
  const SkyView grey(small_tables(with_one(air, 0.745), ScatteringLayout::full, SkyColour::linear_srgb), 0.0);
  const dvec3 before = grey.radiance(sun_direction(32.0, 0.0), sun);
  CHECK(near.z / near.x > 1.2 * before.z / before.x);
}

// Promise: dust whose lobe is narrower in blue makes the sky about a low sun bluer than sunlight, and far from it
// redder.
TEST_CASE("Mars has a blue aureole", "[sky][planets][asymmetries]") {
  const Atmosphere air = mars();
  const SkyView view(tables_of(air, 6), 0.0);
  const double sunlight = air.solar_irradiance[2] / air.solar_irradiance[0];
  for (const double elevation : {3.0, 5.0, 10.0}) {
    const dvec3 sun = sun_direction(elevation, 0.0);
    const auto blue_over_red = [&](const dvec3& direction) {
      const dvec3 radiance = view.radiance(direction, sun);
      return radiance.z / radiance.x / sunlight;
    };
    for (const double off : {0.0, 1.0, 3.0, 5.0}) {
      CAPTURE(elevation, off);
      CHECK(blue_over_red(sun_direction(elevation + off, 0.0)) > 1.2);
    }
    CHECK(blue_over_red(sun_direction(elevation + 40.0, 0.0)) < 0.8);
    CHECK(blue_over_red(sun_direction(elevation, 180.0)) < 0.8);
  }
}

}  // namespace welkin::test
