// Promise: a dark picture has the bits of a bright one, smaller by a power of two. Flushed denormals do not show.
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "image/sphere_grid.h"
#include "support/bit_hash.h"
#include "support/catch.h"
#include "support/test_environments.h"
#include "transform/dark_scale.h"
#include "transform/spectrum.h"
#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::test {
namespace {

using image::GridContent;
using image::SphereGrid;
using transforms::Spectrum;

constexpr int kBands = 70;

/// Noise in steps of 1/256, so that it stays exact far below 1; every tenth texel is black.
std::vector<float> noise(int width, int height) {
  std::vector<float> pixels = make_lat_long(Content::random, width, height, 17).pixels;
  for (std::size_t k = 0; k < pixels.size(); ++k) {
    pixels[k] = k / 3 % 10 == 7 ? 0.0F : std::floor(std::abs(pixels[k]) * 256.0F) / 256.0F;
  }
  return pixels;
}

std::vector<float> times(std::vector<float> rgb, double red, double green, double blue) {
  for (std::size_t k = 0; k < rgb.size(); ++k) {
    const double factor = k % 3 == 0 ? red : k % 3 == 1 ? green : blue;
    rgb[k] = static_cast<float>(static_cast<double>(rgb[k]) * factor);
  }
  return rgb;
}

/// Red, green, blue by turns: the real parts of a coefficient, then the imaginary ones.
std::vector<float> numbers_of(const Spectrum& spectrum) {
  std::vector<float> numbers;
  for (int m = 0; m < spectrum.bands(); ++m) {
    for (int i = 0; i < spectrum.bands() - m; ++i) {
      const float* const at = spectrum.order(m) + std::ptrdiff_t{8} * i;
      numbers.insert(numbers.end(), {at[0], at[2], at[4], at[1], at[3], at[5]});
    }
  }
  return numbers;
}

std::vector<float> numbers_of(const SphereGrid& grid) {
  std::vector<float> numbers;
  constexpr int border = SphereGrid::kBorder;
  for (int ring = -border; ring < grid.rings() + border; ++ring) {
    for (int column = -border; column < grid.columns() + border; ++column) {
      const float* const texel = grid.texel(column, ring);
      numbers.insert(numbers.end(), texel, texel + 3);
    }
  }
  return numbers;
}

SphereGrid synthesised(const Spectrum& spectrum, GridContent content) {
  std::vector<double> zonal{1.0};
  while (zonal.size() < kBands) zonal.push_back(zonal.back() * 0.93);
  SphereGrid grid(kBands + 2, 2 * kBands + 6, content);
  transforms::synthesise(spectrum, zonal, grid, {});
  return grid;
}

}  // namespace

TEST_CASE("A dark picture's spectrum is a bright one's, smaller", "[transform][same_bits]") {
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{7, 3}, std::pair{64, 33}, std::pair{150, 257}}) {
    const std::vector<float> bright = noise(width, height);
    const std::vector<float> expected = numbers_of(transforms::analyse({bright.data(), width, height}, kBands, {}));
    for (const double factor : {0x1p-50, 0x1p-70, 0x1p-100, 0x1p-126}) {
      CAPTURE(width, height, factor);
      const std::vector<float> dark = times(bright, factor, factor * 0x1p-3, 1.0);
      const Spectrum spectrum = transforms::analyse({dark.data(), width, height}, kBands, {});
      CHECK(numbers_of(spectrum) == times(expected, factor, factor * 0x1p-3, 1.0));
    }
  }
}

TEST_CASE("What is made of a dark spectrum is what is made of a bright one, smaller", "[transform][same_bits]") {
  const std::vector<float> pixels = noise(150, 75);
  const Spectrum bright = transforms::analyse({pixels.data(), 150, 75}, kBands, {});
  const std::vector<float> dark_pixels = times(pixels, 0x1p-75, 1.0, 0x1p-65);
  const Spectrum dark = transforms::analyse({dark_pixels.data(), 150, 75}, kBands, {});
  for (const GridContent content : {GridContent::samples, GridContent::spline_coefficients}) {
    const std::vector<float> expected = numbers_of(synthesised(bright, content));
    CHECK(numbers_of(synthesised(dark, content)) == times(expected, 0x1p-75, 1.0, 0x1p-65));
  }
}

TEST_CASE("The darkest pictures give the bits on record", "[transform][same_bits]") {
  const std::vector<float> pixels = times(noise(90, 45), 0x1p-126, 0x1p-140, 0x1p-90);
  const InstructionSet before = active_instruction_set();
  for (const InstructionSet set : available_instruction_sets()) {
    CAPTURE(name(set));
    force_instruction_set(set);
    const Spectrum spectrum = transforms::analyse({pixels.data(), 90, 45}, kBands, {});
    BitHash hash;
    for (const float number : numbers_of(spectrum)) add_bits(hash, number);
    for (const float number : numbers_of(synthesised(spectrum, GridContent::samples))) add_bits(hash, number);
    CHECK(hash.value() == 0x9d3fc22965e893e2U);
  }
  force_instruction_set(before);
}

}  // namespace welkin::test
