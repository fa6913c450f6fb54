// An environment's harmonics up to many hundred bands, and the way back to rings of latitude.
#pragma once

#include <complex>
#include <cstddef>
#include <span>

#include "image/sphere_grid.h"
#include "platform/memory.h"
#include "transform/image_rows.h"
#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::transforms {

/// The most bands of a spectrum.
inline constexpr int kMaximumSpectrumBands = 1536;

/// Coefficients of three channels for all l < bands and 0 <= m <= l, complex: a real function's negative orders follow.
/// f(theta, phi) = sum over l, m >= 0 of (m ? 2 : 1) Re(c(l, m) P(l, m)(cos theta) e^(i m phi)), with P orthonormal
/// ((l, m)'s complex harmonic is P e^(i m phi), Int |.|^2 = 1, no Condon-Shortley phase), theta from +y, phi from +z
/// towards +x: the longitude of `LatLongView`.
class Spectrum {
 public:
  Spectrum() = default;
  /// All zero. Throws `Error` (invalid_argument) unless 1 <= bands <= kMaximumSpectrumBands.
  explicit Spectrum(int bands);

  [[nodiscard]] int bands() const noexcept { return bands_; }
  [[nodiscard]] std::complex<double> value(int l, int m, int channel) const noexcept;
  [[nodiscard]] std::size_t bytes() const noexcept { return values_.bytes(); }

  /// Coefficients of order m: [bands - m][kHarmonicFloats], red, green and blue, each real and imaginary, and two
  /// that mean nothing; index i is l = m + i.
  [[nodiscard]] float* order(int m) noexcept { return values_.data() + start(m); }
  [[nodiscard]] const float* order(int m) const noexcept { return values_.data() + start(m); }

 private:
  [[nodiscard]] std::size_t start(int m) const noexcept;

  int bands_ = 0;
  platform::AlignedBuffer<float> values_;
};

/// Which rows and columns the transform sums.
enum class SourceRows {
  all,
  /// Where there are far more than the bands need, they are brought to fewer first, for a lobe whose spectrum falls to
  /// 1e-4 towards the last band: then noise of the source errs by 1e-5 after the lobe (row_reduction.h).
  fewer,
};

/// Projects a lat-long of finite rgb32f pixels (any size, any row stride), its texels taken as areas, exactly but for
/// rounding: about 1e-7 of the brightest texel's contribution. Texels must be below 1e30 in magnitude; those of at most
/// 1e-35 of the brightest may count as 0. Bits do not depend on threads or instruction set. Memory: 24 bytes per band
/// and row, in addition to the result. Throws `Error` (invalid_argument, cancelled).
[[nodiscard]] Spectrum analyse(const LatLongView& source, int bands, const Control& control,
                               SourceRows rows = SourceRows::all);
[[nodiscard]] Spectrum analyse(const ImageRows& source, int bands, const Control& control,
                               SourceRows rows = SourceRows::all);

/// Writes sum over l, m of zonal[l] c(l, m) Y(l, m) for l < zonal.size() to `grid` (made by the caller; columns >=
/// 2 zonal.size() - 1 and even, any number of rings), border filled, as samples or spline coefficients as the grid's
/// content says. 1 <= zonal.size() <= bands(). Throws `Error` (invalid_argument, cancelled).
void synthesise(const Spectrum& spectrum, std::span<const double> zonal, image::SphereGrid& grid,
                const Control& control);

/// Rings and columns of a grid: a fast size for `bands` bands, `oversampling` times the least (a ring for each band,
/// two columns a ring). What a cubic B-spline through the samples loses of degree l half way between four of them, as a
/// share of that degree, each way: 6e-5 for l = rings / 8, 1.2e-3 for rings / 4, 7e-3 for 3/8, 2.8e-2 for rings / 2,
/// 0.24 for 3/4; like (l / rings)^4. A lobe's last bands, at 4/3, are small enough for that; others may need more.
/// (A wave e^(i w k) on samples k has the spline coefficients 3 / (2 + cos w) times its values, and the B-spline half
/// way between samples is 23/48 at +-1/2 and 1/48 at +-3/2. So it comes back there as (23 cos(w / 2) + cos(3 w / 2)) /
/// 24 x 3 / (2 + cos w) of itself, and w = pi l / rings down the meridians.)
struct GridSize {
  int rings;
  int columns;

  friend bool operator==(const GridSize&, const GridSize&) = default;
};
[[nodiscard]] GridSize grid_for_bands(int bands, double oversampling = 4.0 / 3.0) noexcept;

}  // namespace welkin::transforms
