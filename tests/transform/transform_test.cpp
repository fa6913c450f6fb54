// The fast transform between grids and hundreds of bands, and the Fourier transforms of its rings.
#include "math/quadrature.h"
#include "support/catch.h"
#include "support/sun_maps.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "support/trials.h"
#include "transform/direct_transform.h"
#include "transform/ring_fft.h"
#include "transform/spectrum.h"
#include "transform/transform_kernels.h"
#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::test {

// Fourier transforms of rings, against the definition in double.

namespace {

/// The largest error over all lanes of noise, relative to the signal's root mean square times sqrt(length).
double error_of(int length, const transforms::FourierKernels& kernels) {
  const auto fourier = transforms::RingFourier::get(length);
  const auto floats = static_cast<std::size_t>(length) * transforms::kComplexFloats;
  platform::AlignedBuffer<float> values(floats);
  platform::AlignedBuffer<float> scratch(fourier->scratch_floats());
  std::uint32_t state = static_cast<std::uint32_t>(length);
  for (std::size_t k = 0; k < floats; ++k) {
    state = state * 1664525U + 1013904223U;
    values.data()[k] = static_cast<float>(state >> 8U) * 0x1p-23F - 1.0F;
  }
  const std::vector<float> signal(values.data(), values.data() + floats);
  const float* const result = fourier->transform(kernels, values.data(), scratch.data());
  double error = 0.0;
  const int lanes = length > 300 ? 1 : transforms::kRingLanes;  // which lane, by the length
  for (int lane = length % transforms::kRingLanes, n = 0; n < lanes; ++n, lane = (lane + 1) % transforms::kRingLanes) {
    for (int k = 0; k < length; k += 1 + length / 500) {
      std::complex<double> sum = 0.0;
      for (int i = 0; i < length; ++i) {
        const auto at = static_cast<std::size_t>(i * transforms::kComplexFloats + lane);
        const double rotation = static_cast<double>(std::int64_t{i} * k % length) / length;
        sum += std::complex<double>(signal[at], signal[at + transforms::kRingLanes]) *
               std::polar(1.0, -2.0 * std::numbers::pi * rotation);
      }
      const auto at = static_cast<std::size_t>(k * transforms::kComplexFloats + lane);
      error = std::max(error, std::abs(sum - std::complex<double>(result[at], result[at + transforms::kRingLanes])));
    }
  }
  return error / std::sqrt(length * 2.0 / 3.0);
}

}  // namespace

TEST_CASE("Rings of any length are transformed", "[tables][transform][fourier][slow]") {
  for (int length = 1; length <= 70; ++length) {
    CAPTURE(length);
    CHECK(error_of(length, transforms::fourier_kernels()) < 2e-6);
  }
  // Powers, products, primes by convolution.
  for (const int length :
       {81, 125, 257, 343, 360, 509, 512, 720, 961, 1000, 1024, 1439, 1440, 2048, 2187, 4093, 4096, 6000, 8191}) {
    CAPTURE(length);
    CHECK(error_of(length, transforms::fourier_kernels()) < 3e-6);
  }
}

TEST_CASE("Rings are transformed on every instruction set", "[tables][transform][fourier]") {
  for (const InstructionSet set : available_instruction_sets()) {
    for (const int length : {16, 30, 64, 77, 101, 240}) {
      CAPTURE(name(set), length);
      CHECK(error_of(length, transforms::fourier_kernels(set)) < 3e-6);
    }
  }
}

TEST_CASE("Fast lengths are even and have small factors only", "[tables][transform][fourier]") {
  CHECK(transforms::fast_even_length(1) == 2);
  CHECK(transforms::fast_even_length(7) == 8);
  CHECK(transforms::fast_even_length(13) == 16);
  CHECK(transforms::fast_even_length(1023) == 1024);
  CHECK(transforms::fast_even_length(1025) == 1080);
}

// The fast transform agrees with the definition in double, at any size and number of bands.

namespace {

LatLongImage image_of(Content content, int width, int height, std::uint32_t seed) {
  const TestLatLong made = make_lat_long(content, width, height, seed);
  return {width, height, made.pixels};
}

}  // namespace

TEST_CASE("The definition's Legendre functions are the standard library's", "[transform]") {
  for (const double theta : {1e-3, 0.7, 0.5 * std::numbers::pi, 3.0}) {
    for (const int m : {0, 1, 7, 32, 63}) {
      const std::vector<double> column = legendre_column(m, 64, theta);
      for (unsigned l = 0; l < 64; ++l) {
        const double sign = m % 2 != 0 ? -1.0 : 1.0;  // its Condon-Shortley phase
        const double wanted =
            static_cast<int>(l) < m ? 0.0 : sign * std::sph_legendre(l, static_cast<unsigned>(m), theta);
        CHECK(std::abs(column[l] - wanted) < 1e-9);
      }
    }
  }
}

TEST_CASE("Analysis gives the integrals over the texels' areas", "[specular][transform][truth]") {
  // More bands than texels, fewer, even, odd, prime; rows of any ratio.
  const std::pair<int, int> sizes[] = {{1, 1},  {2, 1},  {1, 2},   {3, 2},    {2, 3},   {7, 7},    {1, 64},
                                       {64, 1}, {64, 3}, {7, 257}, {257, 64}, {64, 32}, {128, 64}, {257, 2}};
  for (const auto& [width, height] : sizes) {
    for (const int bands : some_of(3, {2, 1, 3, 64, 33})) {
      CAPTURE(width, height, bands);
      const LatLongImage image = image_of(Content::random, width, height, 5);
      const Coefficients truth = direct_analysis(image, bands);
      const transforms::Spectrum spectrum = transforms::analyse(image.view(), bands, {});
      REQUIRE(spectrum.bands() == bands);
      CHECK(largest_difference(coefficients_of(spectrum), truth) < 3e-7 * largest(truth));
    }
  }
}

TEST_CASE("Synthesis gives the sum over the harmonics", "[specular][transform][slow]") {
  for (const int bands : {1, 2, 7, 33, 64}) {
    const LatLongImage image = image_of(Content::random, 64, 33, 7);
    const transforms::Spectrum spectrum = transforms::analyse(image.view(), bands + 1, {});
    const Coefficients c = coefficients_of(spectrum);
    std::vector<double> zonal;
    for (int l = 0; l < bands; ++l) zonal.push_back(1.0 / (1.0 + 0.03 * l * l));
    for (const auto& [rings, columns] : {std::pair{1, 128}, std::pair{2, 130}, std::pair{7, 134}, std::pair{33, 162},
                                         std::pair{64, 128}, std::pair{129, 254}}) {
      CAPTURE(bands, rings, columns);
      image::SphereGrid grid(rings, columns, image::GridContent::samples);
      transforms::synthesise(spectrum, zonal, grid, {});
      double most = 0.0;
      double error = 0.0;
      for (int ring = 0; ring < rings; ring += 1 + rings / 9) {
        for (int column = 0; column < columns; column += 1 + columns / 7) {
          const double theta = std::numbers::pi * (ring + 0.5) / rings;
          const double longitude = std::numbers::pi - 2.0 * std::numbers::pi * (column + 0.5) / columns;
          for (int channel = 0; channel < 3; ++channel) {
            const double truth = direct_value(c, zonal, channel, theta, longitude);
            most = std::max(most, std::abs(truth));
            error = std::max(error, std::abs(truth - static_cast<double>(grid.texel(column, ring)[channel])));
          }
          CHECK(grid.texel(column, ring)[3] == 0.0F);
        }
      }
      CHECK(error < 1e-6 * most);
    }
  }
}

// Properties that the transform must keep at hundreds of bands: energy, symmetry, dark skies next to a sun.

namespace {

using image::GridContent;
using image::SphereGrid;

}  // namespace

TEST_CASE("A uniform environment has its mean and nothing else", "[specular][transform]") {
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{9, 4}, std::pair{256, 129}, std::pair{1024, 512}}) {
    CAPTURE(width, height);
    const transforms::Spectrum spectrum = transforms::analyse(grey_lat_long(width, height, 0.7F).view(), 100, {});
    const double mean = static_cast<double>(0.7F) * std::sqrt(4.0 * std::numbers::pi);
    CHECK(std::abs(spectrum.value(0, 0, 0) - mean) < 2e-7 * mean);
    double rest = 0.0;
    for (int m = 0; m < 100; ++m) {
      for (int l = std::max(1, m); l < 100; ++l) rest = std::max(rest, std::abs(spectrum.value(l, m, 1)));
    }
    CHECK(rest < 2e-7 * mean);
  }
}

TEST_CASE("A sun of a million leaves the sky beside it right", "[specular][transform]") {
  // One texel over a background of 1. Its coefficients come from its own integrals, in double.
  const int width = 1024;
  const int height = 512;
  const int bands = 384;
  const int column = 300;
  const double radiance = 1e6;
  for (const int row : {0, 60, 255, 400}) {
    CAPTURE(row);
    LatLongImage image = grey_lat_long(width, height, 1.0F);
    for (int c = 0; c < 3; ++c) image.pixels[static_cast<std::size_t>(3 * (row * width + column) + c)] = 1e6F;
    const transforms::Spectrum spectrum = transforms::analyse(image.view(), bands, {});
    const math::GaussRule rule = math::gauss_legendre(6);
    const double longitude = std::numbers::pi * (1.0 - 2.0 * (column + 0.5) / width);
    double squares = 0.0;  // of the errors of a field through a lobe of roughness 0.111
    double largest_error = 0.0;
    const double alpha = 0.111 * 0.111;
    for (int m = 0; m < bands; ++m) {
      std::vector<double> integrals(static_cast<std::size_t>(bands), 0.0);
      for (int k = 0; k < rule.order; ++k) {
        const double theta = std::numbers::pi * (row + 0.5 + 0.5 * rule.nodes[k]) / height;
        const std::vector<double> functions = legendre_column(m, bands, theta);
        const double weight = rule.weights[k] * 0.5 * std::numbers::pi / height * std::sin(theta);
        for (int l = m; l < bands; ++l) {
          integrals[static_cast<std::size_t>(l)] += weight * functions[static_cast<std::size_t>(l)];
        }
      }
      const double extent = m > 0 ? 2.0 * std::sin(m * std::numbers::pi / width) / m : 2.0 * std::numbers::pi / width;
      for (int l = m; l < bands; ++l) {
        std::complex<double> truth =
            (radiance - 1.0) * integrals[static_cast<std::size_t>(l)] * std::polar(extent, -m * longitude);
        if (l == 0) truth += std::sqrt(4.0 * std::numbers::pi);
        const double error = std::abs(truth - spectrum.value(l, m, 0));
        largest_error = std::max(largest_error, error);
        squares += (m > 0 ? 2.0 : 1.0) * error * error * std::exp(-4.0 * alpha * l);
      }
    }
    CHECK(largest_error < 5e-4);                                  // coefficients go up to 40
    CHECK(std::sqrt(squares / (4.0 * std::numbers::pi)) < 6e-4);  // of the background, which is 1

    // And back: far from the sun and near it, against the sum of the same coefficients in double.
    std::vector<double> lobe;
    for (int l = 0; l < bands; ++l) lobe.push_back(std::exp(-2.0 * alpha * l));
    SphereGrid grid(height, width, GridContent::samples);
    transforms::synthesise(spectrum, lobe, grid, {});
    double error = 0.0;
    for (const int ring : {1, 61, 254, 301, 510}) {
      const double theta = std::numbers::pi * (ring + 0.5) / height;
      std::vector<std::complex<double>> orders;
      for (int m = 0; m < bands; ++m) {
        const std::vector<double> functions = legendre_column(m, bands, theta);
        std::complex<double> sum = 0.0;
        for (int l = m; l < bands; ++l) {
          const auto degree = static_cast<std::size_t>(l);
          sum += lobe[degree] * functions[degree] * spectrum.value(l, m, 2);
        }
        orders.push_back(m > 0 ? 2.0 * sum : sum);
      }
      for (int sample = 7; sample < width; sample += 97) {
        const double angle = std::numbers::pi * (1.0 - 2.0 * (sample + 0.5) / width);
        double truth = 0.0;
        for (int m = 0; m < bands; ++m) {
          truth += (orders[static_cast<std::size_t>(m)] * std::polar(1.0, m * angle)).real();
        }
        const double difference = std::abs(truth - static_cast<double>(grid.texel(sample, ring)[2]));
        error = std::max(error, difference / std::max(1.0, std::abs(truth)));
      }
    }
    CHECK(error < 1e-3);  // relative; the lobe's peak is near 500
  }
}

TEST_CASE("Many bands begin where they should", "[specular][transform][slow]") {
  // 1536 bands, the maximum, on few rings: every function that matters is there, however small it begins.
  const int bands = 1536;
  transforms::Spectrum spectrum(bands);
  const int degree = bands - 1;
  const int order = GENERATE(0, 1, 40, 300, 1000, 1500, 1535);
  spectrum.order(order)[8 * (degree - order)] = 1.0F;
  std::vector<double> zonal(static_cast<std::size_t>(bands), 0.0);
  zonal.back() = 1.0;
  const int rings = 24;
  SphereGrid grid(rings, 2 * bands, GridContent::samples);
  transforms::synthesise(spectrum, zonal, grid, {});
  const int column = 11;
  const double longitude = std::numbers::pi * (1.0 - (column + 0.5) / bands);
  double error = 0.0;
  for (int ring = 0; ring < rings; ++ring) {
    const double theta = std::numbers::pi * (ring + 0.5) / rings;
    const double truth =
        (order > 0 ? 2.0 : 1.0) * legendre_column(order, bands, theta).back() * std::cos(order * longitude);
    error = std::max(error, std::abs(truth - static_cast<double>(grid.texel(column, ring)[0])));
  }
  CHECK(error < 2e-5);  // values are of order 1
}

TEST_CASE("The transform refuses what it cannot do", "[specular][transform]") {
  const TestLatLong source = make_lat_long(Content::random, 8, 4, 44);
  const TestLatLong with_alpha = make_lat_long(Content::random, 8, 4, 44, 4);
  const auto refused = [](const auto& work) { return thrown_by(work).code == ErrorCode::invalid_argument; };
  CHECK(refused([&] { static_cast<void>(transforms::analyse(source.view(), 0, {})); }));
  CHECK(refused([&] { static_cast<void>(transforms::analyse(source.view(), 1537, {})); }));
  CHECK(refused([&] { static_cast<void>(transforms::analyse(with_alpha.view(), 4, {})); }));
  CHECK(refused([&] { static_cast<void>(transforms::analyse(LatLongView{}, 4, {})); }));
  const transforms::Spectrum spectrum = transforms::analyse(source.view(), 4, {});
  const std::vector<double> zonal(5, 1.0);
  SphereGrid narrow(4, 6, GridContent::samples);
  SphereGrid odd(4, 9, GridContent::samples);
  SphereGrid good(4, 8, GridContent::samples);
  const std::span<const double> four(zonal.data(), 4);
  CHECK(refused([&] { transforms::synthesise(spectrum, four, narrow, {}); }));
  CHECK(refused([&] { transforms::synthesise(spectrum, four, odd, {}); }));
  CHECK(refused([&] { transforms::synthesise(spectrum, zonal, good, {}); }));
  CHECK(refused([&] { transforms::synthesise(spectrum, {}, good, {}); }));
  CHECK_NOTHROW(transforms::synthesise(spectrum, four, good, {}));
}

}  // namespace welkin::test
