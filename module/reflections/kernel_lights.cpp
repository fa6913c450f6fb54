#include "reflections/kernel_lights.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace welkin::reflections {
namespace {

/// Mean over its parallelogram, which the horizon cuts, of max(c, 0): `mean_above` of the kernels, in double.
double mean_above(const glm::dvec3& normal, const CutLight& cut) {
  const auto along = [&normal](const float* axis) {
    return std::abs(normal.x * static_cast<double>(axis[0]) + normal.y * static_cast<double>(axis[1]) +
                    normal.z * static_cast<double>(axis[2]));
  };
  const std::array<float, 3> middle{cut.light.x, cut.light.y, cut.light.z};
  const double c = normal.x * static_cast<double>(middle[0]) + normal.y * static_cast<double>(middle[1]) +
                   normal.z * static_cast<double>(middle[2]);
  const auto least = static_cast<double>(cut.least);
  const double high = std::max(along(cut.along), least);
  const double wide = std::max(along(cut.down), least);
  if (c > high + wide) return c;
  const auto cube_above = [](double x) { return x > 0.0 ? x * x * x : 0.0; };
  return (cube_above(c + high + wide) - cube_above(c + high - wide) - cube_above(c - high + wide) +
          cube_above(c - high - wide)) /
         (24.0 * high * wide);
}

}  // namespace

void KernelSums::add(const LobeLight* lights, const std::vector<LobeRun>& runs) {
  for (const LobeRun& run : runs) {
    for (int k = run.first; k < run.first + run.count; ++k) {
      const LobeLight& light = lights[k];
      add(light, towards(static_cast<double>(light.x), static_cast<double>(light.y), static_cast<double>(light.z)));
    }
  }
}

void KernelSums::add(const CutLight* lights, const std::vector<LobeRun>& runs) {
  for (const LobeRun& run : runs) {
    for (int k = run.first; k < run.first + run.count; ++k) add(lights[k].light, mean(lights[k]));
  }
}

void KernelSums::add_to(float* sums, int step) const {
  for (std::size_t c = 0; c < 3; ++c, sums += step) *sums = static_cast<float>(static_cast<double>(*sums) + sums_[c]);
}

double KernelSums::towards(double x, double y, double z) const noexcept {
  x -= direction_.x;
  y -= direction_.y;
  z -= direction_.z;
  const double square = 0.25 * (x * x + y * y + z * z);
  if (square < nearest_ || square > farthest_) return 0.0;
  return kernel_.table().at(std::sqrt(square));
}

/// Of the kernel over a light that the horizon may cut. Where the kernel is the cosine times a steady function, that is
/// taken at the light's middle; else it is looked at in 4 x 4 places.
double KernelSums::mean(const CutLight& cut) const {
  constexpr double kSteady = 10.0;
  constexpr double kLeastCosine = 1e-3;
  constexpr double kSizeOfLeast = 50.0;  // the mean length of `along` and `down`
  if (kernel_.steady_horizon() && kSteady * kSizeOfLeast * static_cast<double>(cut.least) < kernel_.scale()) {
    const double x = static_cast<double>(cut.light.x) - direction_.x;
    const double y = static_cast<double>(cut.light.y) - direction_.y;
    const double z = static_cast<double>(cut.light.z) - direction_.z;
    const double cosine = std::max(1.0 - 0.5 * (x * x + y * y + z * z), kLeastCosine);
    const double share = mean_above(direction_, cut) / cosine;
    return share > 0.0 ? share * kernel_.table().at(std::sqrt(0.5 * (1.0 - cosine))) : 0.0;
  }
  constexpr int kPlaces = 4;
  double sum = 0.0;
  for (int look = 0; look < kPlaces * kPlaces; ++look) {
    const double s = (2.0 * (look % kPlaces) + 1.0) / kPlaces - 1.0;
    const int down = look / kPlaces;
    const double t = (2.0 * down + 1.0) / kPlaces - 1.0;
    const auto at = [&](float middle, int axis) {
      return static_cast<double>(middle) + s * static_cast<double>(cut.along[axis]) +
             t * static_cast<double>(cut.down[axis]);
    };
    sum += towards(at(cut.light.x, 0), at(cut.light.y, 1), at(cut.light.z, 2));
  }
  return sum / (kPlaces * kPlaces);
}

void KernelSums::add(const LobeLight& light, double weight) {
  sums_[0] += weight * static_cast<double>(light.red);
  sums_[1] += weight * static_cast<double>(light.green);
  sums_[2] += weight * static_cast<double>(light.blue);
}

}  // namespace welkin::reflections
