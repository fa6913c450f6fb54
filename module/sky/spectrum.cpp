// Spectra folded to what the eye sees: linear sRGB luminances.
#include "sky/spectrum.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "welkin/sky.h"

namespace welkin::sky {
namespace {

constexpr double kFirst = 360.0;
constexpr double kStep = 5.0;
constexpr std::size_t kPoints = 95;
constexpr double kLast = kFirst + kStep * (kPoints - 1);
constexpr double kLumensPerWatt = 683.0;

// The CIE 1931 2-degree colour matching functions x, y, z at 360, 365, ... 830 nm: the CIE's table (ciexyz31 of the
// Colour and Vision Research Laboratory, cvrl.org). Between its points they are taken as linear, outside as 0.
using Spectrum = std::array<double, kPoints>;
constexpr Spectrum kMatchingX{
    0.0001299,    0.0002321,    0.0004149,    0.0007416,    0.001368,     0.002236,     0.004243,     0.00765,
    0.01431,      0.02319,      0.04351,      0.07763,      0.13438,      0.21477,      0.2839,       0.3285,
    0.34828,      0.34806,      0.3362,       0.3187,       0.2908,       0.2511,       0.19536,      0.1421,
    0.09564,      0.05795001,   0.03201,      0.0147,       0.0049,       0.0024,       0.0093,       0.0291,
    0.06327,      0.1096,       0.1655,       0.2257499,    0.2904,       0.3597,       0.4334499,    0.5120501,
    0.5945,       0.6784,       0.7621,       0.8425,       0.9163,       0.9786,       1.0263,       1.0567,
    1.0622,       1.0456,       1.0026,       0.9384,       0.8544499,    0.7514,       0.6424,       0.5419,
    0.4479,       0.3608,       0.2835,       0.2187,       0.1649,       0.1212,       0.0874,       0.0636,
    0.04677,      0.0329,       0.0227,       0.01584,      0.01135916,   0.008110916,  0.005790346,  0.004109457,
    0.002899327,  0.00204919,   0.001439971,  0.0009999493, 0.0006900786, 0.0004760213, 0.0003323011, 0.0002348261,
    0.0001661505, 0.000117413,  8.307527e-05, 5.870652e-05, 4.150994e-05, 2.935326e-05, 2.067383e-05, 1.455977e-05,
    1.025398e-05, 7.221456e-06, 5.085868e-06, 3.581652e-06, 2.522525e-06, 1.776509e-06, 1.251141e-06};
constexpr Spectrum kMatchingY{
    3.917e-06,  6.965e-06,  1.239e-05,  2.202e-05,  3.9e-05,   6.4e-05,    0.00012,    0.000217,   0.000396,
    0.00064,    0.00121,    0.00218,    0.004,      0.0073,    0.0116,     0.01684,    0.023,      0.0298,
    0.038,      0.048,      0.06,       0.0739,     0.09098,   0.1126,     0.13902,    0.1693,     0.20802,
    0.2586,     0.323,      0.4073,     0.503,      0.6082,    0.71,       0.7932,     0.862,      0.9148501,
    0.954,      0.9803,     0.9949501,  1,          0.995,     0.9786,     0.952,      0.9154,     0.87,
    0.8163,     0.757,      0.6949,     0.631,      0.5668,    0.503,      0.4412,     0.381,      0.321,
    0.265,      0.217,      0.175,      0.1382,     0.107,     0.0816,     0.061,      0.04458,    0.032,
    0.0232,     0.017,      0.01192,    0.00821,    0.005723,  0.004102,   0.002929,   0.002091,   0.001484,
    0.001047,   0.00074,    0.00052,    0.0003611,  0.0002492, 0.0001719,  0.00012,    8.48e-05,   6e-05,
    4.24e-05,   3e-05,      2.12e-05,   1.499e-05,  1.06e-05,  7.4657e-06, 5.2578e-06, 3.7029e-06, 2.6078e-06,
    1.8366e-06, 1.2934e-06, 9.1093e-07, 6.4153e-07, 4.5181e-07};
constexpr Spectrum kMatchingZ{
    0.0006061,    0.001086, 0.001946,    0.003486,    0.006450001, 0.01054999,  0.02005001, 0.03621, 0.06785001,
    0.1102,       0.2074,   0.3713,      0.6456,      1.0390501,   1.3856,      1.62296,    1.74706, 1.7826,
    1.77211,      1.7441,   1.6692,      1.5281,      1.28764,     1.0419,      0.8129501,  0.6162,  0.46518,
    0.3533,       0.272,    0.2123,      0.1582,      0.1117,      0.07824999,  0.05725001, 0.04216, 0.02984,
    0.0203,       0.0134,   0.008749999, 0.005749999, 0.0039,      0.002749999, 0.0021,     0.0018,  0.001650001,
    0.0014,       0.0011,   0.001,       0.0008,      0.0006,      0.00034,     0.00024,    0.00019, 0.0001,
    4.999999e-05, 3e-05,    2e-05,       1e-05};  // 0 from 650 nm on

struct Tristimulus {
  double x, y, z;
};

/// From X, Y, Z to linear sRGB: the inverse of what its primaries (Rec. 709) and white (D65: 0.3127, 0.3290) give, as
/// in `CSS Color 4`, section 10.4.
glm::dvec3 srgb(const Tristimulus& c) {
  return {3.2409699419045226 * c.x - 1.5373831775700939 * c.y - 0.4986107602930034 * c.z,
          -0.9692436362808796 * c.x + 1.8759675015077202 * c.y + 0.04155505740717559 * c.z,
          0.05563007969699366 * c.x - 0.20397695888897652 * c.y + 1.0569715142428786 * c.z};
}

Tristimulus matching(double wavelength) {
  const double position = (wavelength - kFirst) / kStep;
  const std::size_t below = std::min(static_cast<std::size_t>(std::max(position, 0.0)), kPoints - 2);
  const double part = position - static_cast<double>(below);
  const auto at = [&](const Spectrum& table) { return table[below] + part * (table[below + 1] - table[below]); };
  return {at(kMatchingX), at(kMatchingY), at(kMatchingZ)};
}

/// Where either the spectrum or a matching function bends, from 360 to 830 nm, rising.
std::vector<double> bends(const std::vector<double>& rising) {
  std::vector<double> positions;
  for (std::size_t i = 0; i < kPoints; ++i) positions.push_back(kFirst + kStep * static_cast<double>(i));
  for (const double wavelength : rising) {
    if (wavelength > kFirst && wavelength < kLast) positions.push_back(wavelength);
  }
  std::sort(positions.begin(), positions.end());
  return positions;
}

/// A piecewise linear spectrum, constant beyond its ends: shares of the two wavelengths about a position.
struct Shares {
  std::size_t below;
  double above_share;
};
Shares shares(const std::vector<double>& rising, double position) {
  if (position <= rising.front()) return {0, 0.0};
  if (position >= rising.back()) return {rising.size() - 2, 1.0};
  const auto above =
      static_cast<std::size_t>(std::upper_bound(rising.begin(), rising.end(), position) - rising.begin());
  return {above - 1, (position - rising[above - 1]) / (rising[above] - rising[above - 1])};
}

}  // namespace

// A spectrum that is linear between wavelengths is L(lambda) = Sum_i L_i hat_i(lambda), hat_i 1 at wavelength i and 0
// at all others, the first and the last constant beyond their ends. Colours are linear in it:
//   683 Int L M (x, y, z) dlambda = Sum_i L_i w_i,   w_i = 683 Int hat_i M (x, y, z) dlambda,
// M the matrix to sRGB. The weights are exact for such spectra, however few wavelengths there are.
std::vector<glm::dvec3> srgb_weights(const std::vector<double>& wavelengths_nm) {
  check_wavelengths(wavelengths_nm);
  std::vector<double> rising = wavelengths_nm;
  const bool falling = rising.front() > rising.back();
  if (falling) std::reverse(rising.begin(), rising.end());
  std::vector<glm::dvec3> weights(rising.size());
  const std::vector<double> positions = bends(rising);
  for (std::size_t i = 1; i < positions.size(); ++i) {
    const double width = positions[i] - positions[i - 1];
    if (!(width > 0.0)) continue;
    // Between two bends the integrand is the product of two lines: Gauss's rule of two points is exact, and has none
    // at the bends themselves.
    // The nodes are 1/2 -+ 1 / (2 sqrt(3)), with weights of 1/2: exact to degree 3.
    for (const double at : {0.21132486540518713, 0.78867513459481287}) {
      const double wavelength = positions[i - 1] + at * width;
      const glm::dvec3 value = 0.5 * width * kLumensPerWatt * srgb(matching(wavelength));
      const Shares share = shares(rising, wavelength);
      weights[share.below] += (1.0 - share.above_share) * value;
      weights[share.below + 1] += share.above_share * value;
    }
  }
  if (falling) std::reverse(weights.begin(), weights.end());
  return weights;
}

std::vector<glm::dvec3> channel_weights(const Atmosphere& atmosphere, SkyColour colour) {
  if (colour == SkyColour::linear_srgb) return srgb_weights(atmosphere.wavelengths_nm);
  return {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
}

ColourFold::ColourFold(const Atmosphere& atmosphere, SkyColour colour) : weights_(channel_weights(atmosphere, colour)) {
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    weights_[i] *= i < atmosphere.solar_irradiance.size() ? atmosphere.solar_irradiance[i] : 0.0;
    sunlight_ += weights_[i];
  }
  for (int c = 0; c < 3; ++c) sunlight_[c] = std::max(sunlight_[c], 0.0);
  set_asymmetries(atmosphere, colour);
}

void ColourFold::set_asymmetries(const Atmosphere& atmosphere, SkyColour colour) {
  asymmetries_.fill(atmosphere.aerosol_asymmetry);
  const std::vector<double>& given = atmosphere.aerosol_asymmetries;
  if (given.empty()) return;
  const auto [minimum, maximum] = std::minmax_element(given.begin(), given.end());
  for (std::size_t c = 0; c < 3; ++c) {
    double sum = 0.0;
    double scattered = 0.0;
    for (std::size_t i = 0; i < given.size() && i < atmosphere.aerosol.scattering_per_m.size(); ++i) {
      // The mean cosine is linear in the phase function, and is g for Henyey-Greenstein's: a channel's light of the
      // aerosol, Sum_i w_i S_i beta_i P_i, has Sum_i w_i S_i beta_i g_i / Sum_i w_i S_i beta_i (`weights_` hold w_i
      // S_i). Higher moments, g_i^l, are not matched. Negative weights of sRGB may carry the quotient beyond all g_i,
      // where it is clamped.
      const double weight = weights_[i][static_cast<glm::length_t>(c)] * atmosphere.aerosol.scattering_per_m[i];
      sum += weight * given[i];
      scattered += weight;
    }
    const double mean = scattered > 0.0 ? sum / scattered : 0.5 * (*minimum + *maximum);
    asymmetries_[c] = colour == SkyColour::spectral ? given[c] : std::clamp(mean, *minimum, *maximum);
  }
}

glm::dvec3 ColourFold::share(std::span<const double> values) const noexcept {
  glm::dvec3 sum{};
  for (std::size_t i = 0; i < values.size() && i < weights_.size(); ++i) sum += weights_[i] * values[i];
  for (int c = 0; c < 3; ++c) sum[c] = sunlight_[c] > 0.0 ? std::max(sum[c] / sunlight_[c], 0.0) : 0.0;
  return sum;
}

}  // namespace welkin::sky
