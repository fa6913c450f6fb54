// Kernels on 16 lanes: which instruction set is chosen, and that each kernel gives what its double-precision twin
// gives.
#include "image/image_kernels.h"
#include "image/pixels.h"
#include "math/basis.h"
#include "math/quadrature.h"
#include "platform/memory.h"
#include "projection/projection_kernels.h"
#include "simd/dispatch.h"
#include "support/catch.h"
#include "welkin/core.h"

namespace welkin::test {

TEST_CASE("Available instruction sets start with the baseline and are ordered", "[simd]") {
  const auto sets = available_instruction_sets();
#if defined(__aarch64__)
  REQUIRE(sets == std::vector{InstructionSet::neon});
#else
  REQUIRE(sets.front() == InstructionSet::sse2);
  CHECK(sets.back() != InstructionSet::neon);
#endif
  CHECK(std::is_sorted(sets.begin(), sets.end()));
}

TEST_CASE("A forced instruction set is the one that runs", "[simd]") {
  const InstructionSet before = active_instruction_set();
  for (const InstructionSet set : available_instruction_sets()) {
    force_instruction_set(set);
    CHECK(active_instruction_set() == set);
    CHECK(&projection::projection_kernels() == &projection::projection_kernels(set));
  }
  force_instruction_set(before);
  // Three tables of different functions, not three names for one.
  for (const InstructionSet a : available_instruction_sets()) {
    for (const InstructionSet b : available_instruction_sets()) {
      if (a != b)
        CHECK(projection::projection_kernels(a).weighted_sums != projection::projection_kernels(b).weighted_sums);
    }
  }
}

TEST_CASE("Instruction sets have the names that WELKIN_ISA takes", "[simd]") {
  CHECK(std::string(name(InstructionSet::sse2)) == "sse2");
  CHECK(std::string(name(InstructionSet::avx2)) == "avx2");
  CHECK(std::string(name(InstructionSet::avx512)) == "avx512");
  CHECK(std::string(name(InstructionSet::neon)) == "neon");
}

// Each kernel of each instruction set against a plain loop in double, and all sets against each other.

namespace {

using projection::kChunk;
using simd::kLanes;

std::vector<float> noise(std::size_t count, std::uint32_t seed) {
  std::mt19937 generator(seed);
  std::vector<float> values(count);
  for (float& value : values) value = static_cast<float>(generator() % 4096U) / 1024.0F - 1.0F;
  return values;
}

/// All 16-bit patterns that are numbers, in a scrambled order.
std::vector<std::uint16_t> half_noise(std::size_t count, std::uint32_t seed) {
  std::mt19937 generator(seed);
  std::vector<std::uint16_t> values(count);
  for (std::uint16_t& value : values) {
    do value = static_cast<std::uint16_t>(generator());
    while ((value & 0x7C00U) == 0x7C00U);
  }
  return values;
}

float as_float(float value) { return value; }
float as_float(std::uint16_t value) { return image::float_from_half(value); }
float as_float(std::uint8_t value) { return static_cast<float>(value / 255.0); }
float as_float(projection::SrgbByte byte) { return static_cast<float>(image::linear_from_srgb(byte.value / 255.0)); }

template <class Byte>
std::vector<Byte> bytes(std::size_t count, std::uint32_t seed) {
  std::mt19937 generator(seed);
  std::vector<Byte> values(count);
  for (Byte& value : values) value = Byte{static_cast<std::uint8_t>(generator())};
  return values;
}

/// Four classes of one position, as projection::FoldQuadrants defines them; every sum rounds once or twice.
void require_classes(const float* plane, float tl, float tr, float bl, float br) {
  REQUIRE(plane[0] == (tl + tr) + (bl + br));
  REQUIRE(plane[kChunk] == (tr - tl) + (br - bl));
  REQUIRE(plane[2 * kChunk] == (bl + br) - (tl + tr));
  REQUIRE(plane[3 * kChunk] == (br - bl) - (tr - tl));
}

template <class Channel>
void require_quadrants_folded(projection::FoldQuadrants fold, const std::vector<Channel>& texels, int channels,
                              int groups, int rows) {
  // Rows of 4 runs; the bottom runs go upwards from the last row.
  const int count = groups * kLanes;
  const int row_channels = 4 * count * channels;
  const auto stride = static_cast<std::ptrdiff_t>(static_cast<std::size_t>(row_channels) * sizeof(Channel));
  const Channel* const top = texels.data();
  const Channel* const bottom = texels.data() + static_cast<std::ptrdiff_t>(2 * rows - 1) * row_channels;
  const int right = count * channels;
  const projection::QuadrantRuns runs{top, top + right, bottom, bottom + right, stride, -stride, rows};
  platform::AlignedBuffer<float> planes(3 * 4 * kChunk);
  const char* const anywhere = reinterpret_cast<const char*>(texels.data());
  fold(runs, {{anywhere, nullptr, anywhere, anywhere}, 100}, groups, planes.data());
  for (int row = 0; row < rows; ++row) {
    for (int k = 0; k < count; ++k) {
      for (int c = 0; c < 3; ++c) {
        const auto at = [&](const Channel* first, int texel) { return as_float(first[texel * channels + c]); };
        const Channel* const top_row = top + static_cast<std::ptrdiff_t>(row) * row_channels;
        const Channel* const bottom_row = bottom - static_cast<std::ptrdiff_t>(row) * row_channels;
        require_classes(planes.data() + c * 4 * kChunk + row * count + k, at(top_row, k),
                        at(top_row + right, count - 1 - k), at(bottom_row, k), at(bottom_row + right, count - 1 - k));
      }
    }
  }
}

template <class Channel>
void require_halves_folded(projection::FoldHalves fold, const std::vector<Channel>& texels, int channels, int groups) {
  const int count = groups * kLanes;
  const Channel* const first = texels.data();
  const Channel* const second = texels.data() + static_cast<std::ptrdiff_t>(count) * channels + channels;
  platform::AlignedBuffer<float> planes(3 * 2 * kChunk);
  fold(first, second, {}, groups, planes.data());
  for (int k = 0; k < count; ++k) {
    for (int c = 0; c < 3; ++c) {
      const float a = as_float(first[k * channels + c]);
      const float b = as_float(second[k * channels + c]);
      REQUIRE(planes.data()[c * 2 * kChunk + k] == a + b);
      REQUIRE(planes.data()[(c * 2 + 1) * kChunk + k] == a - b);
    }
  }
}

/// By both kernels of a format; `texels(count, seed)` draws channels.
template <class Texels>
void require_folded(const projection::ProjectionKernels& kernels, projection::FoldFormat format, int channels,
                    const Texels& texels) {
  for (const int groups : {1, 2, 3, 16}) {
    for (const int rows : {1, 2, 5}) {
      if (groups * rows > kChunk / kLanes) continue;
      const auto count = static_cast<std::size_t>(2 * rows * 4 * groups * kLanes * 4);
      require_quadrants_folded(kernels.fold_quadrants[format], texels(count, 1), channels, groups, rows);
    }
    const auto count = static_cast<std::size_t>((2 * groups * kLanes + 1) * 4);
    require_halves_folded(kernels.fold_halves[format], texels(count, 2), channels, groups);
  }
}

}  // namespace

TEST_CASE("Folding kernels read every texel of every format", "[simd]") {
  for (const InstructionSet set : available_instruction_sets()) {
    CAPTURE(name(set));
    const projection::ProjectionKernels& kernels = projection::projection_kernels(set);
    require_folded(kernels, projection::fold_rgb32f, 3, noise);
    require_folded(kernels, projection::fold_rgba32f, 4, noise);
    require_folded(kernels, projection::fold_rgb16f, 3, half_noise);
    require_folded(kernels, projection::fold_rgba16f, 4, half_noise);
    require_folded(kernels, projection::fold_rgb8, 3, bytes<std::uint8_t>);
    require_folded(kernels, projection::fold_rgba8, 4, bytes<std::uint8_t>);
    require_folded(kernels, projection::fold_srgb8, 3, bytes<projection::SrgbByte>);
    require_folded(kernels, projection::fold_srgba8, 4, bytes<projection::SrgbByte>);
  }
}

TEST_CASE("Weighted sums match double precision and each other", "[simd]") {
  const projection::ClassCounts shapes[] = {{{1, 0, 0, 0}}, {{2, 1, 1, 0}},     {{4, 2, 2, 1}}, {{6, 4, 4, 2}},
                                            {{3, 2, 0, 0}}, {{30, 25, 25, 20}}, {{1, 2, 0, 0}}, {{9, 0, 0, 0}}};
  for (const projection::ClassCounts& counts : shapes) {
    const int total = counts.count[0] + counts.count[1] + counts.count[2] + counts.count[3];
    platform::AlignedBuffer<float> planes(3 * 4 * kChunk);
    platform::AlignedBuffer<float> weights(static_cast<std::size_t>(total * kChunk));
    const std::vector<float> pixel_noise = noise(planes.size(), 7);
    const std::vector<float> weight_noise = noise(weights.size(), 8);
    std::copy(pixel_noise.begin(), pixel_noise.end(), planes.data());
    std::copy(weight_noise.begin(), weight_noise.end(), weights.data());
    for (const int groups : {1, 7, 16}) {
      std::vector<double> expected(static_cast<std::size_t>(3 * total));
      for (int channel = 0; channel < 3; ++channel) {
        int w = 0;
        for (int symmetry = 0; symmetry < 4; ++symmetry) {
          for (int i = 0; i < counts.count[symmetry]; ++i, ++w) {
            for (int k = 0; k < groups * kLanes; ++k) {
              expected[static_cast<std::size_t>(channel * total + w)] +=
                  static_cast<double>(planes.data()[(channel * 4 + symmetry) * kChunk + k]) *
                  static_cast<double>(weights.data()[w * kChunk + k]);
            }
          }
        }
      }
      std::vector<double> first_set;
      for (const InstructionSet set : available_instruction_sets()) {
        CAPTURE(name(set), total, groups);
        platform::AlignedBuffer<double> sums(static_cast<std::size_t>(3 * total * projection::kSumLanes));
        std::fill_n(sums.data(), sums.size(), 0.0);
        // The addresses to prefetch must not affect the result.
        const char* const anywhere = reinterpret_cast<const char*>(planes.data());
        const projection::FetchAhead ahead{{anywhere, anywhere, nullptr, anywhere}, groups * 4};
        projection::projection_kernels(set).weighted_sums(planes.data(), 4, weights.data(), counts, groups, ahead,
                                                          sums.data());
        std::vector<double> folded(static_cast<std::size_t>(3 * total));
        projection::projection_kernels(set).fold_sum_lanes(sums.data(), 3 * total, folded.data());
        for (std::size_t w = 0; w < folded.size(); ++w) {
          // 256 products of up to 9, each rounded to 6e-8 of a partial sum of up to 144.
          REQUIRE(std::abs(folded[w] - expected[w]) < 1e-4);
        }
        if (first_set.empty()) first_set = folded;
        REQUIRE(std::memcmp(folded.data(), first_set.data(), folded.size() * sizeof(double)) == 0);
      }
    }
  }
}

namespace {

/// Int Y over a texel of the quadrant with u, v >= 0, by a rule of 24 points a side in plain double.
double texel_integral(const image::TexelRun& run, int column, int index) {
  const math::GaussRule rule = math::gauss_legendre(24);
  const double h = 1.0 / run.size;
  const double u0 = (run.size - 1 - 2 * column) * h;
  const double v0 = (run.size - 1 - 2 * run.row) * h;
  std::vector<double> basis(static_cast<std::size_t>(run.bands * run.bands));
  double sum = 0.0;
  double solid_angle = 0.0;
  for (int j = 0; j < rule.order; ++j) {
    for (int i = 0; i < rule.order; ++i) {
      const double u = u0 + h * rule.nodes[i];
      const double v = v0 + h * rule.nodes[j];
      const double r = std::sqrt(1.0 + u * u + v * v);
      const double area = h * h * rule.weights[i] * rule.weights[j] / (r * r * r);
      math::evaluate_basis(u / r, v / r, 1.0 / r, run.bands, basis.data());
      sum += area * basis[static_cast<std::size_t>(index)];
      solid_angle += area;
    }
  }
  if (!run.midpoint) return sum;
  const double r = std::sqrt(1.0 + u0 * u0 + v0 * v0);
  math::evaluate_basis(u0 / r, v0 / r, 1.0 / r, run.bands, basis.data());
  return solid_angle * basis[static_cast<std::size_t>(index)];
}

void require_weights(const image::TexelRun& run, const std::vector<float>& weights, double tolerance) {
  for (int index = 0; index < run.bands * run.bands; ++index) {
    for (int k = 0; k < run.count; ++k) {
      const double expected = texel_integral(run, run.first_column + k, index);
      // Relative to the maximum of this band's harmonics there, so that zero crossings neither excuse an error
      // nor demand more than a float's precision.
      const double scale = texel_integral({run.size, run.row, 0, 1, 1, false}, run.first_column + k, 0) *
                           std::sqrt(2.0 * std::floor(std::sqrt(static_cast<double>(index))) + 1.0);
      CAPTURE(run.size, run.row, run.first_column + k, index, expected);
      REQUIRE(std::abs(static_cast<double>(weights[static_cast<std::size_t>(index * kChunk + k)]) - expected) <=
              tolerance * scale);
    }
    for (int k = run.count; k % kLanes != 0; ++k) {
      REQUIRE(weights[static_cast<std::size_t>(index * kChunk + k)] == 0.0F);
    }
  }
}

struct Run {
  int size, row, column, count;
};

/// `make(kernels, run, slot, weights)` writes the weights of all functions: right on one instruction set, and with the
/// same bits on all others.
template <class Make>
void require_texel_kernel(std::initializer_list<int> numbers_of_bands, const std::vector<Run>& runs, double tolerance,
                          const Make& make) {
  for (const bool midpoint : {false, true}) {
    for (const int bands : numbers_of_bands) {
      std::vector<int> slot(static_cast<std::size_t>(bands * bands));
      std::iota(slot.begin(), slot.end(), 0);
      for (const auto& [size, row, column, count] : runs) {
        const image::TexelRun run{size, row, column, count, bands, midpoint};
        std::vector<float> first_set;
        for (const InstructionSet set : available_instruction_sets()) {
          std::vector<float> weights(slot.size() * kChunk, -1.0F);
          make(image::texel_kernels(set), run, slot.data(), weights.data());
          if (first_set.empty()) {
            require_weights(run, weights, tolerance);
            first_set = weights;
          }
          REQUIRE(std::memcmp(weights.data(), first_set.data(), weights.size() * sizeof(float)) == 0);
        }
      }
    }
  }
}

}  // namespace

TEST_CASE("Texel integrals are right to a float's rounding", "[simd][tables][slow]") {
  require_texel_kernel(
      {1, 3, 10}, {{4, 0, 0, 2}, {7, 3, 0, 4}, {64, 0, 0, 18}, {64, 31, 14, 18}, {257, 128, 120, 9}}, 7e-8,
      [](const image::TexelKernels& kernels, const image::TexelRun& run, const int* slot, float* weights) {
        kernels.integrate_texels(run, math::basis_constants(), math::gauss_legendre(run.size < 8 ? 12 : 5), slot,
                                 weights, kChunk);
      });
}

TEST_CASE("The expansion of texel integrals is right to a few roundings", "[simd][tables]") {
  require_texel_kernel(
      {1, 2, 3}, {{129, 0, 0, 40}, {129, 64, 60, 5}, {256, 0, 0, 20}, {256, 127, 100, 28}, {1000, 77, 400, 30}}, 4e-7,
      [](const image::TexelKernels& kernels, const image::TexelRun& run, const int* slot, float* weights) {
        kernels.expand_texels(run, slot, weights, kChunk);
      });
}

TEST_CASE("The range check finds what is outside, NaN included", "[simd]") {
  for (const InstructionSet set : available_instruction_sets()) {
    const projection::AnyOutside any_outside = projection::projection_kernels(set).any_outside;
    for (const int count : {1, 2, 7, 16, 33, 100}) {
      std::vector<float> values(static_cast<std::size_t>(count), 0.5F);
      CHECK_FALSE(any_outside(values.data(), count, 0.5F, 0.5F));
      for (const float odd : {0.49F, 0.51F, NAN, INFINITY, -INFINITY}) {
        for (int at = 0; at < count; ++at) {
          values[static_cast<std::size_t>(at)] = odd;
          CHECK(any_outside(values.data(), count, 0.5F, 0.5F));
          values[static_cast<std::size_t>(at)] = 0.5F;
        }
      }
    }
  }
}

}  // namespace welkin::test
