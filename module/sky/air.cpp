#include "sky/air.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "math/basis.h"
#include "math/elementary.h"

namespace welkin::sky {
namespace {

/// How far the exponent of a density may go within a shell: four Gauss nodes then integrate it to 2e-6.
constexpr double kLargestExponent = 1.5;
/// Where lengths alone are wanted, a density that takes less than this fraction of the light all else takes is ignored.
constexpr double kFaint = 1e-6;
/// Densities below are too thin to be seen, whatever their slope.
constexpr double kThinnest = 1e-12;
constexpr std::size_t kMaxShells = 160;

const DensityLayer& layer_at(std::span<const DensityLayer> layers, double altitude) {
  std::size_t layer = 0;
  double top = 0.0;
  while (layer + 1 < layers.size()) {
    top += layers[layer].thickness_m;
    if (altitude < top) break;
    ++layer;
  }
  return layers[layer];
}

bool any_above_0(const std::vector<double>& coefficients) {
  return std::any_of(coefficients.begin(), coefficients.end(), [](double value) { return value > 0.0; });
}

double value_at(const std::vector<double>& values, std::size_t index) { return values.empty() ? 0.0 : values[index]; }

}  // namespace

AirModel::AirModel(const Atmosphere& atmosphere)
    : atmosphere_(&atmosphere),
      thickness_(atmosphere.top_radius_m - atmosphere.bottom_radius_m),
      scale_height_(thickness_) {
  matter_ = {&atmosphere.rayleigh, &atmosphere.aerosol};
  for (const Constituent& absorber : atmosphere.absorbers) {
    if (matters(absorber)) matter_.push_back(&absorber);
  }
  std::vector<double> breaks{0.0, thickness_};
  for (const Constituent* const matter : matter_) {
    if (!matters(*matter)) continue;
    const std::vector<double> ends = density_breaks(matter->density, thickness_);
    breaks.insert(breaks.end(), ends.begin(), ends.end());
    for (const DensityLayer& layer : matter->density) {
      const double slope = std::abs(layer.exponential_scale_per_m);
      // 1 / slope < scale_height_ without dividing by a slope of 0.
      if (layer.exponential_term != 0.0 && slope * scale_height_ > 1.0) scale_height_ = 1.0 / slope;
    }
  }
  std::sort(breaks.begin(), breaks.end());
  shells_ = cut_at(breaks, 0.0);
  length_shells_ = cut_at(breaks, kFaint);
}

bool scatters(const Constituent& constituent) noexcept {
  return !constituent.density.empty() && any_above_0(constituent.scattering_per_m);
}

bool matters(const Constituent& constituent) noexcept {
  return scatters(constituent) || (!constituent.density.empty() && any_above_0(constituent.absorption_per_m));
}

// Returns whether the others take so much more of the light there, at every wavelength, that its slope does not show.
bool AirModel::fainter(double share, std::size_t constituent, double altitude) const noexcept {
  for (std::size_t wavelength = 0; wavelength < atmosphere_->wavelengths_nm.size(); ++wavelength) {
    double others = 0.0;
    for (std::size_t i = 0; i < matter_.size(); ++i) {
      if (i != constituent) others += extinction(i, wavelength) * density(matter_[i]->density, altitude);
    }
    if (!(extinction(constituent, wavelength) * density(matter_[constituent]->density, altitude) < share * others)) {
      return false;
    }
  }
  return true;
}

// Returns the steepest exponential that matters between two altitudes, 1/m, among densities that are not negligible at
// the lower end (falling ones) or at the upper (rising ones). Exponents of several kinds of matter do not add up:
// Gauss's rule has to integrate each by itself, and the steepest decides.
double AirModel::steepness(double low, double high, double faint) const noexcept {
  double steepest = 0.0;
  for (std::size_t i = 0; i < matter_.size(); ++i) {
    const Constituent& matter = *matter_[i];
    if (!matters(matter)) continue;
    const DensityLayer& layer = layer_at(matter.density, 0.5 * (low + high));
    const double slope = layer.exponential_scale_per_m;
    if (layer.exponential_term == 0.0 || std::abs(slope) <= steepest) continue;
    const double where = slope < 0.0 ? low : high;
    if (density(matter.density, where) > kThinnest && !fainter(faint, i, where)) steepest = std::abs(slope);
  }
  return steepest;
}

// Steps up from the lower end of each stretch while the air thins fast. (A density that grows upwards is cut as finely
// all the way.)
std::vector<double> AirModel::cut_at(const std::vector<double>& breaks, double faint) const {
  std::vector<double> shells{0.0};
  for (std::size_t i = 1; i < breaks.size(); ++i) {
    // indistinguishable within rounding
    if (!(breaks[i] > shells.back() + 1e-12 * thickness_)) continue;
    double at = shells.back();
    while (shells.size() < kMaxShells) {
      const double step = kLargestExponent / std::max(steepness(at, breaks[i], faint), 1e-300);
      // A rest of less than 0.3 steps is left with the step before it: its exponent is at most 1.3 times
      // `kLargestExponent`, and no shell is so thin that its nodes would be wasted.
      if (!(at + 1.3 * step < breaks[i])) break;
      at += step;
      shells.push_back(at);
    }
    shells.push_back(breaks[i]);
  }
  shells.back() = thickness_;
  return shells;
}

std::vector<std::vector<DensityLayer>> AirModel::profiles() const {
  std::vector<std::vector<DensityLayer>> all;
  for (const Constituent* const matter : matter_) all.push_back(matter->density);
  return all;
}

void AirModel::densities(const std::array<double, 4>& altitudes,
                         std::array<PerConstituent, 4>& amounts) const noexcept {
  amounts = {};
  for (std::size_t i = 0; i < matter_.size(); ++i) {
    const std::vector<DensityLayer>& layers = matter_[i]->density;
    if (layers.size() != 1 || layers.front().exponential_term == 0.0) {
      for (std::size_t k = 0; k < 4; ++k) amounts[k][i] = density(layers, altitudes[k]);
      continue;
    }
    const DensityLayer& layer = layers.front();
    std::array<double, 4> falls;
    for (std::size_t k = 0; k < 4; ++k) falls[k] = layer.exponential_scale_per_m * std::max(altitudes[k], 0.0);
    math::exponentials(falls);
    for (std::size_t k = 0; k < 4; ++k) {
      const double rest = layer.linear_term_per_m * std::max(altitudes[k], 0.0) + layer.constant_term;
      amounts[k][i] = std::clamp(rest + layer.exponential_term * falls[k], 0.0, 1.0);
    }
  }
}

double AirModel::scattering(std::size_t constituent, std::size_t wavelength) const noexcept {
  return value_at(matter_[constituent]->scattering_per_m, wavelength);
}

double AirModel::extinction(std::size_t constituent, std::size_t wavelength) const noexcept {
  return scattering(constituent, wavelength) + value_at(matter_[constituent]->absorption_per_m, wavelength);
}

PerConstituent AirModel::extinctions(std::size_t wavelength) const noexcept {
  PerConstituent all{};
  for (std::size_t i = 0; i < matter_.size(); ++i) all[i] = extinction(i, wavelength);
  return all;
}

double AirModel::albedo(std::size_t wavelength) const noexcept {
  return value_at(atmosphere_->ground_albedo, wavelength);
}

namespace {

/// The layer's formula before it is clamped. Its terms are bounded by `check`, so that only the exponential can
/// overflow, and infinity is clamped like any large number.
double unclamped(const DensityLayer& layer, double altitude) noexcept {
  double value = layer.linear_term_per_m * altitude + layer.constant_term;
  // A term of 0 is left out: 0 times an overflown exponential is not a number.
  if (layer.exponential_term != 0.0) {
    value += layer.exponential_term * math::exponential(layer.exponential_scale_per_m * altitude);
  }
  return value;
}

/// Adds where the formula, monotone between `low` and `high`, passes `level`: by bisection, to the last bit.
void add_crossing(const DensityLayer& layer, double level, double low, double high, std::vector<double>& breaks) {
  const double first = unclamped(layer, low);
  const double last = unclamped(layer, high);
  const bool below = first < level;
  if ((last < level) == below || first == level || last == level) return;
  for (int i = 0; i < 1100; ++i) {
    const double middle = low + 0.5 * (high - low);
    if (!(middle > low && middle < high)) break;
    ((unclamped(layer, middle) < level) == below ? low : high) = middle;
  }
  breaks.push_back(high);
}

/// a s exp(s h) + l = 0: the formula is convex or concave, so it turns at most once.
/// s h = log(-l / (a s)); the formula's second derivative a s^2 exp(s h) has one sign.
double turning_point(const DensityLayer& layer) {
  const double ratio = -layer.linear_term_per_m / (layer.exponential_term * layer.exponential_scale_per_m);
  return ratio > 1e-300 && ratio < 1e300 ? math::logarithm(ratio) / layer.exponential_scale_per_m : -1.0;
}

void add_clamps(const DensityLayer& layer, double bottom, double top, std::vector<double>& breaks) {
  const double extremum = turning_point(layer);  // not finite or outside: monotone
  const double middle = extremum > bottom && extremum < top ? extremum : top;
  for (const double level : {0.0, 1.0}) {
    add_crossing(layer, level, bottom, middle, breaks);
    if (middle < top) add_crossing(layer, level, middle, top, breaks);
  }
}

}  // namespace

double density(std::span<const DensityLayer> layers, double altitude_m) noexcept {
  if (layers.empty()) return 0.0;
  const double altitude = std::max(altitude_m, 0.0);
  return density_of(layer_at(layers, altitude), altitude);
}

double density_of(const DensityLayer& layer, double altitude_m) noexcept {
  return std::clamp(unclamped(layer, altitude_m), 0.0, 1.0);
}

std::vector<double> density_breaks(std::span<const DensityLayer> layers, double thickness_m) {
  std::vector<double> breaks;
  double bottom = 0.0;
  for (std::size_t i = 0; i < layers.size() && bottom < thickness_m; ++i) {
    const bool last = i + 1 == layers.size();
    const double top = last ? thickness_m : std::min(thickness_m, bottom + layers[i].thickness_m);
    if (top > bottom) add_clamps(layers[i], bottom, top, breaks);
    if (!last) breaks.push_back(top);
    bottom = top;
  }
  std::sort(breaks.begin(), breaks.end());
  // A formula that reaches 0 or 1 where its layer ends may round to do so just before it.
  const auto same = [](double a, double b) { return b - a <= 1e-12 * b; };
  breaks.erase(std::unique(breaks.begin(), breaks.end(), same), breaks.end());
  std::erase_if(breaks, [&](double h) { return !(h > 0.0) || same(h, thickness_m) || h > thickness_m; });
  return breaks;
}

namespace {

constexpr double kSmallestMoment = 0.01;

/// Moments of the cosine times a function of moments chi, of which one is lost:
/// (2 l + 1) x P_l = (l + 1) P_(l+1) + l P_(l-1).
/// A function of the moments chi is Sum (2 l + 1) / (4 pi) chi_l P_l; its product with x is integrated against P_l with
/// the recurrence. Twice in a row loses two moments, which is why `aerosol_moments` starts with two more.
std::vector<double> times_cosine(const std::vector<double>& chi) {
  std::vector<double> moments(chi.size() - 1);
  for (std::size_t l = 0; l < moments.size(); ++l) {
    const auto degree = static_cast<double>(l);
    moments[l] = ((degree + 1.0) * chi[l + 1] + (l > 0 ? degree * chi[l - 1] : 0.0)) / (2.0 * degree + 1.0);
  }
  return moments;
}

}  // namespace

std::vector<double> aerosol_moments(const Atmosphere& atmosphere, double g, int bands) {
  std::vector<double> chi(static_cast<std::size_t>(bands) + 2);
  double power = 1.0;
  for (double& moment : chi) {
    moment = power;  // Henyey-Greenstein: g^l
    power *= g;
  }
  if (atmosphere.aerosol_phase == AerosolPhase::cornette_shanks) {
    const std::vector<double> squared = times_cosine(times_cosine(chi));
    // The integral of (1 + x^2) times Henyey-Greenstein's: 1 + (1 + 2 g^2) / 3 = 2 (2 + g^2) / 3, the inverse of
    // Cornette and Shanks' factor 3/2 / (2 + g^2).
    const double whole = chi[0] + squared[0];
    for (std::size_t l = 0; l < squared.size(); ++l) chi[l] = (chi[l] + squared[l]) / whole;
  }
  chi.resize(static_cast<std::size_t>(bands));
  return chi;
}

PhaseSpectrum phase_spectrum(const Atmosphere& atmosphere, double g) {
  PhaseSpectrum spectrum;
  spectrum.aerosol = aerosol_moments(atmosphere, g, kNarrowBands + 1);
  spectrum.narrow = spectrum.aerosol[kMaxSourceBands] > kNarrowForward;
  const int most = spectrum.narrow ? kNarrowBands : kMaxSourceBands;
  spectrum.bands = 3;
  while (spectrum.bands < most &&
         std::abs(spectrum.aerosol[static_cast<std::size_t>(spectrum.bands)]) > kSmallestMoment) {
    ++spectrum.bands;
  }
  if (atmosphere.aerosol.density.empty() || atmosphere.aerosol.scattering_per_m.empty()) spectrum.bands = 3;
  const double left_out = spectrum.aerosol[static_cast<std::size_t>(spectrum.bands)];
  spectrum.aerosol.resize(static_cast<std::size_t>(spectrum.bands));
  if (g > 0.0) {
    spectrum.forward = left_out;
    for (double& moment : spectrum.aerosol) moment = (moment - left_out) / (1.0 - left_out);
  } else if (spectrum.bands == kMaxSourceBands && std::abs(left_out) > kSmallestMoment) {
    // The window 1 - c sin^2((pi / 2) l / bands), c the moment at the cut: it is 1 at l = 0, so that no light is lost,
    // falls to 1 - c at the cut, and leaves lobes alone that are not cut by much.
    for (int l = 0; l < spectrum.bands; ++l) {
      const double cosine = math::sine_cosine_of_turns(0.25 * l / spectrum.bands).cosine;
      spectrum.aerosol[static_cast<std::size_t>(l)] *= 1.0 - std::abs(left_out) * (1.0 - cosine * cosine);
    }
  }
  return spectrum;
}

std::vector<PhaseSpectrum> phase_spectra(const Atmosphere& atmosphere, const std::array<double, 3>& asymmetries) {
  std::vector<PhaseSpectrum> spectra{phase_spectrum(atmosphere, asymmetries[0])};
  if (all_equal(asymmetries)) return spectra;
  for (std::size_t c = 1; c < 3; ++c) spectra.push_back(phase_spectrum(atmosphere, asymmetries[c]));
  const int bands = std::max({spectra[0].bands, spectra[1].bands, spectra[2].bands});
  for (PhaseSpectrum& spectrum : spectra) {
    spectrum.bands = bands;
    spectrum.aerosol.resize(static_cast<std::size_t>(bands));
  }
  return spectra;
}

double aerosol_asymmetry(const Atmosphere& atmosphere, std::size_t wavelength) noexcept {
  return atmosphere.aerosol_asymmetries.empty() ? atmosphere.aerosol_asymmetry
                                                : atmosphere.aerosol_asymmetries[wavelength];
}

double forward_share(const Atmosphere& atmosphere, double g, int orders) {
  return orders > 1 ? phase_spectrum(atmosphere, g).forward : 0.0;
}

std::vector<double> forward_shares(const Atmosphere& atmosphere, int orders) {
  std::vector<double> shares;
  for (std::size_t i = 0; i < atmosphere.wavelengths_nm.size(); ++i) {
    const double g = aerosol_asymmetry(atmosphere, i);
    const bool as_before = i > 0 && g == aerosol_asymmetry(atmosphere, i - 1);
    shares.push_back(as_before ? shares.back() : forward_share(atmosphere, g, orders));
  }
  return shares;
}

NarrowLobe narrow_lobe(const Atmosphere& atmosphere, int orders) {
  NarrowLobe lobe = NarrowLobe::none;
  if (!scatters(atmosphere.aerosol)) return lobe;
  for (std::size_t i = 0; orders > 1 && i < atmosphere.aerosol.scattering_per_m.size(); ++i) {
    const double g = aerosol_asymmetry(atmosphere, i);
    if (phase_spectrum(atmosphere, g).narrow) return NarrowLobe::forward;
    if (g < kNarrowBackward) lobe = NarrowLobe::backward;
  }
  return lobe;
}

double phase_of(const std::vector<double>& moments, double cosine) noexcept {
  return std::max(0.0, math::sum_of_degrees(moments, cosine));
}

AerosolLobe aerosol_lobe(const Atmosphere& atmosphere, double g, bool backwards) noexcept {
  constexpr double quarter_over_pi = 0.07957747154594767;  // 1 / (4 pi)
  // 1 + g^2 - 2 g nu = (1 - g)^2 + 2 g (1 - nu) = (1 + g)^2 - 2 g (1 + nu): the first has no cancellation where the
  // lobe is forward, the second where it is backward. A lobe that points away from the axis has a large gap and a
  // negative slope. Cornette and Shanks' 3 / (8 pi) / (2 + g^2) is 1.5 / (2 + g^2) times 1 / (4 pi).
  const double ahead = backwards ? -g : g;
  const bool cornette = atmosphere.aerosol_phase == AerosolPhase::cornette_shanks;
  AerosolLobe lobe{};
  lobe.factor = quarter_over_pi * (1.0 - g * g) * (cornette ? 1.5 / (2.0 + g * g) : 1.0);
  lobe.gap = (1.0 - ahead) * (1.0 - ahead);
  lobe.slope = 2.0 * ahead;
  lobe.even = cornette ? 1.0 : 0.0;
  return lobe;
}

}  // namespace welkin::sky
