// The prefilter's integral, direction by direction, in double.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "projection/sanitized_pixels.h"
#include "welkin/core.h"

namespace welkin::reflections {

/// Int L k / Int k at unit directions, over all texels as areas. `alpha` above 0.
[[nodiscard]] std::vector<glm::dvec3> integrate_lobes(const projection::SanitizedSource& source, double alpha,
                                                      std::span<const glm::dvec3> directions, const Control& control);

/// The radiance of the texel that a unit direction lies in: the limit for roughness 0.
[[nodiscard]] glm::dvec3 radiance_towards(const projection::SanitizedSource& source,
                                          const glm::dvec3& direction) noexcept;

/// A caller's directions, of length 1. Throws `Error` (invalid_argument) for none, too many, or one that has no length.
[[nodiscard]] std::vector<glm::dvec3> unit_directions(const std::vector<glm::dvec3>& directions);

// How much of a lobe falls on each texel of a picture: the truth's inner part.

/// A row's texels, so far as many directions share them.
struct TexelRow {
  std::vector<double> x, y, z;      ///< unit directions of their areas' centres
  std::vector<double> solid_angle;  ///< steradians
  double radius = 0.0;              ///< radians: no point of a texel is farther from its centre
};

struct TexelRectangle {
  int row = 0;
  int column = 0;
  int rows = 1;
  int columns = 1;
};

/// Where the texels of a picture are. Rows of a cubemap are counted face after face.
class LobeTexels {
 public:
  virtual ~LobeTexels() = default;

  [[nodiscard]] virtual int rows() const noexcept = 0;
  [[nodiscard]] virtual int columns() const noexcept = 0;

  /// Fills `row`, whose vectors have `columns()` entries.
  virtual void fill(int row, TexelRow& texels) const = 0;

  /// Int k(n.l) dl over one texel, relative error below 1e-7. By Gauss rules on ever smaller parts; what the horizon
  /// cuts is integrated over what lies above.
  [[nodiscard]] virtual double integral(int row, int column, const glm::dvec3& normal, double alpha) const noexcept = 0;
  /// The same over a rectangle of texels, of a cubemap on one face.
  [[nodiscard]] virtual double integral(const TexelRectangle& texels, const glm::dvec3& normal,
                                        double alpha) const noexcept = 0;
};

[[nodiscard]] std::unique_ptr<LobeTexels> lobe_texels_of_lat_long(int width, int height);
[[nodiscard]] std::unique_ptr<LobeTexels> lobe_texels_of_cubemap(int size);

/// Int k(n.l) dl over every texel of a row, to `integrals` (`columns()` of them). Where the lobe hardly changes over a
/// texel (radius below 0.007 of its width and distance) it is its value at the centre times the solid angle, which is
/// within 2e-5. False if all are zero.
bool fill_lobe_integrals(const LobeTexels& texels, int row, const TexelRow& centres, const glm::dvec3& normal,
                         double alpha, std::vector<double>& integrals);

}  // namespace welkin::reflections
