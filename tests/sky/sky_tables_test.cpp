// Sky tables: how texels stand for states, quadratures, and what the calls that make them promise.
#include "math/quadrature.h"
#include "sky/air.h"
#include "sky/ray_nodes.h"
#include "sky/sky_geometry.h"
#include "sky/sky_projection.h"
#include "sky/table_mapping.h"
#include "sky/table_sizes.h"
#include "sky/vertical_harmonics.h"
#include "support/catch.h"
#include "support/heap.h"
#include "support/thrown_error.h"
#include "welkin/core.h"
#include "welkin/sky.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {

// Promise: texels of sky tables stand for states that map back to them, on planets of any size.

namespace {

struct Planet {
  double radius, thickness;
};

const std::vector<Planet> kPlanets{{6.36e6, 6e4}, {3.39e6, 1e5}, {1.0, 1.0},   {1.0, 10.0},   {1e9, 1.0},
                                   {1e9, 1e10},   {1e9, 1e4},    {100.0, 1.0}, {6.36e6, 1e2}, {1234.5, 777.0}};

constexpr sky::TableNodes kFew{};
constexpr sky::TableNodes kMany{.many_views = true, .many_suns = true, .many_azimuths = true};

sky::TableMapping mapping_of(const Planet& planet, sky::TableNodes nodes = kFew) {
  return {planet.radius, planet.radius + planet.thickness, -0.5, 0.2678, nodes};
}

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

namespace {

void check_rays(const Planet& planet, const sky::TableMapping& mapping, int zeniths, double altitude) {
  CAPTURE(planet.radius, planet.thickness, zeniths, altitude);
  double worst = 0.0;
  double worst_distance = 0.0;
  double last = -2.0;
  bool rising = true;
  for (int node = 0; node < zeniths; ++node) {
    const sky::Ray ray = mapping.view_ray(altitude, node, zeniths);
    REQUIRE(std::abs(ray.zenith_cosine) <= 1.0);
    REQUIRE(ray.ground == (node < zeniths / 2));
    const double back = mapping.view_position(altitude, ray.zenith_cosine, ray.ground, zeniths);
    // At the ground all rays down are one texel's, and at the top all rays up.
    const bool one_texel = ray.ground && altitude == 0.0;
    if (!one_texel) worst = std::max(worst, std::abs(back - node));
    const double along = ray.ground
                             ? sky::distance_to_ground(planet.radius, altitude, ray.zenith_cosine)
                             : sky::distance_to_top(planet.radius, mapping.thickness(), altitude, ray.zenith_cosine);
    worst_distance = std::max(worst_distance, std::abs(along - ray.length) / (ray.length + planet.thickness * 1e-9));
    // From the nadir to the horizon and from there to the zenith: cosines of both halves rise towards
    // the horizon's node of the ground, and fall to the horizon's of the sky
    if (ray.ground && node > 0) rising = rising && ray.zenith_cosine <= last + 1e-15;
    last = ray.zenith_cosine;
  }
  CHECK(rising);
  CHECK(worst < 1e-5 * zeniths);
  CHECK(worst_distance < 1e-5);
}

}  // namespace

TEST_CASE("Rays map back from their positions, at every height and on both sides of the horizon", "[sky][mapping]") {
  for (const Planet& planet : kPlanets) {
    for (const sky::TableNodes nodes : {kFew, kMany}) {
      const sky::TableMapping mapping = mapping_of(planet, nodes);
      for (const int zeniths : {4, 6, 64, 258}) {
        for (int height = 0; height <= 16; ++height) {
          check_rays(planet, mapping, zeniths, mapping.altitude(height / 16.0));
        }
      }
    }
  }
}

TEST_CASE("Suns map back from their coordinates, the lowest and the zenith are ends", "[sky][mapping]") {
  for (const Planet& planet : kPlanets) {
    for (const double lowest : {-1.0, -0.5, -0.1, 0.0}) {
      for (const sky::TableNodes nodes : {kFew, kMany}) {
        const sky::TableMapping mapping(planet.radius, planet.radius + planet.thickness, lowest, 0.2678, nodes);
        CAPTURE(planet.radius, planet.thickness, lowest, nodes.many_suns);
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
      // the last term is the reference's own rounding
      CHECK(std::abs(found - static_cast<double>(wanted)) < 1e-14 * (altitude + s) + 1e-18 * planet.radius);
      const double end = sky::altitude_along(planet.radius, altitude, mu, whole);
      CHECK(std::abs(end - (ground ? 0.0 : planet.thickness)) < 1e-9 * (planet.thickness + std::abs(mu) * whole));
    }
  }
}

TEST_CASE("Azimuths between view and sun map back, and cosines that none gives count as the nearest",
          "[sky][mapping]") {
  for (const sky::TableNodes nodes : {kFew, kMany}) {
    const sky::TableMapping mapping = mapping_of(kPlanets.front(), nodes);
    CHECK(mapping.angle_cosine(1.0, 0.3, 0.9) == 0.3);
    CHECK(mapping.angle_cosine(0.6, 0.8, 1.0) == Approx(0.96).epsilon(1e-12));
    CHECK(mapping.angle_cosine(0.6, 0.8, 0.0) == Approx(0.0).margin(1e-12));
    CHECK(mapping.azimuth_coordinate(1.1, 0.8) == 1.0);
    CHECK(mapping.azimuth_coordinate(-1.1, 0.8) == 0.0);
    for (const double mu : {-0.9, -0.1, 0.0, 0.5, 0.999}) {
      for (const double mu_s : {-0.99, -0.3, -0.1, -0.01, 0.0, 0.7}) {
        for (int k = 0; k <= 10; ++k) {
          const double nu = mapping.angle_cosine(mu, mu_s, k / 10.0);
          const double cosine = (nu - mu * mu_s) / std::sqrt((1.0 - mu * mu) * (1.0 - mu_s * mu_s));
          CHECK(mapping.azimuth_coordinate(cosine, mu_s) == Approx(k / 10.0).margin(1e-13));
        }
      }
    }
  }
}

// Promise: directions and weights integrate what they should, and what is in closed form is what integrals give.

namespace {

using std::numbers::pi;

double sum(const std::vector<double>& values) {
  double total = 0.0;
  for (const double value : values) total += value;
  return total;
}

}  // namespace

TEST_CASE("weights of a sky's quadratures add up to the sphere", "[sky][harmonics]") {
  for (const double horizon : {0.0, -0.02, -0.136, -0.9}) {
    for (const int zeniths : {2, 3, 7, 16, 33, 128}) {
      CAPTURE(horizon, zeniths);
      for (const SkyQuadrature quadrature : {SkyQuadrature::gauss, SkyQuadrature::gauss_split}) {
        const sky::SkyRule rule = sky::sky_rule({3, quadrature, zeniths, 16}, horizon, 1.0, 0.8);
        CHECK(sum(rule.above.weights) == Approx(1.0 - horizon).epsilon(1e-13));
        CHECK(sum(rule.below.weights) == Approx(1.0 + horizon).epsilon(1e-13));
        for (const double cosine : rule.above.cosines) CHECK(cosine >= horizon);
        for (const double cosine : rule.below.cosines) CHECK(cosine <= horizon);
      }
      const sky::SkyRule uniform = sky::sky_rule({3, SkyQuadrature::uniform, zeniths, 16}, horizon, 1.0, 0.8);
      const double midpoint = pi / (2.0 * zeniths) / std::sin(pi / (2.0 * zeniths)) * 2.0;
      CHECK(sum(uniform.above.weights) + sum(uniform.below.weights) == Approx(midpoint).epsilon(1e-12));
    }
  }
}

TEST_CASE("clustered azimuths integrate harmonics, for any lobe and number", "[sky][harmonics]") {
  for (const double g : {0.0, 0.5, 0.8, 0.95, 0.999, -0.8, -0.999}) {
    for (const int azimuths : {16, 17, 64, 256}) {
      CAPTURE(g, azimuths);
      const sky::AzimuthRule rule = sky::sky_rule({3, SkyQuadrature::gauss_split, 4, azimuths}, 0.0, 1.0, g).azimuths;
      CHECK(sum(rule.weights) == Approx(2.0 * pi).epsilon(2e-3));
      for (const int order : {1, 2, 4}) {
        double integral = 0.0;
        for (std::size_t i = 0; i < rule.cosines.size(); ++i) {
          CHECK(rule.from_sun[i] == Approx(1.0 - rule.cosines[i]).margin(1e-14));
          CHECK(rule.from_opposite[i] == Approx(1.0 + rule.cosines[i]).margin(1e-14));
          integral += rule.weights[i] * std::cos(order * std::acos(rule.cosines[i]));
        }
        CHECK(std::abs(integral) < 5e-2);
      }
    }
  }
  // At Earth's g, to what the default promises.
  const sky::AzimuthRule rule = sky::sky_rule({}, 0.0, 1.0, 0.8).azimuths;
  double integral = 0.0;
  for (std::size_t i = 0; i < rule.cosines.size(); ++i) integral += rule.weights[i] * rule.cosines[i] * rule.cosines[i];
  CHECK(integral == Approx(pi).epsilon(1e-6));
}

TEST_CASE("an aerosol's spectrum is the integral of its phase function, which keeps all light", "[sky][harmonics]") {
  const math::GaussNodes rule = math::gauss_nodes(128);
  for (const AerosolPhase phase : {AerosolPhase::cornette_shanks, AerosolPhase::henyey_greenstein}) {
    for (const double g : {0.0, 1e-3, 0.3, 0.8, -0.6, -0.8, 0.95, 0.99, 0.999}) {
      Atmosphere air = earth_bruneton();
      air.aerosol_phase = phase;
      air.aerosol_asymmetry = g;
      const auto spectrum = sky::aerosol_moments(air, g, kMaximumBands);
      for (const int l : {0, 1, 2, 7, 15}) {
        double integral = 0.0;
        double high = 2.0;
        for (int panel = 0; panel < 30; ++panel) {  // towards the lobe, in 1 - nu or 1 + nu
          const double low = panel == 29 ? 0.0 : 0.4 * high;
          for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
            const double gap = low + 0.5 * (high - low) * (1.0 + rule.nodes[k]);
            const double nu = g < 0.0 ? gap - 1.0 : 1.0 - gap;
            integral += pi * (high - low) * rule.weights[k] * sky::aerosol_phase(phase, g, nu) *
                        std::legendre(static_cast<unsigned>(l), nu);
          }
          high = low;
        }
        CAPTURE(static_cast<int>(phase), g, l);
        CHECK(spectrum[static_cast<std::size_t>(l)] == Approx(integral).epsilon(1e-7).margin(1e-9));
        if (l > 1) continue;
        const double cosine =
            phase == AerosolPhase::henyey_greenstein ? g : 3.0 * g * (4.0 + g * g) / (5.0 * (2.0 + g * g));
        CHECK(integral == Approx(l == 0 ? 1.0 : cosine).epsilon(1e-5).margin(1e-7));
      }
    }
  }
  // Over the sphere 3 / (16 pi) (1 + c^2) is 1.
  for (const double c : {-1.0, 0.0, 0.5}) CHECK(sky::rayleigh_phase(c) == Approx(3.0 / (16.0 * pi) * (1.0 + c * c)));
}

TEST_CASE("harmonics about the vertical are Welkin's, turned", "[sky][harmonics]") {
  constexpr int bands = kMaximumBands;
  std::vector<double> basis(sky::even_count(bands));
  std::vector<glm::dvec3> even(sky::even_count(bands));
  for (const double elevation : {90.0, 71.0, 20.0, 0.0, -33.0, -90.0}) {
    for (const double azimuth : {0.0, 45.0, 133.0, -90.0, 180.0}) {
      CAPTURE(elevation, azimuth);
      // The light of one direction in the sun's vertical plane, but for what is odd about it: nothing.
      const glm::dvec3 direction = sun_direction(elevation, azimuth);
      const sky::SunAngles angles = sky::sun_angles(direction);
      sky::even_basis(angles.zenith_cosine, angles.zenith_sine, bands, basis);
      for (std::size_t k = 0; k < basis.size(); ++k) even[k] = glm::dvec3(basis[k]);
      std::vector<glm::dvec3> rotated(bands * bands);
      sky::rotate_even(even, bands, angles, rotated);
      std::vector<double> expected(bands * bands);
      evaluate_basis(direction, bands, expected);
      for (std::size_t k = 0; k < expected.size(); ++k) CHECK(rotated[k].x == Approx(expected[k]).margin(1e-12));
    }
  }
}

// Promise: precomputing a sky keeps its memory limit, and names what is wrong with its arguments.

namespace {

SkyTableOptions small_options() {
  return {.heights = 4,
          .view_zeniths = 6,
          .sun_zeniths = 7,
          .sun_angles = 3,
          .transmittance_heights = 7,
          .transmittance_zeniths = 9,
          .irradiance_heights = 3,
          .irradiance_sun_zeniths = 5,
          .orders = 3};
}

}  // namespace

TEST_CASE("Orders stop when one changes too little", "[sky][tables]") {
  SkyTableOptions options = small_options();
  options.orders = 64;
  options.convergence_threshold = 0.02;
  const SkyTables tables = precompute_sky(earth_bruneton(), options);
  CHECK(tables.orders > 2);
  CHECK(tables.orders < 10);
  CHECK(tables.last_change < 0.02);
  options.orders = tables.orders;
  options.convergence_threshold = 0.0;
  CHECK(precompute_sky(earth_bruneton(), options).scattering == tables.scattering);
}

TEST_CASE("Sky tables keep their memory limit and predict what they take", "[sky][tables][truth]") {
  SkyTableOptions options = small_options();
  options.memory_limit_bytes = 1000;
  const ThrownError error = thrown_by([&] { static_cast<void>(precompute_sky(earth_bruneton(), options)); });
  CHECK(error.code == ErrorCode::limit_exceeded);
  CHECK(error.says("1000"));
  options = {.heights = 128, .view_zeniths = 1024, .sun_zeniths = 256, .sun_angles = 128};
  CHECK(sky::sky_table_bytes(earth_bruneton(), options) > std::uint64_t{128} * 1024 * 256 * 128 * 32);
  CHECK(thrown_by([&] { static_cast<void>(precompute_sky(earth_bruneton(), options)); }).code ==
        ErrorCode::limit_exceeded);
  for (const ScatteringLayout layout : {ScatteringLayout::full, ScatteringLayout::compact}) {
    SkyTableOptions usual{.layout = layout, .heights = 12, .orders = 2};
    const HeapWatch watch;
    const SkyTables tables = precompute_sky(earth_bruneton(), usual);
    CHECK(watch.peak_bytes() <= static_cast<long>(sky::sky_table_bytes(earth_bruneton(), usual)));
    CHECK(tables.bytes() < sky::sky_table_bytes(earth_bruneton(), usual));
  }
}

TEST_CASE("Options that make no sense are named", "[sky][tables]") {
  const auto refused = [](const char* what, auto change) {
    SkyTableOptions options = small_options();
    change(options);
    const ThrownError error = thrown_by([&] { static_cast<void>(precompute_sky(earth_bruneton(), options)); });
    CAPTURE(what, error.message);
    CHECK(error.code == ErrorCode::invalid_argument);
    CHECK(error.says(what));
  };
  refused("heights", [](SkyTableOptions& o) { o.heights = 1; });
  refused("heights", [](SkyTableOptions& o) { o.heights = 129; });
  refused("view_zeniths", [](SkyTableOptions& o) { o.view_zeniths = 7; });
  refused("view_zeniths", [](SkyTableOptions& o) { o.view_zeniths = 2; });
  refused("sun_zeniths", [](SkyTableOptions& o) { o.sun_zeniths = 3; });
  refused("sun_angles", [](SkyTableOptions& o) { o.sun_angles = -1; });
  refused("transmittance_heights", [](SkyTableOptions& o) { o.transmittance_heights = 1; });
  refused("transmittance_zeniths", [](SkyTableOptions& o) { o.transmittance_zeniths = 1 << 30; });
  refused("irradiance_heights", [](SkyTableOptions& o) { o.irradiance_heights = 0; });
  refused("irradiance_sun_zeniths", [](SkyTableOptions& o) { o.irradiance_sun_zeniths = 1; });
  refused("minimum_sun_elevation_degrees", [](SkyTableOptions& o) { o.minimum_sun_elevation_degrees = 1.0; });
  refused("minimum_sun_elevation_degrees", [](SkyTableOptions& o) { o.minimum_sun_elevation_degrees = std::nan(""); });
  refused("orders", [](SkyTableOptions& o) { o.orders = 0; });
  refused("orders", [](SkyTableOptions& o) { o.orders = 65; });
  refused("convergence_threshold", [](SkyTableOptions& o) { o.convergence_threshold = -1.0; });
  refused("convergence_threshold",
          [](SkyTableOptions& o) { o.convergence_threshold = std::numeric_limits<double>::infinity(); });
  const ThrownError error = thrown_by([] {
    static_cast<void>(precompute_sky(earth_bruneton({400.0, 500.0, 600.0, 700.0}), small_options()));
  });
  CHECK(error.code == ErrorCode::invalid_argument);
  CHECK(error.says("linear_srgb"));
  Atmosphere broken = earth_bruneton();
  broken.rayleigh.scattering_per_m[1] = std::nan("");
  CHECK(thrown_by([&] { static_cast<void>(precompute_sky(broken, small_options())); }).says("rayleigh"));
}

TEST_CASE("Lengths along the rays of tables stay where only ground or haze changes", "[sky]") {
  const Atmosphere clear = earth();
  Atmosphere hazy = with_ground_albedo(clear, 0.8);
  for (double& value : hazy.aerosol.scattering_per_m) value *= 1.5;
  Atmosphere lower = clear;
  lower.aerosol.density = exponential_profile(900.0);
  const auto lengths = [](const Atmosphere& atmosphere, double altitude) {
    const sky::AirModel air(atmosphere);
    const std::vector<sky::Ray> rays{
        {altitude, 1.0, false, air.thickness() - altitude},
        {0.0, 0.5, false, sky::distance_to_top(air.bottom_radius(), air.thickness(), 0.0, 0.5)}};
    auto found = sky::lengths_of(air, rays, {});
    sky::RayPanels panels(air);
    REQUIRE(found->amounts.size() == rays.size());
    for (std::size_t k = 0; k < rays.size(); ++k) CHECK(found->amounts[k] == sky::lengths_along(air, rays[k], panels));
    return found;
  };
  const auto first = lengths(clear, 100.0);
  CHECK(lengths(hazy, 100.0) == first);
  CHECK(lengths(lower, 100.0) != first);
  CHECK(lengths(clear, 200.0) != first);
  CHECK(lengths(clear, 100.0) == first);
}

TEST_CASE("Tables between grounds and hazes are near those that are computed", "[sky][slow]") {
  SkyTableOptions options = small_options();
  options.orders = 4;
  const auto hazy = [](double amount) {
    Atmosphere air = earth_bruneton();
    for (double& value : air.aerosol.scattering_per_m) value *= amount;
    return air;
  };
  const auto over = [](double albedo) { return with_ground_albedo(earth_bruneton(), albedo); };
  const auto error = [&](const auto& atmosphere, const std::vector<double>& positions, double position) {
    std::vector<SkyTables> tables;
    for (const double one : positions) tables.push_back(precompute_sky(atmosphere(one), options));
    const SkyTables between = interpolate_sky(atmosphere(position), tables, positions, position);
    const SkyTables computed = precompute_sky(atmosphere(position), options);
    CHECK(between.transmittance == computed.transmittance);
    CHECK(interpolate_sky(atmosphere(positions[1]), tables, positions, positions[1]).scattering ==
          tables[1].scattering);
    double off = 0.0;
    double all = 0.0;
    for (std::size_t i = 0; i < computed.scattering.size(); ++i) {
      const double difference =
          static_cast<double>(between.scattering[i]) - static_cast<double>(computed.scattering[i]);
      off += difference * difference;
      all += static_cast<double>(computed.scattering[i]) * static_cast<double>(computed.scattering[i]);
    }
    return std::sqrt(off / all);
  };
  const double ground = error(over, {0.0, 0.4, 0.8}, 0.6);
  const double haze = error(hazy, {0.5, 1.0, 2.0}, 1.4);
  CAPTURE(ground, haze);
  CHECK(ground < 6e-4);
  CHECK(haze < 1e-3);
  const std::vector<SkyTables> one(2, precompute_sky(over(0.0), options));
  CHECK_THROWS_AS(interpolate_sky(over(0.1), one, std::vector{0.0, 0.0}, 0.1), Error);
  CHECK_THROWS_AS(interpolate_sky(over(0.1), one, std::vector{0.0}, 0.1), Error);
}

}  // namespace welkin::test
