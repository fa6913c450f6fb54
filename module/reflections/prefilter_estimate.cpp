#include "reflections/prefilter_estimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>

#include "image/geometry.h"
#include "math/elementary.h"
#include "platform/text.h"
#include "reflections/lobe.h"
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

/// Ratio of a mip's own root mean square error to what the sums below say: for the image's position among its texels.
/// This and the shares are fits to `welkin_perf --estimates`, docs/maths/reflections.md. By their moments the shares of
/// `RingShares` lose 0.0114 (l h)^4, those of `halved_faces` 0.0073 (l h)^4 in the mean and 0.0089 root mean square.
constexpr double kSafety = 1.8;
constexpr double kRingSafety = 2.8;     ///< the same of cubemaps, whose edges rings meet by chance
constexpr double kSplineMean = 0.5;     ///< of the loss half way between rings, over all places
constexpr double kSpreadOrder = 0.012;  ///< of (l h)^4, which points that are spread over rings of a `RingTable` lose
constexpr double kSpreadScattered = 0.001;  ///< of l h^2, by which those scatter
constexpr double kHalvedOrder = 0.0085;     ///< of (l h)^4, what faces lose that are halved to texels of h
constexpr double kHalvedScattered = 0.03;   ///< of h, by which those scatter fine degrees
constexpr double kHalvedEdges = 0.02;       ///< of h^2, what texels next to edges gain or lose by it
constexpr double kNearWeights = 1e-5;       ///< of near sums, over the mip's own root mean square
constexpr double kNearTexels = 0.0028;      ///< of the contrast times h^2, which weights of texels of h err by
constexpr double kRounding = 2e-7;          ///< of float harmonics
constexpr double kFiner = 2.5e-6;           ///< of texels so fine that none of the harmonics shows them
constexpr double kFinerToTheEnd = 2e-5;     ///< the same where the last harmonics count as much as the first
constexpr double kTableRounding = 1.5e-7;   ///< of a `RingTable`'s weights where a lobe is three rings wide
constexpr double kCoarse = 3.0;             ///< more of that where a lobe is narrower than three rings

/// Rings of height h that a cubemap was read on.
struct RingLosses {
  /// Share of degree l that is lost.
  [[nodiscard]] double lost(int l) const {
    return std::min(1.0, kSpreadOrder * fourth_power(l * height) + kHalvedOrder * fourth_power(l * halved));
  }
  [[nodiscard]] double scattered(int l) const { return kSpreadScattered * l * height * height; }

  /// Returns the error of uniform light by a lobe: a table's weights are floats, and few rings lie within a lobe.
  [[nodiscard]] double rounded(double alpha) const {
    const double rings = alpha / (3.0 * height);
    if (rings >= 1.0) return kTableRounding / (rings * rings);
    return kTableRounding * (1.0 + kCoarse / (rings * rings * rings * rings * rings));
  }

  [[nodiscard]] static double fourth_power(double x) { return x * x * x * x; }

  double height;
  double halved;  ///< texels of the faces that it was read from, where those were halved first; 0: they were not
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

constexpr std::int64_t kMaxTexels = std::int64_t{1} << 19U;  ///< of an image that is summed

/// A wave of degree l that runs diagonally to texels h wide steps by 2 sin(l h / sqrt(8)) of itself from each to the
/// next, whose square is 8 sin^2(l h / sqrt(8)) / h^2 of it along both axes. Turns.
/// Its phase from texel to texel is l h / sqrt(2) along each axis, and |e^(i p) - 1| = 2 sin(p / 2): the energy's
/// squared gradient is 2 (2 sin(l h / sqrt(8)))^2 / h^2. l h / sqrt(8) radians are l h / (4 sqrt(2) pi) turns.
constexpr double kOfWave = 0.25 / (std::numbers::sqrt2 * kPi);

/// Sums of rows, column by column, as compilers make registers of those.
class ColumnSums {
 public:
  explicit ColumnSums(int columns)
      : steradians(std::size_t{3} * static_cast<std::size_t>(columns)),
        squares_(steradians.size()),
        steps_(steradians.size()) {}

  /// `below`: the next row, or the same. `narrow`: the width of the row's texels over their height. The square of the
  /// gradient times steradians is the square of steps between neighbours.
  void add(const float* here, const float* below, float narrow) {
    const std::size_t values = squares_.size();
    float* const squares = squares_.data();
    const float* const own = steradians.data();
    for (std::size_t k = 0; k < values; ++k) squares[k] += own[k] * (here[k] * here[k]);
    float* const steps = steps_.data();
    const float wide = 1.0F / narrow;
    for (std::size_t k = 0; k + 3 < values; ++k) {
      const float down = below[k] - here[k];
      const float across = here[k + 3] - here[k];
      steps[k] += narrow * (down * down) + wide * (across * across);
    }
  }
  void sum(ImageSums& sums) const {
    sums.energy = std::accumulate(squares_.begin(), squares_.end(), 0.0);
    sums.steps = std::accumulate(steps_.begin(), steps_.end(), 0.0);
  }

  std::vector<float> steradians;  ///< of a row's texels, for each channel

 private:
  std::vector<float> squares_;
  std::vector<float> steps_;
};

}  // namespace

ImageSums::ImageSums(const SourceRows& faces, int rings)
    : texel(std::sqrt(4.0 * kPi / 6.0) / faces.face()), ring(kPi / rings) {
  const int size = faces.face();
  if (std::int64_t{6} * size * size > kMaxTexels) return;
  const auto angles = image::FaceSolidAngles::get(size);
  ColumnSums sums(size);
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column)
      std::fill_n(&sums.steradians[3 * static_cast<std::size_t>(column)], 3,
                  static_cast<float>(angles->at(row, column)));
    const std::size_t next = row + 1 < size ? 1 : 0;
    for (int face = 0; face < 6; ++face) {
      const auto here = static_cast<std::size_t>(size * face + row);
      sums.add(faces.rows[here], faces.rows[here + next], 1.0F);
    }
  }
  sums.sum(*this);
}

ImageSums::ImageSums(const transforms::ImageRows& rows) : texel(kPi / rows.height) {
  if (std::int64_t{rows.width} * rows.height > kMaxTexels) return;
  ColumnSums sums(rows.width);
  for (int row = 0; row < rows.height; ++row) {
    const double own = image::lat_long_texel_solid_angle(rows.width, rows.height, row);
    std::fill(sums.steradians.begin(), sums.steradians.end(), static_cast<float>(own));
    sums.add(rows.row(row), rows.row(std::min(row + 1, rows.height - 1)), static_cast<float>(own / (texel * texel)));
  }
  sums.sum(*this);
}

EnergyBeyond ImageSums::beyond(std::span<const double> energies) const {
  constexpr double kSumsRounding = 2e-6;  // of all energy
  const RingLosses rings{ring, 0.0};
  double left = energy * (1.0 - kSumsRounding);
  double steps_left = steps;
  for (std::size_t l = 0; l < energies.size(); ++l) {
    const double kept = std::max(0.5, 1.0 - rings.lost(static_cast<int>(l)));
    const double own = energies[l] / (kept * kept);
    const double sine = math::sine_cosine_of_turns(kOfWave * texel * static_cast<double>(l)).sine;
    left -= own;
    steps_left -= own * 8.0 * sine * sine / (texel * texel);
  }
  if (!(left > 0.0)) return {};
  // sin^2(l h / sqrt(8)) of one wave that has all that is left of both
  const double square = std::clamp(0.125 * texel * texel * steps_left / left, 0.0, 1.0);
  const double turns = math::arc_sine(std::sqrt(square)) / (2.0 * kPi);
  // Energy that texels' steps alone make mirrors the degrees below at pi / texel.
  const auto known = static_cast<double>(energies.size());
  const double least = known > kPi / texel ? std::max(known, 0.5 * known + kPi / texel) : known;
  return {left, std::max(least, turns / (kOfWave * texel))};
}

namespace {

/// Returns how many degrees of a mip's lobe an estimate looks at. Other lobes than GGX fall so slowly that it must look
/// beyond the transform's `bands`.
int known_degrees(const MipPlan& mip, int bands) {
  const int own = mip.lobe->alpha() > 0.0 ? mip.bands.bands() : bands;
  return mip.lobe->last_band() > 0 ? mip.lobe->last_band() : own + own / 2;
}

}  // namespace

MipPlan with_far_part(MipPlan mip) {
  const std::vector<double>& far = NearTable::get(mip.near)->far();
  for (int l = 0; l < mip.near.bands; ++l)
    mip.bands.zonal[static_cast<std::size_t>(l)] = far[static_cast<std::size_t>(l)] * taper(l, mip.near.bands);
  return mip;
}

namespace {

/// Returns the energy of a degree beyond those that are known.
double tail_of(std::span<const double> energies) {
  const std::size_t quarter = std::max<std::size_t>(1, energies.size() / 4);
  double tail = 0.0;
  for (const double energy : energies.last(std::min(quarter, energies.size()))) tail += energy;
  return tail / static_cast<double>(quarter);
}

/// Returns the square of what near sums lose over faces that were halved: of the near part of each degree's lobe.
double near_square(const MipPlan& mip, const SpectralSource& source) {
  if (mip.near.face == 0 || mip.near.face >= source.face_size) return 0.0;
  const auto degrees = static_cast<int>(4.0 / mip.alpha);
  const std::vector<double> lobe = mip.lobe->spectrum(degrees);
  const std::vector<double>& far = NearTable::get(mip.near)->far();
  const double tail = tail_of(source.energies);
  double sum = 0.0;
  for (std::size_t l = 0; l < lobe.size(); ++l) {
    const double near = lobe[l] - (l < far.size() ? far[l] : 0.0);
    const double lost =
        near * std::min(1.0, kHalvedOrder * RingLosses::fourth_power(2.0 / mip.near.face * static_cast<double>(l)));
    sum += (l < source.energies.size() ? source.energies[l] : tail) * lost * lost;
  }
  return sum;
}

/// Square of the error by a wave that has what energy the image has beyond the known degrees, but for what `counted`
/// of them are taken to have: as it is where one finds an image of stripes or checkers, or texels that are wide for
/// the bands. Far out a lobe goes on as it fell at its end. A wide lobe falls more slowly there, as l^-2.5, and that of
/// roughness 1 is 0 at odd degrees, while stripes are seldom of one degree alone: it is the larger one of two.
double square_beyond(const EnergyBeyond& beyond, const MipPlan& mip, const std::vector<double>& lobe, double counted) {
  constexpr std::size_t kEnd = 8;
  constexpr double kWide = 0.5;
  const double energy = beyond.energy - counted;
  if (energy <= 0.0 || lobe.size() <= kEnd) return 0.0;
  const auto degree = static_cast<std::size_t>(beyond.degree);
  double value = lobe[std::min(degree, lobe.size() - 1)];
  if (mip.lobe->alpha() > kWide) {
    const std::vector<double> ends = mip.lobe->spectrum(static_cast<int>(degree) + 2);
    value = std::max(std::abs(ends[degree]), std::abs(ends[degree + 1]));
  } else if (degree >= lobe.size()) {
    // over each kEnd degrees the lobe falls by as much as over its last ones
    const double fall = std::min(1.0, std::abs(lobe.back()) / std::max(1e-30, std::abs(lobe[lobe.size() - 1 - kEnd])));
    value *=
        math::exponential(static_cast<double>(degree + 1 - lobe.size()) / kEnd * math::logarithm(std::max(1e-9, fall)));
  }
  return energy * value * value;
}

/// Returns the square of the error that the spectrum shows, times 4 pi.
double spectral_square(const MipPlan& mip, std::span<const double> energies, const EnergyBeyond& beyond,
                       const std::optional<RingLosses>& source) {
  const int bands = mip.bands.bands();
  const auto known = static_cast<int>(energies.size());
  const std::vector<double> lobe =
      mip.near.face > 0 ? NearTable::get(mip.near)->far() : mip.lobe->spectrum(known_degrees(mip, known));
  const int rings = mip.grid().rings;
  const double tail = tail_of(energies);
  double sum = 0.0;
  double finer = 0.0;
  for (int l = static_cast<int>(lobe.size()); l < known; ++l) finer += energies[static_cast<std::size_t>(l)];
  for (int l = static_cast<int>(lobe.size()) - 1; l >= 0; --l) {
    const auto degree = static_cast<std::size_t>(l);
    const double zonal = l < bands ? mip.bands.zonal[degree] : 0.0;
    const double truncated = lobe[degree] - zonal;
    const double interpolated = kSplineMean * zonal * spline_loss(l, rings);
    const double lost = source ? zonal * source->lost(l) : 0.0;
    const double energy = l < known ? energies[degree] : tail;
    sum += energy * (truncated * truncated + interpolated * interpolated + lost * lost);
    if (source) {
      const double scattered = zonal * source->scattered(l);
      const double of_texels = zonal * kHalvedScattered * source->halved;
      const double by_halving = of_texels * of_texels * tail / (2.0 * known);
      sum += (2.0 * l + 1.0) * (scattered * scattered * finer + by_halving);
    }
    if (l < known) finer += energy;
  }
  const auto counted = static_cast<double>(std::max(0, static_cast<int>(lobe.size()) - known));
  return sum + square_beyond(beyond, mip, lobe, counted * tail);
}

/// Error of a narrow mip's weights over its root mean square: a share of the steps that grows with alpha for
/// cubemaps and with its root for lat-longs, and the places of lines in floats, no more in all than the error of any
/// weight.
double error_of_weights(const MipPlan& mip, const SpectralSource& source, double rms) {
  constexpr double kMoved = 0x1p-23;  // of a texel: see `clear_of_lines`, and floats
  constexpr double kMax = 9e-4;
  double edges = 0.0;
  if (mip.near.cubemap()) {
    const double texel = 0.5 * kPi / mip.near.face;
    edges = (1.32e-3 + 0.36 * mip.alpha) * mip.alpha + kMoved * std::sqrt(texel / mip.alpha);
    if (source.face_size % (2 * mip.size) == 0) edges += 0.5 * kMoved * texel / mip.alpha;
  } else {
    const double texel = kPi / mip.near.rows;
    edges = 3.3e-5 * std::sqrt(mip.alpha) + 4.0 * kMoved * texel / std::sqrt(mip.alpha);
  }
  const double steps = edges * source.steps / rms;
  return 2.0 * kRounding + (source.negative ? steps : std::min(steps, kMax));
}

}  // namespace

double spectral_rms_error(const MipPlan& mip, const SpectralSource& source, double of_lights, double rms) {
  if (!(rms > 0.0)) return kRounding;
  const bool cube = source.face_size > 0;
  const RingLosses of_cube{cube ? kPi / source.rings : 0.0, source.halved};
  const std::optional<RingLosses> rings = cube ? std::optional(of_cube) : std::nullopt;
  const double square =
      (spectral_square(mip, source.energies, source.beyond, rings) + near_square(mip, source)) / (4.0 * kPi) +
      of_lights * of_lights;
  const double finer = mip.lobe->last_band() > 0 ? kFinerToTheEnd : kFiner;
  double rounding = kRounding + (source.finer ? finer : 0.0);
  if (mip.near.face > 0 && mip.method != MipMethod::near_far) {
    const double texel = 2.0 / mip.near.face;
    const double steps =
        std::sqrt(std::min(1.0, 1.0 * source.face_size / mip.near.face));  // parts of one differ by none
    rounding += kNearWeights + kNearTexels * texel * texel * steps * source.contrast / rms;
  }
  if (cube) {
    rounding += mip.lobe->alpha() > 0.0 ? of_cube.rounded(mip.ring_alpha()) : kTableRounding;
    rounding += kHalvedEdges * of_cube.halved * of_cube.halved;
  }
  if (mip.method != MipMethod::near_far) return (cube ? kRingSafety : kSafety) * (rounding + std::sqrt(square) / rms);
  constexpr double kFlanks = 1e-5;  // of lights' weights, where texels of the mip may see no more of them
  return kSafety * (mip.bands.zonal.front() * rounding + std::sqrt(square) / rms) + (of_lights > 0.0 ? kFlanks : 0.0) +
         error_of_weights(mip, source, rms);
}

namespace {

/// Returns what a lobe other than GGX makes of light beyond the degrees that `spectral_rms_error` looks at, as dense as
/// in the last quarter of the energies: root mean square over the sphere.
double error_beyond(const MipPlan& mip, std::span<const double> energies) {
  if (mip.lobe->last_band() > 0) return 0.0;
  const std::vector<double> known = mip.lobe->spectrum(known_degrees(mip, static_cast<int>(energies.size())));
  // Sum (2 l + 1) k_l^2 over all degrees is 4 pi Int k^2 (Parseval); `left` is that of the degrees beyond. A degree of
  // the energy `tail`, among the last known ones, has tail / (2 l + 1) per harmonic.
  double left = 4.0 * kPi * mip.lobe->square();
  for (std::size_t l = 0; l < known.size(); ++l) left -= (2.0 * static_cast<double>(l) + 1.0) * known[l] * known[l];
  const std::size_t quarter = std::max<std::size_t>(1, energies.size() / 4);
  double tail = 0.0;
  for (const double energy : energies.last(quarter)) tail += energy / static_cast<double>(quarter);
  return std::sqrt(std::max(0.0, left) * tail / (2.0 * static_cast<double>(known.size()) + 1.0) / (4.0 * kPi));
}

/// Gives a mip its lobe's first `bands` and returns the error that is estimated for them.
double error_of_bands(const SpectralSource& source, int bands, MipPlan& mip) {
  mip.bands.zonal = mip.lobe->spectrum(bands);
  for (int l = 0; l < bands && mip.lobe->last_band() == 0; ++l)
    mip.bands.zonal[static_cast<std::size_t>(l)] *= taper(l, bands);
  // Dark parts next to lights are to be right too.
  const double rest = blurred_rms(source.energies, mip.bands.zonal);
  return spectral_rms_error(mip, source, error_beyond(mip, source.energies), rest);
}

/// Chooses the bands of one mip: as few as keep its share of the bound. Returns the error that is estimated for them.
double choose_bands_of_lobe(const PrefilterPlan& plan, const SpectralSource& source, MipPlan& mip) {
  const int last = mip.lobe->last_band();
  int bands = last > 0 ? last : std::min(kMinLobeBands, plan.bands);
  for (;; bands = std::min(plan.bands, bands + std::max(kBandStep, bands / 16 / kBandStep * kBandStep))) {
    const double error = error_of_bands(source, bands, mip);
    if (last > 0 || bands >= plan.bands || error <= kOfLobeBound * plan.bounds.rms) return error;
  }
}

/// Returns the energies of `bands` degrees: beyond the known ones they go on as those fall from their third to their
/// last quarter.
std::vector<double> continued(std::span<const double> known, int bands) {
  const std::size_t quarter = std::max<std::size_t>(1, known.size() / 4);
  const double last = tail_of(known);
  const double third = tail_of(known.first(known.size() - quarter));
  constexpr double kQuarters = 0.33647;  // logarithm of 7 / 5, the ratio of their middles
  const double power =
      last > 0.0 && third > 0.0 ? std::clamp(math::logarithm(third / last) / kQuarters, -1.0, 3.0) : 0.0;
  std::vector<double> energies(known.begin(), known.end());
  const double middle = 0.875 * static_cast<double>(known.size());
  for (int l = static_cast<int>(known.size()); l < bands; ++l)
    energies.push_back(last * math::exponential(power * math::logarithm(middle / l)));
  return energies;
}

/// Returns the bands that a mip will take, more than the plan has. `source`: with the degrees beyond foreseen.
int foreseen_bands(PrefilterPlan plan, SpectralSource source, MipPlan mip) {
  const auto most = static_cast<int>(source.energies.size());
  for (int bands = plan.bands + plan.bands / 8;; bands += bands / 16) {
    plan.bands = std::min(most, (bands + kBandStep - 1) / kBandStep * kBandStep);
    if (source.face_size > 0) source.rings = plan.rows_for_cubemap();
    if (plan.bands == most || error_of_bands(source, plan.bands, mip) <= kOfLobeBound * plan.bounds.rms)
      return plan.bands;
  }
}

}  // namespace

int choose_bands_by_energy(PrefilterPlan& plan, SpectralSource source) {
  int wanted = plan.bands;
  const std::vector<double> energies =
      continued(source.energies, std::min(transforms::kMaximumSpectrumBands, 5 * plan.bands / 2));
  source.energies = energies;
  for (std::size_t level = 0; level < plan.spectral_lobes.size(); ++level) {
    MipPlan mip;
    mip.lobe = plan.spectral_lobes[level];
    mip.method = MipMethod::spectral;
    const double error = choose_bands_of_lobe(plan, source, mip);
    const bool ends = mip.lobe->last_band() > 0;
    if (!ends && error > kOfLobeBound * plan.bounds.rms) {
      if (plan.bands < transforms::kMaximumSpectrumBands) {
        wanted = std::max(wanted, foreseen_bands(plan, source, mip));
      } else if (error > plan.bounds.rms) {
        throw Error(ErrorCode::limit_exceeded,
                    "the kernel of mip " + std::to_string(level) + " is too narrow or has too sharp an edge: with " +
                        std::to_string(plan.bands) + " harmonic bands the mip errs by an estimated " +
                        platform::number_text(error) + ", and rms_error is " + platform::number_text(plan.bounds.rms) +
                        "; widen the kernel, raise rms_error, or use the reference method");
      }
    }
    for (MipPlan& made : plan.mips) {
      if (made.lobe == mip.lobe) made.bands = mip.bands;
    }
  }
  return wanted;
}

/// Returns a lower bound on the mean square over the sphere of texels that are blurred by `zonal`: each by itself, as
/// what they share is not negative, or all evenly spread.
double least_square(const std::vector<BrightTexel>& texels, std::span<const double> zonal) {
  // A light that is spread evenly over an area A has the integral of squares light^2 / A, and the lobe, 1 in all, is as
  // good as even over 1 / Int k^2. Blurred, a texel covers about both areas.
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

bool keeps_rms_error(const MipPlan& mip, double rms_error, const SpectralSource& source,
                     const std::vector<BrightTexel>& lights) {
  const MipPlan own = mip.near.face > 0 ? with_far_part(mip) : mip;
  const std::vector<double> whole = mip.near.face > 0 ? mip.lobe->spectrum(mip.near.bands) : mip.bands.zonal;
  const double rest = blurred_rms(source.energies, whole);
  const double rms = std::sqrt(rest * rest + least_square(lights, whole));
  return spectral_rms_error(own, source, 0.0, rms) <= kOfBound * rms_error;
}

double truncated_afar(const MipPlan& mip, std::span<const double> energies) {
  constexpr double kWide = 0.25;      // alpha of a lobe that is smooth enough for its kink alone to be left out
  constexpr double kOfNarrow = 40.0;  // of alpha^2, the share of narrower lobes' kinks in that of kWide
  constexpr double kAfar = 0.01;      // of what is left out of their middles
  const int bands = mip.bands.bands();
  const double tail = tail_of(energies);
  const auto lost_of = [&](const std::vector<double>& lobe) {
    double sum = 0.0;
    for (std::size_t l = 0; l < lobe.size(); ++l) {
      const double lost = lobe[l] * (1.0 - (static_cast<int>(l) < bands ? taper(static_cast<int>(l), bands) : 0.0));
      sum += (l < energies.size() ? energies[l] : tail) * lost * lost;
    }
    return std::sqrt(sum / (4.0 * kPi));
  };
  const int known = bands + bands / 2;
  const double own = lost_of(mip.near.face > 0 ? NearTable::get(mip.near)->far() : mip.lobe->spectrum(known));
  if (mip.alpha >= kWide) return own;
  return kAfar * own + std::min(1.0, kOfNarrow * mip.alpha * mip.alpha) * lost_of(lobe_spectrum(kWide, known));
}

void refuse_rms_error(double estimate, double rms_error, const std::string& what) {
  throw Error(ErrorCode::limit_exceeded, "rms_error " + platform::number_text(rms_error) +
                                             " cannot be kept on this image: " + what + " would err by an estimated " +
                                             platform::number_text(estimate) +
                                             "; raise rms_error to that, or use the reference method");
}

double blurred_rms(std::span<const double> energies, std::span<const double> zonal) {
  double sum = 0.0;
  for (std::size_t l = 0; l < std::min(energies.size(), zonal.size()); ++l) sum += energies[l] * zonal[l] * zonal[l];
  return std::sqrt(sum / (4.0 * kPi));
}

}  // namespace welkin::reflections
