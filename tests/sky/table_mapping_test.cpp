// Promise: texels of sky tables stand for states that map back to them, on planets of any size.
#include "sky/table_mapping.h"

#include <cmath>
#include <random>
#include <vector>

#include "sky/sky_geometry.h"
#include "support/catch.h"

namespace welkin::test {
namespace {

struct Planet {
  double radius, thickness;
};

const std::vector<Planet> kPlanets{{6.36e6, 6e4}, {3.39e6, 1e5}, {1.0, 1.0},   {1.0, 10.0},   {1e9, 1.0},
                                   {1e9, 1e10},   {1e9, 1e4},    {100.0, 1.0}, {6.36e6, 1e2}, {1234.5, 777.0}};

sky::TableMapping mapping_of(const Planet& planet) { return {planet.radius, planet.radius + planet.thickness, -0.5}; }

}  // namespace

TEST_CASE("Altitudes map back from their coordinates", "[sky][mapping]") {
  for (const Planet& planet : kPlanets) {
    const sky::TableMapping mapping = mapping_of(planet);
    CAPTURE(planet.radius, planet.thickness);
    CHECK(mapping.altitude(0.0) == 0.0);
    CHECK(mapping.altitude(1.0) == mapping.thickness());
    for (int k = 0; k <= 1000; ++k) {
      const double x = k / 1000.0;
      const double altitude = mapping.altitude(x);
      CHECK(altitude >= 0.0);
      CHECK(altitude <= mapping.thickness());
      CHECK(std::abs(mapping.height_coordinate(altitude) - x) < 1e-12);
    }
  }
}

TEST_CASE("Rays map back from their positions, at every height and on both sides of the horizon", "[sky][mapping]") {
  for (const Planet& planet : kPlanets) {
    const sky::TableMapping mapping = mapping_of(planet);
    for (const int zeniths : {4, 6, 64, 258}) {
      for (int height = 0; height <= 16; ++height) {
        const double altitude = mapping.altitude(height / 16.0);
        CAPTURE(planet.radius, planet.thickness, zeniths, altitude);
        double worst = 0.0;
        double worst_distance = 0.0;
        double last = -2.0;
        bool rising = true;
        for (int node = 0; node < zeniths; ++node) {
          const sky::ViewRay ray = mapping.view_ray(altitude, node, zeniths);
          REQUIRE(std::abs(ray.zenith_cosine) <= 1.0);
          REQUIRE(ray.ground == (node < zeniths / 2));
          const double back = mapping.view_position(altitude, ray.zenith_cosine, ray.ground, zeniths);
          // At the ground all rays down are one texel's, and at the top all rays up.
          const bool one_texel = ray.ground && height == 0;
          if (!one_texel) worst = std::max(worst, std::abs(back - node));
          const double along =
              ray.ground ? sky::distance_to_ground(planet.radius, altitude, ray.zenith_cosine)
                         : sky::distance_to_top(planet.radius, mapping.thickness(), altitude, ray.zenith_cosine);
          worst_distance =
              std::max(worst_distance, std::abs(along - ray.distance) / (ray.distance + planet.thickness * 1e-9));
          // From the nadir to the horizon and from there to the zenith: cosines of both halves rise towards
          // the horizon's node of the ground, and fall to the horizon's of the sky
          if (ray.ground && node > 0) rising = rising && ray.zenith_cosine <= last + 1e-15;
          last = ray.zenith_cosine;
        }
        CHECK(rising);
        CHECK(worst < 1e-5 * zeniths);
        CHECK(worst_distance < 1e-5);
      }
    }
  }
}

TEST_CASE("Suns map back from their coordinates, the lowest and the zenith are ends", "[sky][mapping]") {
  for (const Planet& planet : kPlanets) {
    for (const double lowest : {-1.0, -0.5, -0.1, 0.0}) {
      const sky::TableMapping mapping(planet.radius, planet.radius + planet.thickness, lowest);
      CAPTURE(planet.radius, planet.thickness, lowest);
      CHECK(std::abs(mapping.sun_zenith_cosine(0.0) - lowest) < 1e-7);
      CHECK(mapping.sun_zenith_cosine(1.0) == 1.0);
      CHECK(mapping.sun_coordinate(1.0) == 1.0);
      CHECK(mapping.sun_coordinate(-1.0) < 1e-12);
      double last = -2.0;
      for (int k = 0; k <= 500; ++k) {
        const double cosine = mapping.sun_zenith_cosine(k / 500.0);
        CHECK(cosine > last);
        CHECK(std::abs(mapping.sun_coordinate(cosine) - k / 500.0) < 1e-7);
        last = cosine;
      }
    }
  }
}

TEST_CASE("Altitudes along rays agree with long double", "[sky][mapping]") {
  std::mt19937_64 generator(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (const Planet& planet : kPlanets) {
    const sky::TableMapping mapping = mapping_of(planet);
    for (int i = 0; i < 2000; ++i) {
      const double altitude = mapping.altitude(unit(generator));
      const double mu = 2.0 * unit(generator) - 1.0;
      const bool ground = sky::meets_ground(planet.radius, altitude, mu);
      const double whole = ground ? sky::distance_to_ground(planet.radius, altitude, mu)
                                  : sky::distance_to_top(planet.radius, planet.thickness, altitude, mu);
      const double s = whole * unit(generator);
      const long double r = static_cast<long double>(planet.radius) + altitude;
      const long double wanted = std::sqrt(r * r + s * (2.0L * r * mu + s)) - planet.radius;
      const double found = sky::altitude_along(planet.radius, altitude, mu, s);
      // the last term is what the truth itself rounds
      CHECK(std::abs(found - static_cast<double>(wanted)) < 1e-14 * (altitude + s) + 1e-18 * planet.radius);
      const double end = sky::altitude_along(planet.radius, altitude, mu, whole);
      CHECK(std::abs(end - (ground ? 0.0 : planet.thickness)) < 1e-9 * (planet.thickness + std::abs(mu) * whole));
    }
  }
}

TEST_CASE("Azimuths between view and sun map back, and cosines that none gives count as the nearest",
          "[sky][mapping]") {
  using sky::TableMapping;
  CHECK(TableMapping::angle_coordinate(1.0, 0.3, 0.3) == 0.5);
  CHECK(TableMapping::angle_cosine(1.0, 0.3, 0.9) == 0.3);
  CHECK(TableMapping::angle_cosine(0.6, 0.8, 1.0) == Approx(0.96).epsilon(1e-12));
  CHECK(TableMapping::angle_cosine(0.6, 0.8, 0.0) == Approx(0.0).margin(1e-12));
  CHECK(TableMapping::angle_coordinate(0.6, 0.8, 1.0) == 1.0);
  CHECK(TableMapping::angle_coordinate(0.6, 0.8, -1.0) == 0.0);
  for (const double mu : {-0.9, -0.1, 0.0, 0.5, 0.999}) {
    for (const double mu_s : {-0.3, 0.0, 0.7}) {
      for (int k = 0; k <= 10; ++k) {
        const double nu = TableMapping::angle_cosine(mu, mu_s, k / 10.0);
        CHECK(TableMapping::angle_coordinate(mu, mu_s, nu) == Approx(k / 10.0).margin(1e-13));
      }
    }
  }
}

}  // namespace welkin::test
