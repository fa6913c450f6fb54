// Cubemaps on their way to OpenGL, a slice per frame.
#pragma once

#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace window {

/// A prefiltered chain in memory: half floats that a worker has written, or the floats of a sky.
struct Chain {
  std::shared_ptr<const void> owner;
  int size = 0;
  GLenum format = GL_RGB, type = GL_FLOAT;
  std::size_t texel_bytes = 12;
  std::vector<std::array<const void*, 6>> mips;  ///< packed rows
};

/// A texture that is filled within a number of bytes per frame. Mips go from the roughest to the sharpest.
class Upload {
 public:
  explicit Upload(Chain chain) : chain_(std::move(chain)), mip_(static_cast<int>(chain_.mips.size()) - 1) {
    glGenTextures(1, &texture_);
    glBindTexture(GL_TEXTURE_CUBE_MAP, texture_);
    for (int mip = 0; mip <= mip_; ++mip) {
      for (GLenum face = 0; face < 6; ++face) {
        glTexImage2D(GL_TEXTURE_CUBE_MAP_POSITIVE_X + face, mip, GL_RGB16F, chain_.size >> mip, chain_.size >> mip, 0,
                     chain_.format, chain_.type, nullptr);
      }
    }
    glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MAX_LEVEL, mip_);
    glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  }
  ~Upload() { glDeleteTextures(1, &texture_); }
  Upload(const Upload&) = delete;
  Upload& operator=(const Upload&) = delete;

  /// Copies rows until `budget` bytes are spent, at least one. Returns whether the texture is complete.
  bool step(std::size_t budget) {
    glBindTexture(GL_TEXTURE_CUBE_MAP, texture_);
    while (!complete() && budget > 0) {
      const int size = chain_.size >> mip_;
      const std::size_t row_bytes = chain_.texel_bytes * static_cast<std::size_t>(size);
      const int rows = std::clamp(static_cast<int>(budget / row_bytes), 1, size - row_);
      const auto* first = static_cast<const std::byte*>(chain_.mips[static_cast<std::size_t>(mip_)][face_]) +
                          static_cast<std::size_t>(row_) * row_bytes;
      glTexSubImage2D(GL_TEXTURE_CUBE_MAP_POSITIVE_X + static_cast<GLenum>(face_), mip_, 0, row_, size, rows,
                      chain_.format, chain_.type, first);
      budget -= std::min(budget, static_cast<std::size_t>(rows) * row_bytes);
      if ((row_ += rows) < size) continue;
      row_ = 0;
      if (++face_ < 6) continue;
      face_ = 0;
      --mip_;
    }
    return complete();
  }

  [[nodiscard]] bool complete() const noexcept { return mip_ < 0; }
  [[nodiscard]] const void* source() const noexcept { return chain_.owner.get(); }
  [[nodiscard]] GLuint texture() const noexcept { return texture_; }
  [[nodiscard]] int mips() const noexcept { return static_cast<int>(chain_.mips.size()); }

 private:
  Chain chain_;
  GLuint texture_ = 0;
  int mip_, row_ = 0;
  std::size_t face_ = 0;
};

}  // namespace window
