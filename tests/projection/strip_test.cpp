// Large faces are read in strips of 16 rows: the kernels against plain loops in double, the weights against the
// integrals over single texels, and the careful way against the fast one.
#include "image/image_kernels.h"
#include "image/pixels.h"
#include "math/basis.h"
#include "math/quadrature.h"
#include "platform/memory.h"
#include "projection/projection_kernels.h"
#include "projection/strip_kernels.h"
#include "projection/strip_projection.h"
#include "projection/strip_weights.h"
#include "projection/texel_weights.h"
#include "simd/dispatch.h"
#include "support/catch.h"
#include "support/coefficients.h"
#include "support/same_bits.h"
#include "support/test_environments.h"
#include "welkin/core.h"
#include "welkin/projection.h"

namespace welkin::test {
namespace {

using projection::kStripFunctions;
using projection::kStripRows;
using simd::kLanes;

double binomial(int n, int k) {
  if (k < 0 || k > n) return 0.0;
  double result = 1.0;
  for (int i = 1; i <= k; ++i) result = result * (n - k + i) / i;
  return result;
}

/// The k-th polynomial of strip_kernels.h at a row of a strip.
double polynomial(int k, int row) {
  const bool below = row >= kStripRows / 2;
  const int i = below ? row - kStripRows / 2 : kStripRows / 2 - 1 - row;
  const int j = k / 2;
  if (k % 2 == 0) return binomial(i + j, 2 * j);
  return (below ? 1.0 : -1.0) * (2.0 * i + 1.0) / (2.0 * j + 1.0) * binomial(i + j, 2 * j);
}

float as_float(float value) { return value; }
float as_float(std::uint16_t value) { return image::float_from_half(value); }
float as_float(std::uint8_t value) { return static_cast<float>(value) / 255.0F; }
float as_float(projection::SrgbByte byte) { return static_cast<float>(image::linear_from_srgb(byte.value / 255.0)); }

std::vector<float> noise(std::size_t count, std::uint32_t seed) {
  std::mt19937 generator(seed);
  std::vector<float> values(count);
  for (float& value : values) value = static_cast<float>(generator() % 4096U) / 1024.0F - 1.0F;
  return values;
}

/// Noise as four pieces of a strip, times weights, by each instruction set.
template <class Channel>
void require_strip_summed(projection::FoldFormat format, int channels, int row_values, int texels) {
  std::mt19937 generator(7);
  std::vector<Channel> pixels(static_cast<std::size_t>(2 * kStripRows * row_values));
  for (Channel& value : pixels) {
    if constexpr (sizeof(Channel) == 1) {
      value = Channel{static_cast<std::uint8_t>(generator())};
    } else if constexpr (sizeof(Channel) == 2) {
      value = static_cast<std::uint16_t>(0x3000U + generator() % 0x0C00U);
    } else {
      value = static_cast<float>(generator() % 4096U) / 1024.0F - 1.0F;
    }
  }
  std::vector<double> light;
  for (const Channel& value : pixels) light.push_back(static_cast<double>(as_float(value)));
  double polynomials[projection::kMaxMoments][kStripRows];
  for (int k = 0; k < projection::kMaxMoments; ++k) {
    for (int row = 0; row < kStripRows; ++row) polynomials[k][row] = polynomial(k, row);
  }
  const int right_column = row_values / channels - texels;
  const auto at = [&](bool bottom, bool right, int row, int texel) {
    const int column = right ? right_column + texels - 1 - texel : texel;
    return (bottom ? 2 * kStripRows - 1 - row : row) * row_values + channels * column;
  };
  const auto stride = static_cast<std::ptrdiff_t>(row_values) * static_cast<std::ptrdiff_t>(sizeof(Channel));
  const auto piece = [&](bool bottom, bool right) {
    return projection::StripRows{pixels.data() + at(bottom, right, 0, right ? texels - 1 : 0),
                                 bottom ? -stride : stride};
  };
  const projection::StripPieces pieces{piece(false, false), piece(false, true), piece(true, false), piece(true, true)};
  for (int moments = projection::kMinMoments; moments <= projection::kMaxMoments; ++moments) {
    constexpr int floats = kStripFunctions * 3 * kLanes;
    const std::vector<float> values = noise(static_cast<std::size_t>(texels / kLanes * moments * floats), 2);
    platform::AlignedBuffer<float> weights(values.size());
    std::copy(values.begin(), values.end(), weights.data());
    std::vector<double> expected(27);
    std::vector<double> largest(27);
    std::vector<double> expected_planes(static_cast<std::size_t>(moments * projection::kStripPlaneFloats));
    for (int t = 0; t < texels; ++t) {
      for (int k = 0; k < moments; ++k) {
        for (int c = 0; c < 3; ++c) {
          double moment[4] = {};
          for (int p = 0; p < 4; ++p) {
            for (int row = 0; row < kStripRows; ++row) {
              const auto from = static_cast<std::size_t>(at(p >= 2, p % 2 == 1, row, t) + c);
              moment[p] += polynomials[k][row] * light[from];
            }
          }
          const double classes[4] = {
              moment[0] + moment[1] + moment[2] + moment[3], moment[1] + moment[3] - moment[0] - moment[2],
              moment[2] + moment[3] - moment[0] - moment[1], moment[0] + moment[3] - moment[1] - moment[2]};
          for (int symmetry = 0; symmetry < 4 && texels <= projection::kChunk; ++symmetry) {
            expected_planes[static_cast<std::size_t>(((k * 3 + c) * 4 + symmetry) * projection::kChunk + t)] =
                classes[symmetry];
          }
          constexpr int class_of[kStripFunctions] = {0, 0, 0, 0, 1, 1, 2, 2, 3};
          for (int f = 0; f < kStripFunctions; ++f) {
            const auto weight = static_cast<double>(values[static_cast<std::size_t>(
                (t / kLanes * moments + k) * floats + (f * kLanes + t % kLanes) * 3 + c)]);
            expected[static_cast<std::size_t>(c * kStripFunctions + f)] += classes[class_of[f]] * weight;
            largest[static_cast<std::size_t>(c * kStripFunctions + f)] += std::abs(classes[class_of[f]] * weight);
          }
        }
      }
    }
    std::vector<double> first_set;
    std::vector<float> first_planes;
    for (const InstructionSet set : available_instruction_sets()) {
      platform::AlignedBuffer<float> scratch(static_cast<std::size_t>(projection::strip_scratch(moments)));
      platform::AlignedBuffer<double> sums(27 * projection::kSumLanes);
      std::fill_n(sums.data(), sums.size(), 0.0);
      projection::strip_kernels(set).strips[format].of[moments - projection::kMinMoments].sum(
          pieces, texels, weights.data(), scratch.data(), sums.data());
      std::vector<double> folded(27);
      projection::projection_kernels(set).fold_sum_lanes(sums.data(), 27, folded.data());
      for (std::size_t k = 0; k < folded.size(); ++k) {
        CAPTURE(name(set), channels, row_values, texels, moments, k);
        REQUIRE(std::abs(folded[k] - expected[k]) <= 1e-6 * largest[k]);
      }
      if (first_set.empty()) first_set = folded;
      REQUIRE(std::memcmp(folded.data(), first_set.data(), folded.size() * sizeof(double)) == 0);
      if (texels > projection::kChunk) continue;
      platform::AlignedBuffer<float> planes(expected_planes.size());
      std::fill_n(planes.data(), planes.size(), 0.0F);
      projection::strip_kernels(set).strips[format].of[moments - projection::kMinMoments].fold(
          pieces, texels, scratch.data(), planes.data());
      int wrong = 0;
      for (std::size_t k = 0; k < planes.size(); ++k)
        wrong += std::abs(static_cast<double>(planes.data()[k]) - expected_planes[k]) < 2e-3 ? 0 : 1;
      CAPTURE(name(set), channels, texels, moments);
      REQUIRE(wrong == 0);
      if (first_planes.empty()) first_planes.assign(planes.data(), planes.data() + planes.size());
      REQUIRE(std::memcmp(planes.data(), first_planes.data(), planes.size() * sizeof(float)) == 0);
    }
  }
}

}  // namespace

TEST_CASE("Strips are summed with their weights on every instruction set", "[simd][projection][strip]") {
  require_strip_summed<float>(projection::fold_rgb32f, 3, 500, 80);
  require_strip_summed<float>(projection::fold_rgb32f, 3, 2048, 272);  // more than a block of any number of moments
  require_strip_summed<float>(projection::fold_rgba32f, 4, 660, 80);
  require_strip_summed<float>(projection::fold_rgba32f, 4, 1024, 128);
  require_strip_summed<std::uint16_t>(projection::fold_rgba16f, 4, 680, 80);
  require_strip_summed<std::uint16_t>(projection::fold_rgba16f, 4, 1024, 128);
  require_strip_summed<std::uint16_t>(projection::fold_rgb16f, 3, 680, 80);
  require_strip_summed<std::uint8_t>(projection::fold_rgb8, 3, 680, 80);
  require_strip_summed<std::uint8_t>(projection::fold_rgba8, 4, 1024, 128);
  require_strip_summed<projection::SrgbByte>(projection::fold_srgb8, 3, 680, 80);
  require_strip_summed<projection::SrgbByte>(projection::fold_srgba8, 4, 1024, 128);
}

namespace {

/// Compares the weights of a strip's moments in a texel of each row with a finer rule's integral over it.
void require_moments_weighed(int size, int bands, bool midpoint, int strip, int column, double bound) {
  constexpr int positions = 16;
  const auto weight_rows = projection::TexelWeights::get({size, bands, midpoint, size})->weight_rows();
  const projection::StripWeights strips(size, bands, midpoint, weight_rows.data());
  const int functions = bands * bands;
  platform::AlignedBuffer<float> weights(strips.size(positions));
  platform::AlignedBuffer<float> scratch(strips.scratch_size(positions));
  strips.fill(strip, column, positions, weights.data(), scratch.data());
  std::vector<float> truth(static_cast<std::size_t>(functions * positions));
  int wrong = 0;
  for (int row = 0; row < kStripRows; ++row) {
    const image::TexelRun run{size, strip * kStripRows + row, column, positions, bands, midpoint};
    image::texel_kernels().integrate_texels(run, math::basis_constants(), math::gauss_legendre(3), weight_rows.data(),
                                            truth.data(), positions);
    for (int f = 0; f < functions; ++f) {
      for (int t = 0; t < positions; ++t) {
        for (int c = 0; c < (strips.packed() ? 3 : 1); ++c) {
          double weight = 0.0;
          for (int k = 0; k < strips.moments(); ++k) {
            const int at =
                strips.packed() ? (k * functions + f) * 48 + 3 * t + c : (k * functions + f) * projection::kChunk + t;
            weight += polynomial(k, row) * static_cast<double>(weights.data()[at]);
          }
          // Row 0 is the solid angle times Y(0, 0).
          const double solid_angle = static_cast<double>(truth[static_cast<std::size_t>(t)]) / 0.28209479177387814;
          const double off = std::abs(weight - static_cast<double>(truth[static_cast<std::size_t>(f * positions + t)]));
          wrong += off < bound * solid_angle ? 0 : 1;
        }
      }
    }
  }
  CAPTURE(size, bands, midpoint, strip, column);
  CHECK(wrong == 0);
}

}  // namespace

TEST_CASE("What moments weigh gives every texel its integral", "[projection][strip][truth]") {
  for (const bool midpoint : {false, true}) {
    for (const auto& [size, bands] : {std::pair{256, 3},
                                      {288, 3},
                                      {512, 3},
                                      {1024, 3},
                                      {2048, 3},
                                      {256, 4},
                                      {512, 6},
                                      {1024, 4},
                                      {544, 10},
                                      {1024, 16}}) {
      REQUIRE(projection::StripWeights::serve(size, bands));
      // Rows and columns at the edge, between, and at the middle.
      for (const int strip : {0, size / 80, size / 2 / kStripRows - 1}) {
        for (const int column : {0, size / 64 * 16, size / 2 - 16}) {
          // A harmonic of l bands is at most (2 l - 1) / 4 pi squared: sqrt(5), or more, times as large as Y(0, 0).
          require_moments_weighed(size, bands, midpoint, strip, column,
                                  bands == 3 ? 7e-7 : 3.1e-7 * std::sqrt(2.0 * bands - 1.0));
        }
      }
    }
  }
}

TEST_CASE("Large faces' weights of many bands are those of a finer rule", "[projection][truth]") {
  for (const auto& [size, bands] : {std::pair{256, 4}, {384, 6}, {640, 10}, {1024, 16}, {129, 4}}) {
    const auto table = projection::TexelWeights::get({size, bands, false, size});
    platform::AlignedBuffer<float> scratch(table->scratch_size());
    const int functions = bands * bands;
    std::vector<float> fine(static_cast<std::size_t>(functions) * projection::kChunk);
    for (const int index : {0, table->chunk_count() / 2, table->chunk_count() - 1}) {
      const projection::QuadrantChunk chunk = table->chunk(index);
      const float* const weights = table->chunk_weights(index, scratch.data());
      image::texel_kernels().integrate_texels(
          {size, chunk.first_row, chunk.first_column, chunk.column_count, bands, false}, math::basis_constants(),
          math::gauss_legendre(8), table->weight_rows().data(), fine.data(), projection::kChunk);
      int wrong = 0;
      for (int f = 0; f < functions; ++f) {
        for (int t = 0; t < chunk.column_count; ++t) {
          const auto truth = static_cast<double>(fine[static_cast<std::size_t>(f * projection::kChunk + t)]);
          const auto weight = static_cast<double>(weights[f * projection::kChunk + t]);
          // A float's last bit, and the rule's error: row 0 is the solid angle times Y(0, 0).
          const double most = 1.2e-7 * std::abs(truth) + 2e-8 * static_cast<double>(fine[t]);
          wrong += std::abs(weight - truth) <= most ? 0 : 1;
        }
      }
      CAPTURE(size, bands, index);
      CHECK(wrong == 0);
    }
  }
}

TEST_CASE("A policy that changes nothing leaves a large face's bits", "[projection][strip]") {
  const TestCubemap cubemap = make_cubemap(Content::random, 256, 3, 4);
  const ProjectionOptions clamped{.pixels = {.clamp = RadianceClamp{1e30F, true}}};
  CHECK(same_bits(project(cubemap.view(), clamped).radiance, project(cubemap.view()).radiance));
}

TEST_CASE("Large faces: what is not finite is replaced, counted, and leaves other texels alone",
          "[projection][strip]") {
  for (const int channels : {3, 4}) {
    TestCubemap cubemap = make_cubemap(Content::random, 256, channels, 4);
    TestCubemap replaced = cubemap;
    const float infinity = std::numeric_limits<float>::infinity();
    const std::pair<std::size_t, float> odd[] = {
        {0, infinity}, {100003, std::numeric_limits<float>::quiet_NaN()}, {200001, -infinity}};
    for (const auto& [texel, value] : odd) {
      const std::size_t at = texel * static_cast<std::size_t>(channels) + 1;
      cubemap.pixels[at] = value;
      replaced.pixels[at] = value > 0.0F ? 65504.0F : 0.0F;
    }
    if (channels == 4) cubemap.pixels[4003] = std::numeric_limits<float>::quiet_NaN();  // an alpha, which is ignored
    const Projection result = project(cubemap.view());
    CHECK(same_bits(result.radiance, project(replaced.view()).radiance));
    CHECK(result.diagnostics.nans_replaced == 1);
    CHECK(result.diagnostics.infinities_replaced == 2);
  }
}

TEST_CASE("Large faces: finite texels whose sums overflow a float are summed in double", "[projection][strip]") {
  TestCubemap cubemap = make_cubemap(Content::random, 256, 3, 9);
  TestCubemap scaled = cubemap;
  // The scaled image's moments are beyond a float; the coefficients, sums of values times 1e-5, are not.
  for (std::size_t k = 0; k < cubemap.pixels.size(); ++k) {
    const float value = k % 5 == 0 ? cubemap.pixels[k] : 0.0F;
    cubemap.pixels[k] = value;
    scaled.pixels[k] = value * 0x1p122F;
  }
  SphericalHarmonics expected = project(cubemap.view()).radiance;
  for (glm::dvec3& value : expected.coefficients()) value *= 0x1p122;
  CHECK(relative_error(project(scaled.view()).radiance, expected) < 3e-7);
}

}  // namespace welkin::test
