// ASTC's bounded integer sequences: numbers of plain bits below a digit of base 3 or 5, whose digits are packed in
// groups (Khronos Data Format Specification 1.3, "ASTC Compressed Texture Image Formats", whose headings are in
// quotation marks).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace welkin::image::astc {

/// Levels of a number: `bits` plain ones below a digit of base 3 or 5 (or 1: none).
struct Levels {
  int bits;
  int base;
};

constexpr int count_of(Levels levels) { return levels.base << levels.bits; }

constexpr int bit(int value, int index) { return value >> index & 1; }

using Digits = std::array<std::uint8_t, 5>;

/// How many numbers share the bits of their digits, and how many of those bits follow the plain ones of each.
constexpr int group_of(Levels levels) { return levels.base == 3 ? 5 : levels.base == 5 ? 3 : 1; }
constexpr Digits digit_bits_of(Levels levels) {
  return levels.base == 3 ? Digits{2, 2, 1, 2, 1} : levels.base == 5 ? Digits{3, 2, 2, 0, 0} : Digits{};
}

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

/// The digits of each code.
inline constexpr auto kTrits = [] {
  std::array<Digits, 256> table{};
  for (int code = 0; code < 256; ++code) table[static_cast<std::size_t>(code)] = trits_of(code);
  return table;
}();
inline constexpr auto kQuints = [] {
  std::array<Digits, 128> table{};
  for (int code = 0; code < 128; ++code) table[static_cast<std::size_t>(code)] = quints_of(code);
  return table;
}();

/// A group's digits; 0 where there are none.
constexpr Digits digits_of(int code, Levels levels) {
  const auto at = static_cast<std::size_t>(code);
  return levels.base == 3 ? kTrits[at] : levels.base == 5 ? kQuints[at] : Digits{};
}

/// `bits` bits, repeated downwards to `wanted`.
constexpr int repeated(int value, int bits, int wanted) {
  int result = 0;
  for (int shift = wanted - bits;; shift -= bits) {
    result |= shift >= 0 ? value << shift : value >> -shift;
    if (shift <= 0) return result;
  }
}

/// Returns the byte that an end's number stands for (`Color endpoint unquantization`).
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

}  // namespace welkin::image::astc
