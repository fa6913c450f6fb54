#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "image/geometry.h"
#include "image/pixels.h"
#include "platform/float_environment.h"
#include "platform/standard_library.h"
#include "welkin/spherical_harmonics.h"

namespace welkin {
namespace {

constexpr double kMiddleGrey = 0.18;
constexpr double kBrightSurroundings = 2.0 * kMiddleGrey;
constexpr double kPercentile = 0.75;
constexpr double kUnclipped = 0.99;   // what is brighter counts as much as this percentile
constexpr double kDark = 1.0 / 32.0;  // of the mean: what is darker is not lit

/// A texel's luminance, and its solid angle but for a factor.
struct Sample {
  double luminance;
  double weight;
};

template <class Rgb>
double luminance(const Rgb& rgb) {
  return 0.2126 * static_cast<double>(rgb[0]) + 0.7152 * static_cast<double>(rgb[1]) +
         0.0722 * static_cast<double>(rgb[2]);
}

/// The quotient where light and quotient are finite and above 0.
double exposure_to(double shown, double light) {
  const double exposure = shown / light;
  return light > 0.0 && std::isfinite(exposure) && exposure > 0.0 ? exposure : 1.0;
}

/// Returns the luminance that `share` of the solid angle does not exceed, counting only samples of at least `least`.
/// `samples` are sorted by luminance.
double percentile(const std::vector<Sample>& samples, double share, double least) {
  double whole = 0.0;
  for (const Sample& sample : samples) whole += sample.luminance >= least ? sample.weight : 0.0;
  double below = 0.0;
  for (const Sample& sample : samples) {
    if (sample.luminance < least) continue;
    below += sample.weight;
    if (below >= share * whole) return sample.luminance;
  }
  return samples.back().luminance;
}

double mean_luminance(const std::vector<Sample>& samples, double most) {
  double sum = 0.0;
  double weights = 0.0;
  for (const Sample& sample : samples) {
    sum += sample.weight * std::min(sample.luminance, most);
    weights += sample.weight;
  }
  return sum / weights;
}

double exposure_of(std::vector<Sample> samples) {
  // Stable: sums over equal luminances must not depend on whose sort it is.
  platform::ranges::stable_sort(samples, [](const Sample& a, const Sample& b) { return a.luminance < b.luminance; });
  const double most = percentile(samples, kUnclipped, 0.0);
  // A lamp of less than a hundredth of the sphere before black: only itself can be shown.
  const double mean = mean_luminance(samples, most > 0.0 ? most : samples.back().luminance);
  const double least = std::max(kDark * mean, std::numeric_limits<double>::min());
  return exposure_to(kBrightSurroundings, percentile(samples, kPercentile, least));
}

}  // namespace

double exposure_of(const SphericalHarmonics& radiance) {
  const platform::FloatingPointScope floating_point;
  return exposure_to(kMiddleGrey, luminance(mean_radiance(radiance)));
}

namespace {

/// `row_of(row)`: its first texel; `weight_of(row, column)`.
template <class RowOf, class WeightOf>
std::vector<Sample> samples_of(PixelFormat format, int columns, int rows, const RowOf& row_of,
                               const WeightOf& weight_of) {
  std::vector<float> decoded(3 * static_cast<std::size_t>(columns));
  std::vector<Sample> samples;
  samples.reserve(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  for (int row = 0; row < rows; ++row) {
    image::decode_texels(format, row_of(row), columns, decoded.data());
    const float* rgb = decoded.data();
    for (int column = 0; column < columns; ++column, rgb += 3) {
      const double light = luminance(rgb);
      samples.push_back({light > 0.0 ? light : 0.0, weight_of(row, column)});  // NaN is above nothing
    }
  }
  return samples;
}

std::vector<Sample> samples_of(const CubemapView& image) {
  const int size = image.size;
  const auto row_of = [&](int row) { return image::row_of(image, row / size, row % size); };
  return samples_of(image.format, size, 6 * size, row_of, [size](int row, int column) {
    const double u = (2.0 * column + 1.0) / size - 1.0;
    const double v = (2.0 * (row % size) + 1.0) / size - 1.0;
    const double squared = 1.0 + u * u + v * v;
    return 1.0 / (squared * std::sqrt(squared));
  });
}

std::vector<Sample> samples_of(const LatLongView& image) {
  std::vector<double> weights;
  weights.reserve(static_cast<std::size_t>(image.height));
  for (int row = 0; row < image.height; ++row)
    weights.push_back(image::lat_long_texel_solid_angle(image.width, image.height, row));
  const auto row_of = [&](int row) { return image::row_of(image, row); };
  return samples_of(image.format, image.width, image.height, row_of,
                    [&](int row, int /*column*/) { return weights[static_cast<std::size_t>(row)]; });
}

}  // namespace

double exposure_of(const EnvironmentView& image) {
  const platform::FloatingPointScope floating_point;
  image::check_view(image);
  return exposure_of(image::with_view(image, [](const auto& view) { return samples_of(view); }));
}

}  // namespace welkin
