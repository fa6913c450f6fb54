#include "support/random_environments.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <memory>
#include <numbers>
#include <vector>

#include "image/geometry.h"

namespace welkin::test {
namespace {

void fill(const image::TexelGrid& grid, std::vector<float>& pixels,
          const std::function<glm::dvec3(const glm::dvec3&, double, double)>& radiance) {
  pixels.resize(static_cast<std::size_t>(3 * grid.texels()));
  for (std::int64_t texel = 0; texel < grid.texels(); ++texel) {
    const glm::dvec3 value = radiance(grid.direction(texel), static_cast<double>(texel % grid.columns()),
                                      static_cast<double>(texel / grid.columns()));
    for (int c = 0; c < 3; ++c) pixels[static_cast<std::size_t>(3 * texel + c)] = static_cast<float>(value[c]);
  }
}

}  // namespace

double RandomEnvironments::scale(double low, double high) { return low * std::pow(high / low, number()); }

glm::dvec3 RandomEnvironments::direction() {
  const double y = between(-1.0, 1.0);
  const double azimuth = 2.0 * std::numbers::pi * number();
  const double ring = std::sqrt(1.0 - y * y);
  return {ring * std::sin(azimuth), y, ring * std::cos(azimuth)};
}

glm::dvec3 RandomEnvironments::colour() { return {between(0.2, 1.0), between(0.2, 1.0), between(0.2, 1.0)}; }

/// Up to four smooth waves that never fall below zero.
RandomEnvironments::Radiance RandomEnvironments::gradient(double strength) {
  struct Wave {
    glm::dvec3 axis;
    glm::dvec3 colour;
    double frequency;
  };
  std::vector<Wave> waves(static_cast<std::size_t>(whole(1, 4)));
  for (Wave& wave : waves) wave = {direction(), strength * colour(), between(0.3, 4.0)};
  return [waves](const glm::dvec3& d, double, double) {
    glm::dvec3 sum(0.0);
    for (const Wave& wave : waves) sum += wave.colour * (1.0 + std::sin(wave.frequency * glm::dot(wave.axis, d)));
    return sum;
  };
}

/// A value a texel, of a generator of its own.
RandomEnvironments::Radiance RandomEnvironments::noise(double strength) {
  const auto generator = std::make_shared<std::mt19937>(engine_());
  const double power = chance(0.5) ? 1.0 : between(1.0, 8.0);
  return [generator, power, strength](const glm::dvec3&, double, double) {
    glm::dvec3 value;
    for (int c = 0; c < 3; ++c) value[c] = strength * std::pow(static_cast<double>((*generator)()) * 0x1p-32, power);
    return value;
  };
}

/// Checkerboards and stripes: by texels of any period, or by direction.
RandomEnvironments::Radiance RandomEnvironments::pattern(double size) {
  const double period = chance(0.3) ? whole(1, 8) : scale(1.0, 0.5 * size + 1.0);
  const bool stripes = chance(0.3);
  const bool by_direction = chance(0.4);
  const glm::dvec3 axis = direction();
  const double frequency = scale(2.0, 0.25 * size + 3.0);
  const glm::dvec3 dark = chance(0.5) ? glm::dvec3(0.0) : 0.2 * colour();
  const glm::dvec3 bright = scale(0.1, 10.0) * colour() + dark;
  return [=](const glm::dvec3& d, double u, double v) {
    const auto column =
        static_cast<long>(std::floor(by_direction ? frequency * (1.0 + glm::dot(axis, d)) : u / period));
    const auto row = stripes ? 0L : static_cast<long>(std::floor(by_direction ? frequency * (1.0 + d.y) : v / period));
    return (column + row) % 2 == 0 ? dark : bright;
  };
}

/// One to three discs from a hundredth of a degree (a texel, or none) to forty degrees.
RandomEnvironments::Radiance RandomEnvironments::suns() {
  struct Disc {
    glm::dvec3 direction;
    glm::dvec3 radiance;
    double cosine;
  };
  std::vector<Disc> discs(static_cast<std::size_t>(whole(1, 3)));
  for (Disc& disc : discs) {
    const double radius = scale(0.5, 40.0) * std::numbers::pi / 180.0;
    disc = {direction(), scale(1.0, 1e5) * colour(), std::cos(radius)};
  }
  return [discs](const glm::dvec3& d, double, double) {
    glm::dvec3 sum(0.0);
    for (const Disc& disc : discs) sum += glm::dot(disc.direction, d) > disc.cosine ? disc.radiance : glm::dvec3(0.0);
    return sum;
  };
}

/// Sky over ground, sharp or soft.
RandomEnvironments::Radiance RandomEnvironments::horizon() {
  const glm::dvec3 sky = colour();
  const glm::dvec3 ground = 0.3 * colour();
  const double sharpness = scale(1.0, 1000.0);
  const double height = between(-0.3, 0.3);
  return [=](const glm::dvec3& d, double, double) {
    const double share = 0.5 + 0.5 * std::tanh(sharpness * (d.y - height));
    return share * sky + (1.0 - share) * ground;
  };
}

RandomEnvironments::Radiance RandomEnvironments::part(double size) {
  switch (whole(0, 4)) {
    case 0: description_ += " gradient"; return gradient(scale(0.1, 10.0));
    case 1: description_ += " noise"; return noise(scale(0.1, 10.0));
    case 2: description_ += " pattern"; return pattern(size);
    case 3: description_ += " suns"; return suns();
    default: description_ += " horizon"; return horizon();
  }
}

RandomEnvironments::Radiance RandomEnvironments::environment(double size) {
  const glm::dvec3 base = chance(0.3) ? glm::dvec3(0.0) : scale(0.01, 1.0) * colour();
  if (chance(0.1)) {
    description_ += " nearly uniform";
    const double strength = scale(1e-6, 1e-2);
    const Radiance ripple = chance(0.5) ? gradient(strength) : noise(strength);
    return [=](const glm::dvec3& d, double u, double v) { return glm::dvec3(1.0) + base + ripple(d, u, v); };
  }
  const Radiance one = part(size);
  if (chance(0.4)) return [=](const glm::dvec3& d, double u, double v) { return base + one(d, u, v); };
  const Radiance two = part(size);
  return [=](const glm::dvec3& d, double u, double v) { return base + one(d, u, v) + two(d, u, v); };
}

CubemapImage RandomEnvironments::cubemap(int least_size, int most_size) {
  int size = whole(least_size, most_size);
  if (chance(0.4)) {  // of a power of two, as most are
    int power = 1;
    while (2 * power <= size) power *= 2;
    if (power >= least_size) size = power;
  }
  description_ = "cubemap " + std::to_string(size) + ":";
  CubemapImage image{size, {}};
  fill(image::TexelGrid::cubemap(size), image.pixels, environment(size));
  return image;
}

LatLongImage RandomEnvironments::lat_long(int least_height, int most_height) {
  const int height = whole(least_height, most_height);
  const int width = chance(0.8) ? 2 * height : whole(least_height, 4 * most_height);
  description_ = "lat-long " + std::to_string(width) + " x " + std::to_string(height) + ":";
  LatLongImage image{width, height, {}};
  fill(image::TexelGrid::lat_long(width, height), image.pixels, environment(0.5 * height));
  return image;
}

}  // namespace welkin::test
