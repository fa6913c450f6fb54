// What one thread of a `SourceSolver` works in, and the sizes that its two halves share: orders and their rays
// (scattering_solver.cpp), and the source that they leave (source_gathering.cpp).
#pragma once

#include <cstddef>
#include <vector>

#include "sky/ray_light.h"
#include "sky/scattering_solver.h"
#include "sky/sky_geometry.h"
#include "sky/vertical_harmonics.h"

namespace welkin::sky {

namespace solver {

inline constexpr std::size_t kSunBlock = simd::kLanes;  ///< suns that are projected together
inline constexpr std::size_t kZeniths = DirectionRule::kZeniths;

/// Turns that suns and directions keep from the vertical, where azimuths have no meaning: half a degree.
inline constexpr double kOffAxis = 0.5 / 360.0;

inline std::size_t index(int i) { return static_cast<std::size_t>(i); }

}  // namespace solver

struct SourceSolver::Worker {
  Worker(const Air& air, const SourceShape& shape, std::size_t azimuths, int bands)
      : light(air, shape, azimuths * solver::index(shape.suns)),
        rays(3 * azimuths * solver::kSunBlock),
        values(pair_count(bands)),
        harmonics(pair_count(bands) * 3 * solver::kSunBlock),
        lobed(harmonics.size()),
        aerosol(solver::index(bands) * 3 * solver::kSunBlock) {}

  RayLight light;
  std::vector<float> rays;       ///< a ring with the ground's light: [3][azimuths][block]
  std::vector<float> values;     ///< [pairs]
  std::vector<float> harmonics;  ///< [pairs][3][block]
  std::vector<float> lobed;      ///< likewise, each wavelength's times its own lobe's moments, where lobes differ
  std::vector<float> aerosol;    ///< [m][3][block]: for one zenith, folded
};

}  // namespace welkin::sky
