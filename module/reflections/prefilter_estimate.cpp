#include "reflections/prefilter_estimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <string>

#include "image/geometry.h"
#include "platform/text.h"
#include "reflections/lobe.h"
#include "reflections/lobe_errors.h"
#include "reflections/ring_table.h"
#include "transform/transform_kernels.h"
#include "welkin/core.h"

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
constexpr double kFourthOrder = 0.07;   ///< of (l h)^4, which sharpened rings of height h lose of degree l
constexpr double kCrossed = 0.0125;     ///< of l (l + 1) h^2 at edges that rings cross at all places, by chance
constexpr double kScattered = 0.0042;   ///< of l h^2, by which such edges scatter finer degrees' energy to degree l
constexpr double kSpreadOrder = 0.012;  ///< of (l h)^4, which points that are spread over rings of a `RingTable` lose
constexpr double kSpreadScattered = 0.001;  ///< of l h^2, by which those scatter
constexpr double kRounding = 2e-7;          ///< of float harmonics
constexpr double kFiner = 2.5e-6;           ///< of texels so fine that none of the harmonics shows them
constexpr double kTableRounding = 5e-7;     ///< of a `RingTable`'s weights where a lobe is three rings wide

constexpr double kCoarse = 3.0;  ///< more of that where a lobe is narrower than three rings

constexpr double kSummedSafety = 2.4;  ///< of sums over the texels of faces up to 24, each of which is looked at
constexpr double kBlockSafety = 4.2;   ///< of larger ones, where an edge may lie between the places looked at
constexpr double kSumRounding = 4e-7;  ///< of float sums

/// Rings of height h that a cubemap was read on.
struct Rings {
  /// Share of degree l that is lost at edges.
  [[nodiscard]] double lost(int l) const {
    const double phase = l * height;
    const double of_fourth_order = fourth_order * phase * phase * phase * phase;
    const double of_edges = crossed * phase * phase;
    return std::sqrt(of_fourth_order * of_fourth_order + of_edges * of_edges);
  }
  [[nodiscard]] double scattered(int l) const { return scattering * l * height * height; }

  double height;
  double fourth_order;
  double crossed;
  /// Of even light by a lobe: a table's weights are floats, and few rings lie within a lobe.
  [[nodiscard]] double rounded(double alpha) const {
    const double rings = alpha / (3.0 * height);
    if (rings >= 1.0) return rounding / (rings * rings);
    return rounding * (1.0 + kCoarse / (rings * rings * rings * rings * rings));
  }

  double scattering;
  double rounding;
};

Rings rings_of(int rows, int face_size) {
  const double height = kPi / rows;
  if (RingTable::serves({face_size, rows})) return {height, kSpreadOrder, 0.0, kSpreadScattered, kTableRounding};
  return {height, kFourthOrder, kCrossed * std::sqrt(height * face_size / (0.5 * kPi)), kScattered, 0.0};
}

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
  return source.face_size > 0 ? std::optional(rings_of(source.rings, source.face_size)) : std::nullopt;
}

/// `rounding`: of the rings' weights.
double spectral_error(const KernelFactors& factors, const SpectralSource& source, double rounding, double of_lights,
                      double rms) {
  const std::optional<Rings> rings = rings_of(source);
  double square = spectral_square(factors, source.energies, rings) / (4.0 * kPi);
  square += of_lights * of_lights;
  const double least = kRounding + rounding + (source.finer ? kFiner : 0.0);
  return (rings ? kRingSafety : kSafety) * (least + std::sqrt(square) / rms);
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

/// What is left of a bound for the lights, and for texels that see less light than the whole sphere has.
constexpr double kOfBound = 0.8;

/// Returns a lower bound on the mean square over the sphere of texels that are blurred by `zonal`: each by itself, as
/// what they share is not negative, or all evenly spread.
double least_square(const std::vector<BrightTexel>& texels, std::span<const double> zonal) {
  double inverse_area = 0.0;  // of the lobe: Int k^2
  for (std::size_t l = 0; l < zonal.size(); ++l)
    inverse_area += (2.0 * static_cast<double>(l) + 1.0) * zonal[l] * zonal[l] / (4.0 * kPi);
  double sum = 0.0;
  for (const BrightTexel& texel : texels) {
    double light = 0.0;
    for (const float excess : texel.excess) light += static_cast<double>(excess) * static_cast<double>(excess);
    light *= texel.steradians * texel.steradians;
    sum += light / (1.0 / inverse_area + texel.steradians) / (4.0 * kPi);
  }
  const double mean = mean_excess(texels);
  return std::max(mean * mean, sum);
}

bool keeps_rms_error(const PrefilterPlan& plan, const SpectralSource& source, const std::vector<BrightTexel>& lights) {
  const ErrorBounds bounds = plan.tight();
  return std::all_of(plan.spectral_alphas.begin(), plan.spectral_alphas.end(), [&](double alpha) {
    MipPlan mip;
    mip.alpha = alpha;
    mip.bands = choose_bands(alpha, bounds, transforms::kMaximumSpectrumBands);
    const double rest = blurred_rms(source.energies, mip.bands.zonal);
    const double rms = std::sqrt(rest * rest + least_square(lights, mip.bands.zonal));
    const double error = spectral_rms_error(mip, source, 0.0, rms);
    return error <= kOfBound * plan.bounds.rms;
  });
}

double truncated_rms(const MipPlan& mip, std::span<const double> energies) {
  const int bands = mip.bands.bands();
  const std::vector<double> lobe = lobe_spectrum(mip.alpha, bands + bands / 2);
  double sum = 0.0;
  for (std::size_t l = 0; l < std::min(lobe.size(), energies.size()); ++l) {
    const double lost = lobe[l] - (l < mip.bands.zonal.size() ? mip.bands.zonal[l] : 0.0);
    sum += energies[l] * lost * lost;
  }
  return std::sqrt(sum / (4.0 * kPi));
}

void require_rms_error(double estimate, double rms_error, double roughness) {
  if (estimate <= rms_error) return;
  throw Error(ErrorCode::limit_exceeded, "rms_error " + platform::number_text(rms_error) +
                                             " cannot be kept on this picture: the mip of roughness " +
                                             platform::number_text(roughness) + " would err by an estimated " +
                                             platform::number_text(estimate) +
                                             "; raise rms_error to that, or take the reference method");
}

double spectral_rms_error(const KernelFactors& factors, const SpectralSource& source, double of_lights, double rms) {
  if (!(rms > 0.0)) return kRounding;
  return spectral_error(factors, source, source.face_size > 0 ? kTableRounding : 0.0, of_lights, rms);
}

double summed_rms_error(int face_size, double of_weights, double of_lights, double rms) {
  if (!(rms > 0.0)) return kSumRounding;
  const double safety = CubeBlocks(face_size).edge == 1 ? kSummedSafety : kBlockSafety;
  return kSumRounding + safety * std::sqrt(of_weights * of_weights + of_lights * of_lights) / rms;
}

double blurred_rms(std::span<const double> energies, std::span<const double> zonal) {
  double sum = 0.0;
  for (std::size_t l = 0; l < std::min(energies.size(), zonal.size()); ++l) sum += energies[l] * zonal[l] * zonal[l];
  return std::sqrt(sum / (4.0 * kPi));
}

double rms_of_level(const CubemapChain& chain, int level, int samples) {
  const int size = chain.level_size(level);
  const int step = (size + samples - 1) / samples;
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
