// Dynamic range of projections: one texel from 1e-38 to the last float over a background of 1, halves, denormals.
#include <array>
#include <cmath>
#include <limits>

#include "report/stability/cases.h"
#include "report/stability/maps.h"
#include "report/stability/measures.h"
#include "welkin/directional_light.h"
#include "welkin/projection.h"

namespace welkin::report::stability {
namespace {

constexpr double kProjectionError = 5e-7;  ///< projection.h
constexpr int kSize = 32;
constexpr std::size_t kTexel = 2 * 32 * 32 + 5 * 32 + 29;  ///< on +Y, near an edge; on a lat-long south of the equator
constexpr float kLargest = std::numeric_limits<float>::max();

struct Value {
  const char* text;
  float value;
};

constexpr std::array<Value, 9> kValues{{{"1e-38", 1e-38F},
                                        {"1e-20", 1e-20F},
                                        {"1e-4", 1e-4F},
                                        {"1e4", 1e4F},
                                        {"1e8", 1e8F},
                                        {"1e20", 1e20F},
                                        {"1e30", 1e30F},
                                        {"1e38", 1e38F},
                                        {"3.4e38", kLargest}}};

template <class Image>
double projection_error(const Image& image) {
  return relative_error(project(image.view()).radiance, reference_projection(image.view()));
}

/// Of a uniform map against sqrt(4 pi) times its value.
template <class View>
double uniform_error(const View& view, double value) {
  return relative_error(project(view).radiance, constant_radiance(glm::dvec3(value), 3));
}

template <class Half>
CubemapView shared_faces(const Half& pixels, int size) {
  CubemapView view{{}, size, 0, PixelFormat::rgb_f16};
  view.faces.fill(pixels.data());
  return view;
}

double half_error(std::uint16_t half, double value) {
  const std::vector<std::uint16_t> face(std::size_t{3} * kSize * kSize, half);
  return uniform_error(shared_faces(face, kSize), value);
}

/// How wrong the light of the background is once that of the bright texel is known and subtracted.
double background_error(float value) {
  const CubemapImage map = with_texel(uniform_cube(kSize, 1.0F), kTexel, value);
  const CubemapImage texel = with_texel(uniform_cube(kSize, 0.0F), kTexel, value);
  const CubemapImage rest = with_texel(uniform_cube(kSize, 1.0F), kTexel, 0.0F);
  const SphericalHarmonics whole = project(map.view()).radiance;
  const SphericalHarmonics lone = reference_projection(texel.view());
  SphericalHarmonics difference(3);
  for (std::size_t k = 0; k < 9; ++k) difference.coefficients()[k] = whole.coefficients()[k] - lone.coefficients()[k];
  return relative_error(difference, reference_projection(rest.view()));
}

double background_error_without_sun(float value) {
  CubemapImage map = with_texel(uniform_cube(64, 1.0F), 2 * 64 * 64 + 20 * 64 + 29, value);
  if (!take_out_sun(map)) return std::numeric_limits<double>::infinity();
  return uniform_error(map.view(), 1.0);
}

void add_bright_texels(StabilityCases& cases) {
  for (const Value& v : kValues) {
    cases.push_back({std::string("range/cube-texel-") + v.text,
                     "three bands of a cubemap of 1 with one texel of " + std::string(v.text),
                     "reference_projection (double)", StabilityUnit::relative, kProjectionError, [v](const Control&) {
                       return projection_error(with_texel(uniform_cube(kSize, 1.0F), kTexel, v.value));
                     }});
    cases.push_back({std::string("range/lat-long-texel-") + v.text,
                     "three bands of a lat-long of 1 with one texel of " + std::string(v.text),
                     "reference_projection (double)", StabilityUnit::relative, kProjectionError, [v](const Control&) {
                       return projection_error(with_texel(uniform_lat_long(64, 32, 1.0F), 1500, v.value));
                     }});
  }
}

void add_backgrounds(StabilityCases& cases) {
  const std::string advice =
      "A float product has 24 bits: what is 1e7 times fainter than the brightest sum is lost beside it. Take the sun "
      "out "
      "first (take_out_sun) and give it to a directional light; then the rest is exact, whatever the sun was.";
  const auto add = [&](const char* text, float value, const std::string& remedy) {
    cases.push_back({std::string("range/background-under-") + text,
                     "the light of a background of 1 is still right under one texel of " + std::string(text),
                     "reference_projection of the background alone", StabilityUnit::relative, 1e-3,
                     [value](const Control&) { return background_error(value); }, remedy});
  };
  add("1e4", 1e4F, "");
  add("1e6", 1e6F, "");
  add("1e12", 1e12F, advice);
  cases.push_back({"range/background-without-sun-1e12",
                   "after take_out_sun a background of 1 is right, though the sun was 1e12", "closed form",
                   StabilityUnit::relative, kProjectionError,
                   [](const Control&) { return background_error_without_sun(1e12F); }});
}

void add_uniform(StabilityCases& cases) {
  const auto add = [&](const char* name, const char* what, double bound, std::function<double()> measure,
                       const std::string& advice = {}) {
    cases.push_back({name, std::string("three bands of ") + what, "closed form: sqrt(4 pi) times the value",
                     StabilityUnit::relative, bound, [measure](const Control&) { return measure(); }, advice});
  };
  add("range/half-largest", "the largest half, 65504, everywhere", kProjectionError,
      [] { return half_error(0x7BFF, 65504.0); });
  add("range/half-smallest-normal", "the smallest normal half, 2^-14", kProjectionError,
      [] { return half_error(0x0400, 0x1p-14); });
  add("range/half-smallest-denormal", "the smallest denormal half, 2^-24", kProjectionError,
      [] { return half_error(0x0001, 0x1p-24); });
  add("range/float-largest", "the largest float everywhere", kProjectionError,
      [] { return uniform_error(uniform_cube(kSize, kLargest).view(), kLargest); });
  add("range/float-largest-lat-long", "the largest float everywhere on a lat-long", kProjectionError,
      [] { return uniform_error(uniform_lat_long(64, 32, kLargest).view(), kLargest); });
  add("range/float-1e-30", "1e-30 everywhere", kProjectionError,
      [] { return uniform_error(uniform_cube(kSize, 1e-30F).view(), 1e-30F); });
  const std::string advice =
      "Radiance times a texel's solid angle falls below the normal floats and loses bits. Light that dark is no "
      "light; if it is meant, multiply the map by a power of two first and the coefficients by its inverse after.";
  add(
      "range/float-smallest-normal", "the smallest normal float, 2^-126", kProjectionError,
      [] { return uniform_error(uniform_cube(kSize, 0x1p-126F).view(), 0x1p-126); }, advice);
  add(
      "range/float-denormal", "a denormal float, 1e-40", kProjectionError,
      [] { return uniform_error(uniform_cube(kSize, 1e-40F).view(), 1e-40F); }, advice);
  add(
      "range/float-smallest-denormal", "the smallest denormal float, 2^-149", kProjectionError,
      [] { return uniform_error(uniform_cube(kSize, 0x1p-149F).view(), 0x1p-149); }, advice);
}

}  // namespace

void add_range_cases(StabilityCases& cases) {
  add_bright_texels(cases);
  add_backgrounds(cases);
  add_uniform(cases);
}

}  // namespace welkin::report::stability
