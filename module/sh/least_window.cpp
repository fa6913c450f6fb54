// The least lambda, from below.
//
// The minimum over the sphere need not rise steadily with lambda: behind a sun band 2 lifts what band 1 pulls down, and
// the window takes band 2 away first. So halving an interval could find a lambda that is not the least. Instead, each
// direction p gives a bound: as long as the irradiance at p alone is negative, lambda is too small. Take p where the
// irradiance is least, go on to the first lambda that is not ruled out by p, and look for the least irradiance again.
// This never jumps over the least lambda, and as the lowest direction hardly moves it takes a handful of rounds.
#include "sh/least_window.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "sh/basis.h"
#include "welkin/error.h"
#include "welkin/windowing.h"

namespace welkin::sh {
namespace {

/// How far below zero is taken for zero, as a share of the channel's mean irradiance. Searching aims at half of it, so
/// that it arrives.
constexpr double kTolerance = 1e-9;
constexpr int kMostRounds = 1000;  ///< never reached: bounds a loop whose end rests on an argument

using BandValues = std::array<double, kMaximumBands>;

/// What each band of a channel contributes at a direction.
BandValues values_by_band(const SphericalHarmonics& harmonics, int channel, const glm::dvec3& direction) {
  std::array<double, std::size_t{kMaximumBands} * kMaximumBands> basis;
  evaluate_basis(direction.x, direction.y, direction.z, harmonics.bands(), basis.data());
  BandValues values{};
  for (int l = 0; l < harmonics.bands(); ++l) {
    for (int m = -l; m <= l; ++m) {
      values[static_cast<std::size_t>(l)] += basis[SphericalHarmonics::index(l, m)] * harmonics.at(l, m)[channel];
    }
  }
  return values;
}

double sum_of_bands(const BandValues& values, bool positive, double lambda) {
  double sum = 0.0;
  for (int l = 1; l < kMaximumBands; ++l) {
    const double value = values[static_cast<std::size_t>(l)];
    if ((value > 0.0) == positive) sum += value * least_window_factor(l, lambda);
  }
  return sum;
}

/// The lambda from `low` on at which negative bands shrunk far enough to leave `wanted`; they shrink steadily.
double where_negatives_reach(const BandValues& values, double wanted, double low) {
  double high = std::max(2.0 * low, 1e-6);
  while (sum_of_bands(values, false, high) < wanted && high < std::numeric_limits<double>::max() / 4.0) high *= 4.0;
  for (;;) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) return high;
    (sum_of_bands(values, false, middle) < wanted ? low : high) = middle;
  }
}

/// The first lambda from `lambda` on at which the irradiance at one direction is not below `target`. Bands that are
/// positive there shrink too, so with them held where they are lambda comes out too small; and again from there.
double first_lambda_at(const BandValues& values, double target, double lambda) {
  for (int round = 0; round < kMostRounds; ++round) {
    const double others = values[0] + sum_of_bands(values, true, lambda);
    if (others + sum_of_bands(values, false, lambda) >= target) return lambda;
    const double next = where_negatives_reach(values, target - others, lambda);
    if (!(next > lambda)) return lambda;
    lambda = next;
  }
  return lambda;
}

[[noreturn]] void refuse(int channel, const std::string& what) {
  throw Error(ErrorCode::invalid_argument, std::string("the ") +
                                               (channel == 0   ? "red"
                                                : channel == 1 ? "green"
                                                               : "blue") +
                                               " channel " + what);
}

}  // namespace

double least_window_factor(int l, double lambda) noexcept {
  const double laplacian = static_cast<double>(l) * (l + 1.0);
  return 1.0 / (1.0 + lambda * laplacian * laplacian);
}

SphericalHarmonics with_factors(const SphericalHarmonics& harmonics, const std::vector<double>& factors) {
  SphericalHarmonics result = harmonics;
  for (int l = 0; l < result.bands(); ++l) {
    for (int m = -l; m <= l; ++m) result.at(l, m) *= factors[static_cast<std::size_t>(l)];
  }
  return result;
}

double least_window_lambda(const SphericalHarmonics& irradiance) {
  double lambda = 0.0;
  std::vector<double> factors(static_cast<std::size_t>(irradiance.bands()), 1.0);
  for (int round = 0; round < kMostRounds; ++round) {
    const HarmonicMinimum low = minimum(with_factors(irradiance, factors));
    double next = lambda;
    for (int c = 0; c < 3; ++c) {
      if (std::isnan(low.value[c])) refuse(c, "has a coefficient that is not finite; nothing can be windowed there");
      const BandValues values = values_by_band(irradiance, c, low.direction[c]);
      if (low.value[c] >= -kTolerance * std::abs(values[0])) continue;
      if (!(values[0] > 0.0)) {
        refuse(c, "has a mean of " + std::to_string(values[0]) +
                      ", so that no window can lift its irradiance above zero; take the negative light out first "
                      "(NegativePolicy::replace), or use another window");
      }
      next = std::max(next, first_lambda_at(values, -0.5 * kTolerance * values[0], lambda));
    }
    if (!(next > lambda)) return lambda;
    lambda = next;
    for (int l = 0; l < irradiance.bands(); ++l) {
      factors[static_cast<std::size_t>(l)] = least_window_factor(l, lambda);
    }
  }
  return lambda;
}

}  // namespace welkin::sh
