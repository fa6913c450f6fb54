// The smallest sizes: 1 and 2 texels, tables of one entry, chains of one mip.
#include <cmath>

#include "report/stability/cases.h"
#include "report/stability/maps.h"
#include "report/stability/measures.h"
#include "welkin/brdf_table.h"
#include "welkin/irradiance_cubemap.h"
#include "welkin/mip_chain.h"
#include "welkin/projection.h"
#include "welkin/resampling.h"
#include "welkin/specular.h"

namespace welkin::report::stability {
namespace {

ProjectionOptions options_of(int bands, Quadrature quadrature) {
  ProjectionOptions options;
  options.bands = bands;
  options.quadrature = quadrature;
  return options;
}

template <class Image>
double projection_error(const Image& map, int bands, Quadrature quadrature) {
  const ProjectionOptions options = options_of(bands, quadrature);
  return relative_error(project(map.view(), options).radiance, reference_projection(map.view(), options));
}

double prefilter_error(int source, int size) {
  const CubemapImage map = noise_cube(source, 6);
  PrefilterOptions options{.size = size};
  options.roughness = {0.4};
  const PrefilteredSpecular found = prefilter_specular(map.view(), options);
  return worst_relative_error(texels(found.cubemap, 0), reference_specular(map.view(), 0.4, texel_directions(size)));
}

/// A cube of one texel a face, to a lat-long and back.
double round_trip_error() {
  const CubemapImage map = noise_cube(1, 8);
  const CubemapImage back =
      to_cubemap(to_lat_long(map.view(), 64, 32, glm::dmat3(1.0), {}, ResampleFilter::area).view(), 1);
  double worst = 0.0;
  const glm::dvec3 before = project(map.view()).diagnostics.flux;
  worst = relative_error(project(back.view()).diagnostics.flux, before);
  return worst;
}

/// Every result of a 1 x 1 and 2 x 2 cubemap is finite and not negative.
double small_results() {
  double wrong = 0.0;
  for (const int size : {1, 2}) {
    const CubemapImage map = noise_cube(size, 7);
    wrong += unsound(to_lat_long(map.view(), 1, 1).pixels) + unsound(to_lat_long(map.view(), 3, 1).pixels);
    wrong += unsound(to_cubemap(to_lat_long(map.view(), 2, 1).view(), size).pixels);
    wrong += wrong_if(build_mips(map.view()).levels() != size);
    const BrdfTable& table = *brdf_table({.width = size, .height = size});
    wrong += unsound(table.values);
  }
  return wrong;
}

double one_texel_irradiance() {
  const CubemapImage map = uniform_cube(1, 2.0F);
  const SphericalHarmonics light = irradiance_from_radiance(project(map.view()).radiance);
  double worst = 0.0;
  for (const float value : irradiance_cubemap(light, 1).pixels) {
    worst = worse(worst, float_ulps(value, 2.0 * 3.14159265358979323846));
  }
  return worst;
}

/// A chain of one mip is what its own roughness asks for.
double one_mip_error(double roughness) {
  const LatLongImage map = noise_lat_long(32, 16, 3);
  PrefilterOptions options{.size = 8, .mips = 1};
  options.roughness = {roughness};
  const PrefilteredSpecular found = prefilter_specular(map.view(), options);
  if (found.cubemap.levels() != 1) return 1e300;
  return worst_relative_error(texels(found.cubemap, 0), reference_specular(map.view(), roughness, texel_directions(8)));
}

double one_mip_copy() {
  const CubemapImage map = noise_cube(8, 3);
  const PrefilteredSpecular found = prefilter_specular(map.view(), {.size = 8, .mips = 1});
  double wrong = wrong_if(found.cubemap.levels() != 1);
  for (std::size_t k = 0; k < map.pixels.size(); ++k) wrong += wrong_if(found.cubemap.face(0, 0)[k] != map.pixels[k]);
  return wrong;
}

void add_projections(StabilityCases& cases) {
  const auto add = [&](const std::string& name, const std::string& what, std::function<double()> measure) {
    cases.push_back({"sizes/" + name, what, "reference_projection (double)", StabilityUnit::relative, 5e-7,
                     [measure](const Control&) { return measure(); }});
  };
  for (const int size : {1, 2, 3}) {
    const std::string number = std::to_string(size);
    add("cube-" + number, "three bands of a cubemap of " + number,
        [size] { return projection_error(noise_cube(size, 1), 3, Quadrature::exact); });
    add("cube-" + number + "-bands-16", "16 bands of a cubemap of " + number,
        [size] { return projection_error(noise_cube(size, 1), 16, Quadrature::exact); });
    add("cube-" + number + "-midpoint", "three bands of a cubemap of " + number + " by the midpoint rule",
        [size] { return projection_error(noise_cube(size, 1), 3, Quadrature::midpoint); });
  }
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 1}, {1, 2}, {3, 2}}) {
    const std::string shape = std::to_string(width) + "x" + std::to_string(height);
    add("lat-long-" + shape, "three bands of a lat-long of " + shape, [width = width, height = height] {
      return projection_error(noise_lat_long(width, height, 1), 3, Quadrature::exact);
    });
    add("lat-long-" + shape + "-bands-16", "16 bands of a lat-long of " + shape, [width = width, height = height] {
      return projection_error(noise_lat_long(width, height, 1), 16, Quadrature::exact);
    });
  }
}

}  // namespace

void add_size_cases(StabilityCases& cases) {
  add_projections(cases);
  for (const auto& [source, size] : {std::pair{1, 1}, {2, 1}, {1, 2}, {2, 8}, {32, 1}}) {
    cases.push_back({"sizes/prefilter-" + std::to_string(source) + "-to-" + std::to_string(size),
                     "faces of " + std::to_string(source) + " texels prefiltered at roughness 0.4 to faces of " +
                         std::to_string(size) + " (maximum_error)",
                     "reference_specular (double)", StabilityUnit::relative, 1e-2,
                     [source = source, size = size](const Control&) { return prefilter_error(source, size); }});
  }
  for (const double roughness : {0.3, 1.0}) {
    cases.push_back({std::string("sizes/one-mip-") + (roughness < 1.0 ? "0.3" : "1"),
                     std::string("a chain whose only mip has roughness ") + (roughness < 1.0 ? "0.3" : "1"),
                     "reference_specular (double)", StabilityUnit::relative, 1e-2,
                     [roughness](const Control&) { return one_mip_error(roughness); }});
  }
  cases.push_back({"sizes/one-mip-copy", "a chain of one mip without roughness is the source's texels",
                   "the source, bit for bit", StabilityUnit::count, 0.0,
                   [](const Control&) { return one_mip_copy(); }});
  cases.push_back({"sizes/small-results", "resampling, mips and BRDF tables of 1 and 2 texels are finite, not negative",
                   "what the sizes ask for", StabilityUnit::count, 0.0,
                   [](const Control&) { return small_results(); }});
  cases.push_back({"sizes/round-trip-1", "a cubemap of 1 to a lat-long and back keeps its flux", "flux of the source",
                   StabilityUnit::relative, 1e-6, [](const Control&) { return round_trip_error(); }});
  cases.push_back({"sizes/irradiance-1", "irradiance cubemap of 1 texel of a uniform cubemap of 1", "closed form: 2 pi",
                   StabilityUnit::ulps, 4.0, [](const Control&) { return one_texel_irradiance(); }});
}

}  // namespace welkin::report::stability
