#include "sh/error_estimate.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <vector>

namespace welkin::sh {
namespace {

constexpr double kRounding = 2e-7;

/// |c_l| of each band, over orders and channels.
std::vector<double> band_norms(const SphericalHarmonics& radiance) {
  std::vector<double> norms;
  for (int l = 0; l < radiance.bands(); ++l) {
    double sum = 0.0;
    for (int m = -l; m <= l; ++m) sum += glm::dot(radiance.at(l, m), radiance.at(l, m));
    norms.push_back(std::sqrt(sum));
  }
  return norms;
}

}  // namespace

double estimate_error(const SphericalHarmonics& radiance, const ErrorSources& sources) {
  const std::vector<double> norms = band_norms(radiance);
  double total_squared = 0.0;
  for (const double norm : norms) total_squared += norm * norm;
  if (total_squared == 0.0) return 0.0;
  double error_squared = kRounding * kRounding * total_squared;
  const auto add = [&](double error) { error_squared += error * error; };
  // Without a band 2 nothing is known of how concentrated the light is; band 1 is the next best witness.
  const std::size_t witness = std::min<std::size_t>(2, norms.size() - 1);
  const double point_norm = std::sqrt(2.0 * static_cast<double>(witness) + 1.0) * norms[0];
  const double point_share = norms[0] > 0.0 ? std::min(1.0, norms[witness] / point_norm) : 1.0;
  for (std::size_t band = 1; band < norms.size(); ++band) {
    const auto l = static_cast<double>(band);
    if (sources.midpoint_size > 0.0) add(0.14 * l * l / (sources.midpoint_size * sources.midpoint_size) * norms[band]);
    if (sources.reduced_size > 0.0) {
      const double cell = 0.5 * std::numbers::pi / sources.reduced_size;
      add(l * (l + 1.0) * cell * cell / 24.0 * norms[band]);
      add(0.25 * l * cell * point_share * std::sqrt(2.0 * l + 1.0) * norms[0]);
    }
  }
  return std::sqrt(error_squared / total_squared);
}

}  // namespace welkin::sh
