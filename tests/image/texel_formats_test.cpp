// Texels as graphics APIs hold them: halves, b10g11r11 and e5b9g9r9, value by value.
#include <Imath/half.h>

#include "image/image_kernels.h"
#include "image/pixels.h"
#include "support/catch.h"

namespace welkin::test {

// Promises: halves, b10g11r11 and e5b9g9r9 take the value that is nearest, among all that there are; each of these goes
// to itself.

namespace {

/// Values over the whole range, denormals and places halfway between two among them.
std::vector<float> values_up_to(float largest, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<float> values{0.0F, largest, std::numeric_limits<float>::denorm_min(), 0x1p-24F, 0x1p-25F, 0x3p-26F};
  while (values.size() < 20000) {
    const int exponent = static_cast<int>(random() % 48) - 31;
    const float bits = random() % 2 == 0 ? 4096.0F : 8388608.0F;  // few bits: halfway, often
    const float value =
        std::ldexp(1.0F + std::floor(static_cast<float>(random() % 65536U) / 65536.0F * bits) / bits, exponent);
    if (value <= largest) values.push_back(value);
  }
  return values;
}

/// All values of an unsigned float with five bits of exponent (bias 15), rising, in double.
std::vector<double> all_small_floats(int mantissa_bits) {
  std::vector<double> values;
  for (int exponent = 0; exponent < 31; ++exponent) {
    for (int mantissa = 0; mantissa < 1 << mantissa_bits; ++mantissa) {
      const double fraction = std::ldexp(mantissa, -mantissa_bits);
      values.push_back(exponent == 0 ? std::ldexp(fraction, -14) : std::ldexp(1.0 + fraction, exponent - 15));
    }
  }
  return values;
}

/// The index of the nearest; of two, the even one.
std::size_t nearest(const std::vector<double>& values, double value) {
  const auto above = std::lower_bound(values.begin(), values.end(), value);
  if (above == values.end()) return values.size() - 1;
  const auto index = static_cast<std::size_t>(above - values.begin());
  if (index == 0) return 0;
  const double to_above = *above - value;
  const double to_below = value - values[index - 1];
  return to_above < to_below || (to_above == to_below && index % 2 == 0) ? index : index - 1;
}

bool is_a_number(std::uint16_t half) { return (half & 0x7C00U) != 0x7C00U; }

/// All halves, infinities and NaNs too; the floats half way between two of them, and next to those; random bits.
std::vector<float> values_around_halves() {
  std::vector<float> values;
  for (unsigned bits = 0; bits < 65536; ++bits) {
    const auto half = static_cast<std::uint16_t>(bits);
    const float here = image::float_from_half(half);
    values.push_back(here);
    if (!is_a_number(half) || (half & 0x7FFFU) == 0x7BFFU) continue;
    const float middle = 0.5F * (here + image::float_from_half(static_cast<std::uint16_t>(bits + 1)));
    values.insert(values.end(), {middle, std::nextafter(middle, 0.0F), std::nextafter(middle, 2.0F * middle)});
  }
  std::mt19937 random(5);
  for (int k = 0; k < 100'000; ++k) values.push_back(std::bit_cast<float>(static_cast<std::uint32_t>(random())));
  return values;
}

}  // namespace

TEST_CASE("Half values are rounded as Imath rounds them", "[codec][texels]") {
  std::size_t wrong = 0;
  for (const float v : values_around_halves()) {
    if (std::abs(v) <= 65504.0F && image::half_from_float(v) != Imath::half(v).bits()) ++wrong;
  }
  CHECK(wrong == 0);
  for (const float v : {65504.0F, 65519.0F, 65520.0F, 1e30F}) {
    CHECK(image::half_from_float(v) == 0x7BFF);
    CHECK(image::half_from_float(-v) == 0xFBFF);
  }
}

TEST_CASE("Half values in rows are converted as one by one, on each instruction set", "[codec][texels]") {
  const std::vector<float> values = values_around_halves();
  std::vector<std::uint16_t> one_by_one(values.size());
  int changed = 0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    one_by_one[k] = std::isnan(values[k]) ? std::uint16_t{0} : image::half_from_float(values[k]);
    changed += std::abs(values[k]) <= image::kLargestHalf ? 0 : 1;  // NaN counts as well
  }
  std::vector<std::uint16_t> every(65536);
  std::iota(every.begin(), every.end(), std::uint16_t{0});
  for (const InstructionSet set : available_instruction_sets()) {
    CAPTURE(name(set));
    for (const std::size_t skipped : {0U, 1U, 13U}) {  // rows that begin and end within a register
      std::vector<std::uint16_t> halves(values.size() - skipped);
      CHECK(image::half_kernels(set).halves_of_floats(values.data() + skipped, static_cast<int>(halves.size()),
                                                      halves.data()) == changed);
      CHECK(std::equal(halves.begin(), halves.end(), one_by_one.begin() + static_cast<std::ptrdiff_t>(skipped)));
    }
    std::vector<float> floats(every.size());
    image::half_kernels(set).floats_of_halves(every.data(), static_cast<int>(every.size()), floats.data());
    CHECK(std::equal(floats.begin(), floats.end(), every.begin(), [](float value, std::uint16_t half) {
      return std::bit_cast<std::uint32_t>(value) == std::bit_cast<std::uint32_t>(image::float_from_half(half));
    }));
  }
}

TEST_CASE("b10g11r11 takes the nearest value in each channel", "[codec][texels]") {
  const std::vector<double> eleven = all_small_floats(6);
  const std::vector<double> ten = all_small_floats(5);
  REQUIRE(eleven.back() == static_cast<double>(image::kLargestFloat11));
  REQUIRE(ten.back() == static_cast<double>(image::kLargestFloat10));
  for (const float value : values_up_to(image::kLargestFloat10, 2)) {
    const std::uint32_t texel = image::pack_b10g11r11({value, 0.0F, value});
    const auto wide = static_cast<double>(value);
    if (texel != (nearest(eleven, wide) | nearest(ten, wide) << 22U)) FAIL(value << " becomes " << texel);
    if (image::pack_b10g11r11({0.0F, value, 0.0F}) != nearest(eleven, wide) << 11U) FAIL(value << " in green");
  }
  for (std::uint32_t bits = 0; bits < eleven.size(); ++bits) {
    const std::array<float, 3> rgb = image::unpack_b10g11r11(bits | bits << 11U);
    if (static_cast<double>(rgb[0]) != eleven[bits] || static_cast<double>(rgb[1]) != eleven[bits]) FAIL(bits);
  }
  for (std::uint32_t bits = 0; bits < ten.size(); ++bits) {
    if (static_cast<double>(image::unpack_b10g11r11(bits << 22U)[2]) != ten[bits]) FAIL(bits);
  }
}

TEST_CASE("e5b9g9r9 has the least exponent that holds the largest channel, and rounds to its steps",
          "[codec][texels]") {
  const std::vector<float> values = values_up_to(image::kLargestSharedFloat, 3);
  for (std::size_t i = 0; i + 2 < values.size(); ++i) {
    const std::array<float, 3> rgb{values[i], values[i + 1], values[i + 2]};
    const std::uint32_t texel = image::pack_e5b9g9r9(rgb);
    const auto largest = static_cast<double>(std::max({rgb[0], rgb[1], rgb[2]}));
    const int exponent = static_cast<int>(texel >> 27U);
    const double step = std::ldexp(1.0, exponent - 24);
    const std::array<float, 3> back = image::unpack_e5b9g9r9(texel);
    bool right = largest < 511.5 * step && (exponent == 0 || largest >= 511.5 * step / 2);
    for (std::size_t c = 0; c < 3; ++c) {
      right = right && static_cast<double>(back[c]) == std::floor(static_cast<double>(rgb[c]) / step + 0.5) * step;
    }
    if (!right) FAIL(rgb[0] << ' ' << rgb[1] << ' ' << rgb[2] << " become " << texel);
  }
  CHECK(image::pack_e5b9g9r9({1.0F, 0.0F, 0.0F}) == (16U << 27U | 256U));
  CHECK(image::pack_e5b9g9r9({0.0F, 0.0F, image::kLargestSharedFloat}) == (31U << 27U | 511U << 18U));
}

}  // namespace welkin::test
