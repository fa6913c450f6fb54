// The checksum of a file of sky tables: CRC-32 as in ISO 3309, gzip and PNG (polynomial 0x04C11DB7, bits reflected).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "platform/file.h"

namespace welkin::files {

/// Tables for eight bytes at a time: entry [k][b] is the remainder of byte b with k zero bytes after it.
inline constexpr auto kCrc32Tables = [] {
  constexpr std::uint32_t reflected_polynomial = 0xEDB88320U;
  std::array<std::array<std::uint32_t, 256>, 8> tables{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t remainder = byte;
    for (int bit = 0; bit < 8; ++bit) {
      remainder = (remainder >> 1U) ^ ((remainder & 1U) != 0 ? reflected_polynomial : 0U);
    }
    tables[0][byte] = remainder;
  }
  for (std::size_t zeros = 1; zeros < tables.size(); ++zeros) {
    for (std::size_t byte = 0; byte < 256; ++byte) {
      const std::uint32_t before = tables[zeros - 1][byte];
      tables[zeros][byte] = (before >> 8U) ^ tables[0][before & 0xFFU];
    }
  }
  return tables;
}();

/// Returns the checksum of data with checksum `before` (0: no data) followed by these bytes.
[[nodiscard]] inline std::uint32_t crc32(std::uint32_t before, const void* bytes, std::size_t count) noexcept {
  const auto* next = static_cast<const std::uint8_t*>(bytes);
  std::uint32_t remainder = ~before;
  for (; count >= 8; count -= 8, next += 8) {
    const std::uint32_t first = remainder ^ platform::read_little_endian<std::uint32_t>(next);
    const auto second = platform::read_little_endian<std::uint32_t>(next + 4);
    remainder = kCrc32Tables[7][first & 0xFFU] ^ kCrc32Tables[6][first >> 8U & 0xFFU] ^
                kCrc32Tables[5][first >> 16U & 0xFFU] ^ kCrc32Tables[4][first >> 24U] ^
                kCrc32Tables[3][second & 0xFFU] ^ kCrc32Tables[2][second >> 8U & 0xFFU] ^
                kCrc32Tables[1][second >> 16U & 0xFFU] ^ kCrc32Tables[0][second >> 24U];
  }
  for (; count > 0; --count, ++next) {
    remainder = (remainder >> 8U) ^ kCrc32Tables[0][(remainder ^ *next) & 0xFFU];
  }
  return ~remainder;
}

}  // namespace welkin::files
