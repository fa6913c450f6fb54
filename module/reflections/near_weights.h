// Which texels of a source lie within a lobe's near part, and with what weights: sixteen directions at a time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "platform/memory.h"
#include "reflections/near_kernels.h"

namespace welkin::reflections {

/// Where a mip's lobe is split.
struct NearSplit {
  int face = 0;        ///< texels along an edge of the faces that are summed; columns of a lat-long
  int size = 0;        ///< of the mip
  double alpha = 0.0;  ///< of the lobe
  double reach = 0.0;  ///< radians, where the near part ends; at most 0.5
  int bands = 0;       ///< of the far part
  int rows = 0;        ///< of a lat-long; 0: of a cubemap

  [[nodiscard]] bool cubemap() const noexcept { return rows == 0; }
  /// Returns q + s where the near part ends, see `kFarPart`.
  [[nodiscard]] double end() const noexcept;
  /// Returns the reach of a far part that is wider than the lobe.
  [[nodiscard]] double reach_of_lobe() const noexcept { return 2.5 * alpha; }
  /// Returns the reach that has some texels.
  [[nodiscard]] double reach_of_texels() const noexcept { return 5.0 / face; }
  bool operator==(const NearSplit&) const = default;
};

/// The parts of a source that those directions see of which all others are images: of a lat-long one, of a cubemap the
/// faces +z, +x and +y.
inline constexpr std::array<int, 3> kNearFaces{4, 0, 2};

/// Weights of the texels about some directions, in order, and whose they are.
struct NearTile {
  [[nodiscard]] std::size_t bytes() const noexcept;

  std::vector<NearRun> runs;
  std::vector<std::size_t> runs_ends;  ///< of each direction
  std::vector<float> weights;
};

/// Makes weights for the texels of a mip of which all others are images: those whose directions have a longitude from 0
/// (+z) to an eighth of a turn (towards +x), on the face +y for cubemaps, at any latitude of 0 or more for lat-longs. A
/// direction's weights add up to the near part's share of the lobe, over the number of images that it is of itself.
/// A weight errs by less than 0.3 % of the lobe over its texel and 3e-9; errors of a direction's add up to less than
/// 2e-4. The same bits on any number of threads and instruction set.
class NearWeights {
 public:
  /// `share`: of the near part.
  NearWeights(const NearSplit& split, double share);

  /// Returns their centres in half texels of the mip's cube, row by row.
  [[nodiscard]] const std::vector<glm::ivec3>& directions() const noexcept { return directions_; }
  /// Returns how many there are.
  [[nodiscard]] static std::size_t directions_of(const NearSplit& split) noexcept;
  [[nodiscard]] std::size_t tiles() const noexcept;
  [[nodiscard]] static std::size_t first_of(std::size_t tile) noexcept;  ///< direction

  /// Holds what a worker needs.
  struct Scratch;
  void make(std::size_t tile, NearTile& to, Scratch& scratch) const;

 private:
  using Directions = std::array<glm::dvec3, simd::kLanes>;

  struct Window;
  void add_face(const Directions& directions, int part, Scratch& scratch) const;
  void add_lat_long(const Directions& directions, Scratch& scratch) const;
  template <class Group>
  void weigh(const GroupKernels<Group>& kernels, const Group& group, const Window& window, Scratch& scratch) const;
  void weigh_group(std::size_t group, Scratch& scratch) const;
  void take_runs(std::size_t lane, Scratch& scratch) const;

  NearSplit split_;
  double share_;
  SplitLobe lobe_{};
  bool closed_ = false;  ///< whether the texels next to a direction are wide relative to the lobe
  std::vector<glm::ivec3> directions_;
  std::vector<float> column_table_;  ///< of a lat-long, see `LatLongGroup`
};

/// The texels of one part of the source about 16 directions.
struct NearWeights::Window {
  /// Texels of a row, from each direction's own.
  struct Row {
    RowRange range{};
    std::size_t weights = 0;  ///< [columns][16]: the first column's, among all
  };

  int part = 0;
  int first_row = 0;  ///< from the directions' own
  std::vector<Row> rows;
  std::array<int, simd::kLanes> column{};
  std::array<int, simd::kLanes> row{};
  CubeGroup face{};  ///< or
  LatLongGroup lat_long{};
};

/// A worker's scratch for making weights.
struct NearWeights::Scratch {
  std::array<Window, kNearFaces.size()> windows;
  std::size_t count = 0;  ///< of the windows
  platform::AlignedBuffer<float> weights;
  platform::AlignedBuffer<float> corners;
  alignas(64) float bends[2][simd::kLanes] = {};
  NearTile made;
};

}  // namespace welkin::reflections
