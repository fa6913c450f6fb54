// The sun's position by date and site, against astropy's and against geometry.
#include <glm/geometric.hpp>

#include "math/elementary.h"
#include "places.h"
#include "support/catch.h"
#include "support/sun_maps.h"
#include "support/thrown_error.h"
#include "welkin/sky.h"

namespace welkin::test {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// +x east, y up, -z north.
dvec3 by_compass(double elevation, double compass) {
  return {std::cos(elevation * kDegree) * std::sin(compass * kDegree), std::sin(elevation * kDegree),
          -std::cos(elevation * kDegree) * std::cos(compass * kDegree)};
}

double elevation_at(double seconds, double latitude, double longitude) {
  return sun_position(seconds, {.latitude_degrees = latitude, .longitude_degrees = longitude}).elevation_degrees;
}

/// Where `rises` becomes false, to a hundredth of a second.
template <class Rises>
double turning_point(double low, double high, const Rises& rises) {
  while (high - low > 0.01) {
    const double middle = 0.5 * (low + high);
    (rises(middle) ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

bool is_refused(const std::string& date, const std::string& reason) {
  const ThrownError error = thrown_by([&] { static_cast<void>(unix_seconds(date)); });
  INFO(error.message);
  return error.code == ErrorCode::invalid_argument && error.says(reason) && error.says(date.substr(0, 10));
}

}  // namespace

TEST_CASE("sun position: within 0.001 degrees of astropy's from 1950 to 2050", "[sky][sun_position]") {
  std::ifstream file(WELKIN_TEST_DATA "/suns.txt");
  REQUIRE(file);
  int rows = 0;
  double worst = 0.0;
  double worst_refracted = 0.0;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream row(line);
    std::string date;
    SunObserver observer;
    double elevation = 0.0;
    double compass = 0.0;
    double seen = 0.0;
    REQUIRE(row >> date >> observer.latitude_degrees >> observer.longitude_degrees >> elevation >> compass >> seen);
    ++rows;
    const SunPosition sun = sun_position(date, observer);
    worst = std::max(worst, degrees_between(sun.direction, by_compass(elevation, compass)));
    CHECK(degrees_between(by_compass(sun.elevation_degrees, sun.compass_degrees), sun.direction) < 1e-9);
    observer.refraction = true;
    const SunPosition raised = sun_position(date, observer);
    CHECK(raised.elevation_degrees - raised.refraction_degrees == Approx(sun.elevation_degrees).margin(1e-9));
    if (elevation > 5.0) worst_refracted = std::max(worst_refracted, std::abs(raised.elevation_degrees - seen));
  }
  CHECK(rows == 404);
  CHECK(worst < 0.001);           // 0.0007
  CHECK(worst_refracted < 0.01);  // astropy's own formula, in the tangent and its cube, fails near the horizon
}

TEST_CASE("sun position: equinoxes, solstices, perihelion and noon are where almanacs have them",
          "[sky][sun_position]") {
  // Seen from the poles the elevation is the declination, less the parallax and plus it: half the difference.
  const auto declination = [](double seconds) {
    return 0.5 * (elevation_at(seconds, 90.0, 0.0) - elevation_at(seconds, -90.0, 0.0));
  };
  // "The Astronomical Almanac" for 2024: 20 March 03:06, 22 September 12:44 UT. A degree is a day's way, 0.01 36 min.
  CHECK(std::abs(declination(unix_seconds("2024-03-20T03:06:24Z"))) < 0.0005);
  CHECK(std::abs(declination(unix_seconds("2024-09-22T12:43:40Z"))) < 0.0005);
  CHECK(declination(unix_seconds("2024-06-20T20:51Z")) == Approx(23.4385).margin(0.001));
  CHECK(declination(unix_seconds("2024-12-21T09:20Z")) == Approx(-23.4383).margin(0.001));
  const auto distance = [](const char* date) { return sun_position(date, {}).distance_au; };
  CHECK(distance("2024-01-03T00:39Z") == Approx(0.983307).margin(5e-5));
  CHECK(distance("2024-07-05T05:06Z") == Approx(1.016725).margin(5e-5));

  // Noon: due south, highest, and 90 - latitude + declination up. The equation of time on 2024-11-03 is +16 min 27 s.
  const SunObserver greenwich{.latitude_degrees = 51.4779};
  const double start = unix_seconds("2024-11-03T11:00Z");
  const double noon = turning_point(start, start + 7200.0,
                                    [&](double s) { return sun_position(s, greenwich).compass_degrees < 180.0; });
  CHECK(noon - start == Approx(3600.0 - 987.0).margin(3.0));
  const SunPosition sun = sun_position(noon, greenwich);
  CHECK(sun.elevation_degrees + 8.794 / 3600.0 * std::cos(sun.elevation_degrees * kDegree) ==
        Approx(90.0 - 51.4779 + declination(noon)).margin(1e-4));
  CHECK(sun.direction.z > 0.0);
  CHECK(std::abs(sun.azimuth_degrees) < 1e-3);
}

TEST_CASE("sun position: azimuths are those of sun_direction, and north may be put elsewhere", "[sky][sun_position]") {
  SunObserver berlin{.latitude_degrees = 52.5, .longitude_degrees = 13.4};
  const SunPosition evening = sun_position("2026-06-21T18:30Z", berlin);
  CHECK(evening.elevation_degrees == Approx(6.9232).margin(0.002));
  CHECK(evening.compass_degrees == Approx(299.9915).margin(0.002));
  CHECK(evening.azimuth_degrees == Approx(180.0 - evening.compass_degrees).margin(1e-9));
  CHECK(evening.direction == sun_direction(evening.elevation_degrees, evening.azimuth_degrees));
  CHECK(evening.direction.x < 0.0);  // west
  const SunPosition morning = sun_position("2026-06-21T05:00Z", berlin);
  CHECK(morning.direction.x > 0.0);  // east
  berlin.north_azimuth_degrees = 0.0;
  const SunPosition rotated = sun_position("2026-06-21T18:30Z", berlin);
  CHECK(degrees_between(rotated.direction, dvec3(-1.0, 1.0, -1.0) * evening.direction) < 1e-9);
  CHECK(rotated.compass_degrees == evening.compass_degrees);

  // Longitudes that are 360 degrees apart are the same site.
  const double moment = unix_seconds("2000-05-05T05:05:05Z");
  const SunObserver here{.latitude_degrees = -33.0, .longitude_degrees = 151.0};
  const SunObserver around{.latitude_degrees = -33.0, .longitude_degrees = 151.0 - 360.0};
  CHECK(degrees_between(sun_position(moment, here).direction, sun_position(moment, around).direction) < 1e-9);
  // At the poles and at the nadir and zenith nothing becomes NaN.
  for (const double latitude : {-90.0, 90.0, 0.0, 23.44}) {
    for (int hour = 0; hour < 24; ++hour) {
      const SunPosition sun = sun_position(unix_seconds("2024-06-20T00:00Z") + 3600.0 * hour,
                                           {.latitude_degrees = latitude, .refraction = true});
      CHECK(glm::length(sun.direction) == Approx(1.0).epsilon(1e-14));
      CHECK((sun.compass_degrees >= 0.0 && sun.compass_degrees < 360.0));
    }
  }
}

TEST_CASE("sun position: refraction is continuous and that of tables", "[sky][sun_position]") {
  // 29' at a true elevation of 0 (34' at an apparent one); 5.4' at 10 degrees, 1' at 45 (Meeus, chapter 16).
  SunObserver observer{.refraction = true};
  const double start = unix_seconds("2024-03-20T03:00Z");
  const auto raised = [&](double elevation) {
    const auto below = [&](double s) { return elevation_at(s, 0.0, 0.0) < elevation; };
    return sun_position(turning_point(start, start + 9 * 3600.0, below), observer).refraction_degrees * 60.0;
  };
  CHECK(raised(0.0) == Approx(28.9).margin(0.3));
  CHECK(raised(10.0) == Approx(5.4).margin(0.1));
  CHECK(raised(45.0) == Approx(1.0).margin(0.05));
  observer.pressure_hpa = 505.0;
  CHECK(raised(10.0) == Approx(2.7).margin(0.05));
  observer.pressure_hpa = 1010.0;
  double last = sun_position(start, observer).refraction_degrees;
  for (double s = start; s < start + 9 * 3600.0; s += 4.0) {
    const double next = sun_position(s, observer).refraction_degrees;
    CHECK(std::abs(next - last) < 0.02);  // while the sun moves by 0.0167
    CHECK(next >= 0.0);
    last = next;
  }
}

TEST_CASE("sun position: dates are read in their time zone, and refused with a reason", "[sky][sun_position]") {
  CHECK(unix_seconds("1970-01-01T00:00Z") == 0.0);
  CHECK(unix_seconds("2000-02-29T23:59:59.25Z") == 951868799.25);
  CHECK(unix_seconds("2026-06-21T18:30Z") == 1782066600.0);
  CHECK(unix_seconds("1950-01-01 00:00:00Z") == -631152000.0);
  CHECK(unix_seconds("2026-06-21T20:30+02:00") == unix_seconds("2026-06-21T18:30Z"));
  CHECK(unix_seconds("2026-06-21t13:00:00-0530") == unix_seconds("2026-06-21T18:30z"));
  CHECK(unix_seconds("2026-06-21T20:30+02") == unix_seconds("2026-06-21T18:30Z"));
  CHECK(unix_seconds("2025-12-31T23:30-01:00") == unix_seconds("2026-01-01T00:30Z"));
  CHECK(unix_seconds("2016-12-31T23:59:60Z") == unix_seconds("2017-01-01T00:00:00Z"));
  CHECK(unix_seconds("2017-01-01T00:59:60.5+01:00") == unix_seconds("2017-01-01T00:00:00.5Z"));
  CHECK(is_refused("2026-06-21T18:30", "no time zone"));
  CHECK(is_refused("2026-06-31T18:30Z", "day 31"));
  CHECK(is_refused("2025-02-29T18:30Z", "day 29"));
  CHECK(is_refused("1900-02-29T18:30Z", "day 29"));
  CHECK(is_refused("2026-13-01T18:30Z", "month 13"));
  CHECK(is_refused("2026-06-21T24:00Z", "hour 24"));
  CHECK(is_refused("2026-06-21T18:60Z", "minute 60"));
  CHECK(is_refused("2026-06-21T18:30:60Z", "leap second"));
  CHECK(is_refused("2026-06-21T18:30:61Z", "second 61"));
  CHECK(is_refused("2026-06-21T18:30:00.Z", "decimal point"));
  CHECK(is_refused("2026-06-21T18:30+24:00", "zone's hour 24"));
  CHECK(is_refused("2026-06-21T18:30Z ", "goes on"));
  CHECK(is_refused("2026-6-21T18:30Z", "month of 2 digits"));
  CHECK(is_refused("21.06.2026 18:30", "year of 4 digits"));
  CHECK(is_refused("", "year of 4 digits"));
  const auto refused = [](const char* date, const SunObserver& observer, const char* reason) {
    const ThrownError error = thrown_by([&] { static_cast<void>(sun_position(date, observer)); });
    return error.code == ErrorCode::invalid_argument && error.says(reason);
  };
  CHECK(refused("1899-12-31T23:59Z", {}, "1900 to 2099"));
  CHECK(refused("2100-01-01T00:00Z", {}, "1900 to 2099"));
  CHECK_NOTHROW(sun_position("1900-01-01T00:00Z", {}));
  CHECK_NOTHROW(sun_position("2099-12-31T23:59Z", {}));
  CHECK(refused("2026-06-21T18:30Z", {.latitude_degrees = 90.5}, "latitude is 90.5"));
  CHECK(refused("2026-06-21T18:30Z", {.longitude_degrees = std::numeric_limits<double>::quiet_NaN()}, "longitude"));
  CHECK(refused("2026-06-21T18:30Z", {.temperature_celsius = -273.0}, "temperature"));
}

}  // namespace welkin::test
