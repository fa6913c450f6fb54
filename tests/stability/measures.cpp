#include "stability/measures.h"

#include "reference/sky_reference.h"
#include "standard_headers.h"
#include "support/images.h"
#include "support/small_skies.h"

namespace welkin::test::stability {
namespace {

template <class Image, class Value>
Image filled(Image image, const Value& value) {
  const std::span<float> values = test::values_of(image);
  for (std::size_t k = 0; k < values.size(); ++k) values[k] = value(k);
  return image;
}

/// Returns a checkerboard's value by its index in rows of `width` texels.
float board(std::size_t value, int width, float amplitude) {
  const std::size_t texel = value / 3;
  const auto columns = static_cast<std::size_t>(width);
  return (texel / columns + texel % columns) % 2 == 0 ? amplitude : -amplitude;
}

}  // namespace

std::uint32_t hashed(std::uint32_t seed, std::uint32_t index) noexcept {
  std::uint32_t h = index + 0x9E3779B9U * (seed + 1U);
  h = (h ^ (h >> 16U)) * 0x85EBCA6BU;
  h = (h ^ (h >> 13U)) * 0xC2B2AE35U;
  return h ^ (h >> 16U);
}

float noise(std::uint32_t seed, std::uint32_t index) noexcept {
  return static_cast<float>(hashed(seed, index) >> 8U) * 0x1p-24F;
}

Cubemap noise_cube(int size, std::uint32_t seed) {
  return filled(grey_cubemap(size, 0.0F), [seed](std::size_t k) { return noise(seed, static_cast<std::uint32_t>(k)); });
}

LatLongImage noise_lat_long(int width, int height, std::uint32_t seed) {
  return filled(grey_lat_long(width, height, 0.0F),
                [seed](std::size_t k) { return noise(seed, static_cast<std::uint32_t>(k)); });
}

Cubemap checkerboard_cube(int size, float amplitude) {
  return filled(grey_cubemap(size, 0.0F), [=](std::size_t k) { return board(k, size, amplitude); });
}

LatLongImage checkerboard_lat_long(int width, int height, float amplitude) {
  return filled(grey_lat_long(width, height, 0.0F), [=](std::size_t k) { return board(k, width, amplitude); });
}

namespace {

glm::dvec3 above_horizon(const glm::dvec3& direction) { return glm::dvec3(direction.y > 0.0 ? 1.0 : 0.0); }

}  // namespace

Cubemap upper_half_cube(int size) { return cubemap_of(size, above_horizon); }

LatLongImage upper_half_lat_long(int width, int height) { return lat_long_of(width, height, above_horizon); }

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

double relative_error(double found, double truth) {
  return found == truth ? 0.0 : worse(std::abs(found - truth) / std::abs(truth), 0.0);
}

double relative_error(const glm::dvec3& found, const glm::dvec3& truth) {
  return found == truth ? 0.0 : worse(glm::length(found - truth) / glm::length(truth), 0.0);
}

double float_ulps(double found, double truth) {
  if (found == truth) return 0.0;
  const double largest = std::numeric_limits<float>::max();
  const double nearest = std::clamp(truth, -largest, largest);
  const int exponent = nearest == 0.0 ? -126 : std::max(std::ilogb(nearest), -126);
  return worse(std::abs(found - truth) / std::ldexp(1.0, exponent - 23), 0.0);
}

double rms_error(std::span<const glm::dvec3> found, std::span<const glm::dvec3> truth) {
  double off = 0.0;
  double whole = 0.0;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    off += glm::dot(found[k] - truth[k], found[k] - truth[k]);
    whole += glm::dot(truth[k], truth[k]);
  }
  return off == 0.0 ? 0.0 : worse(std::sqrt(off / whole), 0.0);
}

double worse(double a, double b) noexcept { return std::isnan(a) || std::isnan(b) ? kInfinity : std::max(a, b); }

double unsound(std::span<const float> values) noexcept {
  const auto is_unsound = [](float value) { return !(value >= 0.0F) || std::isinf(value); };
  return static_cast<double>(std::count_if(values.begin(), values.end(), is_unsound));
}

double wrong_unless_thrown(ErrorCode code, const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return wrong_if(error.code() != code);
  }
  return 1.0;
}

std::vector<glm::dvec3> spread_directions(int count) {
  const double golden_angle = std::numbers::pi * (3.0 - std::sqrt(5.0));
  std::vector<glm::dvec3> directions;
  for (int k = 0; k < count; ++k) {
    const double y = 1.0 - (2.0 * k + 1.0) / count;
    const double ring = std::sqrt(1.0 - y * y);
    directions.emplace_back(ring * std::sin(golden_angle * k), y, ring * std::cos(golden_angle * k));
  }
  return directions;
}

std::vector<glm::dvec3> texels(const Cubemap& chain, int level) {
  const auto edge = static_cast<std::size_t>(chain.level_size(level));
  std::vector<glm::dvec3> values;
  for (int face = 0; face < 6; ++face) {
    const float* const pixels = chain.face(level, face);
    for (std::size_t k = 0; k < edge * edge; ++k) {
      values.emplace_back(pixels[3 * k], pixels[3 * k + 1], pixels[3 * k + 2]);
    }
  }
  return values;
}

double worst_relative_error(std::span<const glm::dvec3> found, std::span<const glm::dvec3> truth) {
  double worst = 0.0;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    for (int c = 0; c < 3; ++c) worst = worse(worst, relative_error(found[k][c], truth[k][c]));
  }
  return worst;
}

namespace {

constexpr std::array<double, 3> kAzimuths{0.1, 1.4, 3.0};  ///< radians from the sun's

void multiply(std::vector<double>& values, double factor) {
  for (double& value : values) value *= factor;
}

void add_rings(std::vector<glm::dvec3>& directions, double zenith_angle) {
  for (const double azimuth : kAzimuths) {
    const double ring = std::sin(zenith_angle);
    directions.emplace_back(ring * std::sin(azimuth), std::cos(zenith_angle), ring * std::cos(azimuth));
  }
}

}  // namespace

Atmosphere dense_earth(double factor) {
  Atmosphere air = earth_bruneton();
  for (Constituent* const matter : {&air.rayleigh, &air.aerosol}) {
    multiply(matter->scattering_per_m, factor);
    multiply(matter->absorption_per_m, factor);
  }
  for (Constituent& matter : air.absorbers) multiply(matter.absorption_per_m, factor);
  return air;
}

Atmosphere plain_planet(double radius_m, double thickness_m, double scale_height_m) {
  Atmosphere air;
  air.name = "plain";
  air.bottom_radius_m = radius_m;
  air.top_radius_m = radius_m + thickness_m;
  air.rayleigh.density = exponential_profile(scale_height_m);
  const double per_metre = 0.1 / std::min(scale_height_m, thickness_m);
  air.rayleigh.scattering_per_m = {0.5 * per_metre, per_metre, 2.0 * per_metre};
  air.solar_irradiance = {1.5, 1.8, 1.9};
  return air;
}

SkyTableOptions single_order() {
  SkyTableOptions options{.heights = 8, .orders = 1};
  return options;
}

const std::shared_ptr<const SkyTables>& earth_tables() {
  static const auto tables = sky_tables_of(earth_bruneton(), single_order());
  return tables;
}

std::vector<glm::dvec3> hard_directions(const Atmosphere& atmosphere, double altitude_m) {
  const double bottom = atmosphere.bottom_radius_m;
  const double thickness = atmosphere.top_radius_m - bottom;
  const double radius = bottom + altitude_m;
  std::vector<glm::dvec3> directions;
  if (altitude_m > thickness) {
    for (const double share : {-0.9, -0.1, 0.1, 0.5, 0.9}) {  // of the way from the limb's ground to the top, or nadir
      const double passes = bottom + share * (share < 0.0 ? bottom : thickness);
      add_rings(directions, std::numbers::pi - std::asin(passes / radius));
    }
    return directions;
  }
  const double horizon = std::numbers::pi - std::asin(std::min(1.0, bottom / radius));
  for (const double angle : {0.0, 0.5, 1.0, 1.3, 1.5}) add_rings(directions, angle);
  for (const double off : {-1e-2, -1e-4, -1e-6, 1e-6, 1e-4, 1e-2}) add_rings(directions, horizon + off);
  for (const double angle : {2.0, 2.6}) add_rings(directions, angle);
  return directions;
}

double radiance_error(const SkyView& view, const std::vector<glm::dvec3>& directions, double sun_elevation_degrees) {
  const glm::dvec3 sun = sun_direction(sun_elevation_degrees, 0.0);
  std::vector<glm::dvec3> found;
  std::vector<glm::dvec3> truth;
  for (const glm::dvec3& direction : directions) {
    const std::vector<double> reference = reference_sky_radiance(
        view.tables()->atmosphere, view.altitude_m(), direction, sun, {.relative_error = 1e-5, .ground = false});
    truth.emplace_back(reference[0], reference[1], reference[2]);
    found.push_back(view.radiance(direction, sun));
  }
  return rms_error(found, truth);
}

double sky_error(const Atmosphere& atmosphere, double altitude_m, double sun_elevation_degrees,
                 const SkyTableOptions& options) {
  // The next case often has the same planet.
  static std::shared_ptr<const SkyTables> last;
  if (!last || last->atmosphere != atmosphere || last->options != options) last = sky_tables_of(atmosphere, options);
  return radiance_error(SkyView(last, altitude_m, {.ground = false}), hard_directions(atmosphere, altitude_m),
                        sun_elevation_degrees);
}

double unsound_values(const SkyTables& tables) {
  return unsound(tables.transmittance) + unsound(tables.scattering) + unsound(tables.single_mie) +
         unsound(tables.irradiance);
}

}  // namespace welkin::test::stability
