#include "reflections/narrow.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "math/elementary.h"
#include "reflections/cube_rings.h"
#include "transform/ring_fft.h"

namespace welkin::reflections {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kMostBands = 1024;
constexpr int kLeastBands = 120;
constexpr double kBandsTimesReach = 12.0;  ///< what the far part's polynomial was made for
constexpr double kTaper = 0.3;             ///< and the last share of the bands that are tapered
constexpr double kTexelsOfReach = 3.0;     ///< at least
constexpr double kBalance = 5.6;           ///< see `split_for`: measured

int parts_of(double texels_of_radian) {
  constexpr double least = kLeastBands * kTexelsOfReach / kBandsTimesReach;
  return std::max(1, static_cast<int>(std::ceil(least / texels_of_radian - 0.01)));
}

}  // namespace

// Rings lose 2 % of the middle band, which the far part has a twentieth of.
int far_rows_for_cubemap(const NearSplit& split) noexcept {
  return 2 * transforms::fast_even_length(std::max(64, split.bands * 3 / 4));
}

// With t texels in all, a mip's near part takes size^2 t / bands^2, and its far part bands^3.
NearSplit narrow_split(int columns, int rows, int size, double alpha) {
  NearSplit split{.size = size, .alpha = alpha};
  int parts = parts_of(0.5 * columns / (rows == 0 ? 1.0 : kPi));
  while (rows > 0 && columns * parts % 4 != 0) ++parts;
  split.face = columns * parts;
  split.rows = rows == 0 ? 0 : rows * parts_of(rows / kPi);
  const double texels = rows == 0 ? 6.0 * split.face * split.face : 1.0 * split.face * split.rows;
  const double wanted = kBalance * math::exponential(0.4 * math::logarithm(size * std::sqrt(texels / (4.0 * kPi))));
  const double of_radian = rows == 0 ? 0.5 * split.face : std::min(0.5 * split.face, 1.0 * split.rows) / kPi;
  const double most = kBandsTimesReach / kTexelsOfReach * of_radian;  // texels of a radian, where they are largest
  split.bands = std::clamp(8 * static_cast<int>(std::min(wanted, most) / 8.0), kLeastBands, kMostBands);
  split.reach = kBandsTimesReach / split.bands;
  return split;
}

SourceRows cut_rows(std::vector<const float*> source, int columns, const NearSplit& split) {
  const auto cut_rows = static_cast<std::size_t>(split.cubemap() ? 6 * split.face : split.rows);
  const int across = split.face / columns;
  const std::size_t down = cut_rows / source.size();
  if (across == 1 && down == 1) return {std::move(source)};
  SourceRows cut{{},
                 platform::AlignedBuffer<float>(std::size_t{3} * static_cast<std::size_t>(split.face) * source.size())};
  float* next = cut.owned.data();
  for (const float* const row : source) {
    cut.rows.insert(cut.rows.end(), down, next);
    for (int column = 0; column < split.face; ++column)
      next = std::copy_n(row + std::ptrdiff_t{3} * (column / across), 3, next);
  }
  return cut;
}

std::vector<double> tapered(const std::vector<double>& spectrum, int bands) {
  std::vector<double> taken(spectrum.begin(), spectrum.begin() + bands);
  for (int l = 0; l < bands; ++l) {
    const double place = (l + 0.5 - (1.0 - kTaper) * bands) / (kTaper * bands);
    if (place > 0.0) taken[static_cast<std::size_t>(l)] *= 0.5 + 0.5 * math::sine_cosine_of_turns(0.5 * place).cosine;
  }
  return taken;
}

double lost_of_far(const std::vector<double>& spectrum, const std::vector<double>& taken,
                   const std::vector<double>& energies, int rings) {
  constexpr double of_rings = 0.02;  // of (l h)^4, h a ring's height
  const std::size_t quarter = energies.size() / 4;
  double tail = 0.0;
  for (std::size_t l = energies.size() - quarter; l < energies.size(); ++l)
    tail += energies[l] / static_cast<double>(quarter);
  double sum = 0.0;
  for (std::size_t l = 0; l < spectrum.size(); ++l) {
    const double phase = rings > 0 ? kPi * static_cast<double>(l) / rings : 0.0;
    const double kept = 1.0 - std::min(1.0, of_rings * phase * phase * phase * phase);
    const double lost = spectrum[l] - (l < taken.size() ? kept * taken[l] : 0.0);
    sum += lost * lost * (l < energies.size() ? energies[l] : tail);
  }
  return std::sqrt(sum / (4.0 * kPi));
}

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

// All texels count alike, as their solid angles nearly do.
double contrast_of_faces(const std::vector<const float*>& rows, int columns) {
  Steps all;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const bool face_ends = (row + 1) % static_cast<std::size_t>(columns) == 0;
    const Steps own = steps_of(rows[row], face_ends ? rows[row] : rows[row + 1], rows[row], columns);
    all = {all.across + own.across, all.down + own.down};
  }
  return std::sqrt((all.across + all.down) / (static_cast<double>(rows.size()) * columns));
}

double contrast_of(const projection::SanitizedSource& source) {
  return source.cubemap() ? contrast_of_faces(rows_without({}, source).rows, source.columns())
                          : edges_of_lat_long(source);
}

double narrow_error(const projection::SanitizedSource& source, const NarrowMip& mip, double contrast) {
  constexpr double rounding = 4e-7;
  if (!(mip.rms > 0.0)) return rounding;
  constexpr double moved = 0x1p-23;  // of a texel: see `clear_of_lines`, and floats
  const NearSplit split = narrow_split(source.columns(), source.cubemap() ? 0 : source.rows(), mip.size, mip.alpha);
  double edges = 0.0;
  if (source.cubemap()) {
    const double texel = 0.5 * kPi / split.face;
    edges = (1.32e-3 + 0.36 * mip.alpha) * mip.alpha + moved * std::sqrt(texel / mip.alpha);
    if (source.columns() % (2 * mip.size) == 0) edges += 0.5 * moved * texel / mip.alpha;
  } else {
    const double texel = kPi / split.rows;
    edges = 3.3e-5 * std::sqrt(mip.alpha) + 4.0 * moved * texel / std::sqrt(mip.alpha);
  }
  // The largest relative error of texels' weights at any distance, which no sum of light exceeds.
  constexpr double of_weights = 9e-4;
  double steps = edges * contrast / mip.rms;
  if (!source.has_negatives()) steps = std::min(steps, of_weights);
  constexpr double of_far = 1e-6;     // of float harmonics
  constexpr double of_lights = 4e-4;  // of what the far part has of them
  constexpr double of_flanks = 1e-5;  // of their weights, where no texel of the mip may see more than their flanks
  constexpr double safety = 2.0;      // see `spectral_rms_error`
  return rounding + (mip.lights > 0.0 ? of_flanks : 0.0) + of_lights * mip.lights +
         (of_far * mip.far_rms + safety * mip.lost) / mip.rms + steps;
}

}  // namespace welkin::reflections
