// Helpers shared by the prefilter's tests.
#pragma once

#include "support/catch.h"
#include "support/chains.h"
#include "support/images.h"
#include "support/same_bits.h"
#include "welkin/image.h"
#include "welkin/reflections.h"

namespace welkin::test {

/// Returns every `step`-th element of `all`, from the first on.
inline std::vector<glm::dvec3> every(std::size_t step, const std::vector<glm::dvec3>& all) {
  std::vector<glm::dvec3> some;
  for (std::size_t k = 0; k < all.size(); k += step) some.push_back(all[k]);
  return some;
}

/// Returns the step that selects about `probes` of a mip's texels.
inline std::size_t step_for(int size, std::size_t probes) {
  return std::max<std::size_t>(1, static_cast<std::size_t>(6 * size * size) / probes);
}

struct LevelError {
  double rms = 0.0;      ///< relative to the rms of the reference
  double maximum = 0.0;  ///< of |x - t| / t
};

/// Returns the error of every `step`-th texel against `truth` there.
inline LevelError level_error(const Cubemap& chain, int level, const std::vector<glm::dvec3>& truth,
                              std::size_t step = 1) {
  const float* const rgb = chain.face(level, 0);
  LevelError error;
  double squares = 0.0;
  double whole = 0.0;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    for (int c = 0; c < 3; ++c) {
      const double t = truth[k][c];
      const double off = std::abs(static_cast<double>(rgb[3 * k * step + static_cast<std::size_t>(c)]) - t);
      squares += off * off;
      whole += t * t;
      error.maximum = std::max(error.maximum, off / std::max(std::abs(t), 1e-30));
    }
  }
  error.rms = squares > 0.0 ? std::sqrt(squares / whole) : 0.0;
  return error;
}

/// Returns the largest relative difference of a mip's values from a uniform texel; infinite if there is a NaN.
inline double largest_deviation(const Cubemap& chain, int level, const std::vector<float>& texel) {
  const auto values = level_values(chain, level);
  double worst = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double off = std::abs(static_cast<double>(values[k]) / static_cast<double>(texel[k % 3]) - 1.0);
    worst = std::isnan(off) ? std::numeric_limits<double>::infinity() : std::max(worst, off);
  }
  return worst;
}

/// Returns the error of every `step`-th texel of a mip against GGX's integral in double.
inline LevelError error_of_mip(const EnvironmentView& view, const PrefilteredSpecular& result, std::size_t level,
                               std::size_t step = 1) {
  const MipRecord& mip = result.mips[level];
  const auto truth = reference_specular(view, mip.roughness, every(step, texel_centres(mip.size)));
  return level_error(result.cubemap, static_cast<int>(level), truth, step);
}

}  // namespace welkin::test
