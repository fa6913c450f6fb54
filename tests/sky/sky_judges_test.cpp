// The sky beside programs that nobody here wrote.
//
// CDISORT 2.1.3 (Stamnes et al. 1988, "Numerically stable algorithm for discrete-ordinate-method radiative transfer"),
// plane-parallel, 50 streams, 55 layers, intensity correction: molecules of scale height 8 km, aerosol of 1.2 km with a
// Henyey-Greenstein lobe, top at 60 km, the sun a point of irradiance 1. A planet of 1e9 m radius stands in for the
// plane. MYSTIC (Mayer 2009, "Radiative transfer in the cloudy atmosphere"; libRadtran, Monte Carlo in spherical shells
// over a ground of radius 6370 km): molecules alone, black ground, 550 nm.
#include <array>
#include <cmath>
#include <vector>

#include "support/catch.h"
#include "support/small_skies.h"
#include "welkin/sky.h"

namespace welkin {
namespace {

struct SunRow {
  double elevation;
  /// Diffuse irradiance on level ground; radiance 5, 30 and 60 degrees up, each towards the sun and opposite to it.
  std::array<double, 7> light;
};

struct Case {
  const char* name;
  double rayleigh_per_m;
  double aerosol_per_m;
  double absorption_per_m;  ///< of the aerosol
  double asymmetry;
  double ozone_per_m;  ///< at 25 km, the top of a tent from 10 to 40 km
  double albedo;
  double rms_percent;
  double largest_percent;
  std::array<SunRow, 4> suns;
};

// clang-format off
const Case cases[] = {
  {"Earth, clear", 3.0361781e-05, 0.00010580967, 5.5689302e-06, 0.7, 8.501668e-08, 0.1, 0.25, 0.7, {{
      {5, {0.037198, 0.048916, 0.015584, 0.021105, 0.015434, 0.0095479, 0.0084129}},
      {30, {0.15308, 0.21739, 0.064298, 0.23657, 0.038533, 0.051749, 0.02278}},
      {60, {0.19384, 0.10612, 0.069001, 0.096456, 0.040845, 0.18137, 0.032521}},
      {80, {0.20296, 0.082271, 0.071943, 0.061214, 0.047036, 0.092006, 0.04711}}}}},
  {"hazy", 1.2166106e-05, 0.00025333333, 1.3333333e-05, 0.7, 1.8809e-06, 0.1, 1.0, 2.0, {{
      {40, {0.20619, 0.20543, 0.039726, 0.37378, 0.025302, 0.13566, 0.018929}},
      {60, {0.24044, 0.11139, 0.046469, 0.1347, 0.029514, 0.35121, 0.028666}},
      {70, {0.24944, 0.088383, 0.050526, 0.088133, 0.033368, 0.269, 0.038093}},
      {80, {0.25452, 0.073289, 0.055802, 0.063001, 0.039255, 0.15123, 0.054579}}}}},
  {"dusty", 5.1379275e-06, 0.00037699146, 2.23639e-05, 0.752, 6.497166e-07, 0.1, 2.0, 4.0, {{
      {40, {0.26336, 0.22816, 0.031336, 0.62478, 0.020077, 0.19535, 0.016827}},
      {60, {0.3109, 0.11318, 0.039226, 0.16762, 0.025481, 0.70764, 0.028148}},
      {70, {0.32321, 0.086408, 0.043958, 0.10055, 0.030105, 0.46801, 0.039946}},
      {80, {0.3301, 0.069333, 0.049922, 0.066832, 0.037119, 0.21551, 0.061923}}}}},
  {"g 0.85, depth 0.3", 5.1379275e-06, 0.0002375, 1.25e-05, 0.85, 0.0, 0.3, 2.0, 4.0, {{
      {10, {0.090083, 1.4991, 0.020749, 0.14646, 0.010766, 0.014302, 0.0056055}},
      {30, {0.19973, 0.38832, 0.03798, 2.0702, 0.01376, 0.054574, 0.0082017}},
      {60, {0.25206, 0.1023, 0.053847, 0.099911, 0.017729, 1.5311, 0.015284}},
      {80, {0.26297, 0.074742, 0.062947, 0.037986, 0.023463, 0.14506, 0.032423}}}}},
  {"g 0.85, depth 1", 3.0361781e-05, 0.00079166667, 4.1666667e-05, 0.85, 0.0, 0.3, 3.0, 6.0, {{
      {10, {0.074156, 0.05899, 0.015144, 0.074572, 0.022548, 0.0231, 0.015748}},
      {30, {0.29127, 0.23841, 0.044942, 1.4769, 0.045413, 0.111, 0.032842}},
      {60, {0.50701, 0.12955, 0.072039, 0.21523, 0.061103, 2.0667, 0.055768}},
      {80, {0.56214, 0.10112, 0.085603, 0.10881, 0.076273, 0.30452, 0.097151}}}}},
  {"molecules, bright ground", 3.0361781e-05, 0.0, 0.0, 0.0, 0.0, 0.8, 0.25, 0.5, {{
      {10, {0.07883, 0.078104, 0.076752, 0.035606, 0.032071, 0.018866, 0.016567}},
      {30, {0.16008, 0.16086, 0.15471, 0.06981, 0.056173, 0.040903, 0.032165}},
      {60, {0.22897, 0.20372, 0.19666, 0.08946, 0.074325, 0.059353, 0.049688}},
      {80, {0.25002, 0.2098, 0.20694, 0.089656, 0.083573, 0.062379, 0.058497}}}}},
  {"molecules of depth 1, bright ground", 1.25e-04, 0.0, 0.0, 0.0, 0.0, 0.8, 0.4, 0.9, {{
      {10, {0.090477, 0.028336, 0.028298, 0.034549, 0.033196, 0.027576, 0.026098}},
      {30, {0.32217, 0.12628, 0.12466, 0.12614, 0.11321, 0.097492, 0.085821}},
      {60, {0.57168, 0.23532, 0.23195, 0.21201, 0.19179, 0.17091, 0.15367}},
      {80, {0.64866, 0.26459, 0.26309, 0.22893, 0.22029, 0.1884, 0.1811}}}}},
};
// clang-format on

Atmosphere flat(const Case& of) {
  Atmosphere air;
  air.solar_irradiance.assign(3, 1.0);
  air.sun_angular_radius_degrees = 0.0;
  air.bottom_radius_m = 1e9;
  air.top_radius_m = 1e9 + 6e4;
  air.rayleigh.density = exponential_profile(8000.0);
  air.rayleigh.scattering_per_m.assign(3, of.rayleigh_per_m);
  air.ground_albedo.assign(3, of.albedo);
  if (of.aerosol_per_m > 0.0) {
    air.aerosol.density = exponential_profile(1200.0);
    air.aerosol.scattering_per_m.assign(3, of.aerosol_per_m);
    air.aerosol.absorption_per_m.assign(3, of.absorption_per_m);
    air.aerosol_phase = AerosolPhase::henyey_greenstein;
    air.aerosol_asymmetry = of.asymmetry;
  }
  if (of.ozone_per_m > 0.0) {
    Constituent& ozone = air.absorbers.emplace_back();
    ozone.density = tent_profile(25'000.0, 15'000.0);
    ozone.absorption_per_m.assign(3, of.ozone_per_m);
  }
  return air;
}

}  // namespace

TEST_CASE("Skies are those of CDISORT, in haze and over bright ground", "[sky][tables][view][judges][truth]") {
  for (const Case& of : cases) {
    const SkyView view = test::sky_view_of(flat(of));
    double squares = 0.0;
    int count = 0;
    for (const SunRow& sun : of.suns) {
      CAPTURE(of.name, sun.elevation);
      const glm::dvec3 from = sun_direction(sun.elevation, 0.0);
      CHECK(std::abs(view.irradiance(from).x / sun.light[0] - 1.0) < 5e-3);
      for (std::size_t i = 0; i < 6; ++i) {
        const std::array<double, 3> elevations{5.0, 30.0, 60.0};
        const glm::dvec3 direction = sun_direction(elevations[i / 2], i % 2 == 0 ? 0.0 : 180.0);
        if (glm::dot(from, direction) > 0.996) continue;  // the aureole's core, 5 degrees
        const double percent = 100.0 * (view.radiance(direction, from).x / sun.light[1 + i] - 1.0);
        CAPTURE(i, percent);
        CHECK(std::abs(percent) < of.largest_percent);
        squares += percent * percent;
        ++count;
      }
    }
    CAPTURE(of.name);
    CHECK(std::sqrt(squares / count) < of.rms_percent);
  }
}

TEST_CASE("Molecules around a planet send the light that MYSTIC follows", "[sky][tables][view][judges][truth]") {
  struct Row {
    double sun, elevation, azimuth, radiance, deviation;
  };
  constexpr Row rows[] = {
      {60.0, 90.0, 0.0, 1.013500e-02, 2.35e-05},   {60.0, 10.0, 90.0, 2.948990e-02, 2.89e-05},
      {60.0, 5.0, 90.0, 4.344420e-02, 3.01e-05},   {30.0, 10.0, 0.0, 4.831440e-02, 4.40e-05},
      {30.0, 10.0, 180.0, 4.171960e-02, 3.88e-05}, {30.0, 5.0, 180.0, 6.495070e-02, 4.11e-05},
      {5.0, 90.0, 0.0, 4.287070e-03, 1.11e-05},    {5.0, 10.0, 0.0, 3.499190e-02, 3.35e-05},
      {5.0, 10.0, 180.0, 3.296550e-02, 3.16e-05},  {0.0, 90.0, 0.0, 1.850780e-03, 6.02e-06},
      {0.0, 10.0, 0.0, 1.525660e-02, 2.05e-05},    {0.0, 10.0, 180.0, 1.150550e-02, 1.60e-05},
      {-2.0, 90.0, 0.0, 6.842390e-04, 2.45e-06},   {-2.0, 30.0, 0.0, 2.316920e-03, 5.64e-06},
      {-2.0, 10.0, 0.0, 6.446960e-03, 9.90e-06},   {-2.0, 30.0, 180.0, 1.809190e-03, 4.79e-06},
      {-2.0, 10.0, 180.0, 2.505810e-03, 5.17e-06}, {-4.0, 90.0, 0.0, 1.373610e-04, 1.09e-06},
      {-4.0, 30.0, 0.0, 5.604750e-04, 2.76e-06},   {-4.0, 10.0, 0.0, 1.991970e-03, 5.69e-06},
      {-4.0, 30.0, 180.0, 2.655330e-04, 1.79e-06}, {-4.0, 10.0, 180.0, 1.523030e-04, 1.33e-06},
      {-6.0, 90.0, 0.0, 1.189640e-05, 3.29e-07},   {-6.0, 30.0, 0.0, 7.340550e-05, 9.74e-07},
      {-6.0, 10.0, 0.0, 4.432200e-04, 2.73e-06},   {-6.0, 30.0, 180.0, 1.455640e-05, 4.38e-07},
      {-6.0, 10.0, 180.0, 2.291650e-05, 6.03e-07}, {-9.0, 90.0, 0.0, 4.686370e-07, 8.96e-08},
      {-9.0, 30.0, 0.0, 1.578350e-06, 1.67e-07},   {-9.0, 10.0, 0.0, 1.461010e-05, 4.17e-07},
      {-9.0, 30.0, 180.0, 1.128190e-06, 1.36e-07}, {-9.0, 10.0, 180.0, 2.017300e-06, 1.88e-07},
  };
  Atmosphere air = flat(cases[5]);
  air.rayleigh.scattering_per_m.assign(3, 1.21661058e-05);
  air.bottom_radius_m = 6.37e6;
  air.top_radius_m = 6.43e6;
  air.ground_albedo.assign(3, 0.0);
  const SkyView view = test::sky_view_of(air);
  for (const Row& row : rows) {
    const double found = view.radiance(sun_direction(row.elevation, row.azimuth), sun_direction(row.sun, 0.0)).x;
    CAPTURE(row.sun, row.elevation, row.azimuth, found / row.radiance);
    CHECK(std::abs(found - row.radiance) < 0.01 * row.radiance + 3.0 * row.deviation);
  }
}

// Slabs of the literature, in the figures that DISORT 2's own test problems 1 to 3 hold for them: isotropic scattering
// (Van de Hulst 1980, "Multiple Light Scattering", table 12), molecules (Sweigart 1970, "Radiative transfer in
// atmospheres scattering according to the Rayleigh phase function with absorption") and a Henyey-Greenstein lobe of
// 0.75 (Van de Hulst, table 37). Garcia and Siewert's haze L and cloud C.1 have lobes by their moments, which no
// `AerosolPhase` is.
TEST_CASE("Slabs send the light of published tables", "[sky][tables][view][judges][truth]") {
  struct Slab {
    const char* name;
    double asymmetry;  ///< of an aerosol; 2: molecules
    double depth;
    double albedo;  ///< of single scattering
    double sun;     ///< sine of its elevation
    double light;   ///< sunlight on a surface that faces it
    double irradiance;
    std::array<double, 3> sines;     ///< of elevations, towards the sun
    std::array<double, 3> radiance;  ///< from there
    double percent;                  ///< bound on both
  };
  constexpr double kPi = 3.141592653589793;
  constexpr std::array<double, 3> kTenths{1.0, 0.5, 0.1};
  constexpr std::array<double, 3> kGauss{0.981986, 0.538263, 0.018014};
  const Slab slabs[] = {
      {"1a", 0.0, 0.03125, 0.2, 0.1, kPi / 0.1, 7.94108e-2, kTenths, {1.33826e-2, 2.63324e-2, 1.15898e-1}, 0.2},
      {"1b", 0.0, 0.03125, 1.0, 0.1, kPi / 0.1, 4.20233e-1, kTenths, {7.08109e-2, 1.39337e-1, 6.13458e-1}, 0.3},
      {"2a", 2.0, 0.2, 0.5, 0.080442, kPi, 4.41791e-2, kGauss, {7.71897e-3, 2.00778e-2, 2.57685e-2}, 0.6},
      {"2b", 2.0, 0.2, 1.0, 0.080442, kPi, 1.06123e-1, kGauss, {1.86027e-2, 4.64061e-2, 6.77603e-2}, 1.0},
      {"3a", 0.75, 1.0, 1.0, 1.0, kPi, 1.73849, kTenths, {3.05855, 2.66648e-1, 2.13750e-1}, 2.0},
  };
  for (const Slab& slab : slabs) {
    Case of = cases[5];
    const double all = slab.depth / (8000.0 * (1.0 - std::exp(-7.5)));  // its top at 60 km cuts a little
    of.rayleigh_per_m = 0.0;
    of.albedo = 0.0;
    Atmosphere air = flat(of);
    Constituent& matter = slab.asymmetry > 1.0 ? air.rayleigh : air.aerosol;
    matter.density = exponential_profile(8000.0);
    matter.scattering_per_m.assign(3, slab.albedo * all);
    matter.absorption_per_m.assign(3, (1.0 - slab.albedo) * all);
    air.aerosol_phase = AerosolPhase::henyey_greenstein;
    air.aerosol_asymmetry = slab.asymmetry > 1.0 ? 0.0 : slab.asymmetry;
    air.solar_irradiance.assign(3, slab.light);
    const SkyView view = test::sky_view_of(air);
    const auto degrees = [](double sine) { return glm::degrees(std::asin(sine)); };
    const glm::dvec3 sun = sun_direction(degrees(slab.sun), 0.0);
    CAPTURE(slab.name, view.irradiance(sun).x / slab.irradiance);
    CHECK(std::abs(view.irradiance(sun).x / slab.irradiance - 1.0) < 0.01 * slab.percent);
    for (std::size_t i = 0; i < 3; ++i) {
      const double found = view.radiance(sun_direction(degrees(slab.sines[i]), 0.0), sun).x;
      CAPTURE(slab.sines[i], found / slab.radiance[i]);
      CHECK(std::abs(found / slab.radiance[i] - 1.0) < 0.01 * slab.percent);
    }
  }
}

TEST_CASE("What thick air over bright ground sends of further orders is estimated", "[sky][tables][view][truth]") {
  Case thick = cases[6];
  thick.rayleigh_per_m = 2.0 / 8000.0;
  thick.albedo = 0.9;
  const auto view_of = [&](int orders, bool exact) {
    return test::sky_view_of(
        flat(thick),
        {.heights = 16, .view_zeniths = 32, .sun_zeniths = 32, .orders = orders, .truncate_orders = exact});
  };
  const SkyView all = view_of(64, true);
  for (const int orders : {2, 4, 8}) {
    const SkyView estimated = view_of(orders, false);
    for (const double sun : {5.0, 30.0, 80.0}) {
      CAPTURE(orders, sun);
      const glm::dvec3 from = sun_direction(sun, 0.0);
      CHECK(std::abs(estimated.irradiance(from).x / all.irradiance(from).x - 1.0) < 5e-3);
      CHECK(std::abs(estimated.radiance({0.0, 1.0, 0.0}, from).x / all.radiance({0.0, 1.0, 0.0}, from).x - 1.0) < 5e-3);
    }
  }
}

}  // namespace welkin
