// The integral of an image over a kernel that looks the same all about its axis: direction by direction, over all
// texels as areas, in double.
#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "image/geometry.h"
#include "projection/sanitized_pixels.h"
#include "welkin/core.h"

namespace welkin::projection {

/// A kernel as a function of x = 1 - cosine of the angle to its axis, in [0, 2].
class KernelFunction {
 public:
  virtual ~KernelFunction() = default;

  [[nodiscard]] virtual double at(double x) const noexcept = 0;

  /// Replaces each x by the value there.
  virtual void evaluate(std::span<double> x) const noexcept = 0;

  /// Replaces each x by the mean of the values about it where x is the mean and has that variance, but for third
  /// moments: k(x) + k''(x) variance / 2. Called where `curved` is true.
  virtual void evaluate_means(std::span<double> x, std::span<const double> /*variances*/) const noexcept {
    evaluate(x);
  }

  /// Points along an edge of the Gauss rule for a part of a texel that no break cuts: no point of the part is farther
  /// than `radius` (in radians) from its centre, which is at x. 0: the part must be divided.
  [[nodiscard]] virtual int order(double x, double radius) const noexcept = 0;

  /// From this x on, a texel of that radius that no break cuts is its weight times the value at its centroid or, where
  /// `curved` is true, the mean by its variance, within 2e-5; a GGX lobe's within 5e-6.
  [[nodiscard]] virtual double far(double radius) const noexcept = 0;

  /// Points along an edge of a Gauss rule that does the same for every texel of that radius that no break cuts, however
  /// near the axis it is, and that all axes share. 0: there is none; `far` decides.
  [[nodiscard]] virtual int shared_order(double /*radius*/) const noexcept { return 0; }

  double first = 0.0;          ///< the kernel is 0 below this x
  double last = 2.0;           ///< and beyond this one
  bool hemisphere = false;     ///< whether it is 0 beyond the horizon, x = 1, and bends or jumps there
  std::vector<double> breaks;  ///< other x where it bends or jumps
  bool curved = false;         ///< whether a texel's variance counts
  bool cosine = false;         ///< whether it is a multiple of the cosine up to the horizon: a texel's weight is its
                               ///< moment then, which makes the value exact; else its solid angle
};

/// A row's texels, so far as many directions share them.
struct TexelRow {
  std::vector<double> x, y, z;      ///< unit directions of the areas' centroids
  std::vector<double> solid_angle;  ///< steradians
  std::vector<double> moment;       ///< length of Int d dw
  double radius = 0.0;              ///< radians: no point of a texel is farther from its centroid

  explicit TexelRow(std::size_t columns);
};

/// How the unit directions of a row's texels are spread, weighted by solid angle: over a texel the cosine to an axis n
/// has the mean n.c `length`, c the centroid's unit direction, and the variance (n.a)^2 + (n.b)^2, to the second order
/// in the texel's size.
struct TexelSpread {
  std::vector<double> length;  ///< of the mean direction
  std::vector<double> ax, ay, az;
  std::vector<double> bx, by, bz;

  explicit TexelSpread(std::size_t columns);
};

/// Points of Gauss rules on a row's texels, `count` of each, texel after texel.
struct TexelPoints {
  std::vector<double> x, y, z;  ///< unit directions
  std::vector<double> weight;   ///< steradians
  std::size_t count = 0;
};

/// Texels of one row or several, of a cubemap on one face.
struct TexelRectangle {
  int row = 0;
  int column = 0;
  int rows = 1;
  int columns = 1;
};

/// Where the texels of an image are. Rows of a cubemap are counted face after face.
class TexelIntegrals {
 public:
  virtual ~TexelIntegrals() = default;

  virtual void fill(int row, TexelRow& texels) const = 0;

  /// Fills in the spread of texels that `fill` has filled in.
  virtual void fill(int row, const TexelRow& texels, TexelSpread& spread) const = 0;

  /// Fills in the points of a rule of `order` points along an edge.
  virtual void fill(int row, int order, TexelPoints& points) const = 0;

  /// Int k(d) dw about a unit axis. By Gauss rules on ever smaller parts; where the horizon cuts a hemisphere's kernel,
  /// over what lies above. Relative error below 1e-6 for kernels without other breaks.
  [[nodiscard]] virtual double integral(const TexelRectangle& texels, const glm::dvec3& axis,
                                        const KernelFunction& kernel) const noexcept = 0;
};

[[nodiscard]] std::unique_ptr<TexelIntegrals> texel_integrals_of(const image::TexelGrid& grid);

/// Int L k dw about unit axes, one for each. The same bits on any number of threads. Throws `Error` (cancelled).
[[nodiscard]] std::vector<glm::dvec3> integrate_kernel(const SanitizedSource& source, const KernelFunction& kernel,
                                                       std::span<const glm::dvec3> axes, const Control& control);

}  // namespace welkin::projection
