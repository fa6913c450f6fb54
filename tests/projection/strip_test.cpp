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

using projection::FetchList;
using projection::kStripFunctions;
using projection::kStripRows;
using projection::moment_stride;
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

/// Sums of a strip of noise by each instruction set, for rows of whole pages too, which are read in two halves.
template <class Channel>
void require_strip_summed(projection::StripFormat format, int channels, int row_values) {
  constexpr int texels = 80;
  std::mt19937 generator(7);
  std::vector<Channel> pixels(static_cast<std::size_t>(kStripRows * row_values));
  for (Channel& value : pixels) {
    if constexpr (sizeof(Channel) == 2) {
      value = static_cast<std::uint16_t>(0x3000U + generator() % 0x0C00U);
    } else {
      value = static_cast<float>(generator() % 4096U) / 1024.0F - 1.0F;
    }
  }
  const auto stride_bytes = static_cast<std::ptrdiff_t>(row_values) * static_cast<std::ptrdiff_t>(sizeof(Channel));
  for (int moments = projection::kFewestMoments; moments <= projection::kMostMoments; ++moments) {
    for (const bool upwards : {false, true}) {
      std::vector<float> first_set;
      for (const InstructionSet set : available_instruction_sets()) {
        CAPTURE(name(set), channels, row_values, moments, upwards);
        const int stride = moment_stride(texels);
        platform::AlignedBuffer<float> sums(static_cast<std::size_t>(moments * stride));
        std::fill_n(sums.data(), sums.size(), 0.0F);
        const Channel* const first = pixels.data() + (upwards ? (kStripRows - 1) * row_values : 0);
        FetchList fetch;
        fetch.area_count = 1;
        fetch.areas[0] = {reinterpret_cast<const char*>(pixels.data()), 64, 3, 5};
        projection::strip_kernels(set).sum_strip[format][moments - projection::kFewestMoments](
            {first, upwards ? -stride_bytes : stride_bytes}, texels, fetch, 16, sums.data(), stride);
        std::vector<float> packed;
        for (int k = 0; k < moments; ++k) {
          for (int t = 0; t < texels; ++t) {
            for (int c = 0; c < 3; ++c) {
              double expected = 0.0;
              double largest = 0.0;
              for (int row = 0; row < kStripRows; ++row) {
                const int at = (upwards ? kStripRows - 1 - row : row) * row_values + channels * t + c;
                const double term =
                    polynomial(k, row) * static_cast<double>(as_float(pixels[static_cast<std::size_t>(at)]));
                expected += term;
                largest += std::abs(term);
              }
              const float sum = sums.data()[k * stride + 3 * t + c];
              REQUIRE(std::abs(static_cast<double>(sum) - expected) <= 1e-6 * largest);
              packed.push_back(sum);
            }
          }
        }
        if (first_set.empty()) first_set = packed;
        REQUIRE(std::memcmp(packed.data(), first_set.data(), packed.size() * sizeof(float)) == 0);
      }
    }
  }
}

std::vector<float> noise(std::size_t count, std::uint32_t seed) {
  std::mt19937 generator(seed);
  std::vector<float> values(count);
  for (float& value : values) value = static_cast<float>(generator() % 4096U) / 1024.0F - 1.0F;
  return values;
}

}  // namespace

TEST_CASE("Strips are summed to their moments on every instruction set", "[simd][projection][strip]") {
  require_strip_summed<float>(projection::strip_rgb32f, 3, 250);
  require_strip_summed<float>(projection::strip_rgb32f, 3, 1024);
  require_strip_summed<float>(projection::strip_rgba32f, 4, 330);
  require_strip_summed<float>(projection::strip_rgba32f, 4, 2048);
  require_strip_summed<std::uint16_t>(projection::strip_rgba16f, 4, 340);
  require_strip_summed<std::uint16_t>(projection::strip_rgba16f, 4, 2048);
}

TEST_CASE("Moments are reversed by texels on every instruction set", "[simd][strip]") {
  constexpr int texels = 48;
  const int stride = moment_stride(texels);
  const std::vector<float> values = noise(static_cast<std::size_t>(2 * stride), 3);
  platform::AlignedBuffer<float> from(values.size());
  std::copy(values.begin(), values.end(), from.data());
  for (const InstructionSet set : available_instruction_sets()) {
    platform::AlignedBuffer<float> to(values.size());
    projection::strip_kernels(set).reverse_moments(from.data(), 2, texels, stride, to.data());
    for (int row = 0; row < 2; ++row) {
      for (int t = 0; t < texels; ++t) {
        for (int c = 0; c < 3; ++c) {
          CAPTURE(name(set), row, t, c);
          REQUIRE(to.data()[row * stride + 3 * t + c] == from.data()[row * stride + 3 * (texels - 1 - t) + c]);
        }
      }
    }
  }
}

TEST_CASE("Moments times weights are the sums of double precision on every instruction set", "[simd][strip]") {
  constexpr int groups = 5;
  constexpr int moments = 5;
  const int stride = moment_stride(groups * kLanes);
  const int piece = moments * stride;
  constexpr int floats = kStripFunctions * 3 * kLanes;
  const auto aligned = [](const std::vector<float>& values) {
    platform::AlignedBuffer<float> buffer(values.size());
    std::copy(values.begin(), values.end(), buffer.data());
    return buffer;
  };
  const auto values = aligned(noise(static_cast<std::size_t>(2 * 4 * piece), 1));
  const auto weights = aligned(noise(static_cast<std::size_t>(groups * moments * floats), 2));
  std::vector<double> expected(2 * 27);
  for (int face = 0; face < 2; ++face) {
    for (int g = 0; g < groups; ++g) {
      for (int k = 0; k < moments; ++k) {
        for (int at = 0; at < 3 * kLanes; ++at) {
          const auto value = [&](int p) {
            return static_cast<double>(values.data()[(face * 4 + p) * piece + k * stride + g * 3 * kLanes + at]);
          };
          const double classes[4] = {
              value(0) + value(1) + value(2) + value(3), value(1) + value(3) - value(0) - value(2),
              value(2) + value(3) - value(0) - value(1), value(0) + value(3) - value(1) - value(2)};
          constexpr int class_of[kStripFunctions] = {0, 0, 0, 0, 1, 1, 2, 2, 3};
          for (int f = 0; f < kStripFunctions; ++f) {
            expected[static_cast<std::size_t>(face * 27 + at % 3 * kStripFunctions + f)] +=
                classes[class_of[f]] *
                static_cast<double>(weights.data()[(g * moments + k) * floats + f * 3 * kLanes + at]);
          }
        }
      }
    }
  }
  std::vector<double> first_set;
  for (const InstructionSet set : available_instruction_sets()) {
    for (const int at_once : {1, 2}) {
      platform::AlignedBuffer<double> sums(2 * 27 * projection::kSumLanes);
      std::fill_n(sums.data(), sums.size(), 0.0);
      FetchList nothing;
      for (int face = 0; face < 2; face += at_once) {
        projection::StripMoments strip{};
        strip.face_count = at_once;
        for (int k = 0; k < at_once; ++k) {
          strip.faces[k] = values.data() + (face + k) * 4 * piece;
          strip.sums[k] = sums.data() + (face + k) * 27 * projection::kSumLanes;
        }
        projection::strip_kernels(set).sum_moments(strip, moments, groups, weights.data(), nothing, 8);
      }
      std::vector<double> folded(2 * 27);
      projection::projection_kernels(set).fold_sum_lanes(sums.data(), 2 * 27, folded.data());
      for (std::size_t k = 0; k < folded.size(); ++k) {
        CAPTURE(name(set), at_once, k);
        REQUIRE(std::abs(folded[k] - expected[k]) < 1e-4);
      }
      if (first_set.empty()) first_set = folded;
      REQUIRE(std::memcmp(folded.data(), first_set.data(), folded.size() * sizeof(double)) == 0);
    }
  }
}

TEST_CASE("What moments weigh gives every texel its integral", "[projection][strip][truth]") {
  for (const bool midpoint : {false, true}) {
    for (const int size : {256, 288, 512, 1024, 2048}) {
      const auto weight_rows = projection::TexelWeights::get({size, 3, midpoint, size})->weight_rows();
      const projection::StripWeights strips(size, midpoint, weight_rows.data());
      constexpr int positions = 16;
      platform::AlignedBuffer<float> weights(strips.size(positions));
      platform::AlignedBuffer<float> scratch(strips.scratch_size(positions));
      // Rows at the edge, between and at the middle; columns likewise.
      for (const int strip : {0, size / 80, size / 2 / kStripRows - 1}) {
        for (const int column : {0, size / 64 * 16, size / 2 - positions}) {
          strips.fill(strip, column, positions, weights.data(), scratch.data());
          for (int row = 0; row < kStripRows; ++row) {
            double truth[9 * positions];
            std::vector<float> exact(9 * positions);
            const image::TexelRun run{size, strip * kStripRows + row, column, positions, 3, midpoint};
            image::texel_kernels().integrate_texels(run, math::basis_constants(), math::gauss_legendre(3),
                                                    weight_rows.data(), exact.data(), positions);
            std::copy(exact.begin(), exact.end(), truth);
            for (int f = 0; f < kStripFunctions; ++f) {
              for (int t = 0; t < positions; ++t) {
                for (int c = 0; c < 3; ++c) {
                  double weight = 0.0;
                  for (int k = 0; k < strips.moments(); ++k) {
                    weight += polynomial(k, row) *
                              static_cast<double>(weights.data()[(k * kStripFunctions + f) * 48 + 3 * t + c]);
                  }
                  CAPTURE(size, midpoint, strip, column, row, f, t);
                  // Row 0 is the solid angle times Y(0, 0).
                  REQUIRE(std::abs(weight - truth[f * positions + t]) < 7e-7 * truth[t] / 0.28209479177387814);
                }
              }
            }
          }
        }
      }
    }
  }
}

TEST_CASE("The weights of strips that are kept are those that would be computed", "[projection][strip]") {
  for (const bool midpoint : {false, true}) {
    constexpr int size = 256;
    const auto weight_rows = projection::TexelWeights::get({size, 3, midpoint, size})->weight_rows();
    const projection::StripWeights strips(size, midpoint, weight_rows.data());
    REQUIRE(strips.room_size(size / 2) == 0);
    const int last = size / 2 / kStripRows - 1;
    for (const auto& [strip, column] : {std::pair{0, 0}, {1, 32}, {last, 0}, {last, size / 2 - 16}}) {
      const int positions = size / 2 - column;
      CAPTURE(midpoint, strip, column);
      platform::AlignedBuffer<float> weights(strips.size(positions));
      platform::AlignedBuffer<float> scratch(strips.scratch_size(positions));
      strips.fill(strip, column, positions, weights.data(), scratch.data());
      const float* const kept = strips.at(strip, column, positions, nullptr, nullptr);
      REQUIRE(std::memcmp(kept, weights.data(), weights.size() * sizeof(float)) == 0);
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
      for (int f = 0; f < functions; ++f) {
        for (int t = 0; t < chunk.column_count; ++t) {
          CAPTURE(size, bands, index, f, t);
          const auto truth = static_cast<double>(fine[static_cast<std::size_t>(f * projection::kChunk + t)]);
          const auto weight = static_cast<double>(weights[f * projection::kChunk + t]);
          // A float's last place, and what the rule may be off by: row 0 is the solid angle times Y(0, 0).
          REQUIRE(std::abs(weight - truth) <= 1.2e-7 * std::abs(truth) + 2e-8 * static_cast<double>(fine[t]));
        }
      }
    }
  }
}

TEST_CASE("A policy that changes nothing leaves a large face's bits", "[projection][strip]") {
  const TestCubemap cubemap = make_cubemap(Content::random, 256, 3, 4);
  ProjectionOptions clamped;
  clamped.pixels.clamp = RadianceClamp{1e30F, true};
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
    if (channels == 4) cubemap.pixels[4003] = std::numeric_limits<float>::quiet_NaN();  // an alpha: nobody reads it
    const Projection result = project(cubemap.view());
    CHECK(same_bits(result.radiance, project(replaced.view()).radiance));
    CHECK(result.diagnostics.nans_replaced == 1);
    CHECK(result.diagnostics.infinities_replaced == 2);
  }
}

TEST_CASE("Large faces: finite texels whose sums overflow a float are summed in double", "[projection][strip]") {
  TestCubemap cubemap = make_cubemap(Content::random, 256, 3, 9);
  TestCubemap scaled = cubemap;
  // The scaled picture's moments are beyond a float; the coefficients, sums of values times 1e-5, are not.
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
