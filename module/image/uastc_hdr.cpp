#include "image/uastc_hdr.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <span>
#include <utility>

#include "image/block_bits.h"
#include "image/bounded_integers.h"

namespace welkin::image {
namespace {

constexpr int kLargestEnd = 3967;  ///< the last one whose half is finite

// ---- Integers of 192 and 40 levels

constexpr astc::Levels kSingleLevels{6, 3};
constexpr astc::Levels kPairLevels{3, 5};

/// For each byte and each count of upper bits that must stay, the nearest byte that a number stands for; and the
/// numbers of those bytes.
struct LevelTable {
  static constexpr int kMaxKept = 4;
  std::array<std::array<std::uint8_t, 256>, kMaxKept + 1> nearest{};
  std::array<std::uint8_t, 256> number{};

  constexpr explicit LevelTable(astc::Levels levels) {
    std::array<bool, 256> stored{};
    for (int n = 0; n < astc::count_of(levels); ++n) {
      const auto byte = static_cast<std::size_t>(astc::byte_of(n, levels));
      stored[byte] = true;
      number[byte] = static_cast<std::uint8_t>(n);
    }
    for (int kept = 0; kept <= kMaxKept; ++kept) {
      for (int byte = 0; byte < 256; ++byte) {
        const int first = byte & (0xFF00 >> kept);
        const int last = byte | (0xFF >> kept);
        int off = 0;
        const auto serves = [&](int k) { return k >= first && k <= last && stored[static_cast<std::size_t>(k)]; };
        while (!serves(byte - off) && !serves(byte + off)) ++off;
        nearest[static_cast<std::size_t>(kept)][static_cast<std::size_t>(byte)] =
            static_cast<std::uint8_t>(serves(byte - off) ? byte - off : byte + off);
      }
    }
  }
};
constexpr LevelTable kSingleTable(kSingleLevels);
constexpr LevelTable kPairTable(kPairLevels);

const LevelTable& table_of(UastcLines lines) noexcept {
  return lines == UastcLines::single ? kSingleTable : kPairTable;
}

// ---- A line's six bytes

// Channels are ordered: the one that is brightest at the high end, then the two others.
//   high = (a, a - b0, a - b1), low = (a - c, a - b0 - c - d0, a - b1 - c - d1), all times 2^shift.
// Bytes 0 to 5 have the lower bits of a, c, b0, b1, d0, d1. What else they hold is said by the mode.
enum Number : std::uint8_t { kA, kC, kB0, kB1, kD0, kD1 };

struct NumberBit {
  Number number;
  std::uint8_t bit;
};

/// How the mode shares out the bits.
struct EndMode {
  int shift;
  std::array<int, 4> bits;         ///< of a, c, b and d
  std::size_t extras;              ///< how many of those below it has
  std::array<NumberBit, 6> extra;  ///< in bit 6 of bytes 2 to 5, then bit 5 of 4 and 5
};
constexpr std::array<EndMode, 8> kEndModes{{
    {3, {9, 6, 7, 7}, 2, {{{kB0, 6}, {kB1, 6}}}},
    {3, {9, 6, 8, 6}, 4, {{{kB0, 6}, {kB1, 6}, {kB0, 7}, {kB1, 7}}}},
    {2, {10, 7, 6, 7}, 2, {{{kA, 9}, {kC, 6}}}},
    {2, {10, 7, 7, 6}, 4, {{{kB0, 6}, {kB1, 6}, {kA, 9}, {kC, 6}}}},
    {1, {11, 6, 8, 5}, 6, {{{kB0, 6}, {kB1, 6}, {kB0, 7}, {kB1, 7}, {kA, 9}, {kA, 10}}}},
    {1, {11, 8, 6, 6}, 4, {{{kA, 9}, {kA, 10}, {kC, 7}, {kC, 6}}}},
    {0, {12, 7, 7, 5}, 6, {{{kB0, 6}, {kB1, 6}, {kA, 11}, {kC, 6}, {kA, 9}, {kA, 10}}}},
    {0, {12, 7, 6, 6}, 4, {{{kA, 9}, {kA, 10}, {kA, 11}, {kC, 6}}}},
}};
using Numbers = std::array<std::int32_t, 6>;

/// [low, high][channel]; of modes, the brightest channel first.
using FloatEnds = std::array<std::array<float, 3>, 2>;

template <class Ends>
void exchange_channel(Ends& ends, std::size_t brightest) noexcept {
  for (auto& end : ends) std::swap(end[0], end[brightest]);
}

/// Rounds a number between -65536 and 65536.
std::int32_t nearest(float value) noexcept { return static_cast<std::int32_t>(value + 65536.5F) - 65536; }

/// Returns the ends that the numbers stand for, in their own unit.
UastcEnds ends_of(const Numbers& n) noexcept {
  return {{{n[kA] - n[kC], n[kA] - n[kB0] - n[kC] - n[kD0], n[kA] - n[kB1] - n[kC] - n[kD1]},
           {n[kA], n[kA] - n[kB0], n[kA] - n[kB1]}}};
}

/// Returns the ends in steps of 12 bits, the channels in their own order.
UastcEnds shifted_ends(const Numbers& n, const EndMode& mode, std::size_t brightest) noexcept {
  UastcEnds ends = ends_of(n);
  for (auto& end : ends) {
    for (std::int32_t& number : end) number = std::clamp(number * (1 << mode.shift), 0, 4095);
  }
  exchange_channel(ends, brightest);
  return ends;
}

bool fits(const Numbers& n, const EndMode& mode) noexcept {
  const auto below = [](std::int32_t number, int bits) { return number >= 0 && number < 1 << bits; };
  const auto within = [](std::int32_t number, int bits) {
    return number >= -(1 << (bits - 1)) && number < 1 << (bits - 1);
  };
  return below(n[kA], mode.bits[0]) && below(n[kC], mode.bits[1]) && below(n[kB0], mode.bits[2]) &&
         below(n[kB1], mode.bits[2]) && within(n[kD0], mode.bits[3]) && within(n[kD1], mode.bits[3]);
}

/// How many lower bits of a number its own byte has.
int bits_in_byte(Number number, const EndMode& mode) noexcept {
  return number == kA ? 8 : number >= kD0 ? mode.bits[3] : 6;
}

/// The byte that has the lower bits of that number.
std::int32_t byte_of(Number number, const Numbers& n, std::size_t mode, std::size_t brightest) noexcept {
  const EndMode& here = kEndModes[mode];
  const auto extra = [&](std::size_t k) {
    return k < here.extras ? n[here.extra[k].number] >> here.extra[k].bit & 1 : 0;
  };
  const auto bit_of = [](std::size_t value, int bit) { return static_cast<std::int32_t>(value >> bit & 1); };
  const std::int32_t lower = n[number] & ((1 << bits_in_byte(number, here)) - 1);
  switch (number) {
    case kA: return lower;
    case kC: return lower | (n[kA] >> 8 & 1) << 6 | bit_of(mode, 0) << 7;
    case kB0: return lower | extra(0) << 6 | bit_of(mode, 1) << 7;
    case kB1: return lower | extra(1) << 6 | bit_of(mode, 2) << 7;
    case kD0: return lower | extra(2) << 6 | extra(4) << 5 | bit_of(brightest, 0) << 7;
    case kD1: break;
  }
  return lower | extra(3) << 6 | extra(5) << 5 | bit_of(brightest, 1) << 7;
}

/// The line whose numbers are stored by one of the modes, one number after the other: each makes up for what the ones
/// before it were rounded by. Its byte keeps the bits that others have, and a sign.
UastcLine stored_by(std::size_t mode, std::size_t brightest, Numbers n, const FloatEnds& wanted,
                    const LevelTable& levels) noexcept {
  const EndMode& here = kEndModes[mode];
  const float unit = 1.0F / static_cast<float>(1 << here.shift);
  UastcLine line{};
  const auto store = [&](Number number, float exact) {
    const int bits = bits_in_byte(number, here);
    const int whole = number >= kD0 ? bits - 1 : bits;  // the sign's bit is not rounded
    const std::int32_t mask = (1 << whole) - 1;
    const std::int32_t limit = number == kA ? kLargestEnd >> here.shift : n[number] | mask;
    n[number] = std::clamp(nearest(exact), n[number] & ~mask, std::min(n[number] | mask, limit));
    const auto byte = static_cast<std::size_t>(byte_of(number, n, mode, brightest));
    line.bytes[number] = levels.nearest[static_cast<std::size_t>(8 - whole)][byte];
    n[number] = (n[number] & ~mask) | (line.bytes[number] & mask);
  };
  const auto& [low, high] = wanted;
  const auto as_float = [&](Number number) { return static_cast<float>(n[number]); };
  // In the order in which the numbers depend on each other: c, b and d are differences to a (and to each other), so
  // each is computed from what the earlier ones have become, and their rounding does not add up.
  store(kA, high[0] * unit);
  store(kC, as_float(kA) - low[0] * unit);
  store(kB0, as_float(kA) - high[1] * unit);
  store(kB1, as_float(kA) - high[2] * unit);
  store(kD0, as_float(kA) - as_float(kB0) - as_float(kC) - low[1] * unit);
  store(kD1, as_float(kA) - as_float(kB1) - as_float(kC) - low[2] * unit);
  line.ends = shifted_ends(n, here, brightest);
  return line;
}

/// The most exact mode that can hold the ends, if there is one. `kEndModes.size()`: none. Two modes each share a unit.
std::size_t mode_for(const FloatEnds& wanted, Numbers& n) noexcept {
  // Modes 7 and 6 have a step of 1, 5 and 4 of 2, 3 and 2 of 4, 1 and 0 of 8.
  for (std::size_t mode = kEndModes.size(); mode > 0; mode -= 2) {
    const float unit = 1.0F / static_cast<float>(1 << kEndModes[mode - 1].shift);
    const auto& [low, high] = wanted;
    n[kA] = nearest(high[0] * unit);
    n[kC] = n[kA] - nearest(low[0] * unit);
    n[kB0] = n[kA] - nearest(high[1] * unit);
    n[kB1] = n[kA] - nearest(high[2] * unit);
    n[kD0] = n[kA] - n[kB0] - n[kC] - nearest(low[1] * unit);
    n[kD1] = n[kA] - n[kB1] - n[kC] - nearest(low[2] * unit);
    for (const std::size_t here : {mode - 1, mode - 2}) {
      if (fits(n, kEndModes[here])) return here;
    }
  }
  return kEndModes.size();
}

/// Without differences: the upper 8 bits of red and green, 7 of blue.
UastcLine stored_plainly(const FloatEnds& wanted, const LevelTable& levels) noexcept {
  UastcLine line{};
  for (std::size_t c = 0; c < 3; ++c) {
    const std::int32_t step = c == 2 ? 32 : 16;
    // Bit 7 of bytes 4 and 5 name the brightest channel, 0 to 2; both set say that the numbers are plain.
    const std::int32_t mark = c == 2 ? 0x80 : 0;
    for (std::size_t end = 0; end < 2; ++end) {
      std::int32_t number = std::min(nearest(wanted[end][c] / static_cast<float>(step)), kLargestEnd / step);
      const auto& to = levels.nearest[c == 2 ? 1 : 0];
      const auto stored = [&] { return std::int32_t{to[static_cast<std::size_t>(number | mark)]}; };
      while ((stored() & ~mark) * step > kLargestEnd) --number;
      line.bytes[2 * c + end] = static_cast<std::uint8_t>(stored());
      line.ends[end][c] = (stored() & ~mark) * step;
    }
  }
  return line;
}

bool is_finite(const UastcEnds& ends) noexcept {
  for (const auto& end : ends) {
    for (const std::int32_t number : end) {
      if (number > kLargestEnd) return false;
    }
  }
  return true;
}

// ---- Blocks

/// For the digits d0 + base d1 + base^2 d2 + ... the smallest code that is decoded to them.
template <std::size_t groups, std::size_t codes>
constexpr std::array<std::uint8_t, groups> codes_of(const std::array<astc::Digits, codes>& digits, int base) {
  std::array<std::uint8_t, groups> table{};
  for (std::size_t code = codes; code-- > 0;) {
    int number = 0;
    for (std::size_t k = digits[code].size(); k-- > 0;) number = base * number + digits[code][k];
    table[static_cast<std::size_t>(number)] = static_cast<std::uint8_t>(code);
  }
  return table;
}
constexpr std::array<std::uint8_t, 243> kTritCodes = codes_of<243>(astc::kTrits, 3);
constexpr std::array<std::uint8_t, 125> kQuintCodes = codes_of<125>(astc::kQuints, 5);

/// Numbers in groups, whose digits' bits lie between the plain ones.
void put_numbers(BlockBits& to, std::span<const std::uint8_t> numbers, astc::Levels levels) noexcept {
  const astc::Digits digit_bits = astc::digit_bits_of(levels);
  while (!numbers.empty()) {
    const std::size_t count = std::min(numbers.size(), static_cast<std::size_t>(astc::group_of(levels)));
    std::size_t digits = 0;
    for (std::size_t k = count; k-- > 0;) {
      digits = static_cast<std::size_t>(levels.base) * digits + static_cast<std::size_t>(numbers[k] >> levels.bits);
    }
    std::uint32_t code = levels.base == 3 ? kTritCodes[digits] : kQuintCodes[digits];
    for (std::size_t k = 0; k < count; ++k) {
      to.append(numbers[k], levels.bits);
      to.append(code, digit_bits[k]);
      code >>= digit_bits[k];
    }
    numbers = numbers.subspan(count);
  }
}

/// ASTC reads indices from the block's last bit down: the reverse of a stream that begins with texel 0's lowest bit.
/// Where it is shorter than 64 bits, reversing leaves it at the upper end.
void put_indices(BlockBits& to, const std::array<std::uint8_t, kBlockTexels>& indices, int bits) noexcept {
  BlockBits stream;
  for (const std::uint8_t index : indices) stream.append(index, bits);
  to.add(stream.reversed());
}

/// ASTC's seeds of BC6H's partitions. Negative: its first line is BC6H's second. 0: it has none.
constexpr std::array<std::int16_t, kBc6hPartitions> kSeeds{28,   20,   -16, 29,   -91, 9, -107, -72,  149, -204, 50,
                                                           -114, -496, -17, 78,   -39, 0, -252, -828, 43,  156,  116,
                                                           -210, -476, 273, -684, 359, 0, 0,    -246, 0,   0};

constexpr std::uint32_t kFormat = 11;  ///< of the ends

}  // namespace

const std::uint32_t kUastcPartitions = [] {
  std::uint32_t all = 0;
  for (std::size_t k = 0; k < kSeeds.size(); ++k) all |= kSeeds[k] != 0 ? 1U << k : 0U;
  return all;
}();

UastcLine store_uastc_line(const FloatEnds& wanted, UastcLines lines) noexcept {
  const LevelTable& levels = table_of(lines);
  FloatEnds ends = wanted;
  for (auto& end : ends) {
    for (float& number : end) number = std::clamp(number, 0.0F, static_cast<float>(kLargestEnd));
  }
  const auto sum = [](const std::array<float, 3>& end) { return end[0] + end[1] + end[2]; };
  if (sum(ends[0]) > sum(ends[1])) std::swap(ends[0], ends[1]);
  // a, b and c are not negative: the high end's brightest channel must be its largest, and not below the low end's.
  // Ends that do not fit one way may fit exchanged; indices are found from the stored ends afterwards, so nothing else
  // changes.
  for (int order = 0; order < 2; ++order) {
    const auto& high = ends[1];
    const std::size_t brightest = high[0] >= high[1] && high[0] >= high[2] ? 0 : high[1] >= high[2] ? 1 : 2;
    FloatEnds turned = ends;
    exchange_channel(turned, brightest);
    Numbers numbers{};
    const std::size_t mode = mode_for(turned, numbers);
    if (mode < kEndModes.size()) {
      const UastcLine line = stored_by(mode, brightest, numbers, turned, levels);
      if (is_finite(line.ends)) return line;
    }
    std::swap(ends[0], ends[1]);
  }
  return stored_plainly(ends, levels);
}

UastcEnds uastc_ends_of(const std::uint8_t* bytes) noexcept {
  const auto bit = [&](std::size_t byte, int slot) { return bytes[byte] >> slot & 1; };
  const auto brightest = static_cast<std::size_t>(bit(4, 7) | bit(5, 7) << 1);
  if (brightest == 3) {
    const auto end = [&](std::size_t k) -> std::array<std::int32_t, 3> {
      return {bytes[k] << 4, bytes[2 + k] << 4, (bytes[4 + k] & 0x7F) << 5};
    };
    return {end(0), end(1)};
  }
  const EndMode& mode = kEndModes[static_cast<std::size_t>(bit(1, 7) | bit(2, 7) << 1 | bit(3, 7) << 2)];
  Numbers n{};
  for (const Number number : {kA, kC, kB0, kB1, kD0, kD1}) {
    n[number] = bytes[number] & ((1 << bits_in_byte(number, mode)) - 1);
  }
  n[kA] |= bit(1, 6) << 8;
  const std::array<int, 6> extras{bit(2, 6), bit(3, 6), bit(4, 6), bit(5, 6), bit(4, 5), bit(5, 5)};
  for (std::size_t k = 0; k < mode.extras; ++k) n[mode.extra[k].number] |= extras[k] << mode.extra[k].bit;
  const int sign = 1 << (mode.bits[3] - 1);
  for (const Number number : {kD0, kD1}) n[number] = (n[number] ^ sign) - sign;
  return shifted_ends(n, mode, brightest);
}

void pack_uastc_lines(std::span<const UastcLine> lines, int partition,
                      const std::array<std::uint8_t, kBlockTexels>& indices, std::uint8_t* block) noexcept {
  const bool pair = lines.size() == 2;
  const std::int16_t seed = pair ? kSeeds[static_cast<std::size_t>(partition)] : std::int16_t{0};
  BlockBits bits;
  bits.append(pair ? 0x42U : 0x242U, 11);  // block mode: 4 x 4 indices of 2 bits, or of 4
  bits.append(pair ? 1U : 0U, 2);          // partitions in addition to the first
  if (pair) {
    bits.append(static_cast<std::uint32_t>(std::abs(seed)), 10);
    bits.append(0, 2);  // both have the same format
  }
  bits.append(kFormat, 4);
  std::array<std::uint8_t, 12> numbers{};
  const std::size_t count = 6 * lines.size();
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint8_t byte = lines[seed < 0 ? 1 - k / 6 : k / 6].bytes[k % 6];
    numbers[k] = (pair ? kPairTable : kSingleTable).number[byte];
  }
  put_numbers(bits, std::span(numbers).first(count), pair ? kPairLevels : kSingleLevels);
  put_indices(bits, indices, pair ? 2 : 4);
  bits.store(block);
}

void pack_uastc_flat(const std::array<std::uint16_t, 3>& halves, std::uint8_t* block) noexcept {
  BlockBits bits;
  bits.append(0xFFC, 12);  // of halves
  bits.append(~0U, 32);    // and for the whole texture
  bits.append(~0U, 20);
  for (const std::uint16_t half : halves) bits.append(half, 16);
  bits.append(0x3C00, 16);
  bits.store(block);
}

std::uint16_t half_of_logarithm(std::int32_t logarithm) noexcept {
  const std::int32_t m = logarithm & 0x7FF;
  // 2^x - 1 by three straight lines, in eighths of a half's last bit; they meet at m = 512 (1536), 1536 (5632) and the
  // next power of two, 2048 (8192).
  const std::int32_t mantissa = m < 512 ? 3 * m : m >= 1536 ? 5 * m - 2048 : 4 * m - 512;
  return static_cast<std::uint16_t>(std::min((logarithm >> 11 << 10) + (mantissa >> 3), 0x7BFF));
}

}  // namespace welkin::image
