// Pixels with extreme values: the range of projections and of images, and the policies for NaN, infinities and
// negatives.
#include "reference/reference_projection.h"
#include "stability/cases.h"
#include "stability/measures.h"
#include "standard_headers.h"
#include "support/images.h"
#include "support/random_harmonics.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test::stability {

// Dynamic range of projections: one texel from 1e-38 to the last float over a background of 1, halves, denormals.
namespace {

constexpr double kProjectionError = 5e-7;  ///< projection.h
constexpr int kSize = 32;
constexpr std::size_t kTexel = 2 * 32 * 32 + 5 * 32 + 29;  ///< on +Y, near an edge; on a lat-long south of the equator
constexpr float kLargest = std::numeric_limits<float>::max();

const std::vector<std::string> kValues{"1e-38", "1e-20", "1e-4", "1e4", "1e8", "1e20", "1e30", "1e38", "3.4e38"};

/// Returns the number in a name; 3.4e38 stands for the largest float.
float value_of(const std::string& text) { return text == "3.4e38" ? kLargest : static_cast<float>(std::stod(text)); }

template <class Image>
double projection_error(const Image& image) {
  return relative_error(project(image.view()).radiance, reference_projection(image.view()));
}

/// Returns the error of a uniform map's projection against sqrt(4 pi) times its value.
double uniform_error(const EnvironmentView& view, double value) {
  return relative_error(project(view).radiance, constant_radiance(glm::dvec3(value), 3));
}

template <class Half>
CubemapView shared_faces(const Half& pixels, int size) {
  CubemapView view{{}, size, 0, PixelFormat::rgb16f};
  view.faces.fill(pixels.data());
  return view;
}

double half_error(std::uint16_t half, double value) {
  const std::vector<std::uint16_t> face(std::size_t{3} * kSize * kSize, half);
  return uniform_error(shared_faces(face, kSize), value);
}

/// Returns the error of the background's light after the bright texel's known light is subtracted.
double background_error(float value) {
  const Cubemap map = with_texel(grey_cubemap(kSize, 1.0F), kTexel, value);
  const Cubemap texel = with_texel(grey_cubemap(kSize, 0.0F), kTexel, value);
  const Cubemap rest = with_texel(grey_cubemap(kSize, 1.0F), kTexel, 0.0F);
  const SphericalHarmonics whole = project(map.view()).radiance;
  const SphericalHarmonics lone = reference_projection(texel.view());
  SphericalHarmonics difference(3);
  for (std::size_t k = 0; k < 9; ++k) difference.coefficients()[k] = whole.coefficients()[k] - lone.coefficients()[k];
  return relative_error(difference, reference_projection(rest.view()));
}

double background_error_without_sun(float value) {
  Cubemap map = with_texel(grey_cubemap(64, 1.0F), 2 * 64 * 64 + 20 * 64 + 29, value);
  if (!extract_sun(map)) return std::numeric_limits<double>::infinity();
  return uniform_error(map.view(), 1.0);
}

void add_bright_texels(StabilityCases& cases) {
  for (const std::string& text : kValues) {
    const float value = value_of(text);
    cases.add("cube-texel-" + text, "three bands of a cubemap of 1 with one texel of " + text,
              "reference_projection (double)", {kProjectionError},
              [value] { return projection_error(with_texel(grey_cubemap(kSize, 1.0F), kTexel, value)); });
    cases.add("lat-long-texel-" + text, "three bands of a lat-long of 1 with one texel of " + text,
              "reference_projection (double)", {kProjectionError},
              [value] { return projection_error(with_texel(grey_lat_long(64, 32, 1.0F), 1500, value)); });
  }
}

void add_backgrounds(StabilityCases& cases) {
  const std::string advice =
      "A float product has 24 bits: what is 1e7 times fainter than the brightest sum is lost beside it. Take the sun "
      "out "
      "first (extract_sun) and give it to a directional light; then the rest is exact, whatever the sun was.";
  for (const std::string text : {"1e4", "1e6", "1e12"}) {
    cases.add("background-under-" + text, "the light of a background of 1 is still right under one texel of " + text,
              "reference_projection of the background alone", {.bound = 1e-3, .advice = text == "1e12" ? advice : ""},
              [value = value_of(text)] { return background_error(value); });
  }
  cases.add("background-without-sun-1e12", "after extract_sun a background of 1 is right, though the sun was 1e12",
            "closed form", {kProjectionError}, [] { return background_error_without_sun(1e12F); });
}

void add_uniform(StabilityCases& cases) {
  const auto add = [&](const char* name, const std::string& what, std::function<double()> measure,
                       const std::string& advice = {}) {
    cases.add(name, "three bands of " + what, "closed form: sqrt(4 pi) times the value",
              {.bound = kProjectionError, .advice = advice}, std::move(measure));
  };
  const auto cube_of = [](float value) {
    return [=] { return uniform_error(grey_cubemap(kSize, value).view(), value); };
  };
  add("half-largest", "the largest half, 65504, everywhere", [] { return half_error(0x7BFF, 65504.0); });
  add("half-smallest-normal", "the smallest normal half, 2^-14", [] { return half_error(0x0400, 0x1p-14); });
  add("half-smallest-denormal", "the smallest denormal half, 2^-24", [] { return half_error(0x0001, 0x1p-24); });
  add("float-largest", "the largest float everywhere", cube_of(kLargest));
  add("float-largest-lat-long", "the largest float everywhere on a lat-long",
      [] { return uniform_error(grey_lat_long(64, 32, kLargest).view(), kLargest); });
  add("float-1e-30", "1e-30 everywhere", cube_of(1e-30F));
  const std::string advice =
      "Radiance times a texel's solid angle falls below the normal floats and loses bits. Light that dark is no "
      "light; if it is meant, multiply the map by a power of two first and the coefficients by its inverse after.";
  add("float-smallest-normal", "the smallest normal float, 2^-126", cube_of(0x1p-126F), advice);
  add("float-denormal", "a denormal float, 1e-40", cube_of(1e-40F), advice);
  add("float-smallest-denormal", "the smallest denormal float, 2^-149", cube_of(0x1p-149F), advice);
}

}  // namespace

void add_range_cases(StabilityCases& cases) {
  add_bright_texels(cases);
  add_backgrounds(cases);
  add_uniform(cases);
}

// Dynamic range of images: mips, resampling, irradiance and prefiltered cubemaps.
namespace {

constexpr std::size_t kImageTexel = 2 * 32 * 32 + 13 * 32 + 9;
constexpr double kUniformUlps = 8.0;  ///< reflections.h: 1e-6

double worst_ulps(std::span<const float> values, double truth) {
  double worst = 0.0;
  for (const float value : values) worst = worse(worst, float_ulps(value, truth));
  return worst;
}

double mips_ulps(float value) {
  const Cubemap chain = build_mips(grey_cubemap(31, value).view());
  double worst = 0.0;
  for (int level = 0; level < chain.levels(); ++level) {
    for (const glm::dvec3& texel : texels(chain, level)) worst = worse(worst, float_ulps(texel.x, value));
  }
  return worst;
}

/// Texels of a prefiltered mip and their references: every fifth and the brightest.
struct Blurred {
  std::vector<glm::dvec3> found;
  std::vector<glm::dvec3> truth;
};

template <class Image>
Blurred blurred(const Image& source, double roughness) {
  PrefilterOptions options{.size = 8};
  options.roughness = {roughness};
  const std::vector<glm::dvec3> all = texels(prefilter_specular(source.view(), options).cubemap, 0);
  const std::vector<glm::dvec3> all_directions = texel_centres(8);
  const auto brightest = std::max_element(all.begin(), all.end(), [](auto& a, auto& b) { return a.x < b.x; });
  std::vector<glm::dvec3> found{*brightest};
  std::vector<glm::dvec3> directions{all_directions[static_cast<std::size_t>(brightest - all.begin())]};
  for (std::size_t k = 0; k < all.size(); k += 5) {
    found.push_back(all[k]);
    directions.push_back(all_directions[k]);
  }
  return {found, reference_specular(source.view(), roughness, directions)};
}

Cubemap bright_cube(float value) { return with_texel(grey_cubemap(32, 1.0F), kImageTexel, value); }
LatLongImage bright_lat_long(float value) { return with_texel(grey_lat_long(128, 64, 1.0F), 2500, value); }
LatLongImage dark_lat_long(float factor) { return with_texel(grey_lat_long(128, 64, factor), 2500, 100.0F * factor); }

double worst_error(const Blurred& mip) { return worst_relative_error(mip.found, mip.truth); }
double rms_of(const Blurred& mip) { return rms_error(mip.found, mip.truth); }

/// Returns the largest error over the brightest texel.
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
  Cubemap map = with_texel(noise_cube(64, 12), std::size_t{2} * 64 * 64 + 20 * 64 + 29, 1e8F);
  if (!extract_sun(map)) return std::numeric_limits<double>::infinity();
  return worst_error(blurred(map, roughness));
}

double prefilter_uniform_ulps(float value) {
  PrefilterOptions options{.size = 8};
  options.roughness = {0.0, 0.3, 1.0};
  const PrefilteredSpecular result = prefilter_specular(grey_lat_long(32, 16, value).view(), options);
  double worst = 0.0;
  for (int level = 0; level < 3; ++level) {
    for (const glm::dvec3& texel : texels(result.cubemap, level)) worst = worse(worst, float_ulps(texel.y, value));
  }
  return worst;
}

double irradiance_cubemap_ulps(float value) {
  const SphericalHarmonics irradiance = irradiance_from_radiance(constant_radiance(glm::dvec3(value), 3));
  return worst_ulps(irradiance_cubemap(irradiance, 4).pixels(), value * 3.14159265358979323846);
}

void add_uniform_images(StabilityCases& cases) {
  for (const std::string text : {"1e-40", "1", "65504", "3.4e38"}) {
    const float value = value_of(text);
    const auto add = [&](const std::string& name, const std::string& map, double bound,
                         std::function<double()> measure) {
      cases.add(name + "-" + text, map + " of " + text + " stays what it is", "closed form: the value",
                {bound, StabilityUnit::ulps}, std::move(measure));
    };
    add("mips", "every mip of a uniform cubemap", 1.0, [value] { return mips_ulps(value); });
    add("to-cubemap", "a cubemap resampled from a uniform lat-long", 0.0,
        [value] { return worst_ulps(to_cubemap(grey_lat_long(37, 19, value).view(), 11).pixels(), value); });
    add("prefilter-automatic", "a prefiltered uniform lat-long", kUniformUlps,
        [value] { return prefilter_uniform_ulps(value); });
  }
}

/// One texel over a background of 1: the dark side's own digits, the mip as a whole, the light's.
void add_bright_image_texels(StabilityCases& cases, const std::string& roughness_text) {
  const std::string dark =
      "Floats keep some 1e-7 of the brightest light everywhere, and the points that stand for its texel cross the "
      "lobe's horizon one by one: what is a millionth of the light or darker has no digits of its own beside it. Take "
      "the light out first (extract_sun), give it to a directional light and prefilter the rest; or use method "
      "reference.";
  const std::string rings =
      "A cubemap goes by rings twice as fine as its texels, whose means blur a lone texel a little: 0.6 % where the "
      "lobe is no wider than some texels. Give the source as a lat-long or a larger cubemap, take the light out "
      "first (extract_sun), or use method reference.";
  const double roughness = std::stod(roughness_text);
  const auto add = [&](const std::string& name, const std::string& promise, double bound,
                       std::function<double()> measure, const std::string& advice = {}) {
    cases.add(name + "-roughness-" + roughness_text, promise + ", roughness " + roughness_text,
              "reference_specular (double)", {.bound = bound, .advice = advice}, std::move(measure));
  };
  for (const std::string text : {"1e-38", "1e4", "1e8"}) {
    const float value = value_of(text);
    const std::string over = ", one texel of " + text + " over 1";
    const std::string advice = value > 1e6F ? dark : "";
    const auto cube = [=] { return blurred(bright_cube(value), roughness); };
    const auto lat_long = [=] { return blurred(bright_lat_long(value), roughness); };
    add(
        "texel-cube-" + text, "each texel of a mip (maximum_error) of a cubemap of 32" + over, 1e-2,
        [=] { return worst_error(cube()); }, advice);
    add(
        "texel-lat-long-" + text, "each texel of a mip (maximum_error) of a lat-long of 128 x 64" + over, 1e-2,
        [=] { return worst_error(lat_long()); }, advice);
    if (text != "1e4") continue;
    add(
        "rms-cube-1e4", "a mip as a whole, rms (rms_error), of a cubemap of 32" + over, 1e-3,
        [=] { return rms_of(cube()); }, roughness < 0.5 ? rings : "");
    add("rms-lat-long-1e4", "the same of a lat-long of 128 x 64", 1e-3, [=] { return rms_of(lat_long()); });
  }
  for (const std::string text : {"1e20", "1e30", "1e38"}) {
    add("peak-lat-long-" + text,
        "error of any texel over the brightest one's light, lat-long, one texel of " + text + " over 1", 1e-3,
        [=, value = value_of(text)] { return error_of_peak(blurred(bright_lat_long(value), roughness)); });
  }
  for (const std::string text : {"1e-30", "1e-36"}) {
    add("dark-lat-long-" + text,
        "each texel of a mip (maximum_error) of a lat-long, one texel of 100 over 1, all times " + text, 1e-2,
        [=, factor = value_of(text)] { return worst_error(blurred(dark_lat_long(factor), roughness)); });
  }
  add("texel-without-sun-1e8", "each texel (maximum_error) of noise that had a texel of 1e8, after extract_sun", 1e-2,
      [roughness] { return error_without_sun(roughness); });
}

}  // namespace

void add_image_range_cases(StabilityCases& cases) {
  add_uniform_images(cases);
  for (const char* const roughness : {"0.3", "0.8"}) add_bright_image_texels(cases, roughness);
  cases.add("irradiance-cubemap-1e38", "irradiance of a radiance of 1e38 everywhere", "closed form: pi times the value",
            {4.0, StabilityUnit::ulps}, [] { return irradiance_cubemap_ulps(1e38F); });
  const std::string infinite =
      "pi times the largest float is no float: texels are the largest float. The coefficients are doubles and right; "
      "scale "
      "them down before the cubemap is made.";
  cases.add("irradiance-cubemap-3.4e38", "irradiance of a radiance of 3.4e38 everywhere as a finite float",
            "closed form: pi times the value", {4.0, StabilityUnit::ulps, infinite},
            [] { return irradiance_cubemap_ulps(kLargest); });
}

// NaN, infinities and negatives under each policy.
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::size_t kOddTexel = 777;

/// A policy's case: what a texel holds, and what it must count as.
struct Replacement {
  const char* name;
  const char* promise;
  float bad;
  float instead;
  ProjectionOptions options;
};

ProjectionOptions clamped(float maximum) {
  ProjectionOptions options;
  options.pixels.clamp = RadianceClamp{maximum, false};
  return options;
}

ProjectionOptions with(NonFinitePolicy nan, NonFinitePolicy infinity, NegativePolicy negative) {
  ProjectionOptions options;
  options.pixels.nan = nan;
  options.pixels.infinity = infinity;
  options.pixels.negative = negative;
  return options;
}

constexpr NonFinitePolicy kReplace = NonFinitePolicy::replace;

std::vector<Replacement> replacements() {
  return {
      {"nan", "NaN counts as 0", kNaN, 0.0F, {}},
      {"infinity", "+infinity counts as 65504", kInfinity, 65504.0F, {}},
      {"infinity-clamped", "+infinity counts as the clamp's maximum", kInfinity, 100.0F, clamped(100.0F)},
      {"minus-infinity", "-infinity counts as 0", -kInfinity, 0.0F, {}},
      {"negative-kept", "a negative is taken as it is", -3.0F, -3.0F, {}},
      {"negative-replaced", "a negative counts as 0", -3.0F, 0.0F, with(kReplace, kReplace, NegativePolicy::replace)},
      {"minus-1e38", "a huge negative is taken as it is", -1e38F, -1e38F, {}}};
}

template <class Image>
double projected(const Image& map, const Replacement& r) {
  const Image bad = with_texel(map, kOddTexel, r.bad);
  const Image good = with_texel(map, kOddTexel, r.instead);
  return relative_error(project(bad.view(), r.options).radiance, project(good.view(), {}).radiance);
}

double irradiance_of(const Replacement& r) {
  const Cubemap bad = with_texel(noise_cube(16, 1), kOddTexel, r.bad);
  const Cubemap good = with_texel(noise_cube(16, 1), kOddTexel, r.instead);
  const std::vector<glm::dvec3> normals = spread_directions(8);
  return rms_error(direct_irradiance(bad.view(), normals, r.options.pixels), direct_irradiance(good.view(), normals));
}

double prefiltered(const Replacement& r) {
  PrefilterOptions options{.size = 8};
  options.roughness = {0.0, 0.5};
  const Cubemap good = with_texel(noise_cube(16, 1), kOddTexel, r.instead);
  const PrefilteredSpecular wanted = prefilter_specular(good.view(), options);
  options.pixels = r.options.pixels;
  const PrefilteredSpecular found = prefilter_specular(with_texel(noise_cube(16, 1), kOddTexel, r.bad).view(), options);
  return worse(rms_error(texels(found.cubemap, 0), texels(wanted.cubemap, 0)),
               rms_error(texels(found.cubemap, 1), texels(wanted.cubemap, 1)));
}

double rejections() {
  constexpr NonFinitePolicy reject = NonFinitePolicy::reject;
  const auto refused = [](float value, const ProjectionOptions& options) {
    const Cubemap cube = with_texel(noise_cube(16, 1), kOddTexel, value);
    const LatLongImage lat_long = with_texel(noise_lat_long(64, 32, 1), kOddTexel, value);
    const std::vector<glm::dvec3> normals = spread_directions(1);
    PrefilterOptions prefilter{.size = 4};
    prefilter.roughness = {0.5};
    prefilter.pixels = options.pixels;
    return wrong_unless_thrown(ErrorCode::rejected_pixel, [&] { (void)project(cube.view(), options); }) +
           wrong_unless_thrown(ErrorCode::rejected_pixel, [&] { (void)project(lat_long.view(), options); }) +
           wrong_unless_thrown(ErrorCode::rejected_pixel, [&] { (void)prefilter_specular(cube.view(), prefilter); }) +
           wrong_unless_thrown(ErrorCode::rejected_pixel,
                               [&] { (void)direct_irradiance(cube.view(), normals, options.pixels); });
  };
  return refused(kNaN, with(reject, kReplace, NegativePolicy::keep)) +
         refused(kInfinity, with(kReplace, reject, NegativePolicy::keep)) +
         refused(-kInfinity, with(kReplace, reject, NegativePolicy::keep)) +
         refused(-1e-40F, with(kReplace, kReplace, NegativePolicy::reject));
}

double all_nan() {
  const Projection found = project(grey_cubemap(16, kNaN).view());
  const LatLongImage lat_long = grey_lat_long(32, 16, kNaN);
  return norm(found.radiance) + norm(project(lat_long.view()).radiance) +
         wrong_if(found.diagnostics.nans_replaced != 18 * 256);
}

/// Projects four channels with NaN in alpha.
double alpha_error() {
  const Cubemap rgb = noise_cube(16, 1);
  std::vector<float> rgba;
  for (std::size_t texel = 0; texel < rgb.pixels().size() / 3; ++texel) {
    for (std::size_t c = 0; c < 3; ++c) rgba.push_back(rgb.pixels()[3 * texel + c]);
    rgba.push_back(texel % 2 == 0 ? kNaN : kInfinity);
  }
  CubemapView view{{}, 16, 0, PixelFormat::rgba32f};
  for (std::size_t face = 0; face < 6; ++face) view.faces[face] = rgba.data() + face * 1024;
  return relative_error(project(view).radiance, project(rgb.view()).radiance);
}

}  // namespace

void add_policy_cases(StabilityCases& cases) {
  for (const Replacement& r : replacements()) {
    const auto add = [&](const std::string& where, std::function<double()> measure) {
      cases.add(std::string(r.name) + "-" + where, std::string(r.promise) + " (" + where + ")",
                "the same map with that value in its place", {1e-6}, std::move(measure));
    };
    add("cube", [r] { return projected(noise_cube(32, 2), r); });
    add("lat-long", [r] { return projected(noise_lat_long(64, 32, 2), r); });
    add("irradiance", [r] { return irradiance_of(r); });
    add("prefilter", [r] { return prefiltered(r); });
  }
  const std::string truth = "the error's code, the counts";
  cases.add_count("rejected", "what a policy rejects is refused by projection, prefilter and irradiance", truth,
                  rejections);
  cases.add_count("all-nan", "a map of NaN alone is black, and all of it counted", truth, all_nan);
  cases.add("alpha", "NaN and infinity in alpha change nothing", "the same map without alpha", {0.0}, alpha_error);
}

}  // namespace welkin::test::stability
