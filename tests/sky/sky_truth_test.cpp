// Sky tables and views against quadratures of another kind, in double precision.
#include "math/quadrature.h"
#include "reference/sky_monte_carlo.h"
#include "reference/sky_reference.h"
#include "sky/air.h"
#include "sky/sky_geometry.h"
#include "sky/sky_slice.h"
#include "sky/sky_tables_for_tests.h"
#include "sky/spectrum.h"
#include "sky/sunlight.h"
#include "sky/table_mapping.h"
#include "support/catch.h"
#include "support/trials.h"
#include "welkin/sky.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {

// Promise: texels of sky tables hold what the model says, to stated errors, against quadratures of another kind.

namespace {

using glm::dvec3;
using std::numbers::pi;

double sine_of(double cosine) { return std::sqrt(std::max(0.0, (1.0 - cosine) * (1.0 + cosine))); }

/// A texel of a scattering table, as an altitude, a ray and a sun.
struct Texel {
  std::size_t index;
  double altitude;
  sky::Ray view;
  double sun;
  double azimuth_cosine;

  [[nodiscard]] double nu() const {
    return view.zenith_cosine * sun + sine_of(view.zenith_cosine) * sine_of(sun) * azimuth_cosine;
  }
  [[nodiscard]] dvec3 direction() const {
    const double sine = sine_of(view.zenith_cosine);
    return {sine * sine_of(azimuth_cosine), view.zenith_cosine, sine * azimuth_cosine};
  }
  [[nodiscard]] dvec3 to_sun() const { return {0.0, sun, sine_of(sun)}; }
};

Texel texel(const SkyTables& tables, int height, int view, int angle, int sun) {
  const SkyTableOptions& o = tables.options;
  const sky::TableMapping mapping = sky::mapping_of(tables);
  const bool full = o.layout == ScatteringLayout::full;
  const int angles = full ? o.sun_angles : 1;
  Texel t{};
  t.index = static_cast<std::size_t>(((height * o.view_zeniths + view) * angles + angle) * o.sun_zeniths + sun);
  t.altitude = mapping.altitude(static_cast<double>(height) / (o.heights - 1));
  t.view = mapping.view_ray(t.altitude, view, o.view_zeniths);
  t.sun = mapping.sun_zenith_cosine(static_cast<double>(sun) / (o.sun_zeniths - 1));
  t.azimuth_cosine = full ? mapping.azimuth_cosine(static_cast<double>(angle) / (angles - 1), t.sun) : 0.0;
  return t;
}

/// Singly scattered radiance of a texel in a channel.
double radiance(const SkyTables& tables, const Texel& t, std::size_t channel) {
  const Atmosphere& air = tables.atmosphere;
  const double rayleigh = static_cast<double>(tables.scattering[4 * t.index + channel]);
  const double mie = static_cast<double>(tables.single_mie[4 * t.index + channel]);
  return rayleigh * sky::rayleigh_phase(t.nu()) +
         mie * sky::aerosol_phase(air.aerosol_phase, sky::aerosol_asymmetry(air, channel), t.nu());
}

}  // namespace

TEST_CASE("Transmittance tables match the truth to 1e-5 of the optical depth, grazing rays included",
          "[sky][tables][slow]") {
  for (const Atmosphere& air : {earth_bruneton(), earth_hillaire(), mars(), without_aerosol(earth_bruneton())}) {
    const SkyTables tables =
        precompute_sky(air, {.heights = 2, .view_zeniths = 4, .sun_zeniths = 4, .sun_angles = 2, .orders = 1});
    const SkyTableOptions& o = tables.options;
    const sky::TableMapping mapping = sky::mapping_of(tables);
    std::mt19937 generator(5);
    CAPTURE(air.name);
    double worst = 0.0;
    for (int i = 0; i < 120; ++i) {
      const int height = static_cast<int>(generator() % static_cast<unsigned>(o.transmittance_heights));
      const int zenith = i % 3 == 0
                             ? o.transmittance_zeniths - 2 - i % 5
                             : static_cast<int>(generator() % static_cast<unsigned>(o.transmittance_zeniths - 1));
      const double altitude = mapping.altitude(static_cast<double>(height) / (o.transmittance_heights - 1));
      const double cosine =
          mapping.transmittance_ray(altitude, static_cast<double>(zenith) / (o.transmittance_zeniths - 1))
              .zenith_cosine;
      const std::vector<double> truth = reference_transmittance(air, altitude, cosine);
      for (std::size_t c = 0; c < 3; ++c) {
        const auto at = static_cast<std::size_t>(3 * (height * o.transmittance_zeniths + zenith));
        const double found = static_cast<double>(tables.transmittance[at + c]);
        // the last term is what a float rounds
        const double depth = -std::log(std::max(truth[c], 1e-300));
        worst = std::max(worst, (std::abs(found - truth[c]) - 6e-8 * truth[c]) / (truth[c] * depth + 1e-30));
      }
    }
    CHECK(worst < 1e-5);
  }
}

TEST_CASE("Single scattering matches the truth at texels", "[sky][tables][truth]") {
  for (const Atmosphere& air : {earth_bruneton(), mars()}) {
    const SkyTables tables =
        precompute_sky(air, {.heights = 16, .view_zeniths = 32, .sun_zeniths = 32, .sun_angles = 5, .orders = 1});
    const SkyTableOptions& o = tables.options;
    CAPTURE(air.name);
    std::mt19937 generator(2);
    const auto any = [&](int count) { return static_cast<int>(generator() % static_cast<unsigned>(count)); };
    double squares_by_day = 0.0;
    double all_by_day = 0.0;
    double worst_by_day = 0.0;
    double squares_by_night = 0.0;
    double all_by_night = 0.0;
    for (int i = 0; i < 400; ++i) {
      const Texel t = texel(tables, any(o.heights), any(o.view_zeniths), any(o.sun_angles), any(o.sun_zeniths));
      // At the horizon itself the reference may fall on the other side.
      if (std::abs(t.view.zenith_cosine - sky::horizon_cosine(air.bottom_radius_m, t.altitude)) < 1e-9) continue;
      const std::vector<double> truth =
          reference_sky_radiance(air, t.altitude, glm::normalize(t.direction()), glm::normalize(t.to_sun()),
                                 {.relative_error = 1e-5, .ground = false});
      for (std::size_t c = 0; c < 3; ++c) {
        const double error = radiance(tables, t, c) - truth[c];
        const bool day = t.sun > 0.03;
        (day ? squares_by_day : squares_by_night) += error * error;
        (day ? all_by_day : all_by_night) += truth[c] * truth[c];
        if (day && truth[c] > 1e-5) worst_by_day = std::max(worst_by_day, std::abs(error) / truth[c]);
      }
    }
    CAPTURE(worst_by_day, std::sqrt(squares_by_day / all_by_day), std::sqrt(squares_by_night / all_by_night));
    CHECK(std::sqrt(squares_by_day / all_by_day) < 5e-5);
    CHECK(worst_by_day < 2e-3);
    CHECK(std::sqrt(squares_by_night / all_by_night) < 1e-3);
  }
}

namespace {

/// Returns the light scattered or reflected twice that arrives along a texel's ray, by direct integration of the
/// single-scattering reference over points of the ray and all directions about each.
std::vector<double> twice_scattered(const Atmosphere& air, const Texel& t) {
  constexpr int points = 7;
  constexpr int zeniths = 10;
  constexpr int azimuths = 8;  // over half the circle from the sun's: on both sides of it the light is the same
  const math::GaussRule along = math::gauss_legendre(points);
  const math::GaussRule about = math::gauss_legendre(zeniths);
  const dvec3 sun = t.to_sun();
  std::vector<double> sum(3, 0.0);
  for (int i = 0; i < points; ++i) {
    // the square: closer together near the start, where the air is thick
    const double u = 0.5 + 0.5 * along.nodes[i];
    const double s = t.view.length * u * u;
    const double weight = 0.5 * along.weights[i] * 2.0 * u * t.view.length;
    const double radius = air.bottom_radius_m + t.altitude;
    const dvec3 point = dvec3(0.0, radius, 0.0) + s * t.direction();
    const dvec3 up = glm::normalize(point);
    const double altitude = sky::altitude_along(air.bottom_radius_m, t.altitude, t.view.zenith_cosine, s);
    const double mu = glm::dot(up, t.direction());
    const dvec3 north = glm::normalize(sun - up * glm::dot(sun, up));
    const dvec3 east = glm::cross(up, north);
    const double horizon = sky::horizon_cosine(air.bottom_radius_m, altitude);
    std::vector<double> rayleigh(3, 0.0);
    std::vector<double> mie(3, 0.0);
    for (int half = 0; half < 2; ++half) {
      for (int j = 0; j < zeniths; ++j) {
        const double v = 0.5 + 0.5 * about.nodes[j];
        const double reach = half == 0 ? 1.0 - horizon : -1.0 - horizon;
        const double cosine = horizon + reach * v * v;
        const double solid = 0.5 * about.weights[j] * 2.0 * v * std::abs(reach) * 2.0 * pi / (2 * azimuths);
        for (int k = 0; k < azimuths; ++k) {
          const double phi = (k + 0.5) * pi / azimuths;
          const double ahead = sine_of(cosine) * std::cos(phi);
          const double across = sine_of(cosine) * std::sin(phi);
          // in the frame whose vertical is `up`
          const dvec3 local_sun(0.0, glm::dot(sun, up), glm::dot(sun, north));
          const std::vector<double> light =
              reference_sky_radiance(air, altitude, glm::normalize(dvec3(across, cosine, ahead)),
                                     glm::normalize(local_sun), {.relative_error = 3e-3, .ground = true});
          for (const double side : {1.0, -1.0}) {
            const double turned = glm::dot(up * cosine + north * ahead + east * (side * across), t.direction());
            for (std::size_t c = 0; c < 3; ++c) {
              rayleigh[c] += solid * light[c] * sky::rayleigh_phase(turned);
              mie[c] +=
                  solid * light[c] * sky::aerosol_phase(air.aerosol_phase, sky::aerosol_asymmetry(air, c), turned);
            }
          }
        }
      }
    }
    // The transmittance from the start to the point is the ratio of two rays to the top (upwards).
    const std::vector<double> from_start = reference_transmittance(air, t.altitude, t.view.zenith_cosine);
    const std::vector<double> from_point = reference_transmittance(air, altitude, mu);
    for (std::size_t c = 0; c < 3; ++c) {
      const double through = from_start[c] / from_point[c];
      const double molecules = std::exp(altitude * air.rayleigh.density[0].exponential_scale_per_m);
      const double aerosol = std::exp(altitude * air.aerosol.density[0].exponential_scale_per_m);
      sum[c] += weight * through *
                (molecules * air.rayleigh.scattering_per_m[c] * rayleigh[c] +
                 aerosol * air.aerosol.scattering_per_m[c] * mie[c]);
    }
  }
  return sum;
}

}  // namespace

TEST_CASE("The second order matches direct integration over all directions", "[sky][tables][truth]") {
  Atmosphere air = with_ground_albedo(earth_hillaire(), 0.4);
  air.aerosol_asymmetry = 0.5;  // that the brute force gets along with few directions
  air.rayleigh.density = exponential_profile(8000.0);
  air.aerosol.density = exponential_profile(2000.0);
  SkyTableOptions options{.heights = 16, .view_zeniths = 32, .sun_zeniths = 32, .sun_angles = 5, .orders = 1};
  const SkyTables once = precompute_sky(air, options);
  options.orders = 2;
  options.truncate_orders = true;
  const SkyTables twice = precompute_sky(air, options);
  struct Node {
    int height, view, angle, sun;
  };
  for (const Node& p : some_of(2, {Node{2, 24, 3, 27}, Node{5, 21, 0, 22}, Node{1, 18, 4, 19}})) {
    const Texel t = texel(twice, p.height, p.view, p.angle, p.sun);
    REQUIRE(!t.view.ground);
    REQUIRE(t.view.zenith_cosine > 0.0);
    const std::vector<double> truth = twice_scattered(air, t);
    for (std::size_t c = 0; c < 3; ++c) {
      const double found = (static_cast<double>(twice.scattering[4 * t.index + c]) -
                            static_cast<double>(once.scattering[4 * t.index + c])) *
                           sky::rayleigh_phase(t.nu());
      CAPTURE(t.altitude, t.view.zenith_cosine, t.sun, c, found, truth[c], found / truth[c]);
      CHECK(std::abs(found - truth[c]) < 0.02 * truth[c]);
    }
  }
}

TEST_CASE("Orders two to four on the ground match path tracing", "[sky][tables][truth]") {
  const Atmosphere air = with_ground_albedo(earth_bruneton(), 0.0);
  SkyTableOptions options{.irradiance_sun_zeniths = 257, .orders = 1};
  const SkyTables once = precompute_sky(air, options);
  options.orders = 4;
  options.truncate_orders = true;
  const SkyTables four = precompute_sky(air, options);
  constexpr std::size_t sun = 220;
  const double mu_s = sky::mapping_of(four).sun_zenith_cosine(sun / 256.0);
  const TracedLight traced = trace_sky_irradiance(air, 0.0, {0.0, mu_s, sine_of(mu_s)},
                                                  {.lowest_order = 2, .highest_order = 4, .paths = 40'000});
  for (std::size_t c = 0; c < 3; ++c) {
    const double found =
        static_cast<double>(four.irradiance[3 * sun + c]) - static_cast<double>(once.irradiance[3 * sun + c]);
    const double truth = traced.value[c];
    CAPTURE(mu_s, c, found, truth, traced.standard_error[c], found / truth);
    CHECK(std::abs(found - truth) < 3.0 * traced.standard_error[c] + 0.02 * truth);
  }
}

// Singly scattered skies against the dense reference in double precision.

namespace {

struct Errors {
  double rms = 0.0;        ///< relative, by solid angle
  double harmonics = 0.0;  ///< of the first nine coefficients
  double largest = 0.0;    ///< of the brightest
};

/// Directions on both sides of the horizon, denser towards it; half the azimuths, as the other half is the mirror
/// image.
Errors errors_of(const SkyView& view, double altitude, double elevation) {
  const Atmosphere& air = view.tables()->atmosphere;
  const glm::dvec3 sun = sun_direction(elevation, 0.0);
  const double horizon = sky::horizon_cosine(air.bottom_radius_m, altitude);
  const double thickness = air.top_radius_m - air.bottom_radius_m;
  const double highest = altitude > thickness ? sky::horizon_cosine(air.top_radius_m, altitude - thickness) : 1.0;
  constexpr int zeniths = 8;
  constexpr int azimuths = 4;
  double difference = 0.0;
  double whole = 0.0;
  double largest = 0.0;
  double brightest = 0.0;
  constexpr std::array<std::size_t, 6> even{0, 1, 2, 5, 6, 8};  // of nine coefficients, in x
  std::vector<double> basis(9);
  std::vector<double> found(18);
  std::vector<double> expected(18);
  for (int side = 0; side < 2; ++side) {
    const double reach = side == 0 ? highest - horizon : 1.0 + horizon;
    for (int i = 0; i < zeniths; ++i) {
      const double q = (i + 0.5) / zeniths;
      const double mu = side == 0 ? horizon + reach * q * q : horizon - reach * q * q;
      for (int j = 0; j < azimuths; ++j) {
        const double azimuth = pi * (j + 0.37) / azimuths;
        const double sine = std::sqrt(1.0 - mu * mu);
        const glm::dvec3 towards(sine * std::sin(azimuth), mu, sine * std::cos(azimuth));
        const glm::dvec3 sky = view.radiance(towards, sun);
        const std::vector<double> truth = reference_sky_radiance(air, altitude, towards, sun, {1e-5, true});
        const double weight = reach * 2.0 * q / zeniths * 2.0 * pi / azimuths;
        evaluate_basis(towards, 3, basis);
        for (int c = 0; c < 3; ++c) {
          const double exact = truth[static_cast<std::size_t>(c)];
          difference += weight * (sky[c] - exact) * (sky[c] - exact);
          whole += weight * exact * exact;
          largest = std::max(largest, std::abs(sky[c] - exact));
          brightest = std::max(brightest, exact);
          for (std::size_t k = 0; k < even.size(); ++k) {
            found[3 * k + static_cast<std::size_t>(c)] += weight * basis[even[k]] * sky[c];
            expected[3 * k + static_cast<std::size_t>(c)] += weight * basis[even[k]] * exact;
          }
        }
      }
    }
  }
  double off = 0.0;
  double size = 0.0;
  for (std::size_t k = 0; k < found.size(); ++k) {
    off += (found[k] - expected[k]) * (found[k] - expected[k]);
    size += expected[k] * expected[k];
  }
  return {std::sqrt(difference / whole), std::sqrt(off / size), largest / brightest};
}

}  // namespace

// In one case, as all take tables of a second.
TEST_CASE("sky view: a singly scattered sky is the truth to half a percent, and so is the sun", "[sky][view][truth]") {
  SECTION("from within the air") {
    for (const double altitude : {0.0, 2000.0, 20'000.0}) {
      const SkyView view(single_tables(), altitude);
      for (const double elevation : some_of(2, {90.0, 30.0, 0.0, 5.0, -6.0, -2.0})) {
        CAPTURE(altitude, elevation);
        const Errors errors = errors_of(view, altitude, elevation);
        CHECK(errors.harmonics < 0.004);
        CHECK(errors.rms < (elevation > 2.0 ? 0.002 : 0.012));
        CHECK(errors.largest < (elevation > 2.0 ? 0.008 : 0.03));
      }
    }
  }
  SECTION("from the top and from space") {
    for (const double altitude : some_of(2, {60'000.0, 300'000.0, 9.0 * 6'360'000.0})) {
      const SkyView view(single_tables(), altitude);
      for (const double elevation : {60.0, 5.0, -4.0}) {
        CAPTURE(altitude, elevation);
        const Errors errors = errors_of(view, altitude, elevation);
        CHECK(errors.harmonics < 0.005);
        CHECK(errors.rms < 0.02);
        CHECK(errors.largest < 0.04);
      }
    }
  }
  SECTION("the sun comes through the air as in the reference") {
    for (const double altitude : {0.0, 5000.0, 70'000.0, 400'000.0}) {
      const SkyView view(single_tables(), altitude);
      for (const double elevation : {90.0, 30.0, 5.0, 1.0, -2.0, -12.0}) {
        const glm::dvec3 sun = sun_direction(elevation, 0.0);
        const std::vector<double> truth = reference_sun_irradiance(earth_bruneton(), altitude, sun);
        for (int c = 0; c < 3; ++c) {
          CAPTURE(altitude, elevation, c);
          CHECK(view.sun_light(sun).irradiance[c] ==
                Approx(truth[static_cast<std::size_t>(c)]).epsilon(0.003).margin(1e-6));
        }
      }
    }
  }
  SECTION("the shadow's rim has no notches") {
    // Along the horizon light falls from the sun's side to the other, at most into the shadow once.
    for (const double altitude : {0.0, 10'000.0}) {
      const SkyView view(single_tables(), altitude);
      for (const double elevation : {-8.0, -10.0, -12.4, -14.0, -16.0}) {
        const glm::dvec3 sun = sun_direction(elevation, 0.0);
        for (const double height : {0.3, 1.0, 3.0, 8.0}) {
          std::vector<double> around;
          for (int i = 0; i <= 180; ++i) around.push_back(view.radiance(sun_direction(height, i), sun).b);
          const double brightest = *std::max_element(around.begin(), around.end());
          for (std::size_t i = 4; i + 4 < around.size(); ++i) {
            CAPTURE(altitude, elevation, height, i);
            CHECK(around[i] >= 0.5 * std::min(around[i - 4], around[i + 4]) - 1e-6 * brightest);
          }
        }
      }
    }
  }
}

namespace {

/// Returns a ray's transmittance from the ground to its start, from the two rays to the top by their cosines. R mu at
/// the ground is (rho^2 - d^2) / (2 d), rho being the distance of the horizon; at the start (R + h) mu is larger by the
/// distance d.
std::array<double, 3> share_from_ground(const Atmosphere& air, double altitude, double distance) {
  const double radius = air.bottom_radius_m;
  const double rho = sky::tangent_distance(radius, altitude);
  const double along = std::max(0.0, 0.5 * (rho - distance) * (rho + distance) / distance);  // R mu
  const std::vector<double> below = reference_transmittance(air, 0.0, std::min(1.0, along / radius));
  const std::vector<double> above =
      reference_transmittance(air, altitude, std::min(1.0, (along + distance) / (radius + altitude)));
  return {below[0] / above[0], below[1] / above[1], below[2] / above[2]};
}

}  // namespace

// A panel of altitudes from the ground up used to have six nodes regardless of the ray: 0.6 % too long next to the
// horizon, and 1.5e-3 of the ground's light.
TEST_CASE("sky view: the ground's light comes through the air in front of it to 1e-6", "[sky][view][truth]") {
  constexpr int kHalf = 32;
  // A layer much thinner than the scale height: a panel begins just above the ground.
  Atmosphere layered = earth_bruneton();
  layered.name = "layered";
  layered.aerosol.density = {{1.0, 0.0, 0.0, 0.0, 1.0}, {0.0, 1.0, -1.0 / 1200.0, 0.0, 0.0}};
  for (const Atmosphere& air : {earth_bruneton(), mars(), layered}) {
    SkyTables tables;  // only these members are read
    tables.atmosphere = air;
    tables.options.view_zeniths = 2 * kHalf;
    tables.options.orders = 1;  // nothing goes straight on
    const sky::TableMapping mapping = sky::mapping_of(tables);
    const sky::ColourFold fold(air, SkyColour::spectral);
    for (const double altitude : {10.0, 1000.0, 20'000.0}) {
      const std::vector<float> reach = sky::ground_reach(tables, mapping, fold, altitude, kHalf);
      double worst = 0.0;
      for (int k = 0; k < kHalf; ++k) {
        const std::array<double, 3> truth =
            share_from_ground(air, altitude, mapping.view_ray(altitude, k, 2 * kHalf).length);
        for (std::size_t c = 0; c < 3; ++c) {
          worst = std::max(worst, std::abs(static_cast<double>(reach[static_cast<std::size_t>(4 * k) + c]) - truth[c]));
        }
      }
      CAPTURE(air.name, altitude);
      CHECK(worst < 1e-6);
    }
  }
}

}  // namespace welkin::test
