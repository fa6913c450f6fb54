// Which texels of a cubemap lie within a lobe's near part, and with what weights.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "platform/memory.h"
#include "reflections/ring_kernels.h"

namespace welkin::reflections {

/// Where a mip's lobe is split.
struct NearSplit {
  int face = 0;        ///< texels along an edge of the faces that are summed, even
  int size = 0;        ///< of the mip, even
  double alpha = 0.0;  ///< of the lobe
  double reach = 0.0;  ///< radians, where the near part ends
  int bands = 0;       ///< of the far part

  /// Returns q + s there, see `kFarPart`.
  [[nodiscard]] double end() const noexcept;
  /// Whether the reach has some texels, and the far part is wider than the lobe.
  [[nodiscard]] bool serves() const noexcept { return reach * face >= 5.0 && reach >= 2.0 * alpha; }
  bool operator==(const NearSplit&) const = default;
};

/// Weights of the texels near each of some directions. They err by less than 4e-5 of their sum.
class NearWeights {
 public:
  /// Texels of a face's row, and their records, which follow each other.
  struct Row {
    int first = 0;  ///< column
    int end = 0;    ///< the same as first: none is near any direction
    std::uint32_t record = 0;
  };

  /// `share`: the sum of each direction's weights. Directions are unit ones. The same bits on any number of threads and
  /// instruction set.
  NearWeights(const NearSplit& split, const std::vector<glm::dvec3>& directions, double share);

  [[nodiscard]] const std::vector<Row>& rows() const noexcept { return rows_; }  ///< [face][row]
  [[nodiscard]] std::uint32_t records() const noexcept { return records_; }
  [[nodiscard]] std::vector<std::uint32_t>& ends() noexcept { return ends_; }  ///< [directions + 1], see `RingRun`
  [[nodiscard]] platform::AlignedBuffer<RingTap>& taps() noexcept { return taps_; }

 private:
  /// Texels of a row that are near one direction.
  struct Run {
    std::int16_t face, row, first, end;
  };
  class Cone;
  struct Room;

  void find_runs(const std::vector<glm::dvec3>& directions);
  void number_records();
  [[nodiscard]] int weigh_face(const glm::dvec3& direction, std::span<const Run> runs, const Room& room) const;
  void weigh(const glm::dvec3& direction, std::size_t target, double share, const Room& room);

  NearSplit split_;
  std::vector<std::uint32_t> run_ends_;
  std::vector<Run> runs_;
  std::vector<Row> rows_;
  std::uint32_t records_ = 0;
  std::vector<std::uint32_t> ends_;
  platform::AlignedBuffer<RingTap> taps_;
};

}  // namespace welkin::reflections
