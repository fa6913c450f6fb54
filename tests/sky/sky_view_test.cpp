// Views of a sky, at every height and under every sun.
#include "jobs/tiles.h"
#include "reference/sky_reference.h"
#include "sky/air.h"
#include "sky/sky_geometry.h"
#include "sky/sky_slice.h"
#include "sky/sky_tables_for_tests.h"
#include "sky/spectrum.h"
#include "sky/sunlight.h"
#include "sky/table_mapping.h"
#include "support/catch.h"
#include "support/heap.h"
#include "support/random_atmospheres.h"
#include "support/thrown_error.h"
#include "support/trials.h"
#include "welkin/core.h"
#include "welkin/sky.h"

namespace welkin::test {

// A view is the same from every call and on every machine, symmetric, continuous and never negative.

namespace {

constexpr double kSpace = 500'000.0;
constexpr std::array<double, 5> kAltitudes{0.0, 1.7, 7000.0, 60'000.0, kSpace};

/// Directions all over, among them the axes, the sun, its opposite, the horizon, and lengths that are not 1.
std::vector<glm::vec3> some_directions(const glm::dvec3& sun, int count) {
  std::vector<glm::vec3> result{{0, 1, 0},     {0, -1, 0},     {1, 0, 0},         {0, 0, -1},          {0, 0, 1e-30F},
                                {0, 1e-8F, 1}, {0, -1e-8F, 1}, {3e37F, 1e37F, 0}, {1e-30F, 2e-30F, 0}, {0, 5, 3}};
  result.emplace_back(sun);
  result.emplace_back(-sun);
  std::mt19937 engine(7);
  const auto number = [&engine] { return static_cast<float>(engine()) * 0x1p-31F - 1.0F; };
  while (result.size() < static_cast<std::size_t>(count)) result.emplace_back(number(), 0.5F * number(), number());
  result.resize(static_cast<std::size_t>(count));
  return result;
}

std::vector<glm::dvec3> some_suns() {
  return {sun_direction(90.0, 0.0), sun_direction(35.0, 200.0),  sun_direction(0.0, 10.0),
          sun_direction(-5.0, 0.0), sun_direction(-31.0, 100.0), sun_direction(-90.0, 0.0)};
}

std::vector<glm::vec3> batch(const SkyView& view, const std::vector<glm::vec3>& directions, const glm::dvec3& sun) {
  std::vector<glm::vec3> rgb(directions.size());
  view.radiance(directions, sun, rgb);
  return rgb;
}

}  // namespace

TEST_CASE("sky view: one direction and many give the same bits", "[sky][view][determinism][slow]") {
  for (const double altitude : kAltitudes) {
    const SkyView view(small_view_tables(), altitude);
    for (const glm::dvec3& sun : some_suns()) {
      // 1 to 3: few directions; 257: so many that the slice is reduced to the sun first
      for (const int count : {0, 1, 2, 3, 15, 16, 17, 64, 65, 257}) {
        const std::vector<glm::vec3> directions = some_directions(sun, count);
        const std::vector<glm::vec3> many = batch(view, directions, sun);
        for (std::size_t i = 0; i < directions.size(); ++i) {
          const glm::dvec3 one = view.radiance(glm::dvec3(directions[i]), sun);
          CAPTURE(altitude, count, i);
          REQUIRE(std::memcmp(&many[i], std::array{glm::vec3(one)}.data(), sizeof(glm::vec3)) == 0);
        }
      }
    }
  }
}

// The readable counterpart: the same lookup by the slice's own functions, one direction at a time.

namespace {

glm::dvec3 twin(const SkyView& view, glm::dvec3 direction, const glm::dvec3& sun) {
  const sky::SkySlice& slice = SkyViewAccess::slice(view);
  const double bottom = slice.mapping().bottom_radius();
  const double r = bottom + slice.inside();
  direction /= glm::length(direction);
  const double nu = std::clamp(glm::dot(direction, sun), -1.0, 1.0);
  double mu = direction.y;
  double mu_s = sun.y;
  if (slice.outside()) {
    const double viewer = bottom + slice.altitude();
    const double nearest = viewer * std::sqrt(1.0 - mu * mu);
    if (mu >= 0.0 || nearest >= r) return {};
    const double root = std::sqrt(r * r - nearest * nearest);
    mu_s = (viewer * mu_s + (-viewer * mu - root) * nu) / r;
    mu = -root / r;
  }
  const sky::ViewLookup position = slice.view_lookup(mu);
  const sky::SunLookup under = slice.sun_lookup(mu_s);
  const double sines = std::sqrt((1.0 - mu * mu) * (1.0 - mu_s * mu_s));
  const sky::CubicTaps azimuth = slice.azimuth_taps(sines > 1e-9 ? (nu - mu * mu_s) / sines : 0.0, mu_s);
  // Along each axis the weighted sum, within a tenth of the range of the two nodes in the middle.
  const auto limited = [](const double(&values)[4], const sky::CubicTaps& taps, double a, double b) {
    double sum = 0.0;
    for (int i = 0; i < 4; ++i) sum += static_cast<double>(taps.weights[i]) * values[i];
    return std::clamp(sum, 0.9 * std::min(a, b), 1.1 * std::max(a, b));
  };
  const auto cubic = [&](const double(&values)[4], const sky::CubicTaps& taps, int between) {
    return limited(values, taps, values[between], values[between + 1]);
  };
  // Over suns the weights hold the ratios of the brightness there to that of the nodes.
  const auto over_suns = [&](const double(&values)[4]) {
    const sky::SunTaps& taps = under.taps;
    return limited(values, taps.cubic, static_cast<double>(taps.ratios[0]) * values[taps.cubic.between],
                   static_cast<double>(taps.ratios[1]) * values[taps.cubic.between + 1]);
  };
  // Index of the next of the four nodes below, from the signs of the weights, or from an end's weight of 1.
  const auto between = [](const sky::CubicTaps& taps) {
    if (taps.weights[2] < 0.0F || taps.weights[0] == 1.0F) return 0;
    return taps.weights[1] < 0.0F || taps.weights[3] == 1.0F ? 2 : 1;
  };
  double row[sky::kSkyRow]{};
  for (int k = 0; k < sky::kSkyRow; ++k) {
    double views[4];
    for (int a = 0; a < 4; ++a) {
      double azimuths[4];
      for (int b = 0; b < 4; ++b) {
        double suns[4];
        for (int c = 0; c < 4; ++c) {
          const int index = ((position.taps.first + a) * slice.azimuths() + azimuth.first + b) * slice.suns() +
                            under.taps.cubic.first + c;
          suns[c] = static_cast<double>(slice.values()[sky::kSkyRow * index + k]);
        }
        azimuths[b] = over_suns(suns);
      }
      views[a] = cubic(azimuths, azimuth, between(azimuth));
    }
    row[k] = cubic(views, position.taps, between(position.taps));
  }
  // The aureole's factors stand at even steps of sqrt(sin(angle / 2)), straight lines between them.
  const sky::SkyRun run = slice.run(sun);
  const double step = std::sqrt(std::sqrt(0.5 * (1.0 - nu))) * (sky::kAureoleAngles - 1);
  const auto low = std::min<std::size_t>(static_cast<std::size_t>(step), sky::kAureoleAngles - 2);
  const auto factor = [&](std::size_t angle, int k) {
    return run.hazy ? static_cast<double>(run.aureole[sky::kSkyColour * angle + static_cast<std::size_t>(k)]) : 1.0;
  };
  glm::dvec3 rgb;
  const glm::dvec3 ground = slice.ground_radiance((r * mu_s + position.distance * nu) / bottom);
  for (int k = 0; k < 3; ++k) {
    const double aureole = std::lerp(factor(low, k), factor(low + 1, k), step - static_cast<double>(low));
    rgb[k] = static_cast<double>(under.fade) * (std::max(row[k], 0.0) * sky::rayleigh_phase(nu) +
                                                std::max(row[4 + k], 0.0) * aureole * slice.aerosol_phase(nu)[k]);
    if (position.ground) rgb[k] += static_cast<double>(position.transmittance[k]) * ground[k];
  }
  return rgb;
}

}  // namespace

TEST_CASE("sky view: the kernel is its twin in double", "[sky][view][slow]") {
  for (const auto& tables : {small_view_tables(), crowded_view_tables()}) {
    for (const double altitude : kAltitudes) {
      const SkyView view(tables, altitude);
      const double horizon = sky::horizon_cosine(6'360'000.0, altitude);
      for (const glm::dvec3& sun : some_suns()) {
        double brightest = 0.0;
        double worst = 0.0;
        for (const glm::vec3& towards : some_directions(sun, 300)) {
          const glm::dvec3 direction(towards);
          // (of the horizon's own direction rounding decides what it meets)
          if (!(glm::length(direction) > 1e-20)) continue;
          if (std::abs(direction.y / glm::length(direction) - horizon) < 1e-6) continue;
          const glm::dvec3 found = view.radiance(direction, sun);
          const glm::dvec3 expected = twin(view, direction, sun);
          for (int c = 0; c < 3; ++c) {
            brightest = std::max(brightest, expected[c]);
            worst = std::max(worst, std::abs(found[c] - expected[c]));
          }
        }
        CAPTURE(tables->options.view_zeniths, altitude, sun.y);
        CHECK(worst <= 1e-5 * brightest);
      }
    }
  }
}

TEST_CASE("sky view: the two sides of the sun's plane are mirror images", "[sky][view]") {
  for (const double altitude : kAltitudes) {
    const SkyView view(small_view_tables(), altitude);
    for (const double elevation : {60.0, 3.0, -4.0}) {
      const glm::dvec3 sun = sun_direction(elevation, 0.0);
      for (const glm::vec3& towards : some_directions(sun, 200)) {
        const glm::dvec3 here = view.radiance(glm::dvec3(towards), sun);
        const glm::dvec3 there = view.radiance(glm::dvec3(-towards.x, towards.y, towards.z), sun);
        CHECK(here == there);
      }
    }
  }
}

TEST_CASE("sky view: there are no seams", "[sky][view][slow]") {
  // A step of 2e-7 radians in any direction changes the sky by next to nothing, but for the horizon.
  const auto step = [](const SkyView& view, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& sun) {
    const glm::dvec3 here = view.radiance(a, sun);
    const glm::dvec3 there = view.radiance(b, sun);
    return glm::length(here - there) / (glm::length(here) + glm::length(there) + 1e-12);
  };
  for (const auto& tables : {small_view_tables(), crowded_view_tables()}) {
    for (const double altitude : {0.0, 1.7, 7000.0, 60'000.0}) {
      const SkyView view(tables, altitude);
      const double horizon = sky::horizon_cosine(6'360'000.0, altitude);
      for (const double elevation : {70.0, 8.0, 0.0, -3.0}) {
        const glm::dvec3 sun = sun_direction(elevation, 0.0);
        for (int i = 0; i <= 400; ++i) {
          const double mu = -1.0 + 2.0 * i / 400.0;
          if (std::abs(mu - horizon) < 1e-3) continue;
          const auto at = [&](double cosine, double azimuth) {
            const glm::dvec3 level = sun_direction(0.0, azimuth);
            return std::sqrt(1.0 - cosine * cosine) * level + glm::dvec3(0.0, cosine, 0.0);
          };
          CAPTURE(tables->options.view_zeniths, altitude, elevation, mu);
          const double higher = std::min(1.0, mu + 2e-7);
          CHECK(step(view, at(mu, 40.0), at(higher, 40.0), sun) < 1e-4);
          CHECK(step(view, at(mu, 0.0), at(mu, 1e-5), sun) < 1e-4);
          CHECK(step(view, at(mu, 180.0), at(mu, 180.00001), sun) < 1e-4);
        }
      }
    }
  }
}

TEST_CASE("sky view: the sky does not jump as the sun sinks or the viewer climbs", "[sky][view]") {
  const std::vector<glm::vec3> directions = some_directions(sun_direction(5.0, 0.0), 60);
  const auto sum = [&](const SkyView& view, double elevation) {
    double all = 0.0;
    for (const glm::vec3& rgb : batch(view, directions, sun_direction(elevation, 0.0))) {
      all += static_cast<double>(rgb.x + rgb.y + rgb.z);
    }
    return all;
  };
  const SkyView ground(small_view_tables(), 0.0);
  const double noon = sum(ground, 90.0);
  for (double elevation = 90.0; elevation > -89.9; elevation -= 0.25) {
    CAPTURE(elevation);
    CHECK(std::abs(sum(ground, elevation) - sum(ground, elevation - 1e-5)) < 1e-4 * noon);
  }
  // At the top, where rays that come from space take over.
  const SkyView below(small_view_tables(), 60'000.0 - 1e-4);
  const SkyView top(small_view_tables(), 60'000.0);
  const SkyView above(small_view_tables(), 60'000.0 + 1e-4);
  const std::vector<glm::vec3> down{{0, -1, 0}, {0, -0.5F, 0.8F}, {0.3F, -0.3F, -0.7F}, {0, -0.15F, 1.0F}};
  for (const double elevation : {50.0, 2.0, -3.0}) {
    const glm::dvec3 sun = sun_direction(elevation, 0.0);
    for (std::size_t i = 0; i < down.size(); ++i) {
      const glm::vec3 here = batch(top, down, sun)[i];
      CAPTURE(elevation, i);
      CHECK(glm::length(batch(below, down, sun)[i] - here) <= 1e-4F * glm::length(here) + 1e-9F);
      CHECK(glm::length(batch(above, down, sun)[i] - here) <= 1e-4F * glm::length(here) + 1e-9F);
    }
  }
}

TEST_CASE("sky view: a ground that is not shown leaves the air before it", "[sky][view]") {
  const SkyView with(small_view_tables(), 3000.0);
  const SkyView without(small_view_tables(), 3000.0, {.ground = false});
  const glm::dvec3 sun = sun_direction(40.0, 0.0);
  for (const glm::vec3& towards : some_directions(sun, 100)) {
    const glm::dvec3 a = with.radiance(glm::dvec3(towards), sun);
    const glm::dvec3 b = without.radiance(glm::dvec3(towards), sun);
    if (towards.y < -0.1F * std::hypot(towards.x, towards.z)) {
      CHECK(a.g > b.g);
    } else if (towards.y > 0.0F) {
      CHECK(a == b);
    }
  }
  CHECK(SkyView(small_view_tables(), 0.0, {.ground = false}).radiance({0.0, -1.0, 0.0}, sun) == glm::dvec3(0.0));
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST_CASE("sky view: looking up allocates nothing", "[sky][view][allocation]") {
  const SkyView view(small_view_tables(), 100.0);
  const SkyView space(small_view_tables(), kSpace);
  const glm::dvec3 sun = sun_direction(10.0, 0.0);
  const std::vector<glm::vec3> directions = some_directions(sun, 1000);
  std::vector<glm::vec3> rgb(directions.size());
  double sum = 0.0;
  forget_allocations_in_tiles();
  jobs::run_tiles(1, jobs::Placement::calling_thread, 1, {}, [&](std::size_t, std::size_t) {
    for (const SkyView* const each : {&view, &space}) {
      sum += each->radiance(glm::dvec3(0.0, 0.5, 0.5), sun).r + each->sun_light(sun).irradiance.r +
             each->irradiance(sun).r;
      each->radiance(directions, sun, rgb);
      each->radiance(std::span(directions).first(20), sun, rgb);
    }
  });
  CHECK(allocations_in_tiles() == 0);
  CHECK(sum > 0.0);
}
#endif

TEST_CASE("sky view: what cannot be looked up is refused", "[sky][view][errors]") {
  const auto refused = [](const std::shared_ptr<const SkyTables>& tables, double altitude) {
    return thrown_by([&] { static_cast<void>(SkyView(tables, altitude)); });
  };
  CHECK(refused(nullptr, 0.0).says("tables is null"));
  for (const double altitude : {-1.0, 1.1e9, std::numeric_limits<double>::quiet_NaN()}) {
    const ThrownError error = refused(small_view_tables(), altitude);
    CHECK(error.code == ErrorCode::invalid_argument);
    CHECK(error.says("altitude"));
  }
  const auto broken = [&](auto change) {
    SkyTables tables = *small_view_tables();
    change(tables);
    return refused(std::make_shared<const SkyTables>(std::move(tables)), 0.0);
  };
  CHECK(broken([](SkyTables& t) { t.scattering.pop_back(); }).says("scattering"));
  CHECK(broken([](SkyTables& t) { t.single_mie.clear(); }).says("single_mie"));
  CHECK(broken([](SkyTables& t) { t.transmittance.push_back(0.0F); }).says("transmittance"));
  CHECK(broken([](SkyTables& t) { t.irradiance.clear(); }).says("irradiance"));
  CHECK(broken([](SkyTables& t) { t.options.heights = 1 << 20; }).says("heights"));
  CHECK(broken([](SkyTables& t) {
          t.options.minimum_sun_elevation_degrees = 5.0;
        }).says("minimum_sun_elevation_degrees"));
  CHECK(broken([](SkyTables& t) { t.atmosphere.bottom_radius_m = -1.0; }).code == ErrorCode::invalid_argument);
  const SkyView view(small_view_tables(), 0.0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const glm::dvec3& sun : {glm::dvec3(0.0), glm::dvec3(0.0, nan, 1.0), glm::dvec3(infinity, 0.0, 0.0)}) {
    std::vector<glm::vec3> one(1);
    CHECK(thrown_by([&] { static_cast<void>(view.radiance({0.0, 1.0, 0.0}, sun)); }).says("sun's direction"));
    CHECK(thrown_by([&] { view.radiance(one, sun, one); }).code == ErrorCode::invalid_argument);
    CHECK(thrown_by([&] { static_cast<void>(view.sun_light(sun)); }).code == ErrorCode::invalid_argument);
    CHECK(thrown_by([&] { static_cast<void>(view.irradiance(sun)); }).code == ErrorCode::invalid_argument);
    CHECK(thrown_by([&] { static_cast<void>(sky_cubemap(view, sun, 2)); }).code == ErrorCode::invalid_argument);
    CHECK(thrown_by([&] { static_cast<void>(sky_lat_long(view, sun, 2)); }).code == ErrorCode::invalid_argument);
  }
  std::vector<glm::vec3> directions(3);
  std::vector<glm::vec3> rgb(2);
  CHECK(thrown_by([&] { view.radiance(directions, {0.0, 1.0, 0.0}, rgb); }).says("rgb has 2"));
}

// Nothing that is not finite, nothing below zero: any planet, any height, any sun.

namespace {

bool sound(const glm::dvec3& rgb) {
  bool result = true;
  for (int c = 0; c < 3; ++c) result = result && std::isfinite(rgb[c]) && rgb[c] >= 0.0;
  return result;
}

/// Smallest tables with anything in them, some with fewer nodes than a cubic takes.
SkyTableOptions tiny(RandomAtmospheres& random) {
  SkyTableOptions options{.layout = random.chance(0.3) ? ScatteringLayout::compact : ScatteringLayout::full,
                          .heights = random.whole(2, 5),
                          .view_zeniths = 2 * random.whole(2, 5),
                          .sun_zeniths = random.whole(4, 8),
                          .sun_angles = random.whole(2, 5),
                          .transmittance_heights = random.whole(2, 6),
                          .transmittance_zeniths = random.whole(4, 16),
                          .irradiance_heights = random.whole(2, 4),
                          .irradiance_sun_zeniths = random.whole(4, 8),
                          .orders = 1};
  return options;
}

}  // namespace

TEST_CASE("sky view: random atmospheres look finite and not negative", "[sky][view][random][truth]") {
  RandomAtmospheres random(20'261'121);
  for (int i = 0; i < trials(20); ++i) {
    const Atmosphere air = random.next();
    const auto tables = sky_tables_of(air, tiny(random));
    const double thickness = air.top_radius_m - air.bottom_radius_m;
    for (const double altitude :
         {0.0, std::min(1e9, 1e-9 * thickness), std::min(1e9, random.number() * thickness), std::min(1e9, thickness),
          std::min(1e9, thickness * (1.0 + 1e-12)), std::min(1e9, 10.0 * air.bottom_radius_m)}) {
      CAPTURE(i, altitude, air.bottom_radius_m, thickness);
      const SkyView view(tables, altitude);
      bool all = true;
      for (int k = 0; k < 60; ++k) {
        const double elevation = k < 10 ? 90.0 - 20.0 * k : random.between(-90.0, 90.0);
        const glm::dvec3 sun = sun_direction(elevation, random.between(0.0, 360.0));
        const glm::dvec3 towards =
            k % 7 == 0   ? sun
            : k % 7 == 1 ? -sun
                         : sun_direction(random.chance(0.3) ? random.between(-1e-6, 1e-6) : random.between(-90.0, 90.0),
                                         random.between(0.0, 360.0));
        all = all && sound(view.radiance(towards, sun)) && sound(view.sun_light(sun).irradiance) &&
              sound(view.sun_light(sun).radiance) && sound(view.irradiance(sun));
      }
      CHECK(all);
    }
  }
}

namespace {

/// The largest of the three channels.
double largest_relative_error(const glm::dvec3& rgb, const glm::dvec3& truth) {
  double largest = 0.0;
  for (int c = 0; c < 3; ++c) largest = std::max(largest, std::abs(rgb[c] / truth[c] - 1.0));
  return largest;
}

}  // namespace

TEST_CASE("sky view: by day the compact table is the full one but for what it leaves out", "[sky][view][truth]") {
  const auto full = sky_tables_of(earth_bruneton());
  const auto compact = sky_tables_of(earth_bruneton(), {.layout = ScatteringLayout::compact});
  const glm::dvec3 overhead = sun_direction(90.0, 0.0);
  for (const double altitude : {0.0, 700.0, 2000.0, 5000.0, 12'000.0, 35'000.0}) {
    const SkyView a(full, altitude);
    const SkyView b(compact, altitude);
    CAPTURE(altitude);
    for (const double elevation : {90.0, 80.0}) {
      const glm::dvec3 sun = sun_direction(elevation, 0.0);
      CHECK(largest_relative_error(b.irradiance(sun), a.irradiance(sun)) < 3e-4);
    }
    if (altitude > 5000.0) continue;
    // It leaves out the azimuth, which a sun overhead has not, and guesses two channels of the forward lobe, which
    // shows nearer to the sun than this.
    for (double elevation = 5.0; elevation <= 45.0; elevation += 5.0) {
      const glm::dvec3 towards = sun_direction(elevation, 40.0);
      CAPTURE(elevation);
      CHECK(largest_relative_error(b.radiance(towards, overhead), a.radiance(towards, overhead)) < 2.5e-3);
    }
  }
}

TEST_CASE("sky view: folded colours are the folded truth", "[sky][view][truth]") {
  const Atmosphere air = earth_bruneton({400.0, 450.0, 500.0, 550.0, 600.0, 650.0, 700.0});
  const SkyView view = sky_view_of(
      air, {.heights = 4, .view_zeniths = 32, .sun_zeniths = 32, .orders = 1, .colour = SkyColour::linear_srgb});
  const std::vector<glm::dvec3> weights = sky::srgb_weights(air.wavelengths_nm);
  const auto folded = [&](const std::vector<double>& values) {
    glm::dvec3 sum{};
    for (std::size_t i = 0; i < values.size(); ++i) sum += weights[i] * values[i];
    return sum;
  };
  for (const double elevation : {60.0, 10.0}) {
    const glm::dvec3 sun = sun_direction(elevation, 0.0);
    for (const glm::dvec3& towards :
         {glm::dvec3(0, 1, 0), glm::dvec3(0.6, 0.529, 0.6), glm::dvec3(-0.8, 0.2, -0.565)}) {
      const glm::dvec3 unit = glm::normalize(towards);
      const glm::dvec3 truth = folded(reference_sky_radiance(air, 0.0, unit, sun, {1e-6, true}));
      const glm::dvec3 found = view.radiance(unit, sun);
      for (int c = 0; c < 3; ++c) CHECK(found[c] == Approx(std::max(truth[c], 0.0)).epsilon(0.005));
    }
    const glm::dvec3 light = folded(reference_sun_irradiance(air, 0.0, sun));
    for (int c = 0; c < 3; ++c) CHECK(view.sun_light(sun).irradiance[c] == Approx(light[c]).epsilon(0.002));
  }
}

}  // namespace welkin::test
