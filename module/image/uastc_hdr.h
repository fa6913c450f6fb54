// UASTC HDR 4x4: blocks of 4 x 4 texels in 16 bytes that are HDR ASTC as they stand, and of those only what can be
// restated as BC6H (Basis Universal, "UASTC HDR 4x4 Texture Specification" 1.1; Khronos Data Format Specification 1.3,
// "ASTC Compressed Texture Image Formats"). Here is how a block's numbers are chosen and stored; bc6h_kernels.h
// fits the lines.
//
// As in BC6H, a block has one or two lines in colour space. All is computed in ASTC's logarithms: numbers l of 16 bits,
// 2048 for each power of two, in three straight pieces. A line's ends have the upper 12 bits.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "image/bc6h.h"

namespace welkin::image {

/// The kinds of blocks written here, two of the format's 24 modes and the one of equal texels. Others were tried on
/// chains of four photographs: endpoint format 7 (brightness alone) in pairs is 2 to 6 % worse, indices of 12 steps in
/// single lines up to 8 %.
/// The levels are the finest that fit 128 bits: 17 bits of header, 64 of indices and 46 of six ends with 192 levels
/// (256 levels take 48: one bit too many); with two lines 29, 32 and 64 of twelve ends with 40 levels (48 levels take
/// 68: one too many).
enum class UastcLines : std::uint8_t {
  single,  ///< one line, 16 steps, ends of 192 levels
  pair,    ///< two lines, 4 steps, ends of 40 levels
};

/// The ends of a line, 0 to 3967 (65216): [low, high][channel]. Only blocks of one colour reach 65504.
using UastcEnds = std::array<std::array<std::int32_t, 3>, 2>;

/// A line as it is stored: endpoint format 11 ("HDR RGB, direct").
struct UastcLine {
  std::array<std::uint8_t, 6> bytes;
  UastcEnds ends;  ///< what they mean
};

/// Returns the nearest line found for ends that need not be whole numbers. Low and high may come back exchanged.
[[nodiscard]] UastcLine store_uastc_line(const std::array<std::array<float, 3>, 2>& wanted, UastcLines lines) noexcept;

/// Returns the ends that six bytes of endpoint format 11 stand for.
[[nodiscard]] UastcEnds uastc_ends_of(const std::uint8_t* bytes) noexcept;

/// Bit k is set for the partitions of BC6H that ASTC has, too: 27 of 32.
extern const std::uint32_t kUastcPartitions;

/// A block of one line or two. `partition`: BC6H's, of two; the second line is for the texels that `bc6h_second_line`
/// names. `indices`: the texels' steps from the low end, row by row.
void pack_uastc_lines(std::span<const UastcLine> lines, int partition,
                      const std::array<std::uint8_t, kBlockTexels>& indices, std::uint8_t* block) noexcept;

/// Equal texels: exactly these halves ("void extent").
void pack_uastc_flat(const std::array<std::uint16_t, 3>& halves, std::uint8_t* block) noexcept;

/// Rows of an image of blocks, of all of the format's 24 kinds and not only of those that are written here. `blocks`:
/// the row of blocks that holds `first_row`, those below it follow. rgb: [rows][width][3]. A block that the format does
/// not have gives NaN.
void decode_uastc_hdr_rows(const std::uint8_t* blocks, int width, int first_row, int rows, float* rgb) noexcept;

/// Returns the bits of the half that a logarithm of 16 bits stands for.
[[nodiscard]] std::uint16_t half_of_logarithm(std::int32_t logarithm) noexcept;

}  // namespace welkin::image
