#include "estimates/spectrum_errors.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "simd/kernels.h"
#include "specular/bright_texels.h"
#include "specular/cube_rings.h"
#include "specular/lobe.h"

namespace welkin::estimates {
namespace {

using specular::Spectrum;

constexpr std::size_t kMostBright = 256;  ///< as the prefilter's own
constexpr double kPi = std::numbers::pi;
constexpr int kMostRings = 2048;

/// Share of degree l that a cubic spline over `rings` rings loses half way between samples: a fit to the figures of
/// `specular::grid_for_bands` (6e-5 at an eighth, 2.8e-2 at a half, 0.24 at three quarters), each met within 15 %.
double spline_loss(int l, int rings) {
  const double x = static_cast<double>(l) / rings;
  return x * x * x * x * (0.24 + 0.2 * x + 0.65 * x * x);
}

/// Of order m's coefficients the squares of the six numbers that count; orders above 0 stand for two.
template <class Value>
std::vector<double> sum_squares(int bands, const Value& value) {
  std::vector<double> energies(static_cast<std::size_t>(bands));
  for (int m = 0; m < bands; ++m) {
    for (int l = m; l < bands; ++l) {
      double sum = 0.0;
      for (int k = 0; k < 6; ++k) {
        const double number = value(m, (l - m) * simd::kHarmonicFloats + k);
        sum += number * number;
      }
      energies[static_cast<std::size_t>(l)] += m == 0 ? sum : 2.0 * sum;
    }
  }
  return energies;
}

}  // namespace

std::vector<double> band_energies(const Spectrum& spectrum) {
  return sum_squares(spectrum.bands(), [&](int m, int k) { return static_cast<double>(spectrum.order(m)[k]); });
}

std::vector<double> difference_energies(const Spectrum& a, const Spectrum& b) {
  return sum_squares(std::min(a.bands(), b.bands()), [&](int m, int k) {
    return static_cast<double>(a.order(m)[k]) - static_cast<double>(b.order(m)[k]);
  });
}

namespace {

/// What is lost on `rows` rings, from twice as many, or from half where those would be too many. Edges between texels
/// are followed in steps of a ring: the loss falls with their number at least, so it is at most twice the difference
/// to twice as many, and at most the difference to half as many.
std::vector<double> ring_energies(const CubemapView& cube, int rows, const Spectrum& spectrum, const Control& quiet) {
  const bool finer = 2 * rows <= kMostRings;
  const LatLongImage other = specular::rings_of_cubemap(cube, finer ? 2 * rows : rows / 2, quiet);
  std::vector<double> lost = difference_energies(specular::analyse(other.view(), spectrum.bands(), quiet), spectrum);
  if (finer) {
    for (double& energy : lost) energy *= 4.0;
  }
  return lost;
}

}  // namespace

EnvironmentEnergies analyse_energies(const specular::CleanSource& source, const specular::PrefilterPlan& plan,
                                     int bands, const Control& control) {
  const Control quiet{control.stop, {}};
  EnvironmentEnergies energies;
  LatLongImage image;
  if (source.cubemap()) {
    image = specular::rings_of_cubemap(source.cube(), plan.rows_for_cubemap(source.columns()), quiet);
  } else {
    image = {source.columns(), source.rows(), {}};
    for (int row = 0; row < image.height; ++row)
      image.pixels.insert(image.pixels.end(), source.row(row), source.row(row) + std::ptrdiff_t{3} * image.width);
  }
  energies.spectrum = specular::analyse(image.view(), bands, quiet);
  energies.whole = band_energies(energies.spectrum);
  if (source.cubemap()) energies.rings = ring_energies(source.cube(), image.height, energies.spectrum, quiet);
  const specular::CleanSource clean(image.view(), {}, quiet);
  const auto bright = specular::find_bright_texels(clean, plan.least_alpha, kMostBright, quiet);
  if (bright.empty()) {
    energies.rest = energies.whole;
    return energies;
  }
  for (const specular::BrightTexel& texel : bright) {
    const auto place = 3 * (std::ptrdiff_t{texel.row} * image.width + texel.column);
    std::copy(texel.rest.begin(), texel.rest.end(), image.pixels.begin() + place);
  }
  energies.rest = band_energies(specular::analyse(image.view(), bands, quiet));
  return energies;
}

double blurred_rms(double alpha, std::span<const double> energies) {
  if (energies.empty()) return 0.0;
  const std::vector<double> lobe = specular::lobe_spectrum(alpha, static_cast<int>(energies.size()));
  double sum = 0.0;
  for (std::size_t l = 0; l < energies.size(); ++l) sum += lobe[l] * lobe[l] * energies[l];
  return std::sqrt(sum / (4.0 * kPi));
}

double spectral_mip_error(const specular::MipPlan& mip, const EnvironmentEnergies& energies) {
  const auto bands = static_cast<int>(energies.rest.size());
  const std::vector<double> lobe = specular::lobe_spectrum(mip.alpha, bands);
  const int rings = specular::grid_for_bands(mip.bands.bands()).rings;
  double sum = 0.0;
  for (int l = 0; l < bands; ++l) {
    const auto band = static_cast<std::size_t>(l);
    const double zonal = l < mip.bands.bands() ? mip.bands.zonal[band] : 0.0;
    const double truncated = lobe[band] - zonal;
    const double interpolated = zonal * spline_loss(l, rings);
    sum += (truncated * truncated + interpolated * interpolated) * energies.rest[band];
  }
  const double whole = blurred_rms(mip.alpha, energies.whole);
  if (whole == 0.0) return 0.0;
  return (std::sqrt(sum / (4.0 * kPi)) + blurred_rms(mip.alpha, energies.rings)) / whole;
}

}  // namespace welkin::estimates
