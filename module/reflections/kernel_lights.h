// Lights seen through a kernel, which is a table: in double.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <vector>

#include "reflections/lobe.h"
#include "reflections/lobe_kernels.h"

namespace welkin::reflections {

/// What lights give in a direction, red, green and blue.
class KernelSums {
 public:
  KernelSums(const Lobe& kernel, const glm::dvec3& direction)
      : kernel_(kernel),
        direction_(direction),
        nearest_(kernel.nearest() * kernel.nearest()),
        farthest_(kernel.farthest() * kernel.farthest()) {}

  void add(const LobeLight* lights, const std::vector<LobeRun>& runs);
  void add(const CutLight* lights, const std::vector<LobeRun>& runs);

  /// Adds them to sums[0], sums[step], sums[2 step].
  void add_to(float* sums, int step) const;

 private:
  [[nodiscard]] double towards(double x, double y, double z) const noexcept;
  [[nodiscard]] double mean(const CutLight& cut) const;
  void add(const LobeLight& light, double weight);

  const Lobe& kernel_;
  glm::dvec3 direction_;
  double nearest_;  ///< where the kernel is seen at all, squares of s
  double farthest_;
  std::array<double, 3> sums_{};
};

}  // namespace welkin::reflections
