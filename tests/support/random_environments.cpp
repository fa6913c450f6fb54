#include "support/random_environments.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <memory>
#include <numbers>
#include <span>
#include <vector>

#include "image/geometry.h"

namespace welkin::test {
namespace {

void fill(const image::TexelGrid& grid, std::span<float> pixels,
          const std::function<glm::dvec3(const glm::dvec3&, double, double)>& radiance) {
  for (std::int64_t texel = 0; texel < grid.texels(); ++texel) {
    const glm::dvec3 value = radiance(grid.direction(texel), static_cast<double>(texel % grid.columns()),
                                      static_cast<double>(texel / grid.columns()));
    for (int c = 0; c < 3; ++c) pixels[static_cast<std::size_t>(3 * texel + c)] = static_cast<float>(value[c]);
  }
}

/// A bright rectangle of texels.
struct Panel {
  int column;
  int row;
  int width;
  int height;
  glm::dvec3 radiance;
};

glm::dvec3 light_of(const std::vector<Panel>& panels, double u, double v, glm::dvec3 sum = glm::dvec3(0.0)) {
  for (const Panel& panel : panels) {
    const bool inside =
        u >= panel.column && u < panel.column + panel.width && v >= panel.row && v < panel.row + panel.height;
    if (inside) sum += panel.radiance;
  }
  return sum;
}

}  // namespace

const char* name(Family family) noexcept {
  switch (family) {
    case Family::uniform: return "uniform";
    case Family::checkers: return "checkers";
    case Family::lamps: return "lamps";
    case Family::half_black: return "half black";
    case Family::log_normal: return "log-normal";
    case Family::studio: return "studio";
    case Family::count: break;
  }
  return "";
}

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

/// One value per texel, from a separate generator.
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

/// Columns and rows change alternately; one of the two periods may be infinite.
RandomEnvironments::Radiance RandomEnvironments::checkers(int rows) {
  const int period = chance(0.4) ? 1 : whole(1, std::max(1, rows / 3));
  const bool stripes = chance(0.3);
  const bool across = chance(0.5);
  const glm::dvec3 dark = chance(0.5) ? glm::dvec3(0.0) : scale(0.01, 1.0) * colour();
  const glm::dvec3 bright = scale(0.1, 100.0) * colour();
  return [=](const glm::dvec3&, double u, double v) {
    const int column = static_cast<int>(u) / period;
    const int row = static_cast<int>(v) / period;
    return (stripes ? (across ? column : row) : column + row) % 2 == 0 ? dark : bright;
  };
}

/// One to three squares of one to three texels.
RandomEnvironments::Radiance RandomEnvironments::lamps(int columns, int rows) {
  std::vector<Panel> all(static_cast<std::size_t>(whole(1, 3)));
  for (Panel& lamp : all) {
    lamp = {whole(0, columns - 1), whole(0, rows - 1), chance(0.7) ? 1 : whole(2, 3), 0, scale(1e4, 1e8) * colour()};
    lamp.height = lamp.width;
  }
  return [all](const glm::dvec3&, double u, double v) { return light_of(all, u, v); };
}

RandomEnvironments::Radiance RandomEnvironments::log_normal() {
  const auto generator = std::make_shared<std::mt19937>(engine_());
  const double sigma = chance(0.5) ? 4.0 : between(0.5, 4.0);
  const bool grey = chance(0.5);
  return [=](const glm::dvec3&, double, double) {
    const auto draw = [&] { return (static_cast<double>((*generator)()) + 0.5) * 0x1p-32; };
    const auto value = [&] {
      const double radius = std::sqrt(-2.0 * std::log(draw()));
      return std::exp(sigma * radius * std::cos(2.0 * std::numbers::pi * draw()));
    };
    glm::dvec3 rgb(value());
    if (!grey) rgb = {rgb.x, value(), value()};
    return rgb;
  };
}

RandomEnvironments::Radiance RandomEnvironments::studio(int columns, int rows) {
  const glm::dvec3 background = scale(1e-4, 1.0) * colour();
  std::vector<Panel> all(static_cast<std::size_t>(whole(1, 4)));
  for (Panel& panel : all)
    panel = {whole(0, columns - 1), whole(0, rows - 1), whole(1, 8), whole(1, 8), scale(10.0, 1e5) * colour()};
  return [=](const glm::dvec3&, double u, double v) { return light_of(all, u, v, background); };
}

RandomEnvironments::Radiance RandomEnvironments::of_family(Family family, int columns, int rows) {
  description_ += std::string(" ") + name(family);
  switch (family) {
    case Family::uniform: {
      const glm::dvec3 even = scale(1e-3, 1e3) * colour();
      const Radiance ripple = gradient(chance(0.5) ? 0.0 : scale(1e-6, 1e-2));
      return [=](const glm::dvec3& d, double u, double v) { return even * (glm::dvec3(1.0) + ripple(d, u, v)); };
    }
    case Family::checkers: return checkers(rows);
    case Family::lamps: {
      const Radiance background = chance(0.5) ? gradient(1.0) : horizon();
      const double dark = chance(0.5) ? 1.0 : scale(1e-3, 1.0);
      const Radiance own = lamps(columns, rows);
      return [=](const glm::dvec3& d, double u, double v) { return dark * background(d, u, v) + own(d, u, v); };
    }
    case Family::half_black: {
      const glm::dvec3 axis = direction();
      const glm::dvec3 lit = colour();
      const Radiance own = lamps(columns, rows);
      return [=](const glm::dvec3& d, double u, double v) {
        return (glm::dot(axis, d) > 0.0 ? lit : glm::dvec3(0.0)) + own(d, u, v);
      };
    }
    case Family::studio: return studio(columns, rows);
    default: return log_normal();
  }
}

Cubemap RandomEnvironments::cubemap(Family family, int size) {
  description_ = "cubemap " + std::to_string(size) + ":";
  Cubemap image(size);
  fill(image::TexelGrid::cubemap(size), image.pixels(), of_family(family, size, 6 * size));
  return image;
}

LatLongImage RandomEnvironments::lat_long(Family family, int width, int height) {
  description_ = "lat-long " + std::to_string(width) + " x " + std::to_string(height) + ":";
  LatLongImage image{width, height, std::vector<float>(static_cast<std::size_t>(3 * width * height))};
  fill(image::TexelGrid::lat_long(width, height), image.pixels, of_family(family, width, height));
  return image;
}

Cubemap RandomEnvironments::cubemap(int least_size, int most_size) {
  int size = whole(least_size, most_size);
  if (chance(0.4)) {  // a power of two, as most sizes are
    int power = 1;
    while (2 * power <= size) power *= 2;
    if (power >= least_size) size = power;
  }
  description_ = "cubemap " + std::to_string(size) + ":";
  Cubemap image(size);
  fill(image::TexelGrid::cubemap(size), image.pixels(), environment(size));
  return image;
}

LatLongImage RandomEnvironments::lat_long(int least_height, int most_height) {
  const int height = whole(least_height, most_height);
  const int width = chance(0.8) ? 2 * height : whole(least_height, 4 * most_height);
  description_ = "lat-long " + std::to_string(width) + " x " + std::to_string(height) + ":";
  LatLongImage image{width, height, std::vector<float>(static_cast<std::size_t>(3 * width * height))};
  fill(image::TexelGrid::lat_long(width, height), image.pixels, environment(0.5 * height));
  return image;
}

}  // namespace welkin::test
