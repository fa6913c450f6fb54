// What the transform must keep at hundreds of bands: energy, symmetry, dark skies beside a sun.
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <vector>

#include "specular/direct_transform.h"
#include "specular/spectrum.h"
#include "support/catch.h"
#include "support/test_environments.h"
#include "tables/gauss_legendre.h"
#include "welkin/image.h"

namespace welkin::test {
namespace {

using image::GridContent;
using image::SphereGrid;

/// P(l, m) of one angle for all l < bands: the unscaled recurrence, upwards in l, in double.
std::vector<double> legendre_column(int m, int bands, double theta) {
  std::vector<double> column(static_cast<std::size_t>(bands), 0.0);
  double here = std::sqrt(0.25 / std::numbers::pi);
  for (int k = 1; k <= m; ++k) here *= std::sin(theta) * std::sqrt((2.0 * k + 1.0) / (2.0 * k));
  double before = 0.0;
  const double square = static_cast<double>(m) * m;
  for (int l = m; l < bands; ++l) {
    column[static_cast<std::size_t>(l)] = here;
    const double next_square = (l + 1.0) * (l + 1.0);
    const double a = std::sqrt((4.0 * next_square - 1.0) / (next_square - square));
    const double b = l > m ? std::sqrt((2.0 * l + 3.0) * (static_cast<double>(l) * l - square) /
                                       ((2.0 * l - 1.0) * (next_square - square)))
                           : 0.0;
    const double next = a * std::cos(theta) * here - b * before;
    before = here;
    here = next;
  }
  return column;
}

LatLongImage uniform(int width, int height, float value) {
  return {width, height, std::vector<float>(static_cast<std::size_t>(3 * width * height), value)};
}

}  // namespace

TEST_CASE("A uniform environment has its mean and nothing else", "[specular][transform]") {
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{9, 4}, std::pair{256, 129}, std::pair{1024, 512}}) {
    CAPTURE(width, height);
    const specular::Spectrum spectrum = specular::analyse(uniform(width, height, 0.7F).view(), 100, {});
    const double mean = static_cast<double>(0.7F) * std::sqrt(4.0 * std::numbers::pi);
    CHECK(std::abs(spectrum.value(0, 0, 0) - mean) < 2e-7 * mean);
    double rest = 0.0;
    for (int m = 0; m < 100; ++m) {
      for (int l = std::max(1, m); l < 100; ++l) rest = std::max(rest, std::abs(spectrum.value(l, m, 1)));
    }
    CHECK(rest < 2e-7 * mean);
  }
}

TEST_CASE("Turning the source by whole texels turns the phases", "[specular][transform]") {
  const int width = 48;
  const int height = 31;
  const int bands = 40;
  const int shift = 5;
  const TestLatLong source = make_lat_long(Content::random, width, height, 51);
  TestLatLong turned = source;
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      for (int c = 0; c < 3; ++c) {
        turned.pixels[static_cast<std::size_t>(3 * (row * width + (column + shift) % width) + c)] =
            source.pixels[static_cast<std::size_t>(3 * (row * width + column) + c)];
      }
    }
  }
  const specular::Spectrum a = specular::analyse(source.view(), bands, {});
  const specular::Spectrum b = specular::analyse(turned.view(), bands, {});
  double error = 0.0;
  for (int m = 0; m < bands; ++m) {
    // Columns run against longitude: e^(-i m phi) gains e^(+i m 2 pi shift / width).
    const std::complex<double> phase = std::polar(1.0, 2.0 * std::numbers::pi * m * shift / width);
    for (int l = m; l < bands; ++l) {
      for (int c = 0; c < 3; ++c) error = std::max(error, std::abs(b.value(l, m, c) - phase * a.value(l, m, c)));
    }
  }
  CHECK(error < 3e-7 * largest(coefficients_of(a)));
}

TEST_CASE("A band-limited field goes there and back", "[specular][transform]") {
  // Rings fine enough that texels of the samples' values are nearly the field: what is lost is texels' own blur.
  const int bands = 12;
  const TestLatLong noise = make_lat_long(Content::random, 40, 20, 52);
  const specular::Spectrum first = specular::analyse(noise.view(), bands, {});
  const std::vector<double> flat(static_cast<std::size_t>(bands), 1.0);
  double last = 0.0;
  for (const int rings : {128, 256}) {
    SphereGrid grid(rings, 2 * rings, GridContent::samples);
    specular::synthesise(first, flat, grid, {});
    LatLongImage image{2 * rings, rings, {}};
    for (int ring = 0; ring < rings; ++ring) {
      for (int column = 0; column < 2 * rings; ++column) {
        const float* const texel = grid.texel(column, ring);
        image.pixels.insert(image.pixels.end(), texel, texel + 3);
      }
    }
    const specular::Spectrum second = specular::analyse(image.view(), bands, {});
    const double error =
        largest_difference(coefficients_of(first), coefficients_of(second)) / largest(coefficients_of(first));
    CHECK(error < 0.3 * bands * bands / (rings * rings));
    if (rings == 256) CHECK(error < 0.3 * last);  // second order
    last = error;
  }
}

TEST_CASE("A sun of a million leaves the sky beside it right", "[specular][transform]") {
  // One texel over a background of 1. Its coefficients come from its own integrals, in double.
  const int width = 1024;
  const int height = 512;
  const int bands = 384;
  const int column = 300;
  const double radiance = 1e6;
  for (const int row : {0, 60, 255, 400}) {
    CAPTURE(row);
    LatLongImage image = uniform(width, height, 1.0F);
    for (int c = 0; c < 3; ++c) image.pixels[static_cast<std::size_t>(3 * (row * width + column) + c)] = 1e6F;
    const specular::Spectrum spectrum = specular::analyse(image.view(), bands, {});
    const simd::GaussRule rule = tables::gauss_legendre(6);
    const double longitude = std::numbers::pi * (1.0 - 2.0 * (column + 0.5) / width);
    double squares = 0.0;  // of the errors of a field through a lobe of roughness 0.111
    double largest_error = 0.0;
    const double alpha = 0.111 * 0.111;
    for (int m = 0; m < bands; ++m) {
      std::vector<double> integrals(static_cast<std::size_t>(bands), 0.0);
      for (int k = 0; k < rule.order; ++k) {
        const double theta = std::numbers::pi * (row + 0.5 + 0.5 * rule.nodes[k]) / height;
        const std::vector<double> functions = legendre_column(m, bands, theta);
        const double weight = rule.weights[k] * 0.5 * std::numbers::pi / height * std::sin(theta);
        for (int l = m; l < bands; ++l) {
          integrals[static_cast<std::size_t>(l)] += weight * functions[static_cast<std::size_t>(l)];
        }
      }
      const double extent = m > 0 ? 2.0 * std::sin(m * std::numbers::pi / width) / m : 2.0 * std::numbers::pi / width;
      for (int l = m; l < bands; ++l) {
        std::complex<double> truth =
            (radiance - 1.0) * integrals[static_cast<std::size_t>(l)] * std::polar(extent, -m * longitude);
        if (l == 0) truth += std::sqrt(4.0 * std::numbers::pi);
        const double error = std::abs(truth - spectrum.value(l, m, 0));
        largest_error = std::max(largest_error, error);
        squares += (m > 0 ? 2.0 : 1.0) * error * error * std::exp(-4.0 * alpha * l);
      }
    }
    CHECK(largest_error < 5e-4);                                  // coefficients go up to 40
    CHECK(std::sqrt(squares / (4.0 * std::numbers::pi)) < 6e-4);  // of the background, which is 1

    // And back: far from the sun and near it, against the sum in double of the very same coefficients.
    std::vector<double> lobe;
    for (int l = 0; l < bands; ++l) lobe.push_back(std::exp(-2.0 * alpha * l));
    SphereGrid grid(height, width, GridContent::samples);
    specular::synthesise(spectrum, lobe, grid, {});
    double error = 0.0;
    for (const int ring : {1, 61, 254, 301, 510}) {
      const double theta = std::numbers::pi * (ring + 0.5) / height;
      std::vector<std::complex<double>> orders;
      for (int m = 0; m < bands; ++m) {
        const std::vector<double> functions = legendre_column(m, bands, theta);
        std::complex<double> sum = 0.0;
        for (int l = m; l < bands; ++l) {
          const auto degree = static_cast<std::size_t>(l);
          sum += lobe[degree] * functions[degree] * spectrum.value(l, m, 2);
        }
        orders.push_back(m > 0 ? 2.0 * sum : sum);
      }
      for (int place = 7; place < width; place += 97) {
        const double angle = std::numbers::pi * (1.0 - 2.0 * (place + 0.5) / width);
        double truth = 0.0;
        for (int m = 0; m < bands; ++m) {
          truth += (orders[static_cast<std::size_t>(m)] * std::polar(1.0, m * angle)).real();
        }
        const double difference = std::abs(truth - static_cast<double>(grid.texel(place, ring)[2]));
        error = std::max(error, difference / std::max(1.0, std::abs(truth)));
      }
    }
    CHECK(error < 1e-3);  // relative; the lobe's peak is near 500
  }
}

TEST_CASE("Many bands begin where they should", "[specular][transform]") {
  // 1536 bands, the most there are, on few rings: every function that matters is there, however small it begins.
  const int bands = 1536;
  specular::Spectrum spectrum(bands);
  const int degree = bands - 1;
  const int order = GENERATE(0, 1, 40, 300, 1000, 1500, 1535);
  spectrum.order(order)[8 * (degree - order)] = 1.0F;
  std::vector<double> zonal(static_cast<std::size_t>(bands), 0.0);
  zonal.back() = 1.0;
  const int rings = 24;
  SphereGrid grid(rings, 2 * bands, GridContent::samples);
  specular::synthesise(spectrum, zonal, grid, {});
  const int column = 11;
  const double longitude = std::numbers::pi * (1.0 - (column + 0.5) / bands);
  double error = 0.0;
  for (int ring = 0; ring < rings; ++ring) {
    const double theta = std::numbers::pi * (ring + 0.5) / rings;
    const double truth =
        (order > 0 ? 2.0 : 1.0) * legendre_column(order, bands, theta).back() * std::cos(order * longitude);
    error = std::max(error, std::abs(truth - static_cast<double>(grid.texel(column, ring)[0])));
  }
  CHECK(error < 2e-5);  // values are of order 1
}

}  // namespace welkin::test
