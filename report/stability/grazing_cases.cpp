// Kernels on the horizon: cosine and GGX lobes over a half-lit sphere, where all of the light is at grazing angles.
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "report/stability/cases.h"
#include "report/stability/maps.h"
#include "report/stability/measures.h"
#include "welkin/irradiance.h"
#include "welkin/specular.h"

namespace welkin::report::stability {
namespace {

constexpr double kPi = std::numbers::pi;

/// A unit direction that lies so far from the nadir.
glm::dvec3 from_nadir(double degrees) {
  const double angle = degrees * kPi / 180.0;
  return {std::sin(angle) * 0.6, -std::cos(angle), std::sin(angle) * 0.8};
}

/// Irradiance of a lit upper half on a normal `degrees` from the nadir: pi (1 - cos) / 2, written as pi sin^2(half).
double half_lit_irradiance(double degrees) {
  const double half = std::sin(0.5 * degrees * kPi / 180.0);
  return kPi * half * half;
}

template <class Image>
double cosine_error(const Image& map, double degrees) {
  return std::abs(reference_irradiance(map.view(), from_nadir(degrees)).x - half_lit_irradiance(degrees)) / kPi;
}

template <class Image>
double cosine_relative_error(const Image& map, double degrees) {
  return relative_error(reference_irradiance(map.view(), from_nadir(degrees)).x, half_lit_irradiance(degrees));
}

/// What a lobe sees of a half-lit sphere, plus what its mirror image in the horizon sees: all of it.
double mirrored_lobes(double roughness, const std::vector<glm::dvec3>& directions) {
  const CubemapImage map = upper_half_cube(32);
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
double mirrored_texels(double roughness, PrefilterMethod method) {
  constexpr int size = 8;
  PrefilterOptions options{.size = size};
  options.roughness = {roughness};
  options.method = method;
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

/// What a lobe towards the nadir sees of a lit upper half: nothing.
double lobe_behind(double roughness) {
  const CubemapImage map = upper_half_cube(32);
  return reference_specular(map.view(), roughness, {glm::dvec3(0.0, -1.0, 0.0)})[0].x;
}

void add_cosine(StabilityCases& cases) {
  for (const char* const degrees : {"0", "1e-3", "1", "30", "89.999", "90", "90.001", "179", "180"}) {
    const double angle = std::stod(degrees);
    cases.push_back({std::string("grazing/cosine-cube-") + degrees,
                     "irradiance of a lit upper half on a normal " + std::string(degrees) +
                         " degrees from the nadir, over pi (cubemap of 64)",
                     "closed form: pi sin^2 of half the angle", StabilityUnit::relative, 1e-5,
                     [angle](const Control&) { return cosine_error(upper_half_cube(64), angle); }});
    cases.push_back({std::string("grazing/cosine-lat-long-") + degrees, "the same on a lat-long of 256 x 128",
                     "closed form: pi sin^2 of half the angle", StabilityUnit::relative, 1e-5,
                     [angle](const Control&) { return cosine_error(upper_half_lat_long(256, 128), angle); }});
  }
  cases.push_back(
      {"grazing/cosine-sliver-1e-3",
       "of a normal 1e-3 degrees from the nadir the sliver of light itself is right to 1 %",
       "closed form: pi sin^2 of half the angle", StabilityUnit::relative, 1e-2,
       [](const Control&) { return cosine_relative_error(upper_half_lat_long(256, 128), 1e-3); },
       "A texel that the horizon cuts is divided into cells taken at their centres; a sliver thinner than a "
       "cell lies between them. Its light is 1e-10 of the sphere's: nothing depends on it. Where it does, "
       "integrate a finer map."});
  cases.push_back({"grazing/cosine-sliver-5", "of a normal 5 degrees from the nadir it is right to 1 %",
                   "closed form: pi sin^2 of half the angle", StabilityUnit::relative, 1e-2,
                   [](const Control&) { return cosine_relative_error(upper_half_lat_long(256, 128), 5.0); }});
}

void add_lobes(StabilityCases& cases) {
  for (const char* const text : {"0.1", "0.5", "1"}) {
    const double roughness = std::stod(text);
    cases.push_back(
        {std::string("grazing/ggx-truth-") + text,
         "reference_specular of a half-lit sphere on the horizon and its mirror image add up to 1, roughness " +
             std::string(text),
         "closed form: 1", StabilityUnit::relative, 1e-5,
         [roughness](const Control&) { return mirrored_lobes(roughness, grazing_directions()); }});
    cases.push_back({std::string("grazing/ggx-behind-") + text,
                     "a lobe that looks away from all light sees none, roughness " + std::string(text),
                     "closed form: 0", StabilityUnit::relative, 1e-12,
                     [roughness](const Control&) { return lobe_behind(roughness); }});
    cases.push_back(
        {std::string("grazing/ggx-spectral-") + text,
         "prefiltered texels and their mirror images add up to 1, roughness " + std::string(text) + " (maximum_error)",
         "closed form: 1", StabilityUnit::relative, 1e-2,
         [roughness](const Control&) { return mirrored_texels(roughness, PrefilterMethod::automatic); }});
    cases.push_back({std::string("grazing/ggx-sampled-") + text, "the same by samples, roughness " + std::string(text),
                     "closed form: 1", StabilityUnit::relative, 2e-2,
                     [roughness](const Control&) { return mirrored_texels(roughness, PrefilterMethod::sampled); }});
  }
}

}  // namespace

void add_grazing_cases(StabilityCases& cases) {
  add_cosine(cases);
  add_lobes(cases);
}

}  // namespace welkin::report::stability
