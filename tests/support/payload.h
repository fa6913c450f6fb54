// Test payloads whose bytes can be recognized.
#pragma once

#include "support/catch.h"

namespace welkin::test {

/// Returns a payload in which every byte follows from the number.
inline std::vector<std::uint8_t> payload_of(unsigned number, std::size_t bytes) {
  std::vector<std::uint8_t> payload(bytes);
  for (std::size_t k = 0; k < bytes; ++k) payload[k] = static_cast<std::uint8_t>(k * 31 + number * 7 + k / 256);
  return payload;
}

}  // namespace welkin::test
