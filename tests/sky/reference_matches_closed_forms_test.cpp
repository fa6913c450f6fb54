// The truth about single scattering is what can be written down, where it can.
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <vector>

#include "sky/density.h"
#include "sky/phase_functions.h"
#include "support/catch.h"
#include "support/random_atmospheres.h"
#include "support/thrown_error.h"
#include "welkin/sky_reference.h"

namespace welkin {
namespace {

/// Homogeneous air that scatters evenly, over a ground so large that it is flat.
Atmosphere slab(double thickness, std::vector<double> scattering, std::vector<double> absorption) {
  Atmosphere air;
  air.bottom_radius_m = 1e9;
  air.top_radius_m = 1e9 + thickness;
  air.aerosol = {{{.constant_term = 1.0}}, std::move(scattering), std::move(absorption)};
  air.aerosol_phase = AerosolPhase::henyey_greenstein;
  air.aerosol_asymmetry = 0.0;
  air.ground_albedo = {0.1, 0.5, 1.0};
  air.solar_irradiance = {1.0, 2.0, 3.0};
  air.sun_angular_radius_degrees = 0.0;
  return air;
}

}  // namespace

TEST_CASE("sky reference: without air all is black but the ground and the sun", "[sky][air]") {
  Atmosphere nothing = earth();
  nothing.rayleigh = {};
  nothing.aerosol = {};
  nothing.absorbers.clear();
  for (const double altitude : {0.0, 1000.0, 1e7}) {
    for (const glm::dvec3& up : {glm::dvec3(0.0, 1.0, 0.0), glm::dvec3(0.6, 0.8, 0.0)}) {
      CHECK(reference_sky_radiance(nothing, altitude, up, sun_direction(30.0, 0.0)) == std::vector<double>(3, 0.0));
    }
    const glm::dvec3 down(0.0, -1.0, 0.0);
    const std::vector<double> ground = reference_sky_radiance(nothing, altitude, down, sun_direction(30.0, 0.0));
    CHECK(reference_sky_radiance(nothing, altitude, down, sun_direction(30.0, 0.0), {.ground = false})[0] == 0.0);
    for (std::size_t i = 0; i < 3; ++i) {
      CHECK(ground[i] == Approx(0.1 / std::numbers::pi * 0.5 * nothing.solar_irradiance[i]).epsilon(1e-12));
    }
    CHECK(reference_transmittance(nothing, altitude, 0.3) == std::vector<double>(3, 1.0));
    CHECK(reference_transmittance(nothing, altitude, -1.0) == std::vector<double>(3, 0.0));
    CHECK(reference_sun_irradiance(nothing, altitude, sun_direction(30.0, 7.0)) == nothing.solar_irradiance);
  }
}

TEST_CASE("sky reference: a homogeneous slab is the integral of its exponentials", "[sky][air]") {
  constexpr double thickness = 10.0;
  const std::vector<double> scattering{1e-5, 0.02, 0.3};
  const std::vector<double> absorption{0.0, 0.01, 0.2};
  const Atmosphere air = slab(thickness, scattering, absorption);
  for (const double sun_elevation : {90.0, 50.0, 12.0}) {
    for (const double view_elevation : {85.0, 40.0, 11.0}) {
      INFO("sun " << sun_elevation << ", view " << view_elevation);
      const double mu_s = std::sin(sun_elevation * std::numbers::pi / 180.0);
      const double mu = std::sin(view_elevation * std::numbers::pi / 180.0);
      const std::vector<double> up =
          reference_sky_radiance(air, 0.0, sun_direction(view_elevation, 77.0), sun_direction(sun_elevation, 0.0));
      const std::vector<double> down = reference_sky_radiance(air, thickness, -sun_direction(view_elevation, 77.0),
                                                              sun_direction(sun_elevation, 0.0));
      for (std::size_t i = 0; i < 3; ++i) {
        const double extinction = scattering[i] + absorption[i];
        const double depth = extinction * thickness;
        const double source = air.solar_irradiance[i] / (4.0 * std::numbers::pi) * scattering[i] / extinction;
        const double slope = 1.0 / mu - 1.0 / mu_s;
        // (The ground's curvature bends the lowest rays by 1e-6.)
        CHECK(up[i] == Approx(source / mu * std::exp(-depth / mu) * std::expm1(depth * slope) / slope).epsilon(3e-6));
        const double both = 1.0 / mu + 1.0 / mu_s;
        const double ground = air.ground_albedo[i] / std::numbers::pi * mu_s * air.solar_irradiance[i];
        CHECK(down[i] ==
              Approx(-source / mu * std::expm1(-depth * both) / both + ground * std::exp(-depth * both)).epsilon(1e-6));
      }
    }
  }
}

TEST_CASE("sky reference: light goes both ways alike", "[sky][air]") {
  // Over flat ground, radiance over the sine of the sun's elevation is the same with eye and sun exchanged.
  Atmosphere air = earth();
  air.bottom_radius_m = 1e9;
  air.top_radius_m = 1e9 + 60.0;
  air.rayleigh.density = exponential_profile(8.0);
  air.aerosol.density = exponential_profile(1.2);
  air.absorbers[0].density = tent_profile(25.0, 15.0);
  for (Constituent* matter : {&air.rayleigh, &air.aerosol, &air.absorbers[0]}) {
    for (double& value : matter->scattering_per_m) value *= 1000.0;
    for (double& value : matter->absorption_per_m) value *= 1000.0;
  }
  for (const double a : {80.0, 40.0, 10.0}) {
    for (const double b : {60.0, 25.0, 12.0}) {
      const glm::dvec3 first = sun_direction(a, 20.0);
      const glm::dvec3 second = sun_direction(b, 110.0);
      const std::vector<double> there = reference_sky_radiance(air, 60.0, -first, second);
      const std::vector<double> back = reference_sky_radiance(air, 60.0, -second, first);
      for (std::size_t i = 0; i < 3; ++i) CHECK(there[i] / second.y == Approx(back[i] / first.y).epsilon(1e-5));
    }
  }
}

TEST_CASE("sky reference: optical depths are Chapman's", "[sky][air]") {
  // Exponential air over a ball of 20 scale heights, thick enough that its end does not count: along the horizon
  // R exp(x) K1(x), x = R / H (Chapman 1931); upwards H.
  Atmosphere air = earth();
  air.bottom_radius_m = 1000.0;
  air.top_radius_m = 11'000.0;
  constexpr double scale_height = 50.0;
  air.rayleigh = {exponential_profile(scale_height), {1e-5, 1e-3, 1e-2}, {}};
  air.aerosol = {};
  air.absorbers.clear();
  const double x = 1000.0 / scale_height;
  const double across = 1000.0 * std::exp(x) * std::cyl_bessel_k(1.0, x);
  for (std::size_t i = 0; i < 3; ++i) {
    const double coefficient = air.rayleigh.scattering_per_m[i];
    CHECK(-std::log(reference_transmittance(air, 0.0, 0.0)[i]) == Approx(coefficient * across).epsilon(2e-9));
    CHECK(-std::log(reference_transmittance(air, 0.0, 1.0)[i]) == Approx(coefficient * scale_height).epsilon(2e-9));
    CHECK(-std::log(reference_transmittance(air, 100.0, 1.0)[i]) ==
          Approx(coefficient * scale_height * std::exp(-2.0)).epsilon(2e-9));
  }
  // A ray down to its lowest point and up again, from inside and from space.
  const double radius = 1500.0;
  const double cosine = -std::sqrt(1.0 - 1000.0 * 1000.0 / (radius * radius)) * (1.0 - 1e-9);
  const double inward = -std::log(reference_transmittance(air, 500.0, cosine)[2]);
  const double outward = -std::log(reference_transmittance(air, 500.0, -cosine)[2]);
  CHECK(inward + outward == Approx(1e-2 * 2.0 * across).epsilon(1e-6));
  const double far = 50'000.0;
  const double far_cosine = -std::sqrt(1.0 - 1000.0 * 1000.0 / (far * far)) * (1.0 - 1e-12);
  CHECK(-std::log(reference_transmittance(air, far - 1000.0, far_cosine)[2]) ==
        Approx(1e-2 * 2.0 * across).epsilon(1e-4));
}

TEST_CASE("sky reference: a thin shell of scale height 10 m is not missed in ten radii of air", "[sky][air]") {
  Atmosphere air = without_aerosol(earth());
  air.bottom_radius_m = 1e9;
  air.top_radius_m = 1.1e10;
  air.absorbers.clear();
  for (const double scale_height : {10.0, 1e5}) {
    air.rayleigh.density = exponential_profile(scale_height);
    for (std::size_t i = 0; i < 3; ++i) {
      const double expected = scale_height * air.rayleigh.scattering_per_m[i];
      CHECK(-std::log(reference_transmittance(air, 0.0, 1.0)[i]) == Approx(expected).epsilon(1e-9));
      const double across = expected * std::sqrt(0.5 * std::numbers::pi * 1e9 / scale_height);
      CHECK(-std::log(reference_transmittance(air, 0.0, 0.0)[i]) == Approx(across).epsilon(1e-4));
    }
  }
}

TEST_CASE("sky reference: it is what plain marching tends to", "[sky][air]") {
  for (const Atmosphere& air : {earth(), mars()}) {
    for (const double sun_elevation : {40.0, 1.0, -4.0}) {
      for (const double view_elevation : {90.0, 20.0, 2.0}) {
        INFO(air.name << ", sun " << sun_elevation << ", view " << view_elevation);
        const glm::dvec3 sun = sun_direction(sun_elevation, 0.0);
        const glm::dvec3 view = sun_direction(view_elevation, 50.0);
        const double radius = air.bottom_radius_m;
        const double top = air.top_radius_m;
        const double length =
            std::sqrt(radius * radius * view.y * view.y + top * top - radius * radius) - radius * view.y;
        const double nu = glm::dot(view, sun);
        constexpr int steps = 4000;
        std::vector<double> sum(3);
        std::vector<double> depth(3);
        for (int k = 0; k < steps; ++k) {
          // Steps grow with the distance: s = length u^2.
          const double u = (k + 0.5) / steps;
          const double s = length * u * u;
          const double step = 2.0 * length * u / steps;
          const glm::dvec3 place = glm::dvec3(0.0, radius, 0.0) + s * view;
          const double r = glm::length(place);
          const double h = r - radius;
          const glm::dvec3 up = place / r;
          const double elevation_of_sun = std::asin(glm::dot(up, sun)) * 180.0 / std::numbers::pi;
          const glm::dvec3 local = sun_direction(elevation_of_sun, 0.0);
          const std::vector<double> light = reference_sun_irradiance(air, std::max(h, 0.0), local);
          const double phase_r = sky::rayleigh_phase(nu);
          const double phase_m = sky::aerosol_phase(air.aerosol_phase, air.aerosol_asymmetry, nu);
          const double density_r = sky::density(air.rayleigh.density, h);
          const double density_m = sky::density(air.aerosol.density, h);
          for (std::size_t i = 0; i < 3; ++i) {
            double extinction = density_r * air.rayleigh.scattering_per_m[i] +
                                density_m * (air.aerosol.scattering_per_m[i] + air.aerosol.absorption_per_m[i]);
            for (const Constituent& c : air.absorbers) extinction += sky::density(c.density, h) * c.absorption_per_m[i];
            depth[i] += 0.5 * step * extinction;
            sum[i] += step * std::exp(-depth[i]) * light[i] *
                      (phase_r * density_r * air.rayleigh.scattering_per_m[i] +
                       phase_m * density_m * air.aerosol.scattering_per_m[i]);
            depth[i] += 0.5 * step * extinction;
          }
        }
        const std::vector<double> truth = reference_sky_radiance(air, 0.0, view, sun);
        for (std::size_t i = 0; i < 3; ++i) CHECK(truth[i] == Approx(sum[i]).epsilon(3e-4));
      }
    }
  }
}

TEST_CASE("sky reference: refining changes it by no more than was asked", "[sky][air]") {
  const Atmosphere air = earth();
  for (const double altitude : {0.0, 8000.0, 500'000.0}) {
    for (const double elevation : {-75.0, -8.0, -1.0, 0.0, 0.05, 30.0}) {
      for (const double sun : {60.0, 0.1, -3.0, -12.0}) {
        INFO("altitude " << altitude << ", view " << elevation << ", sun " << sun);
        const auto at = [&](double error) {
          return reference_sky_radiance(air, altitude, sun_direction(elevation, 5.0), sun_direction(sun, 0.0),
                                        {.relative_error = error});
        };
        const std::vector<double> fine = at(1e-9);
        const std::vector<double> rough = at(1e-4);
        for (std::size_t i = 0; i < 3; ++i) CHECK(rough[i] == Approx(fine[i]).epsilon(1e-4).margin(1e-200));
      }
    }
  }
}

TEST_CASE("sky reference: the sun sets softly, and at once if it is a point", "[sky][air]") {
  const Atmosphere air = earth();
  const double radius = air.sun_angular_radius_degrees;
  const auto level = reference_transmittance(air, 0.0, 0.0);
  const auto light = [&](const Atmosphere& a, double elevation) {
    return reference_sun_irradiance(a, 0.0, sun_direction(elevation, 0.0))[0];
  };
  CHECK(light(air, 0.0) == Approx(0.5 * level[0] * air.solar_irradiance[0]).epsilon(1e-9));
  CHECK(light(air, -1.01 * radius) == 0.0);
  CHECK(light(air, -0.5 * radius) == Approx(level[0] * 0.15625 * air.solar_irradiance[0]).epsilon(1e-4));
  CHECK(light(air, 3.0 * radius) ==
        Approx(reference_transmittance(air, 0.0, sun_direction(3.0 * radius, 0.0).y)[0] * air.solar_irradiance[0]));
  Atmosphere point = air;
  point.sun_angular_radius_degrees = 0.0;
  CHECK(light(point, 1e-9) == Approx(level[0] * air.solar_irradiance[0]).epsilon(1e-6));
  CHECK(light(point, -1e-9) == 0.0);
  // From space: past the air whole, behind the planet dark.
  CHECK(reference_sun_irradiance(air, 1e7, sun_direction(-40.0, 0.0)) == air.solar_irradiance);
  CHECK(reference_sun_irradiance(air, 1e7, sun_direction(-80.0, 0.0))[1] == 0.0);
}

TEST_CASE("sky reference: what is asked for is checked", "[sky][air]") {
  const glm::dvec3 up(0.0, 1.0, 0.0);
  Atmosphere wrong = earth();
  wrong.aerosol_asymmetry = 2.0;
  CHECK(test::thrown_by([&] { return reference_sky_radiance(wrong, 0.0, up, up); }).says("aerosol_asymmetry"));
  CHECK(test::thrown_by([&] { return reference_transmittance(wrong, 0.0, 1.0); }).says("aerosol_asymmetry"));
  CHECK(test::thrown_by([&] { return reference_sky_radiance(earth(), -1.0, up, up); }).says("altitude is -1"));
  CHECK(test::thrown_by([&] { return reference_sky_radiance(earth(), NAN, up, up); }).says("altitude"));
  CHECK(test::thrown_by([&] { return reference_sky_radiance(earth(), 0.0, 2.0 * up, up); }).says("direction"));
  CHECK(test::thrown_by([&] { return reference_sky_radiance(earth(), 0.0, up, {NAN, 0, 0}); }).says("sun"));
  CHECK(test::thrown_by([&] {
          return reference_sky_radiance(earth(), 0.0, up, up, {.relative_error = 0.0});
        }).says("relative error"));
  CHECK(test::thrown_by([&] { return reference_transmittance(earth(), 0.0, 1.1); }).says("zenith cosine"));
  CHECK(test::thrown_by([&] { return reference_sun_irradiance(earth(), 2e9, up); }).says("altitude"));
}

TEST_CASE("sky reference: random atmospheres give finite light that is not negative", "[sky][air]") {
  test::RandomAtmospheres random(3);
  for (int i = 0; i < test::trials(150); ++i) {
    const Atmosphere air = random.next();
    const double thickness = air.top_radius_m - air.bottom_radius_m;
    const double altitude = std::min(1e9, random.chance(0.3) ? 0.0 : random.between(0.0, 1.3) * thickness);
    const glm::dvec3 view =
        sun_direction(random.chance(0.3) ? 0.0 : random.between(-90.0, 90.0), random.between(0.0, 360.0));
    const glm::dvec3 sun = sun_direction(random.between(-30.0, 90.0), 0.0);
    INFO("atmosphere " << i << ", altitude " << altitude << " of " << thickness);
    const std::vector<double> light = reference_sky_radiance(air, altitude, view, sun, {.relative_error = 1e-3});
    const std::vector<double> transmittance = reference_transmittance(air, altitude, view.y);
    const std::vector<double> direct = reference_sun_irradiance(air, altitude, sun);
    for (std::size_t k = 0; k < light.size(); ++k) {
      CHECK((std::isfinite(light[k]) && light[k] >= 0.0));
      CHECK((transmittance[k] >= 0.0 && transmittance[k] <= 1.0));
      CHECK((direct[k] >= 0.0 && direct[k] <= air.solar_irradiance[k]));
    }
  }
}

}  // namespace welkin
