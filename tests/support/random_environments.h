// Seeded environments of every kind that an error estimate may meet: suns of any size and strength, noise,
// checkerboards and stripes of any period, gradients, horizons, nearly uniform ones, and sums of them.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <random>
#include <string>

#include "welkin/image.h"

namespace welkin::test {

/// Environments whose error estimates were too low once, each at any strength.
enum class Family {
  uniform,     ///< one colour, occasionally with differences of a millionth
  checkers,    ///< texels or blocks of any period
  lamps,       ///< up to three texels of 1e4 to 1e8 over a uniform or smooth background
  half_black,  ///< one half of the sphere is 0; a lamp anywhere
  log_normal,  ///< noise of up to sigma 4, one value per texel
  studio,      ///< up to four panels of up to 8 x 8 texels of 10 to 1e5 over a uniform background
  count,
};
[[nodiscard]] const char* name(Family family) noexcept;

class RandomEnvironments {
 public:
  explicit RandomEnvironments(std::uint32_t seed) : engine_(seed) {}

  /// Draws a cubemap whose face size lies in the given range, odd sizes included. `description()` states its contents.
  [[nodiscard]] Cubemap cubemap(int least_size, int most_size);
  /// Draws a lat-long, usually twice as wide as high, occasionally of another shape.
  [[nodiscard]] LatLongImage lat_long(int least_height, int most_height);

  /// Draw an environment of a family.
  [[nodiscard]] Cubemap cubemap(Family family, int size);
  [[nodiscard]] LatLongImage lat_long(Family family, int width, int height);

  /// Describes the last environment drawn: kinds and size.
  [[nodiscard]] const std::string& description() const noexcept { return description_; }

  double number() { return static_cast<double>(engine_()) * 0x1p-32; }  ///< in [0, 1)
  double between(double low, double high) { return low + (high - low) * number(); }
  double scale(double low, double high);  ///< its logarithm is uniform
  bool chance(double share) { return number() < share; }
  int whole(int low, int high) { return low + static_cast<int>(engine_() % static_cast<unsigned>(high - low + 1)); }
  glm::dvec3 direction();
  glm::dvec3 colour();

 private:
  /// Radiance towards a direction; (u, v), in texels, are for patterns aligned with the image's rows and columns.
  using Radiance = std::function<glm::dvec3(const glm::dvec3& direction, double u, double v)>;

  Radiance part(double size);
  Radiance gradient(double strength);
  Radiance noise(double strength);
  Radiance pattern(double size);
  Radiance suns();
  Radiance horizon();
  Radiance environment(double size);
  Radiance checkers(int rows);
  Radiance lamps(int columns, int rows);
  Radiance log_normal();
  Radiance studio(int columns, int rows);
  Radiance of_family(Family family, int columns, int rows);

  std::mt19937 engine_;
  std::string description_;
};

}  // namespace welkin::test
