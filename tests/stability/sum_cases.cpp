// Sums: over few and over many texels, and whose terms cancel; maps, tables and chains of 1 and 2 texels.
#include "image/geometry.h"
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

// Length of sums: faces up to 8192, against sums in double. An error must not grow with the number of texels.
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kProjectionError = 5e-7;  ///< projection.h

/// Returns k / 1024 as a half, for k below 2048: exactly.
std::uint16_t half_of_1024ths(std::uint32_t k) {
  if (k == 0) return 0;
  const auto exponent = static_cast<std::uint32_t>(std::bit_width(k)) - 1U;
  return static_cast<std::uint16_t>(((exponent + 5U) << 10U) | ((k << (10U - exponent)) & 0x3FFU));
}

/// One face in memory that stands for all six, so that 8192 x 8192 take 0.4 GB.
struct SharedFace {
  int size;
  std::vector<std::uint16_t> pixels;

  [[nodiscard]] CubemapView view() const {
    CubemapView view{{}, size, 0, PixelFormat::rgb16f};
    view.faces.fill(pixels.data());
    return view;
  }
};

std::uint32_t noise_1024ths(std::size_t value) { return hashed(3, static_cast<std::uint32_t>(value)) & 1023U; }

SharedFace noise_face(int size) {
  SharedFace face{size, std::vector<std::uint16_t>(std::size_t{3} * static_cast<std::size_t>(size * size))};
  for (std::size_t k = 0; k < face.pixels.size(); ++k) face.pixels[k] = half_of_1024ths(noise_1024ths(k));
  return face;
}

/// 1638 / 16384, the half next to 0.1: every sum rounds the same way.
constexpr std::uint16_t kTenth = 0x2E66;
constexpr double kTenthValue = 1638.0 / 16384.0;

SharedFace constant_face(int size) {
  return {size, std::vector<std::uint16_t>(std::size_t{3} * static_cast<std::size_t>(size * size), kTenth)};
}

/// Nine harmonics of one row of the noise face in the face's own frame, by the midpoint rule.
void add_noise_row(int size, int row, SphericalHarmonics& sum) {
  const double y0 = 0.5 / std::sqrt(kPi);
  const double y1 = std::sqrt(3.0 / (4.0 * kPi));
  const double y2 = std::sqrt(15.0 / (4.0 * kPi));
  std::vector<double> angles(static_cast<std::size_t>(size));
  image::cubemap_row_solid_angles(row, angles);
  const double v = (2.0 * row + 1.0) / size - 1.0;
  std::array<glm::dvec3, 9> part{};
  for (int column = 0; column < size; ++column) {
    const double u = (2.0 * column + 1.0) / size - 1.0;
    const double r = 1.0 / std::sqrt(1.0 + u * u + v * v);
    const glm::dvec3 d(u * r, v * r, r);
    const std::size_t texel =
        static_cast<std::size_t>(row) * static_cast<std::size_t>(size) + static_cast<std::size_t>(column);
    const glm::dvec3 light =
        angles[static_cast<std::size_t>(column)] / 1024.0 *
        glm::dvec3(noise_1024ths(3 * texel), noise_1024ths(3 * texel + 1), noise_1024ths(3 * texel + 2));
    const std::array<double, 9> basis{y0,
                                      y1 * d.y,
                                      y1 * d.z,
                                      y1 * d.x,
                                      y2 * d.x * d.y,
                                      y2 * d.y * d.z,
                                      y2 * (3.0 * d.z * d.z - 1.0) / std::sqrt(12.0),
                                      y2 * d.x * d.z,
                                      y2 * 0.5 * (d.x * d.x - d.y * d.y)};
    for (std::size_t k = 0; k < 9; ++k) part[k] += basis[k] * light;
  }
  for (std::size_t k = 0; k < 9; ++k) sum.coefficients()[k] += part[k];
}

/// Returns one face's sums in double, rotated into each of the six frames.
SphericalHarmonics noise_truth(int size) {
  SphericalHarmonics local(3);
  for (int row = 0; row < size; ++row) add_noise_row(size, row, local);
  SphericalHarmonics sum(3);
  for (int face = 0; face < 6; ++face) {
    const image::Frame& frame = image::face_frame(face);
    sum = add(sum, rotate(local, glm::dmat3(frame.u, frame.v, frame.normal)));
  }
  return sum;
}

double noise_error(int size) {
  ProjectionOptions midpoint;
  midpoint.quadrature = Quadrature::midpoint;
  const SharedFace face = noise_face(size);
  return relative_error(project(face.view(), midpoint).radiance, noise_truth(size));
}

double constant_error(int size) {
  const SharedFace face = constant_face(size);
  return relative_error(project(face.view()).radiance, constant_radiance(glm::dvec3(kTenthValue), 3));
}

double constant_lat_long_error(int height) {
  const std::vector<std::uint16_t> pixels(
      std::size_t{6} * static_cast<std::size_t>(height) * static_cast<std::size_t>(height), kTenth);
  const LatLongView view{pixels.data(), 2 * height, height, 0, PixelFormat::rgb16f};
  return relative_error(project(view).radiance, constant_radiance(glm::dvec3(kTenthValue), 3));
}

/// Returns the worst error of larger sizes over that of smaller ones; errors below a float's rounding count as that.
double growth(double (*error)(int), const std::vector<int>& small, const std::vector<int>& large) {
  const auto worst = [&](const std::vector<int>& sizes) {
    double most = 0x1p-24;
    for (const int size : sizes) most = worse(most, error(size));
    return most;
  };
  return worst(large) / worst(small);
}

/// Compares the sphere's mean on each mip with that of the first.
double mips_drift(int size) {
  const Cubemap chain = build_mips(noise_cube(size, 9).view());
  const glm::dvec3 first = project(chain.view(0)).diagnostics.total_radiance;
  double worst = 0.0;
  for (int level = 1; level < chain.levels(); ++level) {
    worst = worse(worst, relative_error(project(chain.view(level)).diagnostics.total_radiance, first));
  }
  return worst;
}

double prefilter_drift(int height) {
  const PrefilteredSpecular result = prefilter_specular(noise_lat_long(2 * height, height, 4).view(), {.size = 64});
  double worst = 0.0;
  for (const MipRecord& mip : result.mips) worst = worse(worst, relative_error(mip.mean, result.mips[0].mean));
  return worst;
}

Effort effort_of(int size) { return size > 1024 ? Effort::full : Effort::quick; }

/// `sizes` rise, with some below and some above 1024.
void add_sized(StabilityCases& cases, const std::string& name, const std::string& what, const std::string& truth,
               double (*error)(int), const std::vector<int>& sizes) {
  for (const int size : sizes) {
    cases.add(name + "-" + std::to_string(size), what + ", size " + std::to_string(size), truth,
              {.bound = kProjectionError, .effort = effort_of(size)}, [=] { return error(size); });
  }
  const auto add_growth = [&](const std::vector<int>& small, const std::vector<int>& large) {
    const std::string most = std::to_string(large.back());
    cases.add(name + "-growth-" + most,
              "the worst error of sizes " + std::to_string(large.front()) + " to " + most + " over that of " +
                  std::to_string(small.front()) + " to " + std::to_string(small.back()) +
                  " (below 2^-24 counts as 2^-24)",
              truth, {.bound = 4.0, .unit = StabilityUnit::ratio, .effort = effort_of(large.back())},
              [=] { return growth(error, small, large); });
  };
  add_growth({16, 64}, {256, 500, 512});
  const auto first_large = std::find_if(sizes.begin(), sizes.end(), [](int size) { return size > 1024; });
  add_growth({64, 256, 512}, {first_large, sizes.end()});
}

}  // namespace

void add_accumulation_cases(StabilityCases& cases) {
  add_sized(cases, "noise-cube", "faces of noise by the midpoint rule", "the same sum in double", noise_error,
            {16, 64, 256, 512, 2048, 4096, 8192});
  add_sized(cases, "tenth-cube", "faces of 0.1 everywhere, which rounds the same way in every sum", "closed form",
            constant_error, {16, 64, 256, 1024, 2048, 4096, 8192});
  add_sized(cases, "tenth-lat-long", "the same on a lat-long, twice as wide as high", "closed form",
            constant_lat_long_error, {16, 64, 256, 1024, 2048, 4096});
  for (const int size : {256, 2048}) {
    const std::string text = std::to_string(size);
    cases.add("mips-" + text, "the sphere's total radiance is the same on every mip of " + text,
              "total radiance of the first mip", {.bound = 1e-6, .effort = effort_of(size)},
              [size] { return mips_drift(size); });
  }
  for (const int height : {128, 2048}) {
    const std::string text = std::to_string(height);
    cases.add("prefilter-mean-" + text,
              "a prefiltered chain keeps the mean (source " + std::to_string(2 * height) + " x " + text + ")",
              "mean of the first mip", {.bound = 1e-3, .effort = effort_of(height)},
              [height] { return prefilter_drift(height); });
  }
}

// Cancellation: sums whose terms are large and whose result is small.
namespace {

constexpr double kSphere = 3.5449077018110318;  ///< sqrt(4 pi): band 0 of 1 everywhere

ProjectionOptions bands(int count) {
  ProjectionOptions options{.bands = count};
  return options;
}

/// Returns the norm of the bands above 0 over band 0.
double leak(const SphericalHarmonics& c) { return norm(c, 1) / glm::length(c.at(0, 0)); }

double uniform_leak(int size, int band_count) {
  return leak(project(grey_cubemap(size, 1.0F).view(), bands(band_count)).radiance);
}

double uniform_lat_long_leak(int height, int band_count) {
  return leak(project(grey_lat_long(2 * height, height, 1.0F).view(), bands(band_count)).radiance);
}

/// Returns 1 + amplitude * noise, rounded to floats: reference and result read the same ones.
Cubemap nearly_uniform(int size, float amplitude) {
  Cubemap map = noise_cube(size, 5);
  for (float& value : map.pixels()) value = 1.0F + amplitude * value;
  return map;
}

/// Returns the error of the bands above the first, relative to these bands.
double upper_band_error(float amplitude) {
  const Cubemap map = nearly_uniform(32, amplitude);
  return relative_error(project(map.view()).radiance, reference_projection(map.view()), 1);
}

/// Returns the error over the projection of the map's magnitude.
template <class Image>
double checkerboard_error(const Image& map, double amplitude) {
  return distance(project(map.view()).radiance, reference_projection(map.view())) /
         (std::sqrt(3.0) * kSphere * amplitude);
}

/// Compares a checkerboard's irradiance with that of its negative: E(map) + E(-map) = 0.
double checkerboard_irradiance() {
  const Cubemap plus = checkerboard_cube(33, 1.0F);
  const Cubemap minus = checkerboard_cube(33, -1.0F);
  double worst = 0.0;
  for (const glm::dvec3& normal : spread_directions(20)) {
    const glm::dvec3 sum = direct_irradiance(plus.view(), normal) + direct_irradiance(minus.view(), normal);
    worst = worse(worst, std::abs(sum.x) / std::numbers::pi);
  }
  return worst;
}

double directions_from_nothing() {
  double wrong = 0.0;
  for (const int size : {1, 2, 3, 16, 31, 64, 128}) {
    wrong += wrong_if(dominant_light(project(grey_cubemap(size, 0.7F).view()).radiance).has_value());
    wrong += wrong_if(dominant_light(project(grey_lat_long(2 * size, size, 0.7F).view()).radiance).has_value());
  }
  return wrong;
}

void add_uniform(StabilityCases& cases) {
  for (const int size : {1, 2, 7, 64, 257}) {
    cases.add("uniform-cube-" + std::to_string(size),
              "a uniform cubemap of " + std::to_string(size) + " has nothing above band 0 (3 bands), over band 0",
              "closed form: 0", {2e-7}, [size] { return uniform_leak(size, 3); });
  }
  cases.add("uniform-cube-64-bands-16", "the same with 16 bands, face size 64", "closed form: 0", {1e-6},
            [] { return uniform_leak(64, 16); });
  cases.add("uniform-lat-long-128", "a uniform lat-long of 256 x 128, 3 bands, over band 0", "closed form: 0", {2e-7},
            [] { return uniform_lat_long_leak(128, 3); });
  cases.add("uniform-lat-long-128-bands-16", "the same with 16 bands", "closed form: 0", {1e-6},
            [] { return uniform_lat_long_leak(128, 16); });
  cases.add_count("no-direction-from-rounding",
                  "dominant_light finds no light in uniform maps of any size: rounding is no direction",
                  "there is none", directions_from_nothing);
}

void add_nearly_uniform(StabilityCases& cases) {
  const std::string advice =
      "Rounding leaves some 1e-7 of band 0 in every band. Below that bands have no digits of their own: treat l > 0 as "
      "zero under 1e-6 of band 0 (dominant_light does), or subtract the mean from the map before projecting.";
  for (const std::string amplitude : {"1e-1", "1e-2", "1e-3", "1e-6"}) {
    cases.add("nearly-uniform-" + amplitude,
              "bands 1 and 2 of 1 + " + amplitude + " x noise are right to 1 % of themselves",
              "reference_projection (double)", {.bound = 1e-2, .advice = amplitude == "1e-6" ? advice : ""},
              [value = std::stof(amplitude)] { return upper_band_error(value); });
  }
}

void add_boards(StabilityCases& cases) {
  const auto add = [&](const std::string& name, const std::string& promise, std::function<double()> measure) {
    cases.add("checkerboard-" + name, promise, "reference_projection (double)", {kProjectionError}, std::move(measure));
  };
  for (const int size : {2, 3, 32, 63}) {
    add("cube-" + std::to_string(size),
        "+1 and -1 by turns, face size " + std::to_string(size) + ": error over the light of its magnitude",
        [size] { return checkerboard_error(checkerboard_cube(size, 1.0F), 1.0); });
  }
  add("lat-long-64x32", "the same on a lat-long of 64 x 32",
      [] { return checkerboard_error(checkerboard_lat_long(64, 32, 1.0F), 1.0); });
  add("1e38", "+1e38 and -1e38 by turns: no infinities meet",
      [] { return checkerboard_error(checkerboard_cube(32, 1e38F), 1e38F); });
  cases.add("checkerboard-irradiance", "direct irradiance of a board and of its negative add up to nothing, over pi",
            "closed form: 0", {1e-12}, checkerboard_irradiance);
}

}  // namespace

void add_cancellation_cases(StabilityCases& cases) {
  add_uniform(cases);
  add_nearly_uniform(cases);
  add_boards(cases);
}

// The smallest sizes: 1 and 2 texels, tables of one entry, chains of one mip.
namespace {

double prefilter_error(int source, int size) {
  const Cubemap map = noise_cube(source, 6);
  PrefilterOptions options{.size = size};
  options.roughness = {0.4};
  const PrefilteredSpecular found = prefilter_specular(map.view(), options);
  return worst_relative_error(texels(found.cubemap, 0), reference_specular(map.view(), 0.4, texel_centres(size)));
}

/// Resamples a cube of one texel per face to a lat-long and back.
double round_trip_error() {
  const Cubemap map = noise_cube(1, 8);
  const Cubemap back = to_cubemap(to_lat_long(map.view(), 64, 32, glm::dmat3(1.0), ResampleFilter::area).view(), 1);
  double worst = 0.0;
  const glm::dvec3 before = project(map.view()).diagnostics.total_radiance;
  worst = relative_error(project(back.view()).diagnostics.total_radiance, before);
  return worst;
}

/// Every result of a 1 x 1 and 2 x 2 cubemap is finite and not negative.
double small_results() {
  double wrong = 0.0;
  for (const int size : {1, 2}) {
    const Cubemap map = noise_cube(size, 7);
    wrong += unsound(to_lat_long(map.view(), 1, 1).pixels) + unsound(to_lat_long(map.view(), 3, 1).pixels);
    wrong += unsound(to_cubemap(to_lat_long(map.view(), 2, 1).view(), size).pixels());
    wrong += wrong_if(build_mips(map.view()).levels() != size);
    const BrdfTable& table = *brdf_table({.width = size, .height = size});
    wrong += unsound(table.values);
  }
  return wrong;
}

/// A chain of one mip must match the reference of its roughness.
double one_mip_error(double roughness) {
  const LatLongImage map = noise_lat_long(32, 16, 3);
  PrefilterOptions options{.size = 8, .mips = 1};
  options.roughness = {roughness};
  const PrefilteredSpecular found = prefilter_specular(map.view(), options);
  if (found.cubemap.levels() != 1) return 1e300;
  return worst_relative_error(texels(found.cubemap, 0), reference_specular(map.view(), roughness, texel_centres(8)));
}

}  // namespace

void add_size_cases(StabilityCases& cases) {
  for (const auto& [source, size] : {std::pair{1, 1}, {2, 1}, {1, 2}, {2, 8}, {32, 1}}) {
    const std::string from = std::to_string(source);
    const std::string to = std::to_string(size);
    cases.add("prefilter-" + from + "-to-" + to,
              "faces of " + from + " texels prefiltered at roughness 0.4 to faces of " + to + " (maximum_error)",
              "reference_specular (double)", {1e-2},
              [source = source, size = size] { return prefilter_error(source, size); });
  }
  for (const std::string roughness : {"0.3", "1"}) {
    cases.add("one-mip-" + roughness, "a chain whose only mip has roughness " + roughness,
              "reference_specular (double)", {1e-2}, [value = std::stod(roughness)] { return one_mip_error(value); });
  }
  cases.add_count("small-results", "resampling, mips and BRDF tables of 1 and 2 texels are finite, not negative",
                  "what the sizes ask for", small_results);
  cases.add("round-trip-1", "a cubemap of 1 to a lat-long and back keeps its total radiance",
            "total radiance of the source", {1e-6}, round_trip_error);
}

}  // namespace welkin::test::stability
