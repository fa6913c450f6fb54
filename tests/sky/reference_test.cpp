// The references that skies are held to: a Monte Carlo and closed forms.
#include "reference/reference_air.h"
#include "reference/sky_monte_carlo.h"
#include "reference/sky_reference.h"
#include "sky/air.h"
#include "support/catch.h"
#include "support/random_atmospheres.h"
#include "welkin/core.h"

namespace welkin::test {

// The Monte Carlo estimates what the quadrature says of light that is scattered once. (Its further orders are held
// against tables, which are held to programs of others.)

TEST_CASE("sky paths: first orders are the quadrature of the single-scattering truth", "[sky][air][truth]") {
  Atmosphere hazy = mars();
  hazy.aerosol_phase = AerosolPhase::cornette_shanks;
  hazy.aerosol_asymmetry = -0.4;
  hazy.aerosol_asymmetries.clear();
  Atmosphere tiny = earth_bruneton();
  tiny.bottom_radius_m = 100.0;
  tiny.top_radius_m = 190.0;
  tiny.rayleigh = {exponential_profile(20.0), {0.01, 0.02, 0.05}, {}};
  tiny.aerosol = {tent_profile(30.0, 20.0), {0.02, 0.01, 0.005}, {0.0, 0.01, 0.02}};
  tiny.absorbers.clear();
  struct Planet {
    Atmosphere air;
    std::int64_t paths;
    double noise;   ///< bound of the standard error, relative to the reference
    double errors;  ///< how many standard errors an estimate may be off
  };
  struct View {
    double height;  ///< share of the air's thickness
    double up, sun;
  };
  for (const Planet& planet : {Planet{with_ground_albedo(earth_bruneton(), 0.5), 40'000, 0.02, 3.5},
                               Planet{hazy, 10'000, 0.05, 4.5}, Planet{tiny, 10'000, 0.05, 4.5}}) {
    for (const View& view :
         {View{0.0, 20.0, 40.0}, View{0.0, 20.0, 0.0}, View{0.0, 20.0, -6.0}, View{0.1, -30.0, 40.0}}) {
      const double altitude = view.height * (planet.air.top_radius_m - planet.air.bottom_radius_m);
      const glm::dvec3 sun = sun_direction(view.sun, 0.0);
      const glm::dvec3 direction = sun_direction(view.up, 30.0);
      const TracedLight traced = trace_sky_radiance(planet.air, altitude, direction, sun,
                                                    {.lowest_order = 1, .highest_order = 1, .paths = planet.paths});
      const std::vector<double> truth = reference_sky_radiance(planet.air, altitude, direction, sun, {1e-5, true});
      for (std::size_t c = 0; c < 3; ++c) {
        CAPTURE(planet.air.bottom_radius_m, view.up, view.sun, c, traced.value[c] / truth[c],
                traced.standard_error[c] / truth[c]);
        CHECK(traced.standard_error[c] > 0.0);
        CHECK(traced.standard_error[c] < planet.noise * truth[c]);
        CHECK(std::abs(traced.value[c] - truth[c]) < planet.errors * traced.standard_error[c]);
      }
    }
  }
}

TEST_CASE("sky paths: sums over shells are the quadrature's", "[sky][air]") {
  RandomAtmospheres random(23);
  for (int i = 0; i < trials(60); ++i) {
    const sky::ReferenceAir air(random.next());
    const sky::PathShells shells(air);
    INFO("atmosphere " << i << ", " << shells.count() << " shells");
    for (int k = 0; k < 10; ++k) {
      const double altitude = air.thickness() * random.number() * random.number();
      const double square = air.square_of(altitude);
      const double slope = (air.radius() + altitude) * random.between(-0.2, 1.0);
      const sky::AirRay ray = air.sun_ray(square, slope);
      const auto by_shells = shells.columns(ray);
      const auto by_quadrature = air.columns(ray, 1e-9);
      for (std::size_t w = 0; w < 3; ++w) {
        const double depth = air.optical_depth(by_quadrature, w);
        CHECK(air.optical_depth(by_shells, w) == Approx(depth).epsilon(1e-5).margin(1e-5));
      }
    }
  }
}

// Single scattering against closed forms, where there are any.

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
  Atmosphere air = earth_bruneton();
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
  // Exponential air over a sphere of 20 scale heights, thick enough that its end does not count: along the horizon
  // R exp(x) K1(x), x = R / H (Chapman 1931); upwards H.
  Atmosphere air = earth_bruneton();
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

TEST_CASE("sky reference: it is what plain marching tends to", "[sky][air][truth]") {
  for (const Atmosphere& air : {earth_bruneton(), mars()}) {
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
          const glm::dvec3 position = glm::dvec3(0.0, radius, 0.0) + s * view;
          const double r = glm::length(position);
          const double h = r - radius;
          const glm::dvec3 up = position / r;
          const double elevation_of_sun = std::asin(glm::dot(up, sun)) * 180.0 / std::numbers::pi;
          const glm::dvec3 local = sun_direction(elevation_of_sun, 0.0);
          const std::vector<double> light = reference_sun_irradiance(air, std::max(h, 0.0), local);
          const double phase_r = sky::rayleigh_phase(nu);
          const double density_r = sky::density(air.rayleigh.density, h);
          const double density_m = sky::density(air.aerosol.density, h);
          for (std::size_t i = 0; i < 3; ++i) {
            double extinction = density_r * air.rayleigh.scattering_per_m[i] +
                                density_m * (air.aerosol.scattering_per_m[i] + air.aerosol.absorption_per_m[i]);
            for (const Constituent& c : air.absorbers) extinction += sky::density(c.density, h) * c.absorption_per_m[i];
            depth[i] += 0.5 * step * extinction;
            sum[i] += step * std::exp(-depth[i]) * light[i] *
                      (phase_r * density_r * air.rayleigh.scattering_per_m[i] +
                       sky::aerosol_phase(air.aerosol_phase, sky::aerosol_asymmetry(air, i), nu) * density_m *
                           air.aerosol.scattering_per_m[i]);
            depth[i] += 0.5 * step * extinction;
          }
        }
        const std::vector<double> truth = reference_sky_radiance(air, 0.0, view, sun);
        for (std::size_t i = 0; i < 3; ++i) CHECK(truth[i] == Approx(sum[i]).epsilon(3e-4));
      }
    }
  }
}

}  // namespace welkin::test
