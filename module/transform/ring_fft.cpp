#include "transform/ring_fft.h"

#include <algorithm>
#include <complex>
#include <cstdint>
#include <utility>

#include "math/elementary.h"
#include "math/table_cache.h"

namespace welkin::transforms {
namespace {

constexpr std::size_t kCacheBytes = std::size_t{16} << 20U;

using Number = std::complex<double>;

/// e^(-2 pi i turn / turns), 0 <= turn < turns
Number root(std::int64_t rotation, std::int64_t turns) {
  const math::SineCosine angle = math::sine_cosine_of_turns(static_cast<double>(rotation) / static_cast<double>(turns));
  return {angle.cosine, -angle.sine};
}

void append(std::vector<float>& numbers, Number number) {
  numbers.push_back(static_cast<float>(number.real()));
  numbers.push_back(static_cast<float>(number.imag()));
}

/// e^(-2 pi i p k / (count radix)) at [p][k].
void append_twiddles(std::vector<float>& numbers, int count, int radix) {
  for (int p = 0; p < count; ++p) {
    for (int k = 0; k < radix; ++k) append(numbers, root(std::int64_t{p} * k, std::int64_t{count} * radix));
  }
}

/// Two radices that go in one pass; the second is 1 if there is none.
using RadixPair = std::pair<int, int>;

/// Eights first, the fast ones by twos; empty if a prime factor is above 31.
std::vector<RadixPair> radices_of(int length) {
  std::vector<int> fast;
  for (const int radix : {8, 5, 4, 3, 2}) {
    for (; length % radix == 0; length /= radix) fast.push_back(radix);
  }
  std::vector<RadixPair> radices;
  std::size_t first = 0;
  // A pass of two radices holds their product in local memory, at most 64 numbers: the largest is joined with the
  // smallest, so that passes are alike.
  for (std::size_t last = fast.size(); first < last;) {  // a large one and a small one
    const int large = fast[first++];
    radices.emplace_back(large, first < last ? fast[--last] : 1);
  }
  for (const int radix : {7, 11, 13, 17, 19, 23, 29, 31}) {
    for (; length % radix == 0; length /= radix) radices.emplace_back(radix, 1);
  }
  if (length > 1) radices.clear();
  return radices;
}

/// In double, for the chirp's own spectrum: length a power of two.
void transform_in_double(std::vector<Number>& values) {
  const std::size_t length = values.size();
  std::vector<Number> next(length);
  for (std::size_t stride = 1; stride < length; stride *= 2) {
    const std::size_t count = length / (2 * stride);
    for (std::size_t p = 0; p < count; ++p) {
      const Number twiddle = root(static_cast<std::int64_t>(p), static_cast<std::int64_t>(2 * count));
      for (std::size_t q = 0; q < stride; ++q) {
        const Number a = values[q + stride * p];
        const Number b = values[q + stride * (p + count)];
        const Number difference = a - b;
        next[q + stride * 2 * p] = a + b;
        next[q + stride * (2 * p + 1)] = {difference.real() * twiddle.real() - difference.imag() * twiddle.imag(),
                                          difference.real() * twiddle.imag() + difference.imag() * twiddle.real()};
      }
    }
    values.swap(next);
  }
}

}  // namespace

std::shared_ptr<const RingFourier> RingFourier::get(int length) {
  static auto& cache = *new math::TableCache<int, RingFourier>(kCacheBytes);  // never destroyed
  return cache.get(length, [&] { return std::make_shared<const RingFourier>(length); });
}

RingFourier::RingFourier(int length) : length_(length) {
  const std::vector<RadixPair> radices = radices_of(length);
  if (length > 1 && radices.empty()) {
    plan_convolution();
  } else {
    plan_passes(radices);
  }
}

void RingFourier::plan_passes(const std::vector<std::pair<int, int>>& radices) {
  int stride = 1;
  for (const auto& [first, second] : radices) {
    const int radix = first * second;
    const int count = length_ / (stride * radix);
    Pass pass{first, second, count, stride, factors_.size(), 0, 0};
    append_twiddles(factors_, count, radix);
    pass.inner_twiddles = factors_.size();
    append_twiddles(factors_, second, first);
    pass.roots = factors_.size();
    for (int j = 0; j < first; ++j) append(factors_, root(j, first));
    passes_.push_back(pass);
    stride *= radix;
  }
}

// j k = (j^2 + k^2 - (k - j)^2) / 2, so X(k) = w(k) sum of (x(j) w(j)) conj w(k - j), w(n) = e^(-pi i n^2 / length):
// a convolution, done on a circle too long for its ends to meet.
void RingFourier::plan_convolution() {
  std::size_t padded = 1;
  // k - j runs from -(length - 1) to length - 1, 2 length - 1 values, which must not meet modulo `padded`.
  while (padded < 2 * static_cast<std::size_t>(length_)) padded *= 2;
  convolution_ = std::make_shared<const RingFourier>(static_cast<int>(padded));
  std::vector<Number> response(padded);
  for (int n = 0; n < length_; ++n) {
    // e^(-pi i n^2 / length) repeats when n^2 grows by 2 length: n^2 modulo that, in whole numbers, keeps the angle
    // exact.
    const std::int64_t square = std::int64_t{n} * n % (std::int64_t{2} * length_);
    const Number w = root(square, std::int64_t{2} * length_);
    append(chirp_, w);
    response[static_cast<std::size_t>(n)] = std::conj(w);
    if (n > 0) response[padded - static_cast<std::size_t>(n)] = std::conj(w);
  }
  transform_in_double(response);
  for (const Number& value : response) append(chirp_spectrum_, value / static_cast<double>(padded));
}

std::size_t RingFourier::scratch_floats() const noexcept {
  const auto own = static_cast<std::size_t>(length_) * kComplexFloats;
  return convolution_ ? 2 * convolution_->scratch_floats() : own;
}

float* RingFourier::transform(const FourierKernels& kernels, float* values, float* scratch) const noexcept {
  if (!convolution_) {
    for (const Pass& pass : passes_) {
      const float* const factors = factors_.data();
      kernels.run_fourier_pass({pass.radix, pass.second_radix, pass.count, pass.stride, factors + pass.twiddles,
                                factors + pass.inner_twiddles, factors + pass.roots},
                               values, scratch);
      std::swap(values, scratch);
    }
    return values;
  }
  const int padded = convolution_->length();
  float* const second = scratch + convolution_->scratch_floats();
  kernels.multiply_complex(values, kComplexFloats, chirp_.data(), length_, scratch);
  std::fill(scratch + std::ptrdiff_t{kComplexFloats} * length_, scratch + std::ptrdiff_t{kComplexFloats} * padded,
            0.0F);
  float* const spectrum = convolution_->transform(kernels, scratch, second);
  float* const other = spectrum == scratch ? second : scratch;
  kernels.multiply_complex(spectrum, kComplexFloats, chirp_spectrum_.data(), padded, spectrum);
  // The inverse transform is the forward one read backwards.
  float* const result = convolution_->transform(kernels, spectrum, other);
  // sum X(k) e^(+2 pi i n k / padded) is the transform of X at -n, which lies at padded - n; the division by `padded`
  // is in chirp_spectrum_.
  kernels.multiply_complex(result, 0, chirp_.data(), 1, values);
  kernels.multiply_complex(result + std::ptrdiff_t{kComplexFloats} * (padded - 1), -kComplexFloats, chirp_.data() + 2,
                           length_ - 1, values + kComplexFloats);
  return values;
}

std::size_t RingFourier::bytes() const noexcept {
  return sizeof(*this) + (factors_.size() + chirp_.size() + chirp_spectrum_.size()) * sizeof(float) +
         passes_.size() * sizeof(Pass) + (convolution_ ? convolution_->bytes() : 0);
}

int fast_even_length(int least) noexcept {
  for (int length = std::max(2, least + least % 2);; length += 2) {
    int rest = length;
    for (const int factor : {2, 3, 5}) {
      while (rest % factor == 0) rest /= factor;
    }
    if (rest == 1) return length;
  }
}

}  // namespace welkin::transforms
