// A cubemap's mip chain for bilinear and trilinear look-ups without seams.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "tables/aligned_buffer.h"
#include "welkin/cubemap_chain.h"

namespace welkin::specular {

/// Every face with one more texel beyond each edge: the neighbouring face's, at a corner the mean of the three that
/// meet there. Four floats a texel, the last 0.
class PaddedCube {
 public:
  explicit PaddedCube(const CubemapChain& chain);

  [[nodiscard]] int levels() const noexcept { return static_cast<int>(levels_.size()); }
  [[nodiscard]] std::size_t bytes() const noexcept;

  /// Adds weight times the trilinear interpolation in a direction that need not be of unit length, 0 <= level <=
  /// levels() - 1, to four floats.
  void add(const std::array<float, 3>& direction, float level, float weight, float* sum) const noexcept;

 private:
  struct Level {
    int size;
    tables::AlignedBuffer<float> texels;

    [[nodiscard]] float* texel(int face, int column, int row) noexcept {
      return texels.data() + 4 * ((static_cast<std::ptrdiff_t>(face) * (size + 2) + row + 1) * (size + 2) + column + 1);
    }
    [[nodiscard]] const float* texel(int face, int column, int row) const noexcept {
      return texels.data() + 4 * ((static_cast<std::ptrdiff_t>(face) * (size + 2) + row + 1) * (size + 2) + column + 1);
    }
    void fill(const CubemapChain& chain, int level);
    void fill_corner(int face, int column, int row);
    void add(int face, float u, float v, float weight, float* sum) const noexcept;
  };

  std::vector<Level> levels_;
};

}  // namespace welkin::specular
