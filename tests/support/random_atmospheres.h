// Seeded atmospheres over the whole range that `check` accepts: tiny and giant planets, from no air to a thousand times
// the Earth's, lobes of any sharpness.
#pragma once

#include "support/catch.h"
#include "support/trials.h"
#include "welkin/sky.h"

namespace welkin::test {

class RandomAtmospheres {
 public:
  explicit RandomAtmospheres(std::uint32_t seed) : engine_(seed) {}

  /// Returns a number in [0, 1).
  double number() { return static_cast<double>(engine_()) * 0x1p-32; }
  double between(double low, double high) { return low + (high - low) * number(); }
  /// Returns a number whose logarithm is uniform.
  double scale(double low, double high) { return low * std::pow(high / low, number()); }
  bool chance(double share) { return number() < share; }
  int whole(int low, int high) { return low + static_cast<int>(engine_() % static_cast<unsigned>(high - low + 1)); }

  Atmosphere next(int wavelengths = 3) {
    Atmosphere air;
    air.name = "random";
    count_ = static_cast<std::size_t>(wavelengths);
    air.wavelengths_nm.clear();
    for (int i = 0; i < wavelengths; ++i) {
      air.wavelengths_nm.push_back(wavelengths == 1 ? 550.0 : 380.0 + 400.0 * i / (wavelengths - 1));
    }
    if (chance(0.5)) std::reverse(air.wavelengths_nm.begin(), air.wavelengths_nm.end());
    air.bottom_radius_m = chance(0.3) ? between(3e6, 7e7) : scale(1.0, 1e9);
    const double thickness =
        chance(0.5) ? between(0.001, 0.1) * air.bottom_radius_m
                    : std::max(1e-9 * air.bottom_radius_m,
                               scale(std::min(1.0, 0.5 * air.bottom_radius_m), 9.99 * air.bottom_radius_m));
    air.top_radius_m = air.bottom_radius_m + thickness;
    thickness_ = air.top_radius_m - air.bottom_radius_m;
    if (chance(0.9)) air.rayleigh = constituent(true);
    if (chance(0.9)) air.aerosol = constituent(true);
    for (int i = whole(0, 2); i > 0; --i) air.absorbers.push_back(constituent(false));
    air.aerosol_phase = chance(0.5) ? AerosolPhase::cornette_shanks : AerosolPhase::henyey_greenstein;
    air.aerosol_asymmetry = chance(0.2) ? (chance(0.5) ? 0.999 : -0.8) : between(-0.8, 0.999);
    if (chance(0.8)) air.ground_albedo = values([this] { return chance(0.1) ? 1.0 : number(); });
    air.solar_irradiance = values([this] { return chance(0.05) ? 0.0 : scale(1e-3, 1e4); });
    air.sun_angular_radius_degrees = chance(0.2) ? 0.0 : scale(0.01, 10.0);
    // Uses a copy: later draws must not depend on it.
    RandomAtmospheres apart = *this;
    if (apart.chance(0.3)) air.aerosol_asymmetries = values([&] { return apart.between(-0.8, 0.999); });
    return air;
  }

 private:
  template <class Draw>
  std::vector<double> values(const Draw& draw) {
    std::vector<double> result(count_);
    for (double& value : result) value = draw();
    return result;
  }

  /// Vertical optical depths from almost zero to a thousand times the Earth's.
  std::vector<double> coefficients(double scale_height) {
    if (chance(0.1)) return {};
    const double depth = chance(0.1) ? 0.0 : scale(1e-6, 300.0);
    return values([&] { return std::min(1e5, depth / scale_height * between(0.3, 1.0)); });
  }

  Constituent constituent(bool scatters) {
    Constituent matter;
    const double scale_height = std::min(scale(10.0, 1e5), 10.0 * thickness_);
    double reach = std::min(scale_height, thickness_);
    switch (whole(0, 4)) {
      case 0:
        matter.density = tent_profile(number() * thickness_, std::max(scale(1e-3, 1.0) * thickness_, 1e-6));
        reach = thickness_;
        break;
      case 1: matter.density = layers(scale_height); break;
      default: matter.density = exponential_profile(scale_height); break;
    }
    if (scatters) matter.scattering_per_m = coefficients(reach);
    if (!scatters || chance(0.5)) matter.absorption_per_m = coefficients(reach);
    return matter;
  }

  /// Layers without restriction: slabs, formulas that leave 0 to 1 and come back, layers of no thickness.
  std::vector<DensityLayer> layers(double scale_height) {
    std::vector<DensityLayer> result(static_cast<std::size_t>(whole(1, 8)));
    for (DensityLayer& layer : result) {
      layer.thickness_m = chance(0.1) ? 0.0 : number() * 0.5 * thickness_;
      if (chance(0.7)) layer.exponential_term = between(-2.0, 2.0);
      layer.exponential_scale_per_m = (chance(0.8) ? -1.0 : 1.0) / scale_height;
      if (chance(0.5)) layer.linear_term_per_m = between(-2.0, 2.0) / thickness_;
      if (chance(0.5)) layer.constant_term = between(-1.0, 1.5);
    }
    return result;
  }

  std::mt19937 engine_;
  std::size_t count_ = 3;
  double thickness_ = 0.0;
};

}  // namespace welkin::test
