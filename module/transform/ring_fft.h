// Fourier transforms of any length, of 16 complex signals at once.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "platform/memory.h"
#include "transform/transform_kernels.h"

namespace welkin::transforms {

/// X(k) = sum over i < length of x(i) e^(-2 pi i k / length): a plan and its tables. Prime factors up to 31 go by
/// Stockham passes (radices 8, 4, 2, 3 and 5 fast, others by their definition), lengths with larger ones by a
/// convolution of twice the length (Bluestein 1970).
class RingFourier {
 public:
  /// From a bounded cache. 1 <= length <= 65536.
  static std::shared_ptr<const RingFourier> get(int length);

  explicit RingFourier(int length);

  [[nodiscard]] int length() const noexcept { return length_; }

  /// Floats of scratch that `transform` needs.
  [[nodiscard]] std::size_t scratch_floats() const noexcept;

  /// Transforms values[length][kComplexFloats]; the result lies where the returned pointer says, in `values` or
  /// in `scratch` (both on cache lines), and what is left in the other is of no use. Error: some 3e-7 of the signal's
  /// root mean square.
  [[nodiscard]] float* transform(const FourierKernels& kernels, float* values, float* scratch) const noexcept;

  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  struct Pass {
    int radix;
    int second_radix;
    int count;
    int stride;
    std::size_t twiddles;  ///< where they begin in factors_
    std::size_t inner_twiddles;
    std::size_t roots;
  };

  void plan_passes(const std::vector<std::pair<int, int>>& radices);
  void plan_convolution();

  int length_;
  std::vector<Pass> passes_;
  std::vector<float> factors_;
  std::shared_ptr<const RingFourier> convolution_;  ///< of the padded length, if this length has a large prime factor
  std::vector<float> chirp_;                        ///< e^(-pi i n^2 / length)
  std::vector<float> chirp_spectrum_;               ///< of its conjugate, divided by the padded length
};

/// The smallest number >= `least` that is even and has no prime factors but 2, 3 and 5. `least` <= 2^29.
[[nodiscard]] int fast_even_length(int least) noexcept;

}  // namespace welkin::transforms
