// After "ASTC Compressed Texture Image Formats" of the Khronos Data Format Specification 1.3, whose headings are in
// quotation marks below.
#include "image/uastc_hdr_decoder.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <utility>

#include "image/pixels.h"
#include "image/uastc_hdr.h"

namespace welkin::image {
namespace {

constexpr int kBitsOfBlock = 128;

// ---- Bounded integer sequences: numbers of `bits` plain bits below a digit of base 3 or 5 (or 1: none)

struct Levels {
  int bits;
  int base;
};

constexpr int count_of(Levels levels) { return levels.base << levels.bits; }
constexpr int bits_of(Levels levels, int numbers) {
  // Five digits of base 3 have 243 <= 2^8 values, three of base 5 125 <= 2^7; a last group that is not full takes as
  // many bits as its digits need, ceil(8 n / 5) and ceil(7 n / 3) in all.
  const int digits = levels.base == 3 ? (8 * numbers + 4) / 5 : levels.base == 5 ? (7 * numbers + 2) / 3 : 0;
  return levels.bits * numbers + digits;
}

/// Numbers of endpoints, with 6 values and more. A block uses the finest that fits its bits.
constexpr std::array<Levels, 17> kEndLevels{{{1, 3},
                                             {3, 1},
                                             {1, 5},
                                             {2, 3},
                                             {4, 1},
                                             {2, 5},
                                             {3, 3},
                                             {5, 1},
                                             {3, 5},
                                             {4, 3},
                                             {6, 1},
                                             {4, 5},
                                             {5, 3},
                                             {7, 1},
                                             {5, 5},
                                             {6, 3},
                                             {8, 1}}};
/// Weights, by the six codes of low and of high precision.
constexpr std::array<Levels, 12> kStepLevels{
    {{1, 1}, {0, 3}, {2, 1}, {0, 5}, {1, 3}, {3, 1}, {1, 5}, {2, 3}, {4, 1}, {2, 5}, {3, 3}, {5, 1}}};

/// A block's bits, from below.
class Bits {
 public:
  explicit Bits(const std::uint8_t* block) noexcept {
    for (std::size_t k = 0; k < words_.size(); ++k) {
      for (std::size_t byte = 8; byte-- > 0;) words_[k] = words_[k] << 8U | block[8 * k + byte];
    }
  }
  /// Bits beyond the block's are 0.
  [[nodiscard]] int at(int first, int count) const noexcept {
    if (count == 0 || first >= kBitsOfBlock) return 0;
    const auto shift = static_cast<unsigned>(first % 64);
    std::uint64_t value = words_[static_cast<std::size_t>(first / 64)] >> shift;
    if (first < 64 && shift != 0) value |= words_[1] << (64 - shift);
    return static_cast<int>(value & ((std::uint64_t{1} << static_cast<unsigned>(count)) - 1));
  }
  /// Returns the block with its bits in reverse order.
  [[nodiscard]] Bits reversed() const noexcept {
    Bits other = *this;
    for (std::size_t k = 0; k < words_.size(); ++k) {
      std::uint64_t word = words_[1 - k];
      for (unsigned half = 0; half < 6; ++half) {
        constexpr std::array<std::uint64_t, 6> kHalves{0x5555555555555555U, 0x3333333333333333U, 0x0F0F0F0F0F0F0F0FU,
                                                       0x00FF00FF00FF00FFU, 0x0000FFFF0000FFFFU, 0x00000000FFFFFFFFU};
        word = (word & kHalves[half]) << (1U << half) | (word >> (1U << half) & kHalves[half]);
      }
      other.words_[k] = word;
    }
    return other;
  }

 private:
  std::array<std::uint64_t, 2> words_{};
};

constexpr int bit(int value, int place) { return value >> place & 1; }

using Digits = std::array<std::uint8_t, 5>;

/// Five digits of base 3 from 8 bits.
constexpr Digits trits_of(int code) {
  int c = code & 0x1F;
  int t4 = bit(code, 7);
  int t3 = code >> 5 & 3;
  if ((code >> 2 & 7) == 7) {
    c = (code >> 5) << 2 | (code & 3);
    t4 = t3 = 2;
  } else if (t3 == 3) {
    t3 = t4;
    t4 = 2;
  }
  int t2 = bit(c, 4);
  int t1 = c >> 2 & 3;
  int t0 = bit(c, 1) << 1 | (bit(c, 0) & ~bit(c, 1));
  if ((c & 3) == 3) {
    t2 = 2;
    t1 = bit(c, 4);
    t0 = bit(c, 3) << 1 | (bit(c, 2) & ~bit(c, 3));
  } else if (t1 == 3) {
    t2 = t1 = 2;
    t0 = c & 3;
  }
  return {static_cast<std::uint8_t>(t0), static_cast<std::uint8_t>(t1), static_cast<std::uint8_t>(t2),
          static_cast<std::uint8_t>(t3), static_cast<std::uint8_t>(t4)};
}

/// Three digits of base 5 from 7 bits.
constexpr Digits quints_of(int code) {
  int q0 = 4;
  int q1 = 4;
  int q2 = 4;
  const bool three_of_four = (code >> 1 & 3) == 3;
  if (three_of_four && (code >> 5 & 3) == 0) {
    const int other = bit(code, 0) == 0 ? code >> 3 & 3 : 0;
    q2 = bit(code, 0) << 2 | other;
  } else {
    const int c = three_of_four ? (code >> 3 & 3) << 3 | (~(code >> 5) & 3) << 1 | bit(code, 0) : code & 0x1F;
    if (!three_of_four) q2 = code >> 5 & 3;
    q0 = (c & 7) == 5 ? c >> 3 : c & 7;
    q1 = (c & 7) == 5 ? 4 : c >> 3;
  }
  return {static_cast<std::uint8_t>(q0), static_cast<std::uint8_t>(q1), static_cast<std::uint8_t>(q2), 0, 0};
}

constexpr auto kTrits = [] {
  std::array<Digits, 256> table{};
  for (int code = 0; code < 256; ++code) table[static_cast<std::size_t>(code)] = trits_of(code);
  return table;
}();
constexpr auto kQuints = [] {
  std::array<Digits, 128> table{};
  for (int code = 0; code < 128; ++code) table[static_cast<std::size_t>(code)] = quints_of(code);
  return table;
}();

/// A number's plain bits, and its digit above them. Digits' bits lie between the plain ones, shared by a group.
template <std::size_t most>
void read_numbers(const Bits& from, int place, Levels levels, int count, std::array<std::uint8_t, most>& numbers) {
  constexpr Digits kTritBits{2, 2, 1, 2, 1};
  constexpr Digits kQuintBits{3, 2, 2, 0, 0};
  const int group = levels.base == 3 ? 5 : levels.base == 5 ? 3 : 1;
  const int end = place + bits_of(levels, count);
  const auto read = [&](int bits) {
    const int here = std::min(bits, std::max(0, end - place));  // the last group's further digits are 0
    const int value = from.at(place, here);
    place += here;
    return value;
  };
  for (int first = 0; first < count; first += group) {
    std::array<int, 5> plain{};
    int code = 0;
    int code_bits = 0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(group); ++k) {
      plain[k] = first + static_cast<int>(k) < count ? read(levels.bits) : 0;
      if (levels.base == 1) continue;
      const int bits = levels.base == 3 ? kTritBits[k] : kQuintBits[k];
      code |= read(bits) << code_bits;
      code_bits += bits;
    }
    const Digits digits = levels.base == 3   ? kTrits[static_cast<std::size_t>(code)]
                          : levels.base == 5 ? kQuints[static_cast<std::size_t>(code)]
                                             : Digits{};
    for (int k = 0; k < group && first + k < count; ++k) {
      const auto at = static_cast<std::size_t>(k);
      numbers[static_cast<std::size_t>(first + k)] = static_cast<std::uint8_t>(digits[at] << levels.bits | plain[at]);
    }
  }
}

/// `bits` bits, repeated downwards to `wanted`.
constexpr int repeated(int value, int bits, int wanted) {
  int result = 0;
  for (int place = wanted - bits;; place -= bits) {
    result |= place >= 0 ? value << place : value >> -place;
    if (place <= 0) return result;
  }
}

/// The byte that an end's number stands for ("Color endpoint unquantization").
constexpr int byte_of(int number, Levels levels) {
  const int n = levels.bits;
  if (levels.base == 1) return repeated(number, n, 8);
  const int upper = (number & ((1 << n) - 1)) >> 1;  // without the lowest bit: of n - 1 bits
  const int a = bit(number, 0) != 0 ? 0x1FF : 0;
  constexpr std::array<std::array<int, 7>, 2> kFactors{{{0, 204, 93, 44, 22, 11, 5}, {0, 113, 54, 26, 13, 6, 0}}};
  const bool trits = levels.base == 3;
  int b = 0;
  if (trits) {
    b = n == 2   ? 0x116 * upper
        : n == 3 ? upper << 7 | upper << 2 | upper
        : n == 4 ? upper << 6 | upper
        : n == 5 ? upper << 5 | upper >> 2
        : n == 6 ? upper << 4 | upper >> 4
                 : 0;
  } else {
    b = n == 2   ? 0x10C * upper
        : n == 3 ? upper << 7 | upper << 1 | upper >> 1
        : n == 4 ? upper << 6 | upper >> 1
        : n == 5 ? upper << 5 | upper >> 3
                 : 0;
  }
  const int t = ((number >> n) * kFactors[trits ? 0 : 1][static_cast<std::size_t>(n)] + b) ^ a;
  return (a & 0x80) | t >> 2;
}

/// The share of 64 that a step's number stands for ("Weight unquantization").
constexpr int share_of(int number, Levels levels) {
  const int n = levels.bits;
  int share = 0;
  if (levels.base == 1) {
    share = repeated(number, n, 6);
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
  const auto gather = [&](int& number, const auto& places) {
    for (const BitField& place : places) number |= bit(place.modes, mode) * more[place.from] << place.to;
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
  const auto square = [p](unsigned place) { return (p >> place & 0xFU) * (p >> place & 0xFU); };
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

using BlockHalves = std::array<std::array<std::uint16_t, 3>, kBlockTexels>;

/// False for what the format does not have.
bool decode_block(const std::uint8_t* block, BlockHalves& halves) {
  const Bits bits(block);
  constexpr int kFlat = 0x1FC;
  if (bits.at(0, 9) == kFlat) {
    for (auto& texel : halves) {
      for (std::size_t c = 0; c < 3; ++c)
        texel[c] = static_cast<std::uint16_t>(bits.at(64 + 16 * static_cast<int>(c), 16));
    }
    return bits.at(9, 1) == 1;  // halves
  }
  // 4 x 4 steps for one plane: the only block mode of that shape, but for their precision.
  const int step_code = bits.at(4, 1) | bits.at(0, 2) << 1;
  if (bits.at(0, 2) == 0 || step_code < 2 || bits.at(2, 2) != 0 || bits.at(5, 4) != 2 || bits.at(10, 1) != 0)
    return false;
  const Levels steps = kStepLevels[static_cast<std::size_t>(step_code - 2 + 6 * bits.at(9, 1))];
  constexpr int kMinStepBits = 24;
  const int parts = bits.at(11, 2) + 1;
  if (parts > 2 || bits_of(steps, kBlockTexels) < kMinStepBits) return false;
  const int format_place = parts == 1 ? 13 : 25;
  if (parts == 2 && bits.at(23, 2) != 0) return false;  // formats that differ
  const int format = bits.at(format_place, 4);
  if (format != 7 && format != 11) return false;
  const int per_part = format == 7 ? 4 : 6;
  const int room = kBitsOfBlock - (format_place + 4) - bits_of(steps, kBlockTexels);
  std::size_t fine = kEndLevels.size();
  while (fine > 0 && bits_of(kEndLevels[fine - 1], parts * per_part) > room) --fine;
  if (fine == 0) return false;
  const Levels levels = kEndLevels[fine - 1];

  std::array<std::uint8_t, 12> numbers{};
  read_numbers(bits, format_place + 4, levels, parts * per_part, numbers);
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
      halves[k][c] = half_of_logarithm((16 * (low[c] * (64 - share) + high[c] * share) + 32) >> 6);
    }
  }
  return true;
}

}  // namespace

void decode_uastc_hdr_rows(const std::uint8_t* blocks, int width, int first_row, int rows, float* rgb) noexcept {
  const int last_row = first_row + rows;
  for (int top = first_row / kBlockEdge * kBlockEdge; top < last_row; top += kBlockEdge) {
    for (int left = 0; left < width; left += kBlockEdge, blocks += kBlockBytes) {
      BlockHalves halves{};
      const bool known = decode_block(blocks, halves);
      for (int row = std::max(top, first_row); row < std::min(top + kBlockEdge, last_row); ++row) {
        for (int column = left; column < std::min(left + kBlockEdge, width); ++column) {
          const auto& texel = halves[static_cast<std::size_t>((row - top) * kBlockEdge + column - left)];
          float* const to = rgb + std::ptrdiff_t{3} * (std::ptrdiff_t{row - first_row} * width + column);
          for (std::size_t c = 0; c < 3; ++c) {
            to[c] = known ? float_from_half(texel[c]) : std::numeric_limits<float>::quiet_NaN();
          }
        }
      }
    }
  }
}

}  // namespace welkin::image
