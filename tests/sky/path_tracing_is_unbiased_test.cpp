// The path tracer estimates what the other references say, and neither makes light nor loses it.
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <vector>

#include "sky/path_random.h"
#include "sky/path_scattering.h"
#include "sky/path_shells.h"
#include "sky/phase_functions.h"
#include "sky/reference_air.h"
#include "support/catch.h"
#include "support/heap.h"
#include "support/random_atmospheres.h"
#include "support/thrown_error.h"
#include "welkin/control.h"
#include "welkin/sky_reference.h"
#include "welkin/spherical_harmonics.h"

namespace welkin {
namespace {

constexpr int kBands = 3;
constexpr std::size_t kCoefficients = 9;

/// The singly scattered sky by quadrature: the trapezoid over azimuths and over u, where sin(elevation) = sin^2(pi u /
/// 2) has no slope at the horizon nor the zenith.
std::vector<std::array<double, kCoefficients>> quadrature(const Atmosphere& air, const glm::dvec3& sun) {
  constexpr int zeniths = 20;
  constexpr int azimuths = 16;
  std::vector<std::array<double, kCoefficients>> result(air.wavelengths_nm.size());
  for (int half = 0; half < 2; ++half) {
    for (int i = 0; i < zeniths; ++i) {
      const double u = (i + 0.5) / zeniths;
      const double y = std::pow(std::sin(0.5 * std::numbers::pi * u), 2);
      const double dy = 0.5 * std::numbers::pi * std::sin(std::numbers::pi * u) / zeniths;
      for (int k = 0; k < azimuths; ++k) {
        const double azimuth = 2.0 * std::numbers::pi * (k + 0.5) / azimuths;
        const double level = std::sqrt(1.0 - y * y);
        const glm::dvec3 direction(level * std::sin(azimuth), half == 0 ? y : -y, level * std::cos(azimuth));
        const std::vector<double> light = reference_sky_radiance(air, 0.0, direction, sun, {.relative_error = 1e-3});
        std::array<double, kCoefficients> basis;
        evaluate_basis(direction, kBands, basis);
        for (std::size_t w = 0; w < light.size(); ++w) {
          for (std::size_t c = 0; c < kCoefficients; ++c) {
            result[w][c] += basis[c] * light[w] * dy * 2.0 * std::numbers::pi / azimuths;
          }
        }
      }
    }
  }
  return result;
}

}  // namespace

TEST_CASE("sky paths: first orders are the quadrature of the single-scattering truth", "[sky][air]") {
  Atmosphere hazy = mars();
  hazy.aerosol_phase = AerosolPhase::cornette_shanks;
  hazy.aerosol_asymmetry = -0.4;
  Atmosphere tiny = earth();
  tiny.bottom_radius_m = 100.0;
  tiny.top_radius_m = 190.0;
  tiny.rayleigh = {exponential_profile(20.0), {0.01, 0.02, 0.05}, {}};
  tiny.aerosol = {tent_profile(30.0, 20.0), {0.02, 0.01, 0.005}, {0.0, 0.01, 0.02}};
  tiny.absorbers.clear();
  for (const Atmosphere& air : {with_ground_albedo(earth(), 0.5), hazy, tiny}) {
    for (const double elevation : {35.0, -2.0}) {
      INFO(air.name << ", sun at " << elevation);
      const glm::dvec3 sun = sun_direction(elevation, 30.0);
      const auto truth = quadrature(air, sun);
      const TracedHarmonics traced =
          trace_sky_harmonics(air, 0.0, sun, kBands, {.lowest_order = 1, .highest_order = 1, .paths = 100'000});
      for (std::size_t w = 0; w < truth.size(); ++w) {
        for (std::size_t c = 0; c < kCoefficients; ++c) {
          INFO("wavelength " << w << ", coefficient " << c << ", error " << traced.standard_error[w][c]);
          CHECK(traced.standard_error[w][c] > 0.0);
          CHECK(std::abs(traced.radiance[w][c] - truth[w][c]) <
                4.5 * traced.standard_error[w][c] + 2e-3 * std::abs(truth[w][0]));
        }
      }
    }
  }
}

TEST_CASE("sky paths: air and ground that absorb nothing lose nothing", "[sky][air]") {
  // Light from everywhere alike, L, stays alike inside: what is scattered into a ray makes up for what is scattered out
  // of it. Light from all suns alike is such light: the mean over suns of scattered radiance is L (1 - transmittance to
  // space), with L = E / (4 pi).
  Atmosphere air;
  air.bottom_radius_m = 1000.0;
  air.top_radius_m = 1300.0;
  air.rayleigh = {exponential_profile(60.0), {0.001, 0.005, 0.02}, {}};
  air.aerosol = {tent_profile(50.0, 40.0), {0.01, 0.0, 0.005}, {}};
  air.aerosol_asymmetry = 0.6;
  air.ground_albedo = {1.0, 1.0, 1.0};
  air.solar_irradiance = {4.0, 4.0, 4.0};
  air.sun_angular_radius_degrees = 0.0;
  constexpr int suns = 48;
  std::array<double, 3> mean{};
  std::array<double, 3> variance{};
  for (int i = 0; i < suns; ++i) {
    const double sine = -1.0 + 2.0 * (i + 0.5) / suns;
    const TracedHarmonics traced = trace_sky_harmonics(
        air, 20.0, glm::dvec3(0.0, sine, std::sqrt(1.0 - sine * sine)), 1,
        {.lowest_order = 1, .highest_order = 64, .paths = 8000, .seed = static_cast<std::uint64_t>(i)});
    for (std::size_t w = 0; w < 3; ++w) {
      mean[w] += traced.radiance[w][0] * std::sqrt(4.0 * std::numbers::pi) / suns;
      variance[w] += std::pow(traced.standard_error[w][0] * std::sqrt(4.0 * std::numbers::pi) / suns, 2);
    }
  }
  for (std::size_t w = 0; w < 3; ++w) {
    double clear = 0.0;  // integral over directions of the transmittance to space
    constexpr int steps = 2000;
    for (int i = 0; i < steps; ++i) {
      clear +=
          2.0 * std::numbers::pi * 2.0 / steps * reference_transmittance(air, 20.0, -1.0 + 2.0 * (i + 0.5) / steps)[w];
    }
    const double expected = 4.0 / (4.0 * std::numbers::pi) * (4.0 * std::numbers::pi - clear);
    INFO("wavelength " << w << ": " << mean[w] << " of " << expected << ", error " << std::sqrt(variance[w]));
    CHECK(std::abs(mean[w] - expected) < 4.0 * std::sqrt(variance[w]) + 2e-3 * expected);
    CHECK(std::sqrt(variance[w]) < 0.01 * expected);
  }
}

TEST_CASE("sky paths: orders add up, and higher ones are what is left", "[sky][air]") {
  const glm::dvec3 sun = sun_direction(25.0, 0.0);
  const auto light = [&](int lowest, int highest) {
    return trace_sky_harmonics(earth(), 0.0, sun, 1,
                               {.lowest_order = lowest, .highest_order = highest, .paths = 60'000});
  };
  const TracedHarmonics all = light(1, 5);
  double sum = 0.0;
  double variance = std::pow(all.standard_error[2][0], 2);
  double before = 0.0;
  for (int order = 1; order <= 5; ++order) {
    const TracedHarmonics one = light(order, order);
    sum += one.radiance[2][0];
    variance += std::pow(one.standard_error[2][0], 2);
    if (order > 1) CHECK(one.radiance[2][0] < before);
    CHECK(one.radiance[2][0] > 0.0);
    before = one.radiance[2][0];
  }
  CHECK(std::abs(sum - all.radiance[2][0]) < 4.0 * std::sqrt(variance));
}

TEST_CASE("sky paths: standard errors are what repetitions show", "[sky][air]") {
  std::vector<double> values;
  double claimed = 0.0;
  constexpr int repetitions = 60;
  for (int i = 0; i < repetitions; ++i) {
    const TracedHarmonics traced = trace_sky_harmonics(earth(), 0.0, sun_direction(20.0, 0.0), 1,
                                                       {.paths = 4000, .seed = static_cast<std::uint64_t>(1000 + i)});
    values.push_back(traced.radiance[1][0]);
    claimed += traced.standard_error[1][0] * traced.standard_error[1][0] / repetitions;
  }
  double mean = 0.0;
  for (const double value : values) mean += value / repetitions;
  double variance = 0.0;
  for (const double value : values) variance += (value - mean) * (value - mean) / (repetitions - 1);
  CHECK(std::sqrt(claimed / variance) == Approx(1.0).margin(0.35));
}

TEST_CASE("sky paths: the same bits on any number of threads, without allocation, and others for another seed",
          "[sky][air]") {
  TracedHarmonics one;
  TracedHarmonics many;
  const auto trace = [](std::uint64_t seed) {
    return trace_sky_harmonics(mars(), 50.0, sun_direction(5.0, 12.0), 4,
                               {.lowest_order = 1, .highest_order = 6, .paths = 20'001, .seed = seed});
  };
  test::forget_allocations_in_tiles();
  run_with_threads(1, [&] { one = trace(3); });
  run_with_threads(5, [&] { many = trace(3); });
  CHECK(test::allocations_in_tiles() == 0);
  CHECK(one.radiance == many.radiance);
  CHECK(one.standard_error == many.standard_error);
  CHECK(trace(4).radiance != one.radiance);
}

TEST_CASE("sky paths: shells hold what they say, and their sums are the quadrature's", "[sky][air]") {
  test::RandomAtmospheres random(23);
  for (int i = 0; i < test::trials(60); ++i) {
    const sky::ReferenceAir air(random.next());
    const sky::PathShells shells(air);
    INFO("atmosphere " << i << ", " << shells.count() << " shells");
    for (std::size_t s = 0; s < shells.count(); ++s) {
      for (int p = 0; p <= 20; ++p) {
        const double square = shells.square(s) + (shells.square(s + 1) - shells.square(s)) * (p + 0.01) / 21.0;
        sky::PathShells::Columns densities{};
        shells.densities(s, square, densities);
        for (std::size_t w = 0; w < 3; ++w) REQUIRE(air.optical_depth(densities, w) <= shells.majorant(s));
      }
    }
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

TEST_CASE("sky paths: a density that turns inside of its layer is bounded at its top", "[sky][air]") {
  // 0.05 + h / 200 m - 0.05 exp(h / 100 m): 0 on the ground, 0.70 at 230 m, 0.55 at 300 m.
  Atmosphere air = earth();
  air.top_radius_m = air.bottom_radius_m + 300.0;
  air.rayleigh.density = {
      {.exponential_term = -0.05, .exponential_scale_per_m = 0.01, .linear_term_per_m = 0.005, .constant_term = 0.05}};
  air.rayleigh.scattering_per_m = {0.01, 0.01, 0.01};
  air.aerosol = {};
  air.absorbers.clear();
  const sky::ReferenceAir truth(air);
  const sky::PathShells shells(truth);
  const double top = truth.square_of(100.0 * std::log(10.0));
  sky::PathShells::Columns densities{};
  shells.densities(shells.find(top), top, densities);
  CHECK(densities[0] == Approx(0.05 + 0.5 * std::log(10.0) - 0.5).epsilon(1e-9));
  for (const double square : {0.9999 * top, top, 1.0001 * top}) {
    shells.densities(shells.find(square), square, densities);
    CHECK(truth.optical_depth(densities, 0) <= shells.majorant(shells.find(square)));
  }
}

TEST_CASE("sky paths: drawn angles have their distributions", "[sky][air]") {
  sky::PathRandom random(1, 2);
  constexpr int draws = 200'000;
  const auto mean_of = [&](const auto& draw) {
    double sum = 0.0;
    double squares = 0.0;
    for (int i = 0; i < draws; ++i) {
      const double c = draw();
      sum += c / draws;
      squares += c * c / draws;
    }
    return std::array<double, 2>{sum, squares};
  };
  const auto rayleigh = mean_of([&] { return sky::draw_rayleigh(random); });
  CHECK(rayleigh[0] == Approx(0.0).margin(0.006));
  CHECK(rayleigh[1] == Approx(0.4).epsilon(0.01));
  for (const double g : {-0.7, 0.0, 0.3, 0.8, 0.99}) {
    INFO("g = " << g);
    const auto henyey = mean_of([&] { return sky::draw_aerosol(AerosolPhase::henyey_greenstein, g, random); });
    CHECK(henyey[0] == Approx(g).margin(0.006));
    CHECK(henyey[1] == Approx((1.0 + 2.0 * g * g) / 3.0).margin(0.006));
    const auto cornette = mean_of([&] { return sky::draw_aerosol(AerosolPhase::cornette_shanks, g, random); });
    CHECK(cornette[0] == Approx(3.0 * g * (4.0 + g * g) / (5.0 * (2.0 + g * g))).margin(0.006));
  }
  for (int i = 0; i < 1000; ++i) {
    const glm::dvec3 axis = sun_direction(180.0 * random.number() - 90.0, 360.0 * random.number());
    const double cosine = 2.0 * random.number() - 1.0;
    const glm::dvec3 turned = sky::turned(axis, cosine, random);
    REQUIRE(glm::length(turned) == Approx(1.0).epsilon(1e-14));
    REQUIRE(glm::dot(turned, axis) == Approx(cosine).margin(1e-14));
  }
}

TEST_CASE("sky paths: random atmospheres give finite light that is not negative", "[sky][air]") {
  test::RandomAtmospheres random(29);
  for (int i = 0; i < test::trials(120); ++i) {
    const Atmosphere air = random.next(random.chance(0.1) ? 96 : 3);
    const double altitude =
        std::min(1e9, random.chance(0.3) ? 0.0 : random.between(0.0, 1.3) * (air.top_radius_m - air.bottom_radius_m));
    const TracedHarmonics traced = trace_sky_harmonics(air, altitude, sun_direction(random.between(-20.0, 90.0), 0.0),
                                                       2, {.lowest_order = 1, .highest_order = 8, .paths = 400});
    INFO("atmosphere " << i << ", altitude " << altitude);
    for (std::size_t w = 0; w < traced.radiance.size(); ++w) {
      CHECK(traced.radiance[w][0] >= 0.0);
      for (std::size_t k = 0; k < 4; ++k) {
        CHECK(std::isfinite(traced.radiance[w][k]));
        CHECK((std::isfinite(traced.standard_error[w][k]) && traced.standard_error[w][k] >= 0.0));
      }
    }
  }
}

TEST_CASE("sky paths: what is asked for is checked, and the call stops and tells how far it is", "[sky][air]") {
  const glm::dvec3 up(0.0, 1.0, 0.0);
  const auto refused = [&](int bands, const PathTracingOptions& options, const std::string& words) {
    const test::ThrownError error =
        test::thrown_by([&] { return trace_sky_harmonics(earth(), 0.0, up, bands, options); });
    INFO(error.message);
    CHECK(error.code == ErrorCode::invalid_argument);
    CHECK(error.says(words));
  };
  refused(0, {}, "bands is 0");
  refused(17, {}, "bands is 17");
  refused(3, {.lowest_order = 0}, "lowest order is 0");
  refused(3, {.lowest_order = 3, .highest_order = 2}, "highest order is 2");
  refused(3, {.highest_order = 65}, "65");
  refused(3, {.paths = 1}, "paths is 1");
  CHECK(test::thrown_by([&] { return trace_sky_harmonics(earth(), -1.0, up, 3); }).says("altitude"));
  CHECK(test::thrown_by([&] { return trace_sky_harmonics(earth(), 0.0, 3.0 * up, 3); }).says("sun"));
  std::stop_source stop;
  double told = 0.0;
  const Control control{.stop = stop.get_token(), .progress = [&](double share) {
                          told = share;
                          if (share > 0.05) stop.request_stop();
                        }};
  const test::ThrownError error =
      test::thrown_by([&] { return trace_sky_harmonics(earth(), 0.0, up, 1, {.paths = 4'000'000}, control); });
  CHECK(error.code == ErrorCode::cancelled);
  CHECK(told < 0.5);
}

}  // namespace welkin
