// A cubemap's mip chain for bilinear and trilinear look-ups without seams.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "platform/memory.h"
#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::reflections {

/// Every face with one more texel beyond each edge: the neighbouring face's, at a corner the mean of the three that
/// meet there. Four floats a texel, the last 0.
class PaddedCube {
 public:
  explicit PaddedCube(const CubemapChain& chain);

  [[nodiscard]] int levels() const noexcept { return static_cast<int>(levels_.size()); }
  [[nodiscard]] std::size_t bytes() const noexcept;

  /// Texels along an edge of a level's faces, without those beyond.
  [[nodiscard]] int size(int level) const noexcept { return levels_[static_cast<std::size_t>(level)].size; }

  /// A level's faces one after the other, (size + 2)^2 texels each.
  [[nodiscard]] const float* texels(int level) const noexcept {
    return levels_[static_cast<std::size_t>(level)].texels.data();
  }

 private:
  struct Level {
    int size;
    platform::AlignedBuffer<float> texels;

    [[nodiscard]] float* texel(int face, int column, int row) noexcept {
      return texels.data() + 4 * ((static_cast<std::ptrdiff_t>(face) * (size + 2) + row + 1) * (size + 2) + column + 1);
    }
    void fill(const CubemapChain& chain, int level);
    void fill_corner(int face, int column, int row);
  };

  std::vector<Level> levels_;
};

// Where filtered importance sampling looks, and how blurred: one list for all texels of a mip.

/// One sample in the frame whose z axis is the texel's direction.
struct Tap {
  float x, y, z;  ///< unit
  float weight;   ///< the list's sum is 1
  float level;    ///< of the source's mip chain, fractions too, 0 or above
};

/// Half vectors by GGX's distribution at a Hammersley set, reflected; taps below the horizon are left out. A tap's
/// level is where a texel covers four times the solid angle that falls to the tap, 1 / (samples pdf), pdf = D / 4
/// (Krivanek and Colbert, Real-time Shading with Filtered Importance Sampling, 2008; the further level is their
/// factor against noise). `level_size`: texels along an edge of level 0. 0 < alpha <= 1, 1 <= samples.
[[nodiscard]] std::vector<Tap> make_taps(double alpha, int samples, int level_size, int levels);

// Filtered importance sampling of one mip.

/// Writes the taps' weighted sum about the direction of each texel's centre to six packed RGB faces. The same bits on
/// any number of threads and instruction set. Throws `Error` (cancelled).
void sample_mip(const PaddedCube& source, const std::vector<Tap>& taps, int size, const std::array<float*, 6>& faces,
                const Control& control);

}  // namespace welkin::reflections
