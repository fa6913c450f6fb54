// The near part of a lobe, summed over a cubemap's texels: what is left of it beside a far part of few harmonics.
//
// The far part is a polynomial near the direction (`kFarPart`) and all of the lobe beyond. Texels count as areas, so
// the sums are exact but for their weights' quadrature, whatever the light in the texels.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "platform/memory.h"
#include "reflections/near_weights.h"
#include "reflections/ring_kernels.h"
#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::reflections {

/// The weights of a mip's near sums. They depend on the split alone, and forty-eight images of a direction share them.
class NearSums {
 public:
  [[nodiscard]] static std::shared_ptr<const NearSums> get(const NearSplit& split);
  explicit NearSums(const NearSplit& split);

  /// Writes each texel's sum over packed RGB faces to `to`, six packed faces of the mip. The same bits on any
  /// number of threads and instruction set. Throws `Error` (cancelled).
  void write(const float* faces, float* to, const Control& control) const;

  /// Returns the far part's spectrum over k_0 of the whole lobe, half as many degrees again as its bands.
  [[nodiscard]] const std::vector<double>& far() const noexcept { return far_; }

  [[nodiscard]] std::size_t bytes() const noexcept;
  /// Returns what `write` takes beside the result.
  [[nodiscard]] std::size_t working_bytes() const noexcept {
    return sizeof(float) * (kRecordFloats * records_ + 3 * kCubeImages * targets_.size());
  }
  /// Returns a bound on what making them takes, and `write`.
  [[nodiscard]] static std::size_t most_bytes(const NearSplit& split) noexcept;

  static constexpr int kTurns = 3;  ///< of the axes, from x to y to z: with `kRingImages`, all of a cube's symmetries
  static constexpr int kCubeImages = kTurns * kRingImages;
  /// Floats of six packed faces: the first texel of a run in a row, and from each to the next.
  struct Place {
    std::int32_t first;
    std::int32_t step;
  };
  using Places = std::array<Place, kCubeImages>;

 private:
  /// Texels of a face that follow each other in a row, and as many records.
  struct Texels {
    Places places;
    int count;
    std::uint32_t record;
  };

  void add_targets(std::vector<glm::dvec3>& directions);
  void add_sources(const std::vector<NearWeights::Row>& rows);
  void gather(const float* faces, const Texels& texels, int turn, float* records) const;
  void sum(std::size_t row, int turn, const float* records, float* to, float* diagonal) const;
  void write_diagonals(const float* diagonal, float* to) const;

  NearSplit split_;
  std::vector<Texels> sources_;
  std::vector<Texels> targets_;  ///< record: of the first target, among `ends_`
  std::vector<std::uint32_t> ends_;
  platform::AlignedBuffer<RingTap> taps_;
  std::array<std::size_t, kCubeImages> twins_{};  ///< of each image the other that has the same targets on diagonals
  std::vector<double> far_;
  std::uint32_t records_ = 0;
};

/// Returns where the lobe of a mip is split, from faces of `face`, to take the least time if the far part takes
/// `bands_of_reach` over `reach` bands; none if the faces are too coarse for that.
[[nodiscard]] NearSplit cheapest_split(int face, int size, double alpha, double bands_of_reach) noexcept;
/// Returns about what one thread takes: for the mip, or for any by so many bands of harmonics alone.
[[nodiscard]] double milliseconds_of(const NearSplit& split) noexcept;
[[nodiscard]] double milliseconds_of_harmonics(int bands) noexcept;

}  // namespace welkin::reflections
