// Lobes of any roughness, grazing kernels, and the split sum's table.
#include "perf/report/passes.h"
#include "stability/cases.h"
#include "stability/measures.h"
#include "standard_headers.h"
#include "support/images.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"

namespace welkin::test::stability {

// The BRDF table at its ends: grazing views, roughness near 0 and 1.
namespace {

constexpr double kTableError = 1e-5;  ///< reflections.h

/// Returns the worst error of one column of a table (0: the most grazing view), with `error` of a row's entry by
/// normal_view and the square of the roughness.
template <class RowError>
double column_error(int width, int height, int column, const RowError& error) {
  const auto table = brdf_table({.width = width, .height = height});
  const double normal_view = (column + 0.5) / width;
  double worst = 0.0;
  for (int row = 0; row < height; ++row) {
    const double roughness = (row + 0.5) / height;
    const float* const entry = table->values.data() + static_cast<std::ptrdiff_t>(3) * (row * width + column);
    worst = worse(worst, error(entry, normal_view, roughness * roughness));
  }
  return worst;
}

/// Returns the error of scale and bias.
double ggx_error(const float* entry, double normal_view, double alpha) {
  const report::BrdfTruth truth = report::ggx_truth(normal_view, alpha);
  return worse(std::abs(entry[0] - truth.scale), std::abs(entry[1] - truth.bias));
}

double sheen_error(const float* entry, double normal_view, double alpha) {
  const double sheen = report::sheen_truth(normal_view, alpha);
  return std::abs(entry[2] - sheen) / std::max(1.0, sheen);
}

/// Returns how many values are unsound or exceed the largest half. Sheen goes far above it; none may become infinite.
double half_values_wrong() {
  const auto table = brdf_table({.width = 1024, .height = 64});
  double wrong = unsound(table->values);
  for (const float value : table->values) wrong += wrong_if(value > 65504.0F);
  return wrong;
}

}  // namespace

void add_brdf_cases(StabilityCases& cases) {
  for (const auto& [width, column] : {std::pair{64, 0}, {1024, 0}, {4096, 0}, {4096, 4095}}) {
    const std::string at = std::to_string(column) + "-of-" + std::to_string(width);
    const std::string view = "n.v = " + std::string(column > 0 ? "1 - 0.5 / " : "0.5 / ") + std::to_string(width);
    cases.add("ggx-column-" + at, "scale and bias at " + view + ", 8 roughnesses, absolute",
              "integral over the light's hemisphere in double", {kTableError},
              [w = width, c = column] { return column_error(w, 8, c, ggx_error); });
    cases.add("sheen-column-" + at, "sheen at " + view + ", absolute, of its value where above 1",
              "integral over the light's hemisphere in double", {kTableError},
              [w = width, c = column] { return column_error(w, 8, c, sheen_error); });
  }
  cases.add_count("half-values", "sheen of hundreds at grazing angles is finite, as halves too", "65504 at most",
                  half_values_wrong);
}

// Lobes from a point to the whole hemisphere: roughness 0, 1e-6, 1e-3, about the change of methods, 1.
namespace {

PrefilteredSpecular prefiltered(const Cubemap& source, int size, double roughness, PrefilterMethod method) {
  PrefilterOptions options{.size = size};
  options.roughness = {roughness};
  options.method = method;
  return prefilter_specular(source.view(), options);
}

double error_of(double roughness, int size, PrefilterMethod method) {
  const Cubemap source = noise_cube(16, 12);
  return worst_relative_error(texels(prefiltered(source, size, roughness, method).cubemap, 0),
                              reference_specular(source.view(), roughness, texel_centres(size)));
}

/// Returns the error of lobes narrower than a texel, at the source's size.
double narrow_error(double roughness) {
  const Cubemap source = noise_cube(8, 12);
  return rms_error(texels(prefiltered(source, 8, roughness, PrefilterMethod::automatic).cubemap, 0),
                   reference_specular(source.view(), roughness, texel_centres(8)));
}

/// Returns how far a texel leaves the source's range, 1 to 1000, relative to the end that it passes.
double outside_of_range(double roughness) {
  const Cubemap source = with_texel(grey_cubemap(16, 1.0F), 300, 1000.0F);
  double worst = 0.0;
  for (const glm::dvec3& texel : texels(prefiltered(source, 16, roughness, PrefilterMethod::automatic).cubemap, 0)) {
    worst = worse(worst, worse(1.0 - texel.x, texel.x / 1000.0 - 1.0));
  }
  return worst;
}

double copy_differs() {
  const Cubemap source = noise_cube(32, 12);
  const PrefilteredSpecular found = prefiltered(source, 32, 0.0, PrefilterMethod::automatic);
  double wrong = 0.0;
  for (std::size_t k = 0; k < source.pixels().size(); ++k)
    wrong += wrong_if(found.cubemap.face(0, 0)[k] != source.pixels()[k]);
  return wrong;
}

double schedules_unsound() {
  double wrong = 0.0;
  for (const RoughnessSchedule schedule :
       {RoughnessSchedule::linear, RoughnessSchedule::filament, RoughnessSchedule::babylon, RoughnessSchedule::unity,
        RoughnessSchedule::unreal}) {
    for (int mips = 1; mips <= 16; ++mips) {
      for (const int size : {1, 2, 256, 4096, 8192}) {
        const std::vector<double> table = mip_roughness(schedule, mips, size);
        wrong += wrong_if(table.front() != 0.0 || table.size() != static_cast<std::size_t>(mips));
        for (std::size_t k = 0; k < table.size(); ++k) {
          wrong += wrong_if(!(table[k] >= 0.0 && table[k] <= 1.0) || (k > 0 && table[k] < table[k - 1]));
        }
      }
    }
  }
  return wrong;
}

}  // namespace

void add_roughness_cases(StabilityCases& cases) {
  cases.add_count("0", "roughness 0 at the source's size is a copy", "the source, bit for bit", copy_differs);
  for (const std::string text : {"1e-6", "1e-3", "0.05", "0.06", "0.1", "0.999", "1"}) {
    const double roughness = std::stod(text);
    if (roughness < 0.055) {
      cases.add("automatic-" + text, "faces of 8 of noise at roughness " + text + ", rms (rms_error)",
                "reference_specular (double)", {1e-3}, [=] { return narrow_error(roughness); });
    } else {
      cases.add(
          "automatic-" + text, "every texel of 4 x 4 faces of noise of 16 at roughness " + text + " (maximum_error)",
          "reference_specular (double)", {1e-2}, [=] { return error_of(roughness, 4, PrefilterMethod::automatic); });
    }
    cases.add("range-" + text,
              "one texel of 1000 over 1 at roughness " + text +
                  ": nothing below 1 or above 1000 by more than maximum_error of it",
              "the source's range", {1e-2}, [=] { return outside_of_range(roughness); });
  }
  for (const std::string text : {"1e-3", "0.1", "1"}) {
    cases.add("reference-" + text, "method `reference` at roughness " + text + " is the truth, in float",
              "reference_specular (double)", {1e-7},
              [value = std::stod(text)] { return error_of(value, 4, PrefilterMethod::reference); });
  }
  cases.add_count("schedules", "every schedule rises from 0 and stays in [0, 1], for 1 to 16 mips", "its definition",
                  schedules_unsound);
}

// Kernels on the horizon: cosine and GGX lobes over a half-lit sphere, where all of the light is at grazing angles.
namespace {

constexpr double kPi = std::numbers::pi;

/// Returns the unit direction at that angle from the nadir.
glm::dvec3 from_nadir(double degrees) {
  const double angle = degrees * kPi / 180.0;
  return {std::sin(angle) * 0.6, -std::cos(angle), std::sin(angle) * 0.8};
}

/// Returns a lit upper half's irradiance on a normal `degrees` from the nadir: pi (1 - cos) / 2, as pi sin^2(half).
double half_lit_irradiance(double degrees) {
  const double half = std::sin(0.5 * degrees * kPi / 180.0);
  return kPi * half * half;
}

template <class Image>
double cosine_error(const Image& map, double degrees) {
  return std::abs(direct_irradiance(map.view(), from_nadir(degrees)).x - half_lit_irradiance(degrees)) / kPi;
}

template <class Image>
double cosine_relative_error(const Image& map, double degrees) {
  return relative_error(direct_irradiance(map.view(), from_nadir(degrees)).x, half_lit_irradiance(degrees));
}

/// A lobe's share of a half-lit sphere and that of its mirror image in the horizon must add up to 1.
double mirrored_lobes(double roughness, const std::vector<glm::dvec3>& directions) {
  const Cubemap map = upper_half_cube(32);
  std::vector<glm::dvec3> both = directions;
  for (const glm::dvec3& d : directions) both.emplace_back(d.x, -d.y, d.z);
  const std::vector<glm::dvec3> light = reference_specular(map.view(), roughness, both);
  double worst = 0.0;
  for (std::size_t k = 0; k < directions.size(); ++k) {
    worst = worse(worst, std::abs(light[k].x + light[k + directions.size()].x - 1.0));
  }
  return worst;
}

std::vector<glm::dvec3> grazing_directions() {
  std::vector<glm::dvec3> directions;
  for (const double degrees : {90.0, 90.0 + 1e-9, 90.0 + 1e-4, 91.0}) {
    for (const double azimuth : {0.1, 0.7, 1.3, 2.9}) {
      const double elevation = (degrees - 90.0) * kPi / 180.0;
      directions.emplace_back(std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                              std::cos(elevation) * std::cos(azimuth));
    }
  }
  return directions;
}

/// The prefilter's texels about the horizon, by any method, and their mirror images.
double mirrored_texels(double roughness) {
  constexpr int size = 8;
  PrefilterOptions options{.size = size};
  options.roughness = {roughness};
  const PrefilteredSpecular found = prefilter_specular(upper_half_cube(32).view(), options);
  double worst = 0.0;
  for (const int face : {0, 1, 4, 5}) {
    for (int row = 0; row < size / 2; ++row) {
      for (int column = 0; column < size; ++column) {
        const float* const texels = found.cubemap.face(0, face);
        const auto at = [&](int r) { return texels[static_cast<std::ptrdiff_t>(3) * (r * size + column)]; };
        worst = worse(worst, std::abs(static_cast<double>(at(row)) + static_cast<double>(at(size - 1 - row)) - 1.0));
      }
    }
  }
  return worst;
}

/// A lobe towards the nadir must receive nothing of a lit upper half.
double lobe_behind(double roughness) {
  const Cubemap map = upper_half_cube(32);
  return reference_specular(map.view(), roughness, {glm::dvec3(0.0, -1.0, 0.0)})[0].x;
}

void add_cosine(StabilityCases& cases) {
  const std::string truth = "closed form: pi sin^2 of half the angle";
  for (const std::string degrees : {"0", "1e-3", "1", "30", "89.999", "90", "90.001", "179", "180"}) {
    const double angle = std::stod(degrees);
    cases.add(
        "cosine-cube-" + degrees,
        "irradiance of a lit upper half on a normal " + degrees + " degrees from the nadir, over pi (cubemap of 64)",
        truth, {1e-5}, [angle] { return cosine_error(upper_half_cube(64), angle); });
    cases.add("cosine-lat-long-" + degrees, "the same on a lat-long of 256 x 128", truth, {1e-5},
              [angle] { return cosine_error(upper_half_lat_long(256, 128), angle); });
  }
  cases.add("cosine-sliver-1e-3", "of a normal 1e-3 degrees from the nadir the sliver of light itself is right to 1 %",
            truth, {1e-2}, [] { return cosine_relative_error(upper_half_lat_long(256, 128), 1e-3); });
  cases.add("cosine-sliver-5", "of a normal 5 degrees from the nadir it is right to 1 %", truth, {1e-2},
            [] { return cosine_relative_error(upper_half_lat_long(256, 128), 5.0); });
}

void add_lobes(StabilityCases& cases) {
  for (const std::string text : {"0.1", "0.5", "1"}) {
    const double roughness = std::stod(text);
    cases.add(
        "ggx-truth-" + text,
        "reference_specular of a half-lit sphere on the horizon and its mirror image add up to 1, roughness " + text,
        "closed form: 1", {1e-5}, [roughness] { return mirrored_lobes(roughness, grazing_directions()); });
    cases.add("ggx-behind-" + text, "a lobe that looks away from all light sees none, roughness " + text,
              "closed form: 0", {1e-12}, [roughness] { return lobe_behind(roughness); });
    cases.add("ggx-spectral-" + text,
              "prefiltered texels and their mirror images add up to 1, roughness " + text + " (maximum_error)",
              "closed form: 1", {1e-2}, [roughness] { return mirrored_texels(roughness); });
  }
}

}  // namespace

void add_grazing_cases(StabilityCases& cases) {
  add_cosine(cases);
  add_lobes(cases);
}

}  // namespace welkin::test::stability
