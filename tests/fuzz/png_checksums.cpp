#include "png_checksums.h"

namespace welkin::fuzz {
namespace {

std::uint32_t big_endian(const std::uint8_t* bytes) {
  return std::uint32_t{bytes[0]} << 24U | std::uint32_t{bytes[1]} << 16U | std::uint32_t{bytes[2]} << 8U | bytes[3];
}

std::uint32_t checksum(const std::uint8_t* bytes, std::size_t count) {
  std::uint32_t sum = 0xffffffffU;
  for (std::size_t i = 0; i < count; ++i) {
    sum ^= bytes[i];
    for (int bit = 0; bit < 8; ++bit) {
      sum = sum >> 1U ^ ((sum & 1U) != 0 ? 0xedb88320U : 0U);
    }
  }
  return ~sum;
}

}  // namespace

void mend_png_checksums(std::uint8_t* bytes, std::size_t count) {
  constexpr std::size_t kSignature = 8;
  constexpr std::size_t kAroundData = 12;  // length, type, checksum
  for (std::size_t index = kSignature; count >= kAroundData && index <= count - kAroundData;) {
    const std::size_t length = big_endian(bytes + index);
    if (length > count - index - kAroundData) {
      return;
    }
    const std::uint32_t sum = checksum(bytes + index + 4, 4 + length);
    for (unsigned i = 0; i < 4; ++i) {
      bytes[index + 8 + length + i] = static_cast<std::uint8_t>(sum >> (24U - 8U * i));
    }
    index += length + kAroundData;
  }
}

}  // namespace welkin::fuzz
