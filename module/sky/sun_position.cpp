// The sun's position in the sky of an observer on Earth.
//
// The method is that of Reda and Andreas 2004, "Solar position algorithm for solar radiation applications", Solar
// Energy 76 (5), with its series cut off. Equations by their numbers in NREL/TP-560-34302 (2008). What is left out, in
// degrees: terms of longitude below 2e-6 rad (0.0003 in total), latitude of the ecliptic (0.0003), all but four terms
// of nutation (0.0002), polar motion (0.0001), the ellipsoid in parallax (0.00001).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <string_view>

#include "math/elementary.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "welkin/core.h"
#include "welkin/sky.h"

namespace welkin {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kArcSecond = 1.0 / (360.0 * 3600.0);  // turns
constexpr double kDay = 86400.0;                       // seconds
constexpr double kEpoch = 10957.5;                     // days from 1970 to J2000, the noon of 2000-01-01
constexpr double kCentury = 36525.0;                   // days

/// One term of the series of table A4.2: amplitude cos(phase + rate x millennia).
struct Term {
  double amplitude;  ///< 1e-8 rad
  double phase;      ///< rad
  double rate;       ///< rad per Julian millennium
};

/// L0 of table A4.2 from 2e-6 rad on, without its constant.
constexpr std::array<Term, 25> kLongitude{{
    {3341656.0, 4.6692568, 6283.07585},
    {34894.0, 4.6261, 12566.1517},
    {3497.0, 2.7441, 5753.3849},
    {3418.0, 2.8289, 3.5231},
    {3136.0, 3.6277, 77713.7715},
    {2676.0, 4.4181, 7860.4194},
    {2343.0, 6.1352, 3930.2097},
    {1324.0, 0.7425, 11506.7698},
    {1273.0, 2.0371, 529.691},
    {1199.0, 1.1096, 1577.3435},
    {990.0, 5.233, 5884.927},
    {902.0, 2.045, 26.298},
    {857.0, 3.508, 398.149},
    {780.0, 1.179, 5223.694},
    {753.0, 2.533, 5507.553},
    {505.0, 4.583, 18849.228},
    {492.0, 4.205, 775.523},
    {357.0, 2.92, 0.067},
    {317.0, 5.849, 11790.629},
    {284.0, 1.899, 796.298},
    {271.0, 0.315, 10977.079},
    {243.0, 0.345, 5486.778},
    {206.0, 4.806, 2544.314},
    {205.0, 1.869, 5573.143},
    {202.0, 2.458, 6069.777},
}};

/// The first terms of L1, 1e-8 rad per millennium.
constexpr std::array<Term, 2> kLongitudeRate{{{206059.0, 2.678235, 6283.07585}, {4303.0, 2.6351, 12566.1517}}};

/// The first terms of R0, 1e-8 astronomical units.
constexpr std::array<Term, 2> kDistance{{{1670700.0, 3.0984635, 6283.07585}, {13956.0, 3.05525, 12566.1517}}};

double cosine_of(double radians) { return math::sine_cosine_of_turns(radians / kTurn).cosine; }

template <std::size_t Count>
double sum_of(const std::array<Term, Count>& terms, double millennia) {
  double sum = 0.0;
  for (const Term& term : terms) sum += term.amplitude * cosine_of(term.phase + term.rate * millennia);
  return sum;
}

/// A polynomial of Espenak and Meeus 2006, "Five Millennium Canon of Solar Eclipses" (NASA/TP-2006-214141), section
/// 2.8: seconds from universal to terrestrial time, by years since `origin`.
struct DeltaTime {
  double until;  ///< year
  double origin;
  std::array<double, 6> coefficients;
};

constexpr std::array<DeltaTime, 7> kDeltaTimes{{
    {1920.0, 1900.0, {-2.79, 1.494119, -0.0598939, 0.0061966, -0.000197, 0.0}},
    {1941.0, 1920.0, {21.20, 0.84493, -0.076100, 0.0020936, 0.0, 0.0}},
    {1961.0, 1950.0, {29.07, 0.407, -1.0 / 233.0, 1.0 / 2547.0, 0.0, 0.0}},
    {1986.0, 1975.0, {45.45, 1.067, -1.0 / 260.0, -1.0 / 718.0, 0.0, 0.0}},
    {2005.0, 2000.0, {63.86, 0.3345, -0.060374, 0.0017275, 0.000651814, 0.00002373599}},
    {2050.0, 2000.0, {62.92, 0.32217, 0.005589, 0.0, 0.0, 0.0}},
    {2150.0, 1820.0, {-205.724, 0.5628, 0.0032, 0.0, 0.0, 0.0}},  // -20 + 32 u^2 - 0.5628 (2150 - y)
}};

/// An error of a second moves the sun by 0.00001 degrees.
double delta_time_seconds(double year) {
  const DeltaTime* row = kDeltaTimes.data();
  while (row + 1 < kDeltaTimes.data() + kDeltaTimes.size() && year >= row->until) ++row;
  double sum = 0.0;
  for (std::size_t k = row->coefficients.size(); k-- > 0;) sum = sum * (year - row->origin) + row->coefficients[k];
  return sum;
}

/// The sun's position among the stars and the Earth's rotation at a moment, in turns.
struct Apparent {
  double right_ascension;
  double declination;
  double sidereal_time;  ///< of Greenwich, apparent
  double distance_au;
};

Apparent apparent_sun(double unix_seconds) {
  const double days = unix_seconds / kDay - kEpoch;  // universal time, from J2000
  const double delta = delta_time_seconds(2000.0 + days / 365.25);
  const double centuries = (days + delta / kDay) / kCentury;  // terrestrial time (7)
  const double t = centuries / 10.0;                          // (8)

  // Longitude of the Earth and distance (9 to 12), and of the sun (13).
  // (10) sums L_0 + L_1 t + L_2 t^2 + ...; the constant of L_2 is 52919e-8. Its other terms, L_3 and on stay below 1e-6
  // rad in the years that are accepted (|t| <= 0.1 millennia).
  const double linear = 628331966747.0 + sum_of(kLongitudeRate, t) + 52919.0 * t;
  const double earth = (175347046.0 + sum_of(kLongitude, t) + linear * t) / (1e8 * kTurn);
  const double distance = 1.00013989 + 1e-8 * sum_of(kDistance, t);

  // Nutation: the four largest terms (Meeus, "Astronomical Algorithms", chapter 22), which stand for equations 15
  // to 23.
  const auto node = math::sine_cosine_of_turns((125.04452 - 1934.136261 * centuries) / 360.0);
  const auto sun = math::sine_cosine_of_turns(2.0 * (280.4665 + 36000.7698 * centuries) / 360.0);
  const auto moon = math::sine_cosine_of_turns(2.0 * (218.3165 + 481267.8813 * centuries) / 360.0);
  // 0.21 sin(2 node) = 0.42 sin cos, and -0.09 cos(2 node) = -0.09 (cos - sin) (cos + sin).
  const double in_longitude = -17.20 * node.sine - 1.32 * sun.sine - 0.23 * moon.sine + 0.42 * node.sine * node.cosine;
  const double in_obliquity = 9.20 * node.cosine + 0.57 * sun.cosine + 0.10 * moon.cosine -
                              0.09 * (node.cosine - node.sine) * (node.cosine + node.sine);
  // Obliquity (24, 25), aberration (26), apparent longitude (27).
  const double obliquity = (84381.448 - 46.815 * centuries + in_obliquity) * kArcSecond;
  const double longitude = earth + 0.5 + (in_longitude - 20.4898 / distance) * kArcSecond;

  // Sidereal time at Greenwich (28, 29), by whole days apart so that no digits are lost.
  const auto tilt = math::sine_cosine_of_turns(obliquity);
  // (28) is 280.46061837 + 360.98564736629 days + 0.000387933 T^2 degrees: of the 360 per day only the fraction of a
  // day counts.
  const double rotation = 280.46061837 / 360.0 + (days - std::floor(days)) + 0.98564736629 / 360.0 * days +
                          0.000387933 / 360.0 * centuries * centuries;
  const double sidereal = rotation + in_longitude * kArcSecond * tilt.cosine;

  // Right ascension and declination (30, 31) for latitude 0.
  const auto along = math::sine_cosine_of_turns(longitude);
  const double y = along.sine * tilt.cosine;
  const double z = along.sine * tilt.sine;
  return {math::turns_of(y, along.cosine), math::turns_of(z, std::sqrt(1.0 - z * z)), sidereal, distance};
}

/// Degrees by which air raises what stands at an elevation (42, without its correction below the horizon: under an
/// elevation of -0.575 degrees the ray would meet the ground, and the angle falls off as the tangent grows).
double refraction_at(double elevation_degrees, const SunObserver& observer) {
  constexpr double kLowest = -0.575;
  const auto tangent = [](double degrees) {
    const auto angle = math::sine_cosine_of_turns(degrees / 360.0);
    return angle.sine / angle.cosine;
  };
  const double seen = std::max(elevation_degrees, kLowest);
  const double raised = 1.02 / 60.0 / tangent(seen + 10.3 / (seen + 5.11));
  const double fall = elevation_degrees < kLowest ? tangent(kLowest) / tangent(elevation_degrees) : 1.0;
  return std::max(0.0, observer.pressure_hpa / 1010.0 * 283.0 / (273.0 + observer.temperature_celsius) * raised * fall);
}

void check(double unix_seconds, const SunObserver& observer) {
  // 1900-01-01 and 2100-01-01.
  if (!(unix_seconds >= -25567.0 * kDay && unix_seconds < 47482.0 * kDay)) {
    throw Error(ErrorCode::invalid_argument, "sun_position: the date is " + platform::number_text(unix_seconds) +
                                                 " s after 1970; the sun's place is computed from 1900 to 2099");
  }
  platform::require_between("the observer's latitude", observer.latitude_degrees, -90.0, 90.0);
  platform::require_between("the observer's longitude", observer.longitude_degrees, -360.0, 360.0);
  platform::require_between("the azimuth of north", observer.north_azimuth_degrees, -1e6, 1e6);
  platform::require_between("the air's pressure in hPa", observer.pressure_hpa, 0.0, 2000.0);
  platform::require_between("the air's temperature in degrees Celsius", observer.temperature_celsius, -120.0, 100.0);
}

/// Degrees, from -180 to below 180.
double wrapped(double turns) { return (turns - std::floor(turns + 0.5)) * 360.0; }

}  // namespace

SunPosition sun_position(double unix_seconds, const SunObserver& observer) {
  const platform::FloatingPointScope floating_point;
  check(unix_seconds, observer);
  const Apparent sun = apparent_sun(unix_seconds);
  const double hour_angle = sun.sidereal_time + observer.longitude_degrees / 360.0 - sun.right_ascension;  // (32)
  const auto hour = math::sine_cosine_of_turns(hour_angle - std::floor(hour_angle));
  const auto latitude = math::sine_cosine_of_turns(observer.latitude_degrees / 360.0);
  const auto declination = math::sine_cosine_of_turns(sun.declination);
  // The sun's unit vector (cos d cos H, cos d sin H, sin d), H the hour angle westwards, rotated about the west axis by
  // the colatitude. Angles follow by arctangents of two components: the arcsine of (41) loses half of its digits near
  // the zenith.
  const double south = declination.cosine * hour.cosine * latitude.sine - declination.sine * latitude.cosine;
  const double west = declination.cosine * hour.sine;
  const double up = declination.sine * latitude.sine + declination.cosine * hour.cosine * latitude.cosine;
  const double level = std::sqrt(south * south + west * west);

  SunPosition position;
  // Elevation (41), less the parallax (33): 8.794 arc seconds seen from the mean distance, for a sun on the horizon.
  position.elevation_degrees = 360.0 * (math::turns_of(up, level) - 8.794 * kArcSecond / sun.distance_au * level);
  if (observer.refraction) {
    position.refraction_degrees = refraction_at(position.elevation_degrees, observer);
    position.elevation_degrees += position.refraction_degrees;
  }
  position.elevation_degrees = std::clamp(position.elevation_degrees, -90.0, 90.0);
  // From south towards east, which the axes have as from +z towards +x where north lies at 180 degrees (45, 46).
  const double from_south = math::turns_of(-west, south);
  position.azimuth_degrees = wrapped(from_south + (observer.north_azimuth_degrees - 180.0) / 360.0);
  const double compass = wrapped(0.5 - from_south);
  position.compass_degrees = compass < 0.0 ? compass + 360.0 : compass;
  position.distance_au = sun.distance_au;
  position.direction = sun_direction(position.elevation_degrees, position.azimuth_degrees);
  return position;
}

// Dates as people write them.

namespace {

/// Reads a date from the left.
class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text), rest_(text) {}

  [[noreturn]] void refuse(const std::string& why) const {
    throw Error(ErrorCode::invalid_argument,
                "the date \"" + std::string(text_.substr(0, 64)) + "\" " + why +
                    "; write it as 2026-06-21T18:30Z, 2026-06-21T18:30:15.5Z or 2026-06-21T20:30+02:00");
  }

  [[nodiscard]] bool skip(char c) {
    if (rest_.empty() || rest_.front() != c) return false;
    rest_.remove_prefix(1);
    return true;
  }
  void expect(char c) {
    if (!skip(c))
      refuse(std::string("lacks '") + c + "' where it ends or has \"" + std::string(rest_.substr(0, 8)) + '"');
  }

  /// Reads `digits` digits; throws unless the number is from `lowest` to `highest`.
  int number(const char* what, std::size_t digits, int lowest, int highest) {
    int value = 0;
    for (std::size_t k = 0; k < digits; ++k) {
      if (k >= rest_.size() || rest_[k] < '0' || rest_[k] > '9') {
        refuse(std::string("has no ") + what + " of " + std::to_string(digits) + " digits");
      }
      value = 10 * value + (rest_[k] - '0');
    }
    rest_.remove_prefix(digits);
    if (value < lowest || value > highest) {
      refuse(std::string("has the ") + what + " " + std::to_string(value) + ", which must be from " +
             std::to_string(lowest) + " to " + std::to_string(highest));
    }
    return value;
  }

  /// Reads the digits after a decimal point; those after the ninth are ignored.
  double fraction() {
    double value = 0.0;
    double unit = 1.0;
    std::size_t digits = 0;
    for (; !rest_.empty() && rest_.front() >= '0' && rest_.front() <= '9'; rest_.remove_prefix(1), ++digits) {
      if (digits >= 9) continue;
      value = 10.0 * value + (rest_.front() - '0');
      unit *= 10.0;
    }
    if (digits == 0) refuse("has no digits behind its decimal point");
    return value / unit;
  }

  [[nodiscard]] bool at_end() const { return rest_.empty(); }

 private:
  std::string_view text_;
  std::string_view rest_;
};

int days_of_month(int year, int month) {
  constexpr std::array<int, 12> days{31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
  const bool leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
  return days[static_cast<std::size_t>(month - 1)] + (month == 2 && leap ? 1 : 0);
}

/// Days from 1970-01-01, in the Gregorian calendar. Years begin in March, so that the leap day is their last.
int days_from_1970(int year, int month, int day) {
  // From March on months have 31, 30, 31, 30, 31 days again and again, 153 in five: (153 m + 2) / 5 days lie before
  // month m (March: 0). 719468 days lie between 0000-03-01 and 1970-01-01.
  const int shifted = month <= 2 ? year - 1 : year;
  const int of_year = (153 * (month > 2 ? month - 3 : month + 9) + 2) / 5 + day - 1;
  return 365 * shifted + shifted / 4 - shifted / 100 + shifted / 400 + of_year - 719468;
}

/// Minutes by which the zone is ahead of universal time.
int zone_minutes(Reader& reader) {
  if (reader.skip('Z') || reader.skip('z')) return 0;
  const bool ahead = reader.skip('+');
  if (!ahead && !reader.skip('-')) reader.refuse("has no time zone (Z, or hours and minutes such as +02:00)");
  const int hours = reader.number("zone's hour", 2, 0, 23);
  (void)reader.skip(':');
  const int minutes = 60 * hours + (reader.at_end() ? 0 : reader.number("zone's minute", 2, 0, 59));
  return ahead ? minutes : -minutes;
}

}  // namespace

double unix_seconds(std::string_view date) {
  const platform::FloatingPointScope floating_point;
  Reader reader(date);
  const int year = reader.number("year", 4, 1, 9999);
  reader.expect('-');
  const int month = reader.number("month", 2, 1, 12);
  reader.expect('-');
  const int day = reader.number("day", 2, 1, days_of_month(year, month));
  if (!reader.skip(' ') && !reader.skip('t')) reader.expect('T');
  const int hour = reader.number("hour", 2, 0, 23);
  reader.expect(':');
  const int minute = reader.number("minute", 2, 0, 59);
  int second = 0;
  double fraction = 0.0;
  if (reader.skip(':')) {
    second = reader.number("second", 2, 0, 60);
    if (reader.skip('.')) fraction = reader.fraction();
  }
  const int of_day = 60 * hour + minute - zone_minutes(reader);
  if (!reader.at_end()) reader.refuse("goes on behind its time zone");
  if (second == 60 && (of_day + 1440) % 1440 != 1439) {
    reader.refuse("has the second 60, a leap second, which is inserted only after 23:59:59 UTC");
  }
  return (days_from_1970(year, month, day) * 1440.0 + of_day) * 60.0 + second + fraction;
}

SunPosition sun_position(std::string_view date, const SunObserver& observer) {
  return sun_position(unix_seconds(date), observer);
}

}  // namespace welkin
