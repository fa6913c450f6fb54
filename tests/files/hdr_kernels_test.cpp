// The kernel of Radiance pictures: mantissas and exponents to floats.

#include "files/hdr_kernels.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "support/catch.h"
#include "support/same_bits.h"
#include "welkin/core.h"

namespace welkin::test {

// Promises: every mantissa with every exponent becomes the float that its definition says, at any length, on every
// instruction set, and nothing else is written.

namespace {

constexpr int kGuards = 16;
constexpr float kUntouched = -1.0F;

/// mantissa 2^(exponent - 136), and 0 with exponent 0.
std::vector<float> expected(const std::vector<std::uint8_t>& planes, int length) {
  std::vector<float> rgb;
  const auto plane = static_cast<std::size_t>(length);
  for (std::size_t i = 0; i < plane; ++i) {
    const int exponent = planes[3 * plane + i];
    for (std::size_t c = 0; c < 3; ++c) {
      const double value = exponent == 0 ? 0.0 : std::ldexp(static_cast<double>(planes[c * plane + i]), exponent - 136);
      rgb.push_back(static_cast<float>(value));
    }
  }
  return rgb;
}

void check(const std::vector<std::uint8_t>& planes, int length) {
  std::vector<float> wanted = expected(planes, length);
  wanted.insert(wanted.end(), kGuards, kUntouched);
  for (const InstructionSet set : available_instruction_sets()) {
    CAPTURE(length, static_cast<int>(set));
    std::vector<float> rgb(wanted.size(), kUntouched);
    files::hdr_kernels(set).floats_from_rgbe(planes.data(), length, rgb.data());
    CHECK(same_bits(wanted, rgb.data()));
  }
}

}  // namespace

TEST_CASE("every mantissa with every exponent is the float that it stands for", "[codec][hdr][kernels]") {
  constexpr int kValues = 256;
  for (int exponent = 0; exponent < kValues; ++exponent) {
    std::vector<std::uint8_t> planes;
    for (int component = 0; component < 3; ++component) {
      for (int k = 0; k < kValues; ++k) planes.push_back(static_cast<std::uint8_t>(k + 85 * component));
    }
    planes.insert(planes.end(), kValues, static_cast<std::uint8_t>(exponent));
    check(planes, kValues);
  }
}

TEST_CASE("runs of RGBE of any length are converted, and nothing behind them is written", "[codec][hdr][kernels]") {
  for (const int length : {1, 2, 3, 7, 13, 14, 15, 16, 17, 18, 19, 31, 32, 33, 34, 63, 64, 65, 257}) {
    std::vector<std::uint8_t> planes;
    for (int k = 0; k < 4 * length; ++k) planes.push_back(static_cast<std::uint8_t>(37 * k + k / 11));
    check(planes, length);
  }
}

}  // namespace welkin::test
