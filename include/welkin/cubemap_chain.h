// A cubemap with its mip chain.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "welkin/export.h"
#include "welkin/image_view.h"

namespace WELKIN_EXPORT welkin {

/// How many levels a whole chain has, from `size` down to 1: 1 + floor(log2(size)). `size` >= 1.
[[nodiscard]] constexpr int full_chain_levels(int size) noexcept {
  int levels = 1;
  while (size > 1) {
    size /= 2;
    ++levels;
  }
  return levels;
}

/// Six faces of RGB floats in the frames of `CubemapView`, and their smaller levels, in one block of memory: level
/// after level, face after face, row after row, no padding. Level l has max(1, size >> l) texels along an edge, as
/// graphics APIs count. Moves are cheap; there is no copy.
class CubemapChain {
 public:
  /// No levels.
  CubemapChain() = default;

  /// The pixels are not initialised. Throws `Error` (invalid_argument) unless 1 <= size <= 16384 and
  /// 1 <= levels <= full_chain_levels(size).
  CubemapChain(int size, int levels);

  /// Texels along an edge of level 0; 0 if there are no levels.
  [[nodiscard]] int size() const noexcept { return size_; }
  /// How many levels there are; 0 if it is empty.
  [[nodiscard]] int levels() const noexcept { return static_cast<int>(offsets_.size()); }
  /// Texels along an edge of a level.
  [[nodiscard]] int level_size(int level) const noexcept { return size_ >> level > 1 ? size_ >> level : 1; }
  /// Memory of all levels.
  [[nodiscard]] std::size_t bytes() const noexcept { return values_ * sizeof(float); }

  /// First channel of a face's first texel: level_size^2 x 3 floats. 0 <= level < levels(), 0 <= face < 6.
  [[nodiscard]] float* face(int level, int face) noexcept { return pixels_.get() + face_offset(level, face); }
  /// First float of a face: level_size x level_size texels of RGB, packed, row 0 on top.
  [[nodiscard]] const float* face(int level, int face) const noexcept {
    return pixels_.get() + face_offset(level, face);
  }

  /// A level as a view. It is valid while the chain lives and is not assigned to.
  [[nodiscard]] CubemapView view(int level) const noexcept;
  /// All levels, as `project` and the writers take them.
  [[nodiscard]] std::vector<CubemapView> views() const;

 private:
  [[nodiscard]] std::size_t face_offset(int level, int face) const noexcept {
    const auto edge = static_cast<std::size_t>(level_size(level));
    return offsets_[static_cast<std::size_t>(level)] + static_cast<std::size_t>(face) * edge * edge * 3;
  }

  int size_ = 0;
  std::size_t values_ = 0;
  std::vector<std::size_t> offsets_;  ///< of each level's first value
  std::unique_ptr<float[]> pixels_;
};

}  // namespace welkin
