// The fast transform gives what the definition gives, in double, at any size and number of bands.
#include <glm/geometric.hpp>
#include <utility>
#include <vector>

#include "specular/direct_transform.h"
#include "specular/spectrum.h"
#include "support/catch.h"
#include "support/test_environments.h"
#include "welkin/projection.h"

namespace welkin::test {
namespace {

LatLongImage image_of(Content content, int width, int height, std::uint32_t seed) {
  const TestLatLong made = make_lat_long(content, width, height, seed);
  return {width, height, made.pixels};
}

}  // namespace

TEST_CASE("Analysis gives the integrals over the texels' areas", "[specular][transform]") {
  // More bands than texels, fewer, even, odd, prime; rows of any ratio.
  const std::pair<int, int> sizes[] = {{1, 1},  {2, 1},  {1, 2},   {3, 2},    {2, 3},   {7, 7},    {1, 64},
                                       {64, 1}, {64, 3}, {7, 257}, {257, 64}, {64, 32}, {128, 64}, {257, 2}};
  for (const auto& [width, height] : sizes) {
    for (const int bands : {1, 2, 3, 33, 64}) {
      CAPTURE(width, height, bands);
      const LatLongImage image = image_of(Content::random, width, height, 5);
      const Coefficients truth = direct_analysis(image, bands);
      const specular::Spectrum spectrum = specular::analyse(image.view(), bands, {});
      REQUIRE(spectrum.bands() == bands);
      CHECK(largest_difference(coefficients_of(spectrum), truth) < 3e-7 * largest(truth));
    }
  }
}

TEST_CASE("The first bands are those of the reference projection", "[specular][transform]") {
  for (const auto& [width, height] : {std::pair{64, 32}, std::pair{33, 17}, std::pair{2, 1}, std::pair{512, 256}}) {
    for (const int bands : {1, 3, 16}) {
      CAPTURE(width, height, bands);
      const LatLongImage image = image_of(Content::high_range, width, height, 6);
      ProjectionOptions options;
      options.bands = bands;
      const SphericalHarmonics truth = reference_projection(image.view(), options);
      const SphericalHarmonics found = specular::analyse(image.view(), bands + 5, {}).harmonics(bands);
      double most = 0.0;
      double error = 0.0;
      for (std::size_t k = 0; k < truth.coefficients().size(); ++k) {
        most = std::max(most, glm::length(truth.coefficients()[k]));
        error = std::max(error, glm::length(found.coefficients()[k] - truth.coefficients()[k]));
      }
      CHECK(error < 1e-6 * most);
    }
  }
}

TEST_CASE("Synthesis gives the sum over the harmonics", "[specular][transform]") {
  for (const int bands : {1, 2, 7, 33, 64}) {
    const LatLongImage image = image_of(Content::random, 64, 33, 7);
    const specular::Spectrum spectrum = specular::analyse(image.view(), bands + 1, {});
    const Coefficients c = coefficients_of(spectrum);
    std::vector<double> zonal;
    for (int l = 0; l < bands; ++l) zonal.push_back(1.0 / (1.0 + 0.03 * l * l));
    for (const auto& [rings, columns] : {std::pair{1, 128}, std::pair{2, 130}, std::pair{7, 134}, std::pair{33, 162},
                                         std::pair{64, 128}, std::pair{129, 254}}) {
      CAPTURE(bands, rings, columns);
      image::SphereGrid grid(rings, columns, image::GridContent::samples);
      specular::synthesise(spectrum, zonal, grid, {});
      double most = 0.0;
      double error = 0.0;
      for (int ring = 0; ring < rings; ring += 1 + rings / 9) {
        for (int column = 0; column < columns; column += 1 + columns / 7) {
          const double theta = std::numbers::pi * (ring + 0.5) / rings;
          const double longitude = std::numbers::pi - 2.0 * std::numbers::pi * (column + 0.5) / columns;
          for (int channel = 0; channel < 3; ++channel) {
            const double truth = direct_value(c, zonal, channel, theta, longitude);
            most = std::max(most, std::abs(truth));
            error = std::max(error, std::abs(truth - static_cast<double>(grid.texel(column, ring)[channel])));
          }
          CHECK(grid.texel(column, ring)[3] == 0.0F);
        }
      }
      CHECK(error < 1e-6 * most);
    }
  }
}

}  // namespace welkin::test
