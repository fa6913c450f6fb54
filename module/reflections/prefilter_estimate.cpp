#include "reflections/prefilter_estimate.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "image/geometry.h"
#include "reflections/lobe.h"
#include "transform/transform_kernels.h"

namespace welkin::reflections {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kMostSamples = 32;  ///< along an edge of a face

/// Share of degree l that a cubic spline over `rings` rings loses half way between samples: a fit to the figures of
/// `transforms::grid_for_bands` (6e-5 at an eighth, 2.8e-2 at a half, 0.24 at three quarters), each met within 15 %.
double spline_loss(int l, int rings) {
  const double x = static_cast<double>(l) / rings;
  return x * x * x * x * (0.24 + 0.2 * x + 0.65 * x * x);
}

/// Share of degree l that the means over rings of height h = pi / rings lose at edges between a cube's texels, which
/// lie anywhere in a ring's texel; l (l + 1) h^2 / 24 is what a box of that width takes from the degree.
double ring_loss(int l, int rings) {
  if (rings == 0) return 0.0;
  const double height = kPi / rings;
  return l * (l + 1.0) * height * height / 24.0;
}

/// Share of the picture's finest detail that its steps across rings fold into a lobe, by measurement.
constexpr double kFolded = 1e-3;

}  // namespace

std::vector<double> energies_of(const transforms::Spectrum& spectrum) {
  std::vector<double> energies(static_cast<std::size_t>(spectrum.bands()), 0.0);
  for (int m = 0; m < spectrum.bands(); ++m) {
    const float* values = spectrum.order(m);
    const double times = m == 0 ? 1.0 : 2.0;  // the negative order has the same
    for (int l = m; l < spectrum.bands(); ++l, values += transforms::kHarmonicFloats) {
      double sum = 0.0;
      for (int k = 0; k < 6; ++k) sum += static_cast<double>(values[k]) * static_cast<double>(values[k]);
      energies[static_cast<std::size_t>(l)] += times * sum;
    }
  }
  return energies;
}

double spectral_rms_error(const MipPlan& mip, std::span<const double> energies, int source_rings) {
  const int bands = mip.bands.bands();
  const auto known = static_cast<int>(energies.size());
  const int last = bands + bands / 2;
  const std::vector<double> lobe = lobe_spectrum(mip.alpha, last);
  const int rings = transforms::grid_for_bands(bands).rings;
  double tail = 0.0;
  for (int l = known - known / 4; l < known; ++l)
    tail += energies[static_cast<std::size_t>(l)] / std::max(1, known / 4);
  double sum = 0.0;
  for (int l = 0; l < last; ++l) {
    const auto degree = static_cast<std::size_t>(l);
    const double zonal = l < bands ? mip.bands.zonal[degree] : 0.0;
    const double truncated = lobe[degree] - zonal;
    const double interpolated = zonal * spline_loss(l, rings);
    const double moved = zonal * ring_loss(l, source_rings);
    const double energy = l < known ? energies[degree] : tail;
    sum += energy * (truncated * truncated + interpolated * interpolated + moved * moved);
    if (source_rings > 0) sum += zonal * zonal * kFolded * kFolded * tail * (l + 0.5) / known;
  }
  return std::sqrt(sum / (4.0 * kPi));
}

double rms_of_level(const CubemapChain& chain, int level) {
  const int size = chain.level_size(level);
  const int step = (size + kMostSamples - 1) / kMostSamples;
  std::vector<double> angles(static_cast<std::size_t>(size));
  double squares = 0.0;
  double whole = 0.0;
  for (int row = step / 2; row < size; row += step) {
    image::cubemap_row_solid_angles(row, angles);
    for (int face = 0; face < 6; ++face) {
      const float* const values = chain.face(level, face) + std::ptrdiff_t{3} * size * row;
      for (int column = step / 2; column < size; column += step) {
        const double steradians = angles[static_cast<std::size_t>(column)];
        for (int c = 0; c < 3; ++c) {
          const auto value = static_cast<double>(values[3 * column + c]);
          squares += steradians * value * value;
        }
        whole += steradians;
      }
    }
  }
  return std::sqrt(squares / whole);
}

}  // namespace welkin::reflections
