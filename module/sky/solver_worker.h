// Memory of one thread of a `SourceSolver`, and the sizes that its two halves share: orders and their rays
// (scattering_solver.cpp), and the source that they leave (source_gathering.cpp).
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "jobs/tiles.h"
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

/// Short work between passes, which the next one waits for.
template <class Work>
void each(const std::vector<std::size_t>& heights, const Work& work) {
  jobs::run_tiles(heights.size(), jobs::Placement::arena, jobs::worker_count(jobs::Placement::arena), {},
                  [&](std::size_t tile, std::size_t) { work(heights[tile]); });
}

/// Fills the row of a height by the cubic through those of the four nearest even ones. `rows` are of all heights;
/// values are not below 0 unless `with_sign`.
template <class Value>
void fill(std::size_t height, std::size_t heights, std::vector<Value>& rows, bool with_sign = false) {
  const std::size_t size = rows.size() / heights;
  const Cubic cubic = cubic_at(0.5 * static_cast<double>(height), static_cast<int>((heights + 1) / 2));
  const Value* const from = rows.data() + 2 * index(cubic.first) * size;
  Value weights[4];
  for (std::size_t k = 0; k < 4; ++k) weights[k] = static_cast<Value>(cubic.weights[k]);
  const Value minimum = with_sign ? std::numeric_limits<Value>::lowest() : Value{0};
  Value* const to = rows.data() + height * size;
  for (std::size_t i = 0; i < size; ++i) {
    const Value sum = weights[0] * from[i] + weights[1] * from[2 * size + i] + weights[2] * from[4 * size + i] +
                      weights[3] * from[6 * size + i];
    to[i] = sum > minimum ? sum : minimum;
  }
}

}  // namespace solver

struct SourceSolver::Worker {
  Worker(const AirModel& air, const SourceShape& shape, std::size_t azimuths, int bands)
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
  std::vector<float> lobed;      ///< [pairs][3][block]: harmonics times moments of each one's lobe, where they differ
  std::vector<float> aerosol;    ///< [m][3][block]: for one zenith, folded
};

}  // namespace welkin::sky
