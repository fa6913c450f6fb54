// One path of light through air and over ground, followed backwards from the eye, at all wavelengths at once.
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec3.hpp>

#include "sky/path_random.h"
#include "sky/path_shells.h"
#include "sky/reference_air.h"

namespace welkin::sky {

class PathTracer {
 public:
  static constexpr std::size_t kMostWavelengths = 96;
  using Spectrum = std::array<double, kMostWavelengths>;

  PathTracer(const ReferenceAir& air, double altitude, const glm::dvec3& sun, int lowest_order, int highest_order);

  /// An estimate of the light of those orders that arrives from a direction.
  void trace(const glm::dvec3& direction, PathRandom& random, Spectrum& radiance) const;

 private:
  struct Path;

  [[nodiscard]] bool fly(Path& path, PathRandom& random) const;
  [[nodiscard]] bool collide(Path& path, std::size_t shell, double square, PathRandom& random) const;
  void advance(Path& path, double distance) const;
  void add_sun_on_air(Path& path, Spectrum& radiance) const;
  void add_sun_on_ground(Path& path, Spectrum& radiance) const;
  [[nodiscard]] bool scatter(Path& path, PathRandom& random) const;
  [[nodiscard]] bool reflect(Path& path, PathRandom& random) const;
  [[nodiscard]] bool survives(Path& path, PathRandom& random) const;
  [[nodiscard]] double sunlight(const Path& path, Spectrum& transmittance) const;

  const ReferenceAir& air_;
  PathShells shells_;
  double altitude_;
  glm::dvec3 sun_;
  int lowest_order_;
  int highest_order_;
  std::array<const ReferenceAir::Matter*, 2> scatterers_{};  ///< Rayleigh's, the aerosol: where there are
  std::array<std::size_t, 2> scatterer_indices_{};
};

}  // namespace welkin::sky
