// Reads blocks of UASTC HDR, after "ASTC Compressed Texture Image Formats" of the Khronos Data Format
// Specification 1.3, whose headings are in quotation marks below.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "image/block_bits.h"
#include "image/bounded_integers.h"
#include "image/uastc_hdr.h"

namespace welkin::image {
namespace {

using astc::bit, astc::byte_of, astc::Levels;

/// The bits of a sequence of numbers of some levels.
constexpr int bits_of(Levels levels, int numbers) {
  // Five digits of base 3 have 243 <= 2^8 values, three of base 5 125 <= 2^7; a last group that is not full takes as
  // many bits as its digits need, ceil(8 n / 5) and ceil(7 n / 3) in all.
  const int digits = levels.base == 3 ? (8 * numbers + 4) / 5 : levels.base == 5 ? (7 * numbers + 2) / 3 : 0;
  return levels.bits * numbers + digits;
}

/// All kinds of numbers, in rising order of their values. Weights are of the first twelve, by the six codes of low and
/// of high precision; endpoints of those with 6 values and more, and a block uses the finest that fits its bits.
constexpr std::array kLevels{Levels{1, 1}, Levels{0, 3}, Levels{2, 1}, Levels{0, 5}, Levels{1, 3}, Levels{3, 1},
                             Levels{1, 5}, Levels{2, 3}, Levels{4, 1}, Levels{2, 5}, Levels{3, 3}, Levels{5, 1},
                             Levels{3, 5}, Levels{4, 3}, Levels{6, 1}, Levels{4, 5}, Levels{5, 3}, Levels{7, 1},
                             Levels{5, 5}, Levels{6, 3}, Levels{8, 1}};
constexpr std::size_t kFirstOfEnds = 4;

/// A number's plain bits, and its digit above them. Digits' bits lie between the plain ones, shared by a group.
template <std::size_t most>
void read_numbers(const BlockBits& from, int next, Levels levels, int count, std::array<std::uint8_t, most>& numbers) {
  const int group = astc::group_of(levels);
  const astc::Digits digit_bits = astc::digit_bits_of(levels);
  const int end = next + bits_of(levels, count);
  const auto read = [&](int bits) {
    const int here = std::min(bits, std::max(0, end - next));  // the last group's further digits are 0
    const int value = from.at(next, here);
    next += here;
    return value;
  };
  for (int first = 0; first < count; first += group) {
    std::array<int, 5> plain{};
    int code = 0;
    int code_bits = 0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(group); ++k) {
      plain[k] = first + static_cast<int>(k) < count ? read(levels.bits) : 0;
      code |= read(digit_bits[k]) << code_bits;
      code_bits += digit_bits[k];
    }
    const astc::Digits digits = astc::digits_of(code, levels);
    for (int k = 0; k < group && first + k < count; ++k) {
      const auto at = static_cast<std::size_t>(k);
      numbers[static_cast<std::size_t>(first + k)] = static_cast<std::uint8_t>(digits[at] << levels.bits | plain[at]);
    }
  }
}

/// The share of 64 that a step's number stands for ("Weight unquantization").
constexpr int share_of(int number, Levels levels) {
  const int n = levels.bits;
  int share = 0;
  if (levels.base == 1) {
    share = astc::repeated(number, n, 6);
  } else if (n == 0) {
    constexpr std::array<int, 3> kThirds{0, 32, 63};
    constexpr std::array<int, 5> kFifths{0, 16, 32, 47, 63};
    share = levels.base == 3 ? kThirds[static_cast<std::size_t>(number)] : kFifths[static_cast<std::size_t>(number)];
  } else {
    const int upper = (number & ((1 << n) - 1)) >> 1;
    const int a = bit(number, 0) != 0 ? 0x7F : 0;
    const bool trits = levels.base == 3;
    const int c = trits ? (n == 1 ? 50 : n == 2 ? 23 : 11) : (n == 1 ? 28 : 13);
    const int b = n == 1 ? 0 : !trits ? 0x42 * upper : n == 2 ? 0x45 * upper : upper << 5 | upper;
    share = (a & 0x20) | (((number >> n) * c + b) ^ a) >> 2;
  }
  // From 0 to 63 to 0 to 64, so that the high end is reached exactly.
  return share > 32 ? share + 1 : share;
}

// ---- Ends

/// Endpoint format 7 ("HDR RGB, base and scale"): the high end, and how far all of its channels are above the low
/// one's.
UastcEnds scaled_ends(const std::uint8_t* v) {
  const int value = (v[0] & 0xC0) >> 6 | (v[1] & 0x80) >> 5 | (v[2] & 0x80) >> 4;
  const int brightest = (value & 0xC) != 0xC ? value >> 2 : value != 0xF ? value & 3 : 0;
  const int mode = (value & 0xC) != 0xC ? value & 3 : value != 0xF ? 4 : 5;
  int red = v[0] & 0x3F;
  int green = v[1] & 0x1F;
  int blue = v[2] & 0x1F;
  int scale = v[3] & 0x1F;
  const std::array<int, 7> more{bit(v[1], 6), bit(v[1], 5), bit(v[2], 6), bit(v[2], 5),
                                bit(v[3], 7), bit(v[3], 6), bit(v[3], 5)};
  struct BitField {
    int modes;         ///< a bit for each mode that has it
    std::size_t from;  ///< of the bits above
    int to;
  };
  const auto gather = [&](int& number, const auto& fields) {
    for (const BitField& field : fields) number |= bit(field.modes, mode) * more[field.from] << field.to;
  };
  gather(green, std::array<BitField, 2>{{{0x30, 0, 6}, {0x3A, 1, 5}}});
  gather(blue, std::array<BitField, 2>{{{0x30, 2, 6}, {0x3A, 3, 5}}});
  gather(scale, std::array<BitField, 3>{{{0x3D, 6, 5}, {0x2D, 5, 6}, {0x04, 4, 7}}});
  gather(red, std::array<BitField, 10>{{{0x3B, 4, 6},
                                        {0x04, 3, 6},
                                        {0x10, 5, 7},
                                        {0x0F, 2, 7},
                                        {0x05, 1, 8},
                                        {0x0A, 0, 8},
                                        {0x05, 0, 9},
                                        {0x02, 6, 9},
                                        {0x01, 3, 10},
                                        {0x02, 5, 10}}});
  constexpr std::array<int, 6> kShifts{1, 1, 2, 3, 4, 5};
  const int shift = kShifts[static_cast<std::size_t>(mode)];
  std::array<int, 3> high{red << shift, green << shift, blue << shift};
  if (mode != 5) high = {high[0], high[0] - high[1], high[0] - high[2]};
  std::swap(high[0], high[static_cast<std::size_t>(brightest)]);
  UastcEnds ends{};
  for (std::size_t c = 0; c < 3; ++c) {
    ends[0][c] = std::clamp(high[c] - (scale << shift), 0, 4095);
    ends[1][c] = std::clamp(high[c], 0, 4095);
  }
  return ends;
}

// ---- Blocks

/// ASTC's pseudo-random division of a block of 4 x 4 texels in two: which part each is in, by bits.
std::uint32_t second_part(int index) {
  std::uint32_t p = static_cast<std::uint32_t>(index) + 1024;
  p ^= p >> 15U;
  p -= p << 17U;
  p += p << 7U;
  p += p << 4U;
  p ^= p >> 5U;
  p += p << 16U;
  p ^= p >> 7U;
  p ^= p >> 3U;
  p ^= p << 6U;
  p ^= p >> 17U;
  const std::uint32_t one = (index & 2) != 0 ? 4 : 5;
  const std::uint32_t across = (index & 1) != 0 ? one : 5;
  const std::uint32_t down = (index & 1) != 0 ? 5 : one;
  const auto square = [p](unsigned shift) { return (p >> shift & 0xFU) * (p >> shift & 0xFU); };
  std::uint32_t parts = 0;
  for (std::uint32_t k = 0; k < kBlockTexels; ++k) {
    const std::uint32_t x = 2 * (k % kBlockEdge);  // a small block is looked at twice as closely
    const std::uint32_t y = 2 * (k / kBlockEdge);
    const std::uint32_t first = (square(0) >> across) * x + (square(4) >> down) * y + (p >> 14U);
    const std::uint32_t second = (square(8) >> across) * x + (square(12) >> down) * y + (p >> 10U);
    parts |= (first & 63U) >= (second & 63U) ? 0U : 1U << k;
  }
  return parts;
}

/// Decodes to 16 x 3 half floats. Returns false for blocks that the format does not have.
bool decode_block(const std::uint8_t* block, std::uint16_t* halves) {
  const BlockBits bits(block);
  constexpr int kFlat = 0x1FC;
  if (bits.at(0, 9) == kFlat) {
    for (int k = 0; k < 3 * static_cast<int>(kBlockTexels); ++k) {
      halves[k] = static_cast<std::uint16_t>(bits.at(64 + 16 * (k % 3), 16));
    }
    return bits.at(9, 1) == 1;  // halves
  }
  // 4 x 4 steps for one plane: the only block mode of that shape, but for their precision.
  const int step_code = bits.at(4, 1) | bits.at(0, 2) << 1;
  if (bits.at(0, 2) == 0 || step_code < 2 || bits.at(2, 2) != 0 || bits.at(5, 4) != 2 || bits.at(10, 1) != 0)
    return false;
  const Levels steps = kLevels[static_cast<std::size_t>(step_code - 2 + 6 * bits.at(9, 1))];
  constexpr int kMinStepBits = 24;
  const int parts = bits.at(11, 2) + 1;
  if (parts > 2 || bits_of(steps, kBlockTexels) < kMinStepBits) return false;
  const int format_offset = parts == 1 ? 13 : 25;
  if (parts == 2 && bits.at(23, 2) != 0) return false;  // formats that differ
  const int format = bits.at(format_offset, 4);
  if (format != 7 && format != 11) return false;
  const int per_part = format == 7 ? 4 : 6;
  const int free_bits = kBitsOfBlock - (format_offset + 4) - bits_of(steps, kBlockTexels);
  std::size_t fine = kLevels.size();
  while (fine > kFirstOfEnds && bits_of(kLevels[fine - 1], parts * per_part) > free_bits) --fine;
  if (fine == kFirstOfEnds) return false;
  const Levels levels = kLevels[fine - 1];

  std::array<std::uint8_t, 12> numbers{};
  read_numbers(bits, format_offset + 4, levels, parts * per_part, numbers);
  for (std::uint8_t& number : numbers) number = static_cast<std::uint8_t>(byte_of(number, levels));
  std::array<UastcEnds, 2> ends{};
  for (int part = 0; part < parts; ++part) {
    const std::uint8_t* const its = numbers.data() + part * per_part;
    ends[static_cast<std::size_t>(part)] = format == 7 ? scaled_ends(its) : uastc_ends_of(its);
  }
  std::array<std::uint8_t, kBlockTexels> shares{};
  read_numbers(bits.reversed(), 0, steps, kBlockTexels, shares);
  const std::uint32_t second = parts == 2 ? second_part(bits.at(13, 10)) : 0;
  for (std::size_t k = 0; k < kBlockTexels; ++k) {
    const auto& [low, high] = ends[second >> k & 1U];
    const int share = share_of(shares[k], steps);
    for (std::size_t c = 0; c < 3; ++c) {
      halves[3 * k + c] = half_of_logarithm((16 * (low[c] * (64 - share) + high[c] * share) + 32) >> 6);
    }
  }
  return true;
}

}  // namespace

void decode_uastc_hdr_rows(const std::uint8_t* blocks, int width, int first_row, int rows, float* rgb) noexcept {
  decode_block_rows(blocks, width, first_row, rows, rgb, [](const std::uint8_t* block, std::uint16_t* halves) {
    constexpr std::uint16_t not_a_number = 0x7E00;
    if (!decode_block(block, halves)) std::fill_n(halves, 3 * kBlockTexels, not_a_number);
  });
}

}  // namespace welkin::image
