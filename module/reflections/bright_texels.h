// Texels so bright that they are kept out of the harmonics.
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec3.hpp>
#include <vector>

#include "projection/sanitized_pixels.h"
#include "welkin/core.h"

namespace welkin::reflections {

struct BrightTexel {
  int row = 0;  ///< of a cubemap counted face after face
  int column = 0;
  std::array<float, 3> rest{};    ///< what is left in the image
  std::array<float, 3> excess{};  ///< radiance that is extracted
  double steradians = 0.0;

  /// Returns radiance times steradians of what is extracted.
  [[nodiscard]] glm::dvec3 light() const noexcept { return steradians * glm::dvec3(excess[0], excess[1], excess[2]); }
};

/// Texels that are, or are part of, light so bright that float harmonics, and harmonics that end, would lose what is
/// dark relative to it: at most `most`, the brightest. `alpha` is the narrowest lobe's. By row and column. Throws
/// `Error` (cancelled).
[[nodiscard]] std::vector<BrightTexel> find_bright_texels(const projection::SanitizedSource& source, double alpha,
                                                          std::size_t most, const Control& control);
inline constexpr std::size_t kMaxBright = 1U << 16U;  ///< for spectral mips
inline constexpr std::size_t kMaxBrightFar = 4096;    ///< for narrow lobes' far part, whose mips are large

/// How many are found, and what the search for them takes. At most, unless they lie about a pole or are bright in one
/// channel alone, or outshine all the rest: they are 25 times as bright as the mean. `rows`: of a lat-long, or of a
/// cubemap's six faces.
struct BrightSearch {
  std::size_t texels = 0;
  std::size_t bytes = 0;
};
[[nodiscard]] BrightSearch search_for_bright_texels(bool cubemap, int columns, int rows, double alpha,
                                                    std::size_t most) noexcept;

/// Returns the mean over the sphere of what is extracted, root of the squares of the channels.
[[nodiscard]] double mean_excess(const std::vector<BrightTexel>& texels) noexcept;

}  // namespace welkin::reflections
