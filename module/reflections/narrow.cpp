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
#include "reflections/near_parts.h"
#include "transform/ring_fft.h"

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

// Rings lose 0.02 (l pi / rows)^4 of band l, 0.8 % of the middle one at two rows per band, which a narrow lobe has
// little of.
int rows_for_far_part(const NarrowSplit& split) noexcept { return 2 * transforms::fast_even_length(split.bands); }

namespace {

/// Sums of squares over rows.
struct Steps {
  double across = 0.0;
  double down = 0.0;
};

/// `below`: the next row, or `here` where there is none; `left`: what is left of the first texel.
Steps steps_of(const float* here, const float* below, const float* left, int columns) {
  Steps steps;
  for (int k = 0; k < 3 * columns; ++k) {
    const auto value = static_cast<double>(here[k]);
    const double across = value - static_cast<double>(k >= 3 ? here[k - 3] : left[k]);
    const double down = value - static_cast<double>(below[k]);
    steps.across += across * across;
    steps.down += down * down;
  }
  return steps;
}

/// All texels count alike, as their solid angles nearly do.
double contrast_of_cubemap(const projection::SanitizedSource& source) {
  Steps all;
  for (int row = 0; row < source.rows(); ++row) {
    const bool face_ends = (row + 1) % source.columns() == 0;
    const float* const here = source.row(row);
    const Steps own = steps_of(here, face_ends ? here : source.row(row + 1), here, source.columns());
    all = {all.across + own.across, all.down + own.down};
  }
  return std::sqrt((all.across + all.down) / (static_cast<double>(source.rows()) * source.columns()));
}

/// Edges of meridians are a row high at all latitudes, those of rows as long as their columns are wide.
double edges_of_lat_long(const projection::SanitizedSource& source) {
  const double columns_a_radian = source.columns() / (2.0 * kPi);
  const double rows_a_radian = source.rows() / kPi;
  double edges = 0.0;
  double whole = 0.0;
  for (int row = 0; row < source.rows(); ++row) {
    const bool last = row + 1 == source.rows();
    const float* const here = source.row(row);
    const Steps own = steps_of(here, last ? here : source.row(row + 1),
                               here + std::ptrdiff_t{3} * (source.columns() - 1), source.columns());
    const double middle = math::sine_cosine_of_turns(0.5 * (row + 0.5) / source.rows()).sine;
    const double end = math::sine_cosine_of_turns(0.5 * (row + 1.0) / source.rows()).sine;
    edges += columns_a_radian * own.across + rows_a_radian * end * own.down;
    whole += middle * source.columns();
  }
  return std::sqrt(edges / whole);
}

}  // namespace

double contrast_of(const projection::SanitizedSource& source) {
  return source.cubemap() ? contrast_of_cubemap(source) : edges_of_lat_long(source);
}

double narrow_error(const projection::SanitizedSource& source, const NarrowMip& mip, double contrast) {
  const bool cubemap = source.cubemap();
  const double rounding = cubemap ? 4e-7 : 2e-7;
  if (!(mip.rms > 0.0)) return rounding;
  double edges = 0.0;
  if (cubemap) {
    constexpr double moved = 0x1p-23;  // of a texel: see `clear_of_lines`
    edges = 4.5e-3 * mip.alpha;
    if (source.columns() % (2 * mip.size) == 0) edges += moved * 0.25 * kPi / source.columns() / mip.alpha;
  } else {
    edges = 1e-4 * std::sqrt(mip.alpha);  // of the step where a lobe is cut by an edge
  }
  // The largest relative error of texels' weights at any distance, which no sum of light exceeds.
  const double of_weights = cubemap ? 5e-3 : 5e-4;
  double lost = edges * contrast / mip.rms;
  if (!source.has_negatives()) lost = std::min(lost, of_weights);
  constexpr double of_far = 1e-6;  // of float harmonics
  return rounding + of_far * mip.far_rms / mip.rms + lost;
}

namespace {

/// The Gaussians from the split on: see `kGaussianStep`. Their weights are their integrals over the sphere; t + 2 in
/// place of t is the lobe's factor 1 - 2 s.
GaussianLobe gaussians_of(double split, double q) {
  constexpr double end = 14.0;  // t q: 1e-5 of the lobe lies beyond
  const double ratio = math::exponential(kGaussianStep);
  GaussianLobe lobe{};
  for (double t = split; lobe.count < GaussianLobe::kMost && (lobe.count == 0 || t * q < end); t *= ratio) {
    const double weight = kGaussianStep * t * t * math::exponential(-t * q) / (t + 2.0);
    lobe.root[lobe.count] = static_cast<float>(0.5 * std::sqrt(t + 2.0));
    lobe.weight[lobe.count] = static_cast<float>(0.25 * q * weight);
    ++lobe.count;
  }
  return lobe;
}

SplitLobe split_lobe(const NarrowSplit& split, double alpha) {
  const double square = alpha * alpha;
  const double rest = 1.0 - square;
  SplitLobe lobe{};
  lobe.width_squared = static_cast<float>(4.0 * square);
  lobe.split = static_cast<float>(split.split);
  lobe.offset = static_cast<float>(split.split * square / rest);
  lobe.far_scale = static_cast<float>(square * split.split * split.split / (4.0 * std::numbers::pi * rest * rest));
  return lobe;
}

}  // namespace

void add_near_parts(const projection::SanitizedSource& source, const NarrowSplit& split, double alpha, int size,
                    const std::array<float*, 6>& faces, const Control& control) {
  const double energy = 1.0 - far_part(source.cubemap(), split, alpha, 1).front();
  const NearPart part{source, split, energy, size, faces};
  if (source.cubemap()) {
    add_cubemap_near(part, split_lobe(split, alpha), control);
  } else {
    add_lat_long_near(part, gaussians_of(split.split, alpha * alpha / (1.0 - alpha * alpha)), control);
  }
}

}  // namespace welkin::reflections
