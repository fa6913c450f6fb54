// Chains as shaders read them, and how far that is from the truth.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "perf/report/error_norms.h"
#include "welkin/image.h"
#include "welkin/reflections.h"

namespace welkin::report {

/// Returns what a graphics API reads from a level: bilinear within a face, across its edges from the neighbouring face,
/// and at a corner the mean of the three texels there.
[[nodiscard]] glm::dvec3 lookup(const Cubemap& chain, int level, const glm::dvec3& direction);

/// Returns the same between two levels, `level` being a fraction.
[[nodiscard]] glm::dvec3 lookup(const Cubemap& chain, double level, const glm::dvec3& direction);

/// The integral at all roughnesses, in directions that are chosen by the light: half of them evenly over the sphere,
/// half in proportion to what is reflected there, so that the surroundings of a sun are among them.
class LookupTruth {
 public:
  /// `directions`: how many for each of `kRoughnesses`. Cost: that of `reference_specular` in all of them.
  LookupTruth(const LatLongView& source, int directions);

  /// Returns the error of a chain that is read by a schedule's formula. rms: of the difference over that of the truth,
  /// over all roughnesses. Maximum: the rms error of the worst roughness.
  [[nodiscard]] ErrorNorms errors(const Cubemap& chain, RoughnessSchedule schedule) const;

 private:
  /// Roughnesses (k + 1/2) / kRoughnesses.
  static constexpr int kRoughnesses = 16;

  struct Place {
    glm::dvec3 direction;
    glm::dvec3 truth;
    double weight = 0.0;  ///< of its square: one over its density
  };

  std::vector<std::vector<Place>> places_;  ///< of each roughness
};

}  // namespace welkin::report
