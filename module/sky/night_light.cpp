#include "sky/night_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "math/elementary.h"
#include "sky/air.h"
#include "sky/ray_nodes.h"
#include "sky/sky_geometry.h"
#include "sky/spectrum.h"

namespace welkin::sky {
namespace {

constexpr double kAirglowShare = 0.6;    // f; Patat 2003, table C.1
constexpr double kAirglowLayer = 130e3;  // H, m above the ground; Patat 2003, table C.1

/// A photometric band: what a star of magnitude 0 sends (Bessell 1979, as tabulated by J. Huchra, "Photometric
/// Systems"), and the dark sky over Paranal, magnitudes a square arcsecond (Patat 2003, abstract).
struct Band {
  double wavelength_nm;
  double zero_jansky;
  double sky_magnitude;
};

constexpr std::array<Band, 5> kBands{{{360.0, 1810.0, 22.3},    // U
                                      {440.0, 4260.0, 22.6},    // B
                                      {550.0, 3640.0, 21.6},    // V
                                      {640.0, 3080.0, 20.9},    // R
                                      {790.0, 2550.0, 19.7}}};  // I

/// Returns radiance per wavelength, in any unit. A jansky is per frequency: over the squared wavelength it is per that.
/// f_lambda = f_nu c / lambda^2, and a magnitude is a factor 10^(-2/5) = exp(-ln(10) / 2.5).
double band_radiance(const Band& band) {
  constexpr double magnitude = 0.921034037197618;  // ln(10) / 2.5
  return band.zero_jansky / (band.wavelength_nm * band.wavelength_nm) *
         math::exponential(-magnitude * (band.sky_magnitude - kBands[2].sky_magnitude));
}

/// Straight lines between the bands.
double spectrum(double wavelength_nm) {
  std::size_t i = 0;
  while (i + 2 < kBands.size() && wavelength_nm > kBands[i + 1].wavelength_nm) ++i;
  const double part = std::clamp(
      (wavelength_nm - kBands[i].wavelength_nm) / (kBands[i + 1].wavelength_nm - kBands[i].wavelength_nm), 0.0, 1.0);
  const double low = band_radiance(kBands[i]);
  return low + part * (band_radiance(kBands[i + 1]) - low);
}

/// Returns what each wavelength adds to the channels of the zenith's radiance as seen from the ground, scaled so that
/// its luminance, by the weights that fold spectra to colours, is the atmosphere's `night_zenith_luminance`.
std::vector<glm::dvec3> zenith_channels(const SkyTables& tables) {
  const std::vector<double>& wavelengths = tables.atmosphere.wavelengths_nm;
  const std::vector<glm::dvec3> folded = srgb_weights(wavelengths);
  double luminance = 0.0;
  for (std::size_t i = 0; i < wavelengths.size(); ++i) {
    const glm::dvec3& rgb = folded[i];  // luminance of linear sRGB: IEC 61966-2-1
    luminance += spectrum(wavelengths[i]) * (0.2126 * rgb.x + 0.7152 * rgb.y + 0.0722 * rgb.z);
  }
  const double scale = tables.atmosphere.night_zenith_luminance / luminance;
  std::vector<glm::dvec3> channels = channel_weights(tables.atmosphere, tables.options.colour);
  for (std::size_t i = 0; i < wavelengths.size(); ++i) channels[i] *= scale * spectrum(wavelengths[i]);
  return channels;
}

/// Returns optical depths of the air above an altitude, one per wavelength.
std::vector<double> depths_above(const Atmosphere& atmosphere, double altitude) {
  const AirModel air(atmosphere);
  RayPanels panels(air);
  const PerConstituent lengths = lengths_along(air, {altitude, 1.0, false, air.thickness() - altitude}, panels);
  std::vector<double> depths;
  for (std::size_t i = 0; i < atmosphere.wavelengths_nm.size(); ++i) {
    depths.push_back(optical_depth(air.extinctions(i), lengths));
  }
  return depths;
}

}  // namespace

NightLight::NightLight(const SkyTables& tables, double altitude_m) {
  const Atmosphere& atmosphere = tables.atmosphere;
  if (!(atmosphere.night_zenith_luminance > 0.0)) return;
  const double bottom = atmosphere.bottom_radius_m;
  const double layer = bottom + std::max(kAirglowLayer, atmosphere.top_radius_m - bottom);
  const std::vector<glm::dvec3> zenith = zenith_channels(tables);
  const std::vector<double> from_ground = depths_above(atmosphere, 0.0);
  const std::vector<double> above = depths_above(atmosphere, altitude_m);
  lowest_ = horizon_cosine(bottom, altitude_m);
  for (int node = 0; node < kNightNodes; ++node) {
    const double cosine = lowest_ + (1.0 - lowest_) * node / (kNightNodes - 1);
    // A line at the angle z from the zenith at radius r crosses the layer's sphere at an angle whose sine is b / layer,
    // b = r sin z. Its path there is 1 / cos of that angle times the vertical one. The air is given the same path
    // (Patat 2003).
    const double ratio = (bottom + altitude_m) / layer;
    const double path = 1.0 / std::sqrt(1.0 - ratio * ratio * std::max(0.0, (1.0 - cosine) * (1.0 + cosine)));
    glm::dvec3 rgb(0.0);
    for (std::size_t i = 0; i < zenith.size(); ++i) {
      rgb += zenith[i] * ((1.0 - kAirglowShare) + kAirglowShare * path) *
             math::exponential(from_ground[i] - above[i] * path);
    }
    for (int c = 0; c < 3; ++c) nodes_.push_back(static_cast<float>(std::max(rgb[c], 0.0)));
    nodes_.push_back(0.0F);
  }
  integrate();
}

glm::dvec3 NightLight::radiance(double zenith_cosine) const noexcept {
  if (nodes_.empty()) return glm::dvec3(0.0);
  const Between point = between((zenith_cosine - lowest_) / (1.0 - lowest_) * (kNightNodes - 1), kNightNodes);
  const float* const low = nodes_.data() + 4 * point.node;
  glm::dvec3 rgb;
  for (int c = 0; c < 3; ++c) {
    rgb[c] = static_cast<double>(low[c]) + point.part * (static_cast<double>(low[4 + c]) - static_cast<double>(low[c]));
  }
  return rgb;
}

// Midpoints: 1e-5 of it.
void NightLight::integrate() {
  constexpr int steps = 512;
  for (int k = 0; k < steps; ++k) {
    const double cosine = (k + 0.5) / steps;
    irradiance_ += 2.0 * std::numbers::pi * cosine / steps * radiance(cosine);
  }
}

}  // namespace welkin::sky
