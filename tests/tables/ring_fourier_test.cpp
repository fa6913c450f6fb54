// Fourier transforms of rings, against the definition in double.
#include "tables/ring_fourier.h"

#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <vector>

#include "simd/kernels.h"
#include "support/catch.h"
#include "welkin/instruction_set.h"

namespace welkin::test {
namespace {

/// The largest error over all lanes of noise, relative to the signal's root mean square times sqrt(length).
double error_of(int length, const simd::Kernels& kernels) {
  const auto fourier = tables::RingFourier::get(length);
  const auto floats = static_cast<std::size_t>(length) * simd::kComplexFloats;
  tables::AlignedBuffer<float> values(floats);
  tables::AlignedBuffer<float> scratch(fourier->scratch_floats());
  std::uint32_t state = static_cast<std::uint32_t>(length);
  for (std::size_t k = 0; k < floats; ++k) {
    state = state * 1664525U + 1013904223U;
    values.data()[k] = static_cast<float>(state >> 8U) * 0x1p-23F - 1.0F;
  }
  const std::vector<float> signal(values.data(), values.data() + floats);
  const float* const result = fourier->transform(kernels, values.data(), scratch.data());
  double error = 0.0;
  const int lanes = length > 300 ? 1 : simd::kRingLanes;  // which lane, by the length
  for (int lane = length % simd::kRingLanes, n = 0; n < lanes; ++n, lane = (lane + 1) % simd::kRingLanes) {
    for (int k = 0; k < length; k += 1 + length / 500) {
      std::complex<double> sum = 0.0;
      for (int i = 0; i < length; ++i) {
        const auto at = static_cast<std::size_t>(i * simd::kComplexFloats + lane);
        const double turn = static_cast<double>(std::int64_t{i} * k % length) / length;
        sum += std::complex<double>(signal[at], signal[at + simd::kRingLanes]) *
               std::polar(1.0, -2.0 * std::numbers::pi * turn);
      }
      const auto at = static_cast<std::size_t>(k * simd::kComplexFloats + lane);
      error = std::max(error, std::abs(sum - std::complex<double>(result[at], result[at + simd::kRingLanes])));
    }
  }
  return error / std::sqrt(length * 2.0 / 3.0);
}

}  // namespace

TEST_CASE("Rings of any length are transformed", "[tables][transform][fourier]") {
  for (int length = 1; length <= 70; ++length) {
    CAPTURE(length);
    CHECK(error_of(length, simd::active_kernels()) < 2e-6);
  }
  // Powers, products, primes by convolution.
  for (const int length :
       {81, 125, 257, 343, 360, 509, 512, 720, 961, 1000, 1024, 1439, 1440, 2048, 2187, 4093, 4096, 6000, 8191}) {
    CAPTURE(length);
    CHECK(error_of(length, simd::active_kernels()) < 3e-6);
  }
}

TEST_CASE("Rings are transformed on every instruction set", "[tables][transform][fourier]") {
  for (const InstructionSet set : available_instruction_sets()) {
    for (const int length : {16, 30, 64, 77, 101, 240}) {
      CAPTURE(name(set), length);
      CHECK(error_of(length, simd::kernels(set)) < 3e-6);
    }
  }
}

TEST_CASE("Fast lengths are even and have small factors only", "[tables][transform][fourier]") {
  CHECK(tables::fast_even_length(1) == 2);
  CHECK(tables::fast_even_length(7) == 8);
  CHECK(tables::fast_even_length(13) == 16);
  CHECK(tables::fast_even_length(1023) == 1024);
  CHECK(tables::fast_even_length(1025) == 1080);
}

}  // namespace welkin::test
