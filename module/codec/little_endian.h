// Integers as the texture formats store them: least significant byte first.
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

namespace welkin::codec {

// Texels are copied between memory and file as they are.
static_assert(std::endian::native == std::endian::little, "texture files need their byte order turned here");

template <std::unsigned_integral Value>
[[nodiscard]] Value read_little_endian(const std::uint8_t* bytes) noexcept {
  Value value{};
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

template <std::unsigned_integral Value>
void append_little_endian(std::vector<std::uint8_t>& bytes, Value value) {
  const std::size_t place = bytes.size();
  bytes.resize(place + sizeof value);
  std::memcpy(bytes.data() + place, &value, sizeof value);
}

}  // namespace welkin::codec
