#include "reflections/prefilter_estimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>

#include "image/geometry.h"
#include "reflections/lobe.h"
#include "transform/transform_kernels.h"

namespace welkin::reflections {
namespace {

constexpr double kPi = std::numbers::pi;

/// Share of degree l that a cubic spline over `rings` rings loses half way between samples: a fit to the figures of
/// `transforms::grid_for_bands` (6e-5 at an eighth, 2.8e-2 at a half, 0.24 at three quarters), each met within 15 %.
double spline_loss(int l, int rings) {
  const double x = static_cast<double>(l) / rings;
  return x * x * x * x * (0.24 + 0.2 * x + 0.65 * x * x);
}

/// Of a mip's own root mean square error, over what the sums below say: for the picture's place among a mip's texels.
/// This and the shares are fits to `welkin_perf --estimates`, docs/reflections.md.
constexpr double kSafety = 1.8;
constexpr double kRingSafety = 2.5;     ///< the same of cubemaps, whose edges rings meet by chance
constexpr double kSplineMean = 0.5;     ///< of the loss half way between rings, over all places
constexpr double kSpreadOrder = 0.017;  ///< of (l h)^4, which points that are spread over rings of a `RingTable` lose
constexpr double kSpreadScattered = 0.001;  ///< of l h^2, by which those scatter
constexpr double kRounding = 2e-7;          ///< of float harmonics
constexpr double kTableRounding = 1.5e-7;   ///< of a `RingTable`'s weights where a lobe is three rings wide

/// Rings of height h that a cubemap was read on.
struct Rings {
  /// Share of degree l that is lost.
  [[nodiscard]] double lost(int l) const {
    const double phase = l * height;
    return kSpreadOrder * phase * phase * phase * phase;
  }
  [[nodiscard]] double scattered(int l) const { return kSpreadScattered * l * height * height; }

  /// Of even light by a lobe: a table's weights are floats, and few rings lie within a lobe.
  [[nodiscard]] double rounded(double alpha) const {
    const double rings = std::max(1.0, alpha / (3.0 * height));
    return kTableRounding / (rings * rings);
  }

  double height;
};

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

namespace {

/// Square of the error by what the spectrum knows, times 4 pi.
double spectral_square(const KernelFactors& factors, std::span<const double> energies,
                       const std::optional<Rings>& source) {
  const std::span<const double> lobe = factors.kernel;
  const auto bands = static_cast<int>(factors.zonal.size());
  const auto known = static_cast<int>(energies.size());
  const int rings = factors.rings;
  double tail = 0.0;
  for (int l = known - known / 4; l < known; ++l)
    tail += energies[static_cast<std::size_t>(l)] / std::max(1, known / 4);
  double sum = 0.0;
  double finer = 0.0;
  for (int l = static_cast<int>(lobe.size()); l < known; ++l) finer += energies[static_cast<std::size_t>(l)];
  for (int l = static_cast<int>(lobe.size()) - 1; l >= 0; --l) {
    const auto degree = static_cast<std::size_t>(l);
    const double zonal = l < bands ? factors.zonal[degree] : 0.0;
    const double truncated = lobe[degree] - zonal;
    const double interpolated = kSplineMean * zonal * spline_loss(l, rings);
    const double lost = source ? zonal * source->lost(l) : 0.0;
    const double energy = l < known ? energies[degree] : tail;
    sum += energy * (truncated * truncated + interpolated * interpolated + lost * lost);
    if (source) {
      const double scattered = zonal * source->scattered(l);
      sum += scattered * scattered * (2.0 * l + 1.0) * finer;
    }
    if (l < known) finer += energy;
  }
  return sum;
}

}  // namespace

namespace {

/// Rings of a source that is a cubemap.
std::optional<Rings> rings_of(const SpectralSource& source) {
  return source.face_size > 0 ? std::optional(Rings{kPi / source.rings}) : std::nullopt;
}

/// `rounding`: of the rings' weights.
double spectral_error(const KernelFactors& factors, const SpectralSource& source, double rounding, double of_lights,
                      double rms) {
  const std::optional<Rings> rings = rings_of(source);
  double square = spectral_square(factors, source.energies, rings) / (4.0 * kPi);
  square += of_lights * of_lights;
  return (rings ? kRingSafety : kSafety) * (kRounding + rounding + std::sqrt(square) / rms);
}

}  // namespace

double spectral_rms_error(const MipPlan& mip, const SpectralSource& source, double of_lights, double rms) {
  if (!(rms > 0.0)) return kRounding;
  const int bands = mip.bands.bands();
  const std::vector<double> lobe = lobe_spectrum(mip.alpha, bands + bands / 2);
  const std::optional<Rings> rings = rings_of(source);
  return spectral_error({lobe, mip.bands.zonal, transforms::grid_for_bands(bands).rings}, source,
                        rings ? rings->rounded(mip.alpha) : 0.0, of_lights, rms);
}

double spectral_rms_error(const KernelFactors& factors, const SpectralSource& source, double of_lights, double rms) {
  if (!(rms > 0.0)) return kRounding;
  return spectral_error(factors, source, source.face_size > 0 ? kTableRounding : 0.0, of_lights, rms);
}

double blurred_rms(std::span<const double> energies, std::span<const double> zonal) {
  double sum = 0.0;
  for (std::size_t l = 0; l < std::min(energies.size(), zonal.size()); ++l) sum += energies[l] * zonal[l] * zonal[l];
  return std::sqrt(sum / (4.0 * kPi));
}

double rms_of_level(const CubemapChain& chain, int level, int samples) {
  const int size = chain.level_size(level);
  const int step = (size + samples - 1) / samples;
  const auto angles = image::FaceSolidAngles::get(size);
  double squares = 0.0;
  double whole = 0.0;
  for (int row = step / 2; row < size; row += step) {
    for (int face = 0; face < 6; ++face) {
      const float* const values = chain.face(level, face) + std::ptrdiff_t{3} * size * row;
      for (int column = step / 2; column < size; column += step) {
        const double steradians = angles->at(row, column);
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
