// Promise: a cubemap goes into the caller's memory in the requested format, pitch and order, with the same texels as in
// a file; nothing is written outside them.
#include <Imath/half.h>

#include "image/image_kernels.h"
#include "image/pixels.h"
#include "support/catch.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::test {
namespace {

constexpr TexelFormat kFormats[] = {TexelFormat::rgba16f, TexelFormat::rgba32f, TexelFormat::b10g11r11,
                                    TexelFormat::e5b9g9r9};
constexpr std::byte kUntouched{0xA5};

std::size_t texel_bytes(TexelFormat format) {
  return format == TexelFormat::rgba32f ? 16 : format == TexelFormat::rgba16f ? 8 : 4;
}

Cubemap random_chain(int size, int levels) {
  Cubemap chain(size, levels);
  for (int level = 0; level < levels; ++level) {
    const TestCubemap pixels = make_cubemap(Content::high_range, chain.level_size(level), 3, 7U);
    std::memcpy(chain.face(level, 0), pixels.pixels.data(), pixels.pixels.size() * sizeof(float));
  }
  return chain;
}

/// Returns one row in the format, by the encoder whose every value tests/files/textures_test.cpp checks.
std::vector<std::uint8_t> encoded_row(const Cubemap& chain, int level, int face, int row, TexelFormat format) {
  const auto edge = static_cast<std::size_t>(chain.level_size(level));
  std::vector<std::uint8_t> texels(edge * texel_bytes(format));
  image::encode_texels(format, chain.face(level, face) + 3 * edge * static_cast<std::size_t>(row), edge, texels.data());
  return texels;
}

}  // namespace

TEST_CASE("upload: every texel is where the layout says, and nothing else is touched") {
  for (const int size : {1, 2, 3, 7, 64, 257}) {
    const Cubemap chain = random_chain(size, full_chain_levels(size));
    for (const TexelFormat format : kFormats) {
      for (const UploadOrder order : {UploadOrder::level_by_level, UploadOrder::face_by_face}) {
        for (const std::uint64_t alignment : {1U, 256U}) {
          INFO(size << ' ' << static_cast<int>(format) << ' ' << static_cast<int>(order) << ' ' << alignment);
          const UploadLayout layout{format, size, chain.levels(), order, alignment, 2 * alignment};
          std::vector<std::byte> memory(upload_bytes(layout) + 64, kUntouched);
          const std::vector<CubemapTarget> targets = upload_targets(layout, memory);
          REQUIRE(store_texels(chain, targets) == 0);
          std::vector<bool> written(memory.size(), false);
          bool right = true;
          for (int level = 0; level < chain.levels(); ++level) {
            const CubemapTarget& target = targets[static_cast<std::size_t>(level)];
            CHECK(target.row_stride_bytes % static_cast<std::ptrdiff_t>(alignment) == 0);
            for (int face = 0; face < 6; ++face) {
              const auto* const first = static_cast<const std::byte*>(target.faces[static_cast<std::size_t>(face)]);
              CHECK((first - memory.data()) % static_cast<std::ptrdiff_t>(2 * alignment) == 0);
              for (int row = 0; row < target.size; ++row) {
                const std::vector<std::uint8_t> expected = encoded_row(chain, level, face, row, format);
                const std::byte* const texels = first + row * target.row_stride_bytes;
                right = right && std::memcmp(texels, expected.data(), expected.size()) == 0;
                const auto begin = written.begin() + (texels - memory.data());
                right = right && std::find(begin, begin + static_cast<std::ptrdiff_t>(expected.size()), true) ==
                                     begin + static_cast<std::ptrdiff_t>(expected.size());
                std::fill_n(begin, expected.size(), true);
              }
            }
          }
          CHECK(right);
          for (std::size_t k = 0; k < memory.size(); ++k) right = right && (written[k] || memory[k] == kUntouched);
          CHECK(right);
        }
      }
    }
  }
}

TEST_CASE("upload: bottom-up rows, pixels of every kind, and the same bytes on any number of threads") {
  for (const PixelFormat format : {PixelFormat::rgb32f, PixelFormat::rgba32f, PixelFormat::rgb16f, PixelFormat::rgba16f,
                                   PixelFormat::rgb8, PixelFormat::srgba8}) {
    constexpr int size = 200;
    std::vector<std::byte> pixels(6 * size * size * bytes_per_texel(format), std::byte{0x2C});
    CubemapView view{{}, size, 0, format};
    for (std::size_t face = 0; face < 6; ++face)
      view.faces[face] = pixels.data() + face * size * size * bytes_per_texel(format);
    std::vector<std::vector<std::byte>> results;
    for (const int threads : {1, 2, 5}) {
      std::vector<std::byte> memory(6 * size * size * 8);
      CubemapTarget target{{}, size, -size * 8, TexelFormat::rgba16f};
      for (std::size_t face = 0; face < 6; ++face)
        target.faces[face] = memory.data() + (face * size + size - 1) * size * 8;
      run_with_threads(threads, [&] { store_texels(view, target); });
      results.push_back(std::move(memory));
    }
    CHECK(results[0] == results[1]);
    CHECK(results[0] == results[2]);
    float first[3] = {};
    image::decode_texels(format, pixels.data(), 1, first);
    std::uint16_t red = 0;
    std::memcpy(&red, results[0].data(), sizeof red);
    CHECK(red == image::half_from_float(first[0]));
  }
}

TEST_CASE("upload: what a format cannot hold is clamped and counted") {
  Cubemap chain(1, 1);
  std::fill_n(chain.face(0, 0), 18, 1.0F);
  chain.face(0, 0)[0] = 1e6F;
  chain.face(0, 1)[1] = -2.0F;
  chain.face(0, 2)[2] = std::numeric_limits<float>::quiet_NaN();
  const std::uint64_t expected[] = {2, 0, 3, 3};  // halves hold -2, floats everything
  for (std::size_t k = 0; k < 4; ++k) {
    const UploadLayout layout{kFormats[k], 1, 1};
    std::vector<std::byte> memory(upload_bytes(layout));
    CHECK(store_texels(chain, upload_targets(layout, memory)) == expected[k]);
  }
}

TEST_CASE("upload: what does not fit is refused before anything is written") {
  const Cubemap chain = random_chain(8, 2);
  const UploadLayout layout{TexelFormat::rgba16f, 8, 2};
  std::vector<std::byte> memory(upload_bytes(layout), kUntouched);
  const auto refused = [&](const auto& change) {
    std::vector<CubemapTarget> targets = upload_targets(layout, memory);
    change(targets);
    const ThrownError error = thrown_by([&] { store_texels(chain, targets); });
    CHECK(error.code == ErrorCode::invalid_argument);
    CHECK(std::all_of(memory.begin(), memory.end(), [](std::byte byte) { return byte == kUntouched; }));
  };
  refused([](auto& targets) { targets[1].faces[3] = nullptr; });
  refused([](auto& targets) { targets[1].size = 3; });
  refused([](auto& targets) { targets[1].row_stride_bytes = 31; });
  refused([](auto& targets) { targets[1].row_stride_bytes = -31; });
  refused([](auto& targets) { targets[1].format = static_cast<TexelFormat>(9); });
  refused([](auto& targets) { targets.pop_back(); });
  CHECK(thrown_by([&] {
          static_cast<void>(upload_targets(layout, std::span(memory).first(memory.size() - 1)));
        }).says("bytes"));
  for (const UploadLayout& wrong : {UploadLayout{TexelFormat::rgba16f, 0, 1}, UploadLayout{TexelFormat::rgba16f, 8, 5},
                                    UploadLayout{TexelFormat::rgba16f, 8, 0},
                                    UploadLayout{TexelFormat::rgba16f, 8, 1, UploadOrder::level_by_level, 0}}) {
    CHECK(thrown_by([&] { static_cast<void>(upload_bytes(wrong)); }).code == ErrorCode::invalid_argument);
  }
  Control control;
  stop_source stop;
  stop.request_stop();
  control.stop = stop.get_token();
  CHECK(thrown_by([&] { store_texels(chain, upload_targets(layout, memory), control); }).code == ErrorCode::cancelled);
}

// Promises: halves, b10g11r11 and e5b9g9r9 take the value that is nearest, among all that there are; each of these goes
// to itself.

namespace {

/// Returns values over the whole range, denormals and midpoints between two values among them.
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

/// Every half, infinities and NaNs too; the floats midway between two of them, and next to those; random bits.
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
  values.insert(values.end(), {65519.0F, 65520.0F, 1e30F, -1e30F, 1e-30F});
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
