// What a mip's weights err by, and what that makes of a picture: the estimate of mips that are sums over texels.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "platform/memory.h"
#include "reflections/ring_kernels.h"
#include "welkin/image.h"

namespace welkin::reflections {

/// Squares of a cube's texels, at most 24 along an edge: of faces up to 24 the texels themselves.
struct CubeBlocks {
  explicit CubeBlocks(int face_size) noexcept;

  [[nodiscard]] std::size_t count() const noexcept { return std::size_t{6} * static_cast<std::size_t>(size * size); }

  int edge = 1;  ///< texels along a block's edge, a power of two
  int size;      ///< blocks along a face's edge
};

/// A picture by blocks. Not a texel of it must be looked at again for a further mip.
class BlockLight {
 public:
  explicit BlockLight(int face_size);

  /// `source`: rgb32f.
  void read(const CubemapView& source);

  /// A record's number, which is the block's, and the block's mean radiance.
  [[nodiscard]] const std::vector<GroupTap>& means() const noexcept { return means_; }
  /// Mean square of what a block's texels differ from its mean by, the sum of all channels.
  [[nodiscard]] const std::vector<float>& deviations() const noexcept { return deviations_; }

 private:
  CubeBlocks blocks_;
  std::vector<GroupTap> means_;
  std::vector<float> deviations_;
};

/// A mip's weights against the lobe's integrals: the differences at some texels of the mip and their sixteen images
/// each. What they make of a picture's blocks is summed as the mip itself is. What a block's texels differ from its
/// mean by counts half as much again as if they were independent.
class LobeErrors {
 public:
  static constexpr int kTexels = 6;  ///< of the sixteenth, that are looked at

  explicit LobeErrors(int face_size);

  /// off[point]: the error of a texel's weight of radiance, of the `texel`-th of those that are looked at.
  void add(int texel, const std::vector<double>& off);

  /// Root mean square of what the mip errs by, all channels together.
  [[nodiscard]] double rms(const BlockLight& light) const;

  [[nodiscard]] static std::size_t bytes_for(int face_size) noexcept;

 private:
  CubeBlocks blocks_;
  std::vector<float> scattered_;            ///< mean square of a block's differences
  platform::AlignedBuffer<float> records_;  ///< [kTexels / 3][block][image][3 texels]
};

}  // namespace welkin::reflections
