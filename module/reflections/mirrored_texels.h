// Texels of a cubemap that a mirror or a quarter turn brings to each other. On a lat-long whose columns divide by four
// they lie at the same places within its texels, so that they share what depends on the place alone.
#pragma once

#include <cstdint>
#include <vector>

#include "image/cube_symmetry.h"
#include "image/geometry.h"

namespace welkin::reflections {

/// Where a texel's centre lies.
struct SpherePlace {
  double latitude;   ///< turns, up
  double longitude;  ///< turns, from +z towards +x, at most half a turn either way
  double sine;       ///< of the latitude
  double cosine;
};

/// Quarter turns of an image from z towards x, the way that longitudes rise.
constexpr int turns_of(const image::CubeImage& image) noexcept { return (4 - image.quarter) % 4; }

/// The texels of six faces, as some that are given by number, "originals", and the images of each.
class MirroredTexels {
 public:
  /// `columns`: of the lat-long. Where they do not divide by four, a texel has one image at most, below.
  MirroredTexels(int size, int columns);

  /// Originals that have the same images.
  struct Set {
    bool cap = false;                      ///< on the upper face, else on +z before their own image
    image::CubeImage own;                  ///< where the originals are
    std::vector<image::CubeImage> images;  ///< all of them, the originals' own place included
  };
  [[nodiscard]] const std::vector<Set>& sets() const noexcept { return sets_; }
  /// Originals of a set, and one of them: texels from the middle of a face, across, and up or (on a cap) towards z.
  [[nodiscard]] std::int64_t count() const noexcept { return std::int64_t{half_} * half_; }
  struct Original {
    int across;
    int along;
  };
  [[nodiscard]] Original original(std::int64_t number) const noexcept {
    return {static_cast<int>(number % half_), static_cast<int>(number / half_)};
  }

  /// Of an original: y >= 0.
  [[nodiscard]] SpherePlace place(const Set& set, const Original& original) const;
  /// Whether an image is not another one too, as those on the plane of a mirror are.
  [[nodiscard]] bool has(const Set& set, const Original& original, const image::CubeImage& image) const noexcept {
    if (size_ % 2 == 0) return true;
    if (image.mirrored && original.across == 0) return false;
    return original.along != 0 || !(set.cap ? image.quarter != 0 : image.below);
  }
  /// Steps in memory are even: of packed texels where `Original` counts.
  [[nodiscard]] image::CubeTexel texel(const Set& set, const Original& original,
                                       const image::CubeImage& image) const noexcept;

 private:
  /// Halves of a texel from the middle of a face.
  [[nodiscard]] int steps(int texels) const noexcept { return 2 * texels + (size_ % 2 == 0 ? 1 : 0); }

  int size_;
  int half_;
  std::vector<Set> sets_;
};

}  // namespace welkin::reflections
