#include "sky/air.h"

#include <algorithm>
#include <cmath>

#include "sky/density.h"

namespace welkin::sky {
namespace {

/// How far the exponent of a density may go within a shell: four Gauss nodes then integrate it to 2e-6.
constexpr double kLargestExponent = 1.5;
/// Densities below are too thin to be seen, whatever their slope.
constexpr double kThinnest = 1e-12;
constexpr std::size_t kMostShells = 160;

const DensityLayer& layer_at(const std::vector<DensityLayer>& layers, double altitude) {
  std::size_t layer = 0;
  double top = 0.0;
  while (layer + 1 < layers.size()) {
    top += layers[layer].thickness_m;
    if (altitude < top) break;
    ++layer;
  }
  return layers[layer];
}

double value_at(const std::vector<double>& values, std::size_t index) { return values.empty() ? 0.0 : values[index]; }

}  // namespace

Air::Air(const Atmosphere& atmosphere)
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
    const std::vector<double> own = density_breaks(matter->density, thickness_);
    breaks.insert(breaks.end(), own.begin(), own.end());
    for (const DensityLayer& layer : matter->density) {
      const double slope = std::abs(layer.exponential_scale_per_m);
      if (layer.exponential_term != 0.0 && slope * scale_height_ > 1.0) scale_height_ = 1.0 / slope;
    }
  }
  std::sort(breaks.begin(), breaks.end());
  shells_.push_back(0.0);
  for (std::size_t i = 1; i < breaks.size(); ++i) {
    // nearer than rounding can tell apart: one and the same
    if (breaks[i] > shells_.back() + 1e-12 * thickness_) divide(shells_.back(), breaks[i]);
  }
  shells_.back() = thickness_;
}

bool Air::matters(const Constituent& constituent) noexcept {
  const auto acts = [](const std::vector<double>& coefficients) {
    return std::any_of(coefficients.begin(), coefficients.end(), [](double value) { return value > 0.0; });
  };
  return !constituent.density.empty() && (acts(constituent.scattering_per_m) || acts(constituent.absorption_per_m));
}

// The steepest exponential that matters between two altitudes, 1/m: of densities that are not negligible at the lower
// end (falling ones) or at the upper (rising ones).
double Air::steepness(double low, double high) const noexcept {
  double steepest = 0.0;
  for (const Constituent* const matter : matter_) {
    if (!matters(*matter)) continue;
    const DensityLayer& layer = layer_at(matter->density, 0.5 * (low + high));
    const double slope = layer.exponential_scale_per_m;
    if (layer.exponential_term == 0.0) continue;
    const double here = density(matter->density, slope < 0.0 ? low : high);
    if (here > kThinnest) steepest = std::max(steepest, std::abs(slope));
  }
  return steepest;
}

// Steps up from the lower end while the air thins fast. (A density that grows upwards is cut as finely all the way.)
void Air::divide(double low, double high) {
  double at = low;
  while (shells_.size() < kMostShells) {
    const double step = kLargestExponent / std::max(steepness(at, high), 1e-300);
    if (!(at + 1.3 * step < high)) break;
    at += step;
    shells_.push_back(at);
  }
  shells_.push_back(high);
}

void Air::densities(double altitude, Amounts& amounts) const noexcept {
  amounts = {};
  for (std::size_t i = 0; i < matter_.size(); ++i) amounts[i] = density(matter_[i]->density, altitude);
}

double Air::scattering(std::size_t constituent, std::size_t wavelength) const noexcept {
  return value_at(matter_[constituent]->scattering_per_m, wavelength);
}

double Air::extinction(std::size_t constituent, std::size_t wavelength) const noexcept {
  return scattering(constituent, wavelength) + value_at(matter_[constituent]->absorption_per_m, wavelength);
}

double Air::albedo(std::size_t wavelength) const noexcept { return value_at(atmosphere_->ground_albedo, wavelength); }

}  // namespace welkin::sky
