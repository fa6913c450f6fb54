#include "reflections/narrow.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "math/elementary.h"
#include "reflections/gaussian_kernels.h"
#include "reflections/lobe.h"

namespace welkin::reflections {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kMostBands = 1536;
constexpr int kLeastBands = 144;
constexpr double kBandsPerColumn = 0.75;    ///< of a whole turn's columns
constexpr double kBandsOfGaussians = 0.65;  ///< the same of lat-longs: the widest near Gaussian ends three texels away
constexpr double kEnd = 11.0;               ///< bands^2 / split: what lies beyond the last band is e^-11
constexpr double kEndOfGaussians = 9.5;     ///< the same of lat-longs
constexpr double kCut = 8.0;                ///< u at the near part's end: (1 + u) e^-u = 3.0e-3

int parts_of(int count, double wanted) { return std::max(1, static_cast<int>(std::ceil(wanted / count - 0.01))); }

}  // namespace

NarrowSplit split_for(bool cubemap, int columns, int rows) noexcept {
  NarrowSplit split;
  // texels that would fit a turn, along the axis on which they are small
  const double fine = cubemap ? kPi * columns : std::max<double>(columns, 2.0 * rows);
  const double wanted = fine * (cubemap ? kBandsPerColumn : kBandsOfGaussians);
  split.bands = std::clamp(8 * static_cast<int>(std::ceil(wanted / 8.0)), kLeastBands, kMostBands);
  if (!cubemap) {
    // the first Gaussian that is not far; the last that is holds e^-kEndOfGaussians at the last band
    split.largest_far = static_cast<double>(split.bands) * split.bands / kEndOfGaussians;
    split.split = math::exponential(kGaussianStep) * split.largest_far;
    split.columns = columns;
    split.rows = rows;
    return split;
  }
  const double along_face = std::max(fine, kLeastBands / kBandsPerColumn) / kPi;
  split.columns = columns * parts_of(columns, along_face);
  split.rows = rows * parts_of(rows, along_face);
  split.split = static_cast<double>(split.bands) * split.bands / kEnd;
  split.largest_far = split.split;
  split.reach = 2.0 * std::sqrt(kCut / split.split);
  return split;
}

double sharpest_far_lobe(const NarrowSplit& split) noexcept { return 1.0 / std::sqrt(split.largest_far); }

std::vector<double> far_part(bool cubemap, const NarrowSplit& split, double alpha, int bands) {
  return cubemap ? far_spectrum(alpha, split.split, bands) : gaussian_spectrum(alpha, split.split, bands);
}

transforms::GridSize grid_of_far_part(bool cubemap, const NarrowSplit& split) noexcept {
  // Gaussians leave little in the last bands for the spline to lose
  return cubemap ? transforms::grid_for_bands(split.bands) : transforms::grid_for_bands(split.bands, 1.2);
}

// The means over the texels of rings blur: band l loses (l pi / rows)^2 / 24, 1 % of the middle one at three rows a
// band, which a narrow lobe has little of.
int rows_for_far_part(int face_size, const NarrowSplit& split) noexcept {
  const double wanted = std::min(3.0 * split.bands, 2048.0);
  return 2 * face_size * std::max(1, static_cast<int>(std::ceil(wanted / (2.0 * face_size))));
}

double contrast_of(const projection::SanitizedSource& source) {
  double differences = 0.0;
  double squares = 0.0;
  for (int row = 0; row < source.rows(); ++row) {
    const bool face_ends = source.cubemap() && (row + 1) % source.columns() == 0;
    const float* const here = source.row(row);
    const float* const below = row + 1 < source.rows() && !face_ends ? source.row(row + 1) : here;
    double changed = 0.0;
    double own = 0.0;
    for (int k = 0; k < 3 * source.columns(); ++k) {
      const auto value = static_cast<double>(here[k]);
      const double across = k >= 3 ? value - static_cast<double>(here[k - 3]) : 0.0;
      const double down = value - static_cast<double>(below[k]);
      changed += across * across + down * down;
      own += value * value;
    }
    const double weight = source.cubemap() ? 1.0 : math::sine_cosine_of_turns(0.5 * (row + 0.5) / source.rows()).sine;
    differences += weight * changed;
    squares += weight * own;
  }
  return squares > 0.0 ? std::sqrt(differences / squares) : 0.0;
}

double narrow_error(const projection::SanitizedSource& source, double contrast, double alpha, int size) noexcept {
  constexpr double rounding = 4e-7;
  const double texels =
      alpha * std::max(1.0, source.columns() / 64.0);  // the lobe's width over a texel's, but for a factor
  const double of_contrast = source.cubemap() ? 4e-3 * alpha : 1.8e-3 * std::sqrt(texels * std::sqrt(texels));
  constexpr double moved = 0x1p-23;  // of a texel: see `clear_of_lines`
  double error = of_contrast;
  if (source.cubemap() && source.columns() % (2 * size) == 0) error += moved * 0.25 * kPi / source.columns() / alpha;
  return rounding + error * contrast;
}

}  // namespace welkin::reflections
