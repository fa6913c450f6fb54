// Dynamic range of pictures: mips, resampling, irradiance and prefiltered cubemaps.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "report/stability/cases.h"
#include "report/stability/maps.h"
#include "report/stability/measures.h"
#include "welkin/directional_light.h"
#include "welkin/irradiance_cubemap.h"
#include "welkin/mip_chain.h"
#include "welkin/resampling.h"
#include "welkin/specular.h"

namespace welkin::report::stability {
namespace {

constexpr float kLargest = std::numeric_limits<float>::max();
constexpr std::size_t kTexel = 2 * 32 * 32 + 13 * 32 + 9;
constexpr double kUniformUlps = 8.0;  ///< specular.h: 1e-6

double worst_ulps(std::span<const float> values, double truth) {
  double worst = 0.0;
  for (const float value : values) worst = worse(worst, float_ulps(value, truth));
  return worst;
}

double mips_ulps(float value) {
  const CubemapChain chain = build_mips(uniform_cube(31, value).view());
  double worst = 0.0;
  for (int level = 0; level < chain.levels(); ++level) {
    for (const glm::dvec3& texel : texels(chain, level)) worst = worse(worst, float_ulps(texel.x, value));
  }
  return worst;
}

/// Texels of a prefiltered mip and their truths: every fifth and the brightest.
struct Blurred {
  std::vector<glm::dvec3> found;
  std::vector<glm::dvec3> truth;
};

template <class Image>
Blurred blurred(const Image& source, double roughness) {
  PrefilterOptions options{.size = 8};
  options.roughness = {roughness};
  const std::vector<glm::dvec3> all = texels(prefilter_specular(source.view(), options).cubemap, 0);
  const std::vector<glm::dvec3> all_directions = texel_directions(8);
  const auto brightest = std::max_element(all.begin(), all.end(), [](auto& a, auto& b) { return a.x < b.x; });
  std::vector<glm::dvec3> found{*brightest};
  std::vector<glm::dvec3> directions{all_directions[static_cast<std::size_t>(brightest - all.begin())]};
  for (std::size_t k = 0; k < all.size(); k += 5) {
    found.push_back(all[k]);
    directions.push_back(all_directions[k]);
  }
  return {found, reference_specular(source.view(), roughness, directions)};
}

CubemapImage bright_cube(float value) { return with_texel(uniform_cube(32, 1.0F), kTexel, value); }
LatLongImage bright_lat_long(float value) { return with_texel(uniform_lat_long(128, 64, 1.0F), 2500, value); }
LatLongImage dark_lat_long(float factor) {
  return with_texel(uniform_lat_long(128, 64, factor), 2500, 100.0F * factor);
}

double worst_error(const Blurred& mip) { return worst_relative_error(mip.found, mip.truth); }
double rms_of(const Blurred& mip) { return rms_error(mip.found, mip.truth); }

/// The largest error over the brightest texel.
double error_of_peak(const Blurred& mip) {
  double peak = 0.0;
  double worst = 0.0;
  for (std::size_t k = 0; k < mip.truth.size(); ++k) {
    peak = std::max(peak, mip.truth[k].x);
    worst = worse(worst, std::abs(mip.found[k].x - mip.truth[k].x));
  }
  return worst / peak;
}

double error_without_sun(double roughness) {
  CubemapImage map = with_texel(noise_cube(64, 12), std::size_t{2} * 64 * 64 + 20 * 64 + 29, 1e8F);
  if (!take_out_sun(map)) return std::numeric_limits<double>::infinity();
  return worst_error(blurred(map, roughness));
}

double prefilter_uniform_ulps(float value, PrefilterMethod method) {
  PrefilterOptions options{.size = 8};
  options.roughness = {0.0, 0.3, 1.0};
  options.method = method;
  const PrefilteredSpecular result = prefilter_specular(uniform_lat_long(32, 16, value).view(), options);
  double worst = 0.0;
  for (int level = 0; level < 3; ++level) {
    for (const glm::dvec3& texel : texels(result.cubemap, level)) worst = worse(worst, float_ulps(texel.y, value));
  }
  return worst;
}

double irradiance_cubemap_ulps(float value) {
  const SphericalHarmonics irradiance = irradiance_from_radiance(constant_radiance(glm::dvec3(value), 3));
  return worst_ulps(irradiance_cubemap(irradiance, 4).pixels, value * 3.14159265358979323846);
}

std::string name_of(const char* what, const std::string& value) {
  return "image-range/" + std::string(what) + "-" + value;
}

std::string kept(const std::string& map, const std::string& value) {
  return map + " of " + value + " stays what it is";
}

void add_uniform(StabilityCases& cases) {
  constexpr std::array<std::pair<const char*, float>, 4> values{
      {{"1e-40", 1e-40F}, {"1", 1.0F}, {"65504", 65504.0F}, {"3.4e38", kLargest}}};
  for (const auto& [text, value] : values) {
    const auto add = [&cases, word = std::string(text)](const char* what, const std::string& promise, double bound,
                                                        std::function<double()> measure) {
      cases.push_back({name_of(what, word),
                       kept(promise, word),
                       "closed form: the value",
                       StabilityUnit::ulps,
                       bound,
                       [measure](const Control&) { return measure(); },
                       {}});
    };
    add("mips", "every mip of a uniform cubemap", 1.0, [value = value] { return mips_ulps(value); });
    add("to-cubemap", "a cubemap resampled from a uniform lat-long", 0.0,
        [value = value] { return worst_ulps(to_cubemap(uniform_lat_long(37, 19, value).view(), 11).pixels, value); });
    add("prefilter-automatic", "a prefiltered uniform lat-long", kUniformUlps,
        [value = value] { return prefilter_uniform_ulps(value, PrefilterMethod::automatic); });
    add("prefilter-sampled", "a uniform lat-long prefiltered by samples", kUniformUlps,
        [value = value] { return prefilter_uniform_ulps(value, PrefilterMethod::sampled); });
  }
}

struct Lobe {
  const char* text;
  double roughness;
};
constexpr std::array<Lobe, 2> kLobes{{{"0.3", 0.3}, {"0.8", 0.8}}};

/// One texel over a background of 1: the dark side's own digits, the mip as a whole, the light's.
void add_bright_texels(StabilityCases& cases) {
  const std::string dark =
      "Floats keep some 1e-7 of the brightest light everywhere, and the points that stand for its texel cross the "
      "lobe's horizon one by one: what is a millionth of the light or darker has no digits of its own beside it. Take "
      "the light out first (take_out_sun), give it to a directional light and prefilter the rest; or use method "
      "reference.";
  const std::string rings =
      "A cubemap goes by rings twice as fine as its texels, whose means blur a lone texel a little: 0.6 % where the "
      "lobe is no wider than some texels. Give the source as a lat-long or a larger cubemap, take the light out "
      "first (take_out_sun), or use method reference.";
  for (const Lobe& lobe : kLobes) {
    const double roughness = lobe.roughness;
    const auto add = [&](const std::string& name, const std::string& promise, double bound,
                         std::function<double()> measure, const std::string& advice = {}) {
      cases.push_back({"image-range/" + name + "-roughness-" + lobe.text, promise + ", roughness " + lobe.text,
                       "reference_specular (double)", StabilityUnit::relative, bound,
                       [measure](const Control&) { return measure(); }, advice});
    };
    for (const auto& [text, value] : {std::pair{"1e-38", 1e-38F}, {"1e4", 1e4F}, {"1e8", 1e8F}}) {
      const std::string over = std::string(", one texel of ") + text + " over 1";
      const std::string advice = value > 1e6F ? dark : "";
      add(
          std::string("texel-cube-") + text, "each texel of a mip (maximum_error) of a cubemap of 32" + over, 1e-2,
          [v = value, roughness] { return worst_error(blurred(bright_cube(v), roughness)); }, advice);
      add(
          std::string("texel-lat-long-") + text, "each texel of a mip (maximum_error) of a lat-long of 128 x 64" + over,
          1e-2, [v = value, roughness] { return worst_error(blurred(bright_lat_long(v), roughness)); }, advice);
    }
    add(
        "rms-cube-1e4", "a mip as a whole, rms (rms_error), of a cubemap of 32, one texel of 1e4 over 1", 1e-3,
        [roughness] { return rms_of(blurred(bright_cube(1e4F), roughness)); }, roughness < 0.5 ? rings : "");
    add("rms-lat-long-1e4", "the same of a lat-long of 128 x 64", 1e-3,
        [roughness] { return rms_of(blurred(bright_lat_long(1e4F), roughness)); });
    for (const auto& [text, value] : {std::pair{"1e20", 1e20F}, {"1e30", 1e30F}, {"1e38", 1e38F}}) {
      add(std::string("peak-lat-long-") + text,
          std::string("error of any texel over the brightest one's light, lat-long, one texel of ") + text + " over 1",
          1e-3, [v = value, roughness] { return error_of_peak(blurred(bright_lat_long(v), roughness)); });
    }
    for (const auto& [text, factor] : {std::pair{"1e-30", 1e-30F}, {"1e-36", 1e-36F}}) {
      add(std::string("dark-lat-long-") + text,
          std::string("each texel of a mip (maximum_error) of a lat-long, one texel of 100 over 1, all times ") + text,
          1e-2, [f = factor, roughness] { return worst_error(blurred(dark_lat_long(f), roughness)); });
    }
    add("texel-without-sun-1e8", "each texel (maximum_error) of noise that had a texel of 1e8, after take_out_sun",
        1e-2, [roughness] { return error_without_sun(roughness); });
  }
}

}  // namespace

void add_image_range_cases(StabilityCases& cases) {
  add_uniform(cases);
  add_bright_texels(cases);
  cases.push_back({"image-range/irradiance-cubemap-1e38", "irradiance of a radiance of 1e38 everywhere",
                   "closed form: pi times the value", StabilityUnit::ulps, 4.0,
                   [](const Control&) { return irradiance_cubemap_ulps(1e38F); }});
  cases.push_back({"image-range/irradiance-cubemap-3.4e38",
                   "irradiance of a radiance of 3.4e38 everywhere as a finite float", "closed form: pi times the value",
                   StabilityUnit::ulps, 4.0, [](const Control&) { return irradiance_cubemap_ulps(kLargest); },
                   "pi times the largest float is no float: the texels are infinite. The coefficients are doubles and "
                   "right; scale them down before the cubemap is made."});
}

}  // namespace welkin::report::stability
