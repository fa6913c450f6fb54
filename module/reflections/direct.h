// The prefilter's integral, direction by direction, in double.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "projection/kernel_integrals.h"
#include "projection/sanitized_pixels.h"
#include "reflections/lobe.h"
#include "welkin/core.h"

namespace welkin::reflections {

/// `lobe` as a function that is integrated over texels; its integral is `lobe_integral`. `alpha` above 0.
class GgxFunction final : public projection::KernelFunction {
 public:
  explicit GgxFunction(double alpha);

  [[nodiscard]] double at(double x) const noexcept override {
    if (x >= 1.0) return 0.0;
    const double width = square_ + x * slope_;
    return (1.0 - x) * scale_ / (width * width);
  }
  void evaluate(std::span<double> x) const noexcept override;
  void evaluate_means(std::span<double> x, std::span<const double> variances) const noexcept override;
  [[nodiscard]] int order(double x, double radius) const noexcept override;
  [[nodiscard]] double far(double radius) const noexcept override;

 private:
  double square_;
  double slope_;
  double scale_;
};

/// Int L k / Int k at unit directions, over all texels as areas. Relative error below 1e-5 for continuous lobes.
[[nodiscard]] std::vector<glm::dvec3> integrate_lobe(const projection::SanitizedSource& source, const Lobe& lobe,
                                                     std::span<const glm::dvec3> directions, const Control& control);

/// A caller's directions, of length 1. Throws `Error` (invalid_argument) for none, too many, or one that has no length.
[[nodiscard]] std::vector<glm::dvec3> unit_directions(const std::vector<glm::dvec3>& directions);

}  // namespace welkin::reflections
