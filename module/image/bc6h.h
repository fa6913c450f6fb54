// BC6H: 4 x 4 texels of RGB halves in 16 bytes (Khronos Data Format Specification 1.3, "BC6H"; Direct3D 11's "BC6H
// Format"). Here is what a block holds, and the exact way from a block to halves; bc6h_kernels.h has the way back.
//
// A block has one or two lines in colour space. A line is given by its two ends, and each texel by an index along it.
// With two lines one of 32 partitions says which texels belong to which. The modes share out the bits: some store all
// ends with few bits, others the first one with many and the rest as differences to it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace welkin::image {

inline constexpr int kBlockEdge = 4;             ///< texels along an edge of a block
inline constexpr std::size_t kBlockTexels = 16;  ///< of a block
inline constexpr std::size_t kBlockBytes = 16;   ///< of a block

/// Whether the half floats of a texture may be negative: BC6H_SFLOAT and BC6H_UFLOAT.
enum class Bc6hRange { positive, signed_values };

/// The properties of a mode.
struct Bc6hMode {
  int prefix;                     ///< the block's first bits
  int prefix_bits;                ///< 2 or 5
  int end_bits;                   ///< of the first end, in each channel
  std::array<int, 3> other_bits;  ///< of the other ends, in red, green and blue
  bool differences;               ///< the other ends are stored as differences from the first
  bool two_lines;                 ///< with a partition, and indices of 3 bits; else one, and 4 bits
};

/// Modes are counted from 1 to 14, as Direct3D's documentation does.
inline constexpr int kBc6hModes = 14;
[[nodiscard]] const Bc6hMode& bc6h_mode(int mode) noexcept;

/// The numbers that lie in a block.
struct Bc6hFields {
  int mode = 0;       ///< 1 to 14; 0: reserved, which stands for black
  int partition = 0;  ///< 0 to 31, with two lines
  /// [low end of the first line, its high one, low of the second, its high][channel]. As they are stored: the lowest
  /// bits of a number, or of a difference to the first end.
  std::array<std::array<std::uint32_t, 3>, 4> ends{};
  std::array<std::uint8_t, kBlockTexels> indices{};  ///< from the low end to the high one
};

[[nodiscard]] Bc6hFields unpack_bc6h(const std::uint8_t* block) noexcept;

/// Packs a block of mode 1 to 14. The upper bit of the index of each line's anchor must be 0, for it is not stored.
void pack_bc6h(const Bc6hFields& fields, std::uint8_t* block) noexcept;

// Which texels of a block with two lines belong to which: plain numbers, as a kernel calls nothing outside, and not
// inline, as its objects define nothing that others could be linked to.

/// Texel k of the second line is bit k (row by row). These are the first 32 of BC7's partitions, too.
constexpr std::uint16_t kBc6hSecondLines[] = {0xCCCC, 0x8888, 0xEEEE, 0xECC8, 0xC880, 0xFEEC, 0xFEC8, 0xEC80,
                                              0xC800, 0xFFEC, 0xFE80, 0xE800, 0xFFE8, 0xFF00, 0xFFF0, 0xF000,
                                              0xF710, 0x008E, 0x7100, 0x08CE, 0x008C, 0x7310, 0x3100, 0x8CCE,
                                              0x088C, 0x3110, 0x6666, 0x366C, 0x17E8, 0x0FF0, 0x718E, 0x399C};

/// The texel of the second line whose index has one bit less. The first line's is texel 0.
constexpr std::uint8_t kBc6hAnchors[] = {15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15,
                                         15, 2,  8,  2,  2,  8,  8,  15, 2,  8,  2,  2,  8,  8,  2,  2};

inline constexpr int kBc6hPartitions = 32;
static_assert(sizeof kBc6hSecondLines == kBc6hPartitions * sizeof(std::uint16_t) &&
              sizeof kBc6hAnchors == kBc6hPartitions);

[[nodiscard]] std::uint16_t bc6h_second_line(int partition) noexcept;
[[nodiscard]] int bc6h_anchor(int partition) noexcept;

/// Writes 16 x 3 half floats, row by row. Reserved modes give black.
void decode_bc6h(const std::uint8_t* block, Bc6hRange range, std::uint16_t* halves) noexcept;

/// The stored numbers of the ends, differences added to the first: [end][channel]; negative only in the signed format.
using Bc6hNumbers = std::array<std::array<std::int32_t, 3>, 4>;
[[nodiscard]] Bc6hNumbers bc6h_numbers(const Bc6hFields& fields, Bc6hRange range) noexcept;

/// Returns the decoder's end of 16 bits (and a sign) for a stored number.
[[nodiscard]] std::int32_t bc6h_end(std::int32_t number, int mode, Bc6hRange range) noexcept;

/// Returns the position of an index along its line, in 64ths.
[[nodiscard]] std::int32_t bc6h_weight(std::int32_t index, int mode) noexcept;

/// Stores one channel's numbers. Returns false and stores nothing if the block's mode cannot hold them.
[[nodiscard]] bool store_bc6h_numbers(const Bc6hNumbers& numbers, std::size_t channel, Bc6hRange range,
                                      Bc6hFields& fields) noexcept;

/// Writes one channel's 16 half floats of a block of mode 1 to 14 with these numbers.
void decode_bc6h_channel(const Bc6hFields& fields, const Bc6hNumbers& numbers, std::size_t channel, Bc6hRange range,
                         std::uint16_t* halves) noexcept;

/// Decodes rows of an image of blocks. `blocks`: the row of blocks that holds `first_row`, those below it follow.
/// rgb: [rows][width][3].
void decode_bc6h_rows(const std::uint8_t* blocks, Bc6hRange range, int width, int first_row, int rows,
                      float* rgb) noexcept;

/// Returns the number of blocks that cover `texels` texels in a row.
[[nodiscard]] constexpr int blocks_across(int texels) noexcept { return (texels + kBlockEdge - 1) / kBlockEdge; }

}  // namespace welkin::image
