// Sources far finer than their bands, brought to fewer rows and columns before the transform.
#include "transform/row_reduction.h"

#include "image/sphere_grid.h"
#include "jobs/tiles.h"
#include "support/bit_hash.h"
#include "support/catch.h"
#include "support/heap.h"
#include "support/test_environments.h"
#include "support/trials.h"
#include "transform/dark_scale.h"
#include "transform/spectrum.h"
#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::test {

using transforms::SourceRows, transforms::Spectrum, transforms::ReducedShape;

namespace {

struct Shape {
  int width;
  int height;
  int bands;
};

/// Halvings of columns: 1, 2, none (the width does not divide by four), 3 and none.
constexpr Shape kShapes[] = {{768, 384, 64}, {1536, 771, 48}, {1030, 513, 64}, {2048, 200, 60}, {130, 195, 33}};

/// Returns the root mean square over all coefficients but the mean's, which would hide the rest.
double rms_of(const Spectrum& spectrum) {
  double squares = 0.0;
  for (int m = 0; m < spectrum.bands(); ++m) {
    for (int l = std::max(1, m); l < spectrum.bands(); ++l) {
      for (int c = 0; c < 3; ++c) squares += (m > 0 ? 2.0 : 1.0) * std::norm(spectrum.value(l, m, c));
    }
  }
  return std::sqrt(squares / (3.0 * (spectrum.bands() * spectrum.bands() - 1.0)));
}

/// Returns, by degree, the root mean square over the orders of the difference of `a` and `b`.
std::vector<double> errors_of(const Spectrum& a, const Spectrum& b) {
  std::vector<double> errors;
  for (int l = 0; l < a.bands(); ++l) {
    double squares = 0.0;
    for (int m = 0; m <= l; ++m) {
      for (int c = 0; c < 3; ++c) squares += (m > 0 ? 2.0 : 1.0) * std::norm(a.value(l, m, c) - b.value(l, m, c));
    }
    errors.push_back(std::sqrt(squares / (3.0 * (2 * l + 1))));
  }
  return errors;
}

/// Returns the error bound that row_reduction.h states for degree l, with its next orders and float rounding.
double bound_at(int l, const Shape& shape, double rounding) {
  const ReducedShape reduced = transforms::reduced_shape(shape.width, shape.height, shape.bands);
  const double degree = (l + 2) * std::numbers::pi / reduced.rows;
  const double rows = 0.005 * std::pow(degree, 5.0) * std::max(1.0, degree);
  const double columns =
      reduced.halvings > 0 ? std::pow(std::tan(0.5 * std::numbers::pi * l / reduced.columns), 5.0) : 0.0;
  return 1.1 * (rows + columns) + rounding;
}

/// Checks errors relative to `scale`.
void check_errors(const LatLongImage& image, const Shape& shape, double scale, double rounding) {
  const std::vector<double> errors = errors_of(transforms::analyse(image.view(), shape.bands, {}),
                                               transforms::analyse(image.view(), shape.bands, {}, SourceRows::fewer));
  int above = 0;
  for (int l = 1; l < shape.bands; ++l) {
    const double error = errors[static_cast<std::size_t>(l)] / scale;
    CAPTURE(l, error, bound_at(l, shape, rounding));
    const bool within = error < bound_at(l, shape, rounding);
    if (!within && above++ < 3) CHECK(within);
  }
  CHECK(above == 0);
}

}  // namespace

TEST_CASE("Reduced rows take no more memory than was said, and not much less", "[transform]") {
  if (kSanitized) return;
  for (const auto& [width, height, bands] : {std::array{2048, 1024, 96}, {1024, 512, 33}, {514, 300, 8}}) {
    const TestLatLong source = make_lat_long(Content::random, width, height, 3);
    const transforms::ReducedShape shape = transforms::reduced_shape(width, height, bands);
    REQUIRE(shape.rows > 0);
    std::uint64_t peak = 0;
    {
      const HeapWatch heap;
      transforms::ReducedRows rows(transforms::ImageRows(source.view()), shape);
      rows.fill({});
      peak = static_cast<std::uint64_t>(heap.peak_bytes());
    }
    const std::size_t workers = jobs::worker_count(jobs::Placement::arena);
    const std::uint64_t said = transforms::ReducedRows::most_bytes(width, height, bands, workers);
    CAPTURE(width, peak, said);
    CHECK(peak <= said + 16384);  // tables of the pool
    if (kSeesMalloc) CHECK(said <= peak + peak / 4 + 16384);
  }
  CHECK(transforms::ReducedRows::most_bytes(256, 128, 96, 4) == 0);
  CHECK(transforms::ReducedRows::most_bytes(8192, 4096, 1000, 2) > std::size_t{20} << 20U);
}

TEST_CASE("Few rows have the harmonics of all rows", "[transform][reduction]") {
  for (const Shape& shape : kShapes) {
    CAPTURE(shape.width, shape.height, shape.bands);
    REQUIRE(transforms::reduced_shape(shape.width, shape.height, shape.bands).rows > 0);
    const TestLatLong noise = make_lat_long(Content::random, shape.width, shape.height, 91);
    const LatLongImage image{shape.width, shape.height, noise.pixels};
    check_errors(image, shape, rms_of(transforms::analyse(image.view(), shape.bands, {})), 3e-5);
  }
}

TEST_CASE("Only sources finer than their bands are brought to fewer rows", "[transform][reduction]") {
  CHECK(transforms::reduced_shape(1024, 512, 415) == ReducedShape{});
  CHECK(transforms::reduced_shape(8192, 4096, 415) == ReducedShape{832, 2048, 2});
  CHECK(transforms::reduced_shape(8191, 4096, 415) == ReducedShape{});  // 180 degrees are no whole number of columns
  CHECK(transforms::reduced_shape(8190, 4096, 415) == ReducedShape{832, 8190, 0});
  CHECK(transforms::reduced_shape(2, 4096, 1) == ReducedShape{32, 2, 0});
  const TestLatLong noise = make_lat_long(Content::random, 257, 128, 3);
  const Spectrum all = transforms::analyse(noise.view(), 20, {});
  const Spectrum same = transforms::analyse(noise.view(), 20, {}, SourceRows::fewer);
  const std::vector<double> errors = errors_of(all, same);
  CHECK(*std::ranges::max_element(errors) == 0.0);
}

namespace {

std::vector<float> noise_of(std::size_t count, std::uint32_t state) {
  std::vector<float> values;
  for (std::size_t k = 0; k < count; ++k) {
    state = state * 1664525U + 1013904223U;
    values.push_back(static_cast<float>(state >> 8U) * 0x1p-23F - 1.0F);
  }
  return values;
}

}  // namespace

TEST_CASE("Steps are shared as the definition says", "[transform][reduction][kernels]") {
  constexpr int kShares = transforms::kStepShares;
  for (const InstructionSet set : available_instruction_sets()) {
    for (const int floats : {1, 2, 3, 7, 16, 64, 257}) {
      for (const int edges : {1, 2, 5}) {
        CAPTURE(name(set), floats, edges);
        const auto width = static_cast<std::size_t>(floats);
        const std::size_t stride = width + 3;
        const std::vector<float> rows = noise_of(stride * static_cast<std::size_t>(edges + 1), 5);
        const std::vector<float> shares = noise_of(static_cast<std::size_t>(kShares * edges), 6);
        std::vector<float> sums = noise_of(kShares * width, 7);
        std::vector<double> truth(sums.begin(), sums.end());
        std::array<float*, kShares> totals{};
        for (std::size_t k = 0; k < kShares; ++k) {
          totals[k] = sums.data() + k * width;
          for (std::size_t i = 0; i < width; ++i) {
            for (std::size_t edge = 0; edge < static_cast<std::size_t>(edges); ++edge) {
              const double step = static_cast<double>(rows[(edge + 1) * stride + 3 + i]) - rows[edge * stride + 3 + i];
              truth[k * width + i] += step * shares[edge * kShares + k];
            }
          }
        }
        std::vector<const float*> pointers;
        for (int row = 0; row <= edges; ++row) pointers.push_back(rows.data() + static_cast<std::size_t>(row) * stride);
        transforms::fourier_kernels(set).share_steps({pointers.data(), 3, shares.data(), edges, floats}, totals.data());
        double error = 0.0;
        for (std::size_t i = 0; i < truth.size(); ++i) error = std::max(error, std::abs(truth[i] - sums[i]));
        CHECK(error < 2e-6);
      }
    }
  }
}

TEST_CASE("Columns are halved as the definition says", "[transform][reduction][kernels]") {
  constexpr double kTaps[] = {1.0, 5.0, 10.0, 10.0, 5.0, 1.0};
  for (const InstructionSet set : available_instruction_sets()) {
    for (const int count : {1, 2, 3, 7, 32, 64, 257}) {
      CAPTURE(name(set), count);
      std::vector<float> values = noise_of(static_cast<std::size_t>(3 * (2 * count + 4)), 8);
      std::vector<double> truth;
      for (int i = 0; i < count; ++i) {
        for (int c = 0; c < 3; ++c) {
          double sum = 0.0;
          for (int k = 0; k < 6; ++k) sum += kTaps[k] / 16.0 * values[static_cast<std::size_t>(3 * (2 * i + k) + c)];
          truth.push_back(sum);
        }
      }
      transforms::fourier_kernels(set).halve_columns(values.data(), count, values.data());  // in place
      double error = 0.0;
      for (std::size_t i = 0; i < truth.size(); ++i) error = std::max(error, std::abs(truth[i] - values[i]));
      CHECK(error < 1e-6);
    }
  }
}

// Promise: a dark image's results are a bright one's, scaled exactly by a power of two. Flushed denormals do not show.

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

TEST_CASE("A dark image's spectrum is a bright one's, smaller", "[transform][same_bits]") {
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

TEST_CASE("The darkest images give the bits on record", "[transform][same_bits]") {
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
