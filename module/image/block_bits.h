// Blocks of 4 x 4 texels in 128 bits, as BC6H and ASTC have them: their bits, and rows of an image of them.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "image/bc6h.h"
#include "image/pixels.h"

namespace welkin::image {

inline constexpr int kBitsOfBlock = 128;

/// A block's bits, from below: the lowest bit of its first byte is the first one.
/// Words lie in memory as their bytes do in a block: all processors that there are builds for are little-endian.
class BlockBits {
 public:
  BlockBits() = default;
  explicit BlockBits(const std::uint8_t* block) noexcept { std::memcpy(words_.data(), block, kBlockBytes); }

  /// `count`: up to 16. Bits beyond the block's are 0.
  [[nodiscard]] int at(int first, int count) const noexcept {
    if (count == 0 || first >= kBitsOfBlock) return 0;
    const auto shift = static_cast<unsigned>(first % 64);
    std::uint64_t value = words_[static_cast<std::size_t>(first / 64)] >> shift;
    if (first < 64 && shift != 0) value |= words_[1] << (64 - shift);
    return static_cast<int>(value & ((std::uint64_t{1} << static_cast<unsigned>(count)) - 1));
  }

  /// Sets the bits after those that were appended before. `count`: up to 32; `value` may have more bits.
  void append(std::uint32_t value, int count) noexcept {
    const std::uint64_t kept = value & ((std::uint64_t{1} << count) - 1);
    words_[0] |= offset_ < 64 ? kept << offset_ : 0;
    if (offset_ + count > 64) words_[1] |= offset_ < 64 ? kept >> (64 - offset_) : kept << (offset_ - 64);
    offset_ += count;
  }

  /// Adds what other bits have set.
  void add(const BlockBits& other) noexcept {
    for (std::size_t k = 0; k < words_.size(); ++k) words_[k] |= other.words_[k];
  }

  /// Returns the block with its bits in reverse order.
  [[nodiscard]] BlockBits reversed() const noexcept {
    constexpr std::array<std::uint64_t, 6> kHalves{0x5555555555555555U, 0x3333333333333333U, 0x0F0F0F0F0F0F0F0FU,
                                                   0x00FF00FF00FF00FFU, 0x0000FFFF0000FFFFU, 0x00000000FFFFFFFFU};
    BlockBits other;
    for (std::size_t k = 0; k < words_.size(); ++k) {
      std::uint64_t word = words_[1 - k];
      for (unsigned half = 0; half < 6; ++half) {
        word = (word & kHalves[half]) << (1U << half) | (word >> (1U << half) & kHalves[half]);
      }
      other.words_[k] = word;
    }
    return other;
  }

  void store(std::uint8_t* block) const noexcept { std::memcpy(block, words_.data(), kBlockBytes); }

 private:
  std::array<std::uint64_t, 2> words_{};
  int offset_ = 0;
};

/// Decodes rows of an image of blocks. `blocks`: the row of blocks that holds `first_row`, those below it follow.
/// rgb: [rows][width][3]. `decode(block, halves)` writes a block's 16 x 3 half floats, row by row.
template <class Decode>
void decode_block_rows(const std::uint8_t* blocks, int width, int first_row, int rows, float* rgb,
                       const Decode& decode) noexcept {
  const int last_row = first_row + rows;
  for (int top = first_row / kBlockEdge * kBlockEdge; top < last_row; top += kBlockEdge) {
    for (int left = 0; left < width; left += kBlockEdge, blocks += kBlockBytes) {
      std::array<std::uint16_t, 3 * kBlockTexels> halves{};
      decode(blocks, halves.data());
      const auto values = static_cast<std::size_t>(3 * std::min(kBlockEdge, width - left));
      for (int row = std::max(top, first_row); row < std::min(top + kBlockEdge, last_row); ++row) {
        const auto* const from = halves.data() + std::ptrdiff_t{3} * kBlockEdge * (row - top);
        float* const to = rgb + std::ptrdiff_t{3} * (std::ptrdiff_t{width} * (row - first_row) + left);
        std::transform(from, from + values, to, float_from_half);
      }
    }
  }
}

}  // namespace welkin::image
