// The light that air scatters anew: over height, direction and sun.
#pragma once

#include <cstddef>
#include <vector>

#include "simd/sky_kernels.h"
#include "sky/table_mapping.h"

namespace welkin::sky {

/// Nodes of a source. Heights and suns as in tables; zenith angles and angles between direction and sun evenly from 0
/// to 180 degrees. All at least 2.
struct SourceShape {
  int heights = 32;
  int zeniths = 33;
  int angles = 25;
  int suns = 48;  ///< a multiple of 16

  /// Texels over angles and suns.
  [[nodiscard]] std::size_t picture() const noexcept {
    return static_cast<std::size_t>(angles) * static_cast<std::size_t>(suns);
  }
  [[nodiscard]] std::size_t size() const noexcept {
    return static_cast<std::size_t>(heights) * static_cast<std::size_t>(zeniths) * 4 * picture();
  }
};

/// Radiance that arrives from everywhere, folded with a phase function: what a unit of scattering sends on in a
/// direction. [heights][zeniths][angles][suns][4]
struct ScatteringSource {
  SourceShape shape;
  std::vector<float> rayleigh;
  std::vector<float> aerosol;  ///< empty: nothing but molecules scatters

  explicit ScatteringSource(const SourceShape& nodes, bool with_aerosol)
      : shape(nodes), rayleigh(nodes.size()), aerosol(with_aerosol ? nodes.size() : 0) {}
};

[[nodiscard]] simd::SunAxis sun_axis(const TableMapping& mapping, int nodes) noexcept;

}  // namespace welkin::sky
