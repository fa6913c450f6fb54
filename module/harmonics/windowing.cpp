#include "harmonics/windowing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "math/basis.h"
#include "math/elementary.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "welkin/core.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::harmonics {
namespace {

// The least lambda, from below.
//
// The minimum over the sphere need not rise steadily with lambda: behind a sun band 2 lifts what band 1 pulls down, and
// the window takes band 2 away first. So halving an interval could find a lambda that is not the least. Instead, each
// direction p gives a bound: as long as the irradiance at p alone is negative, lambda is too small. Take p where the
// irradiance is least, go on to the first lambda that is not ruled out by p, and look for the least irradiance again.
// This never jumps over the least lambda, and as the lowest direction hardly moves it takes a handful of rounds.

/// How far below zero is taken for zero, as a share of the channel's mean irradiance. Searching aims at half of it, so
/// that it arrives.
constexpr double kTolerance = 1e-9;
constexpr int kMaxRounds = 1000;  ///< never reached: bounds a loop whose end rests on an argument

using BandValues = std::array<double, kMaximumBands>;

/// Returns the contribution of each band of a channel at a direction.
BandValues values_by_band(const SphericalHarmonics& harmonics, int channel, const glm::dvec3& direction) {
  std::array<double, std::size_t{kMaximumBands} * kMaximumBands> basis;
  math::evaluate_basis(direction.x, direction.y, direction.z, harmonics.bands(), basis.data());
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
    if ((value > 0.0) == positive) sum += value * min_laplacian_factor(l, lambda);
  }
  return sum;
}

/// The lambda from `low` on at which negative bands shrunk far enough to leave `wanted`; they shrink steadily.
double where_negatives_reach(const BandValues& values, double wanted, double low) {
  // Each factor falls with lambda, so a sum of negative terms rises to 0 monotonically: bisection finds the only
  // crossing, between neighbouring doubles. Growth by 4 reaches the largest double within 530 steps.
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
  for (int round = 0; round < kMaxRounds; ++round) {
    // f(lambda) = values[0] + P(lambda) + N(lambda) with P >= 0 falling and N <= 0 rising. For l > lambda therefore
    //   f(l) <= values[0] + P(lambda) + N(l),
    // and below the l at which the right side is `target` f is below it, too: no solution is passed over. Where a step
    // no longer moves lambda the two sides are equal.
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

double min_laplacian_factor(int l, double lambda) noexcept {
  // The g that minimizes |f - g|^2 + lambda |Laplacian g|^2. Harmonics are eigenfunctions of the Laplacian, with -l
  // (l + 1), so each coefficient minimizes
  //   (c - g)^2 + lambda l^2 (l + 1)^2 g^2   for itself, at   g = c / (1 + lambda l^2 (l + 1)^2)
  // (Sloan, "Stupid Spherical Harmonics Tricks", 2008).
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

double min_laplacian_lambda(const SphericalHarmonics& irradiance) {
  double lambda = 0.0;
  std::vector<double> factors(static_cast<std::size_t>(irradiance.bands()), 1.0);
  for (int round = 0; round < kMaxRounds; ++round) {
    const HarmonicMinimum low = minimum(with_factors(irradiance, factors));
    double next = lambda;
    for (int c = 0; c < 3; ++c) {
      if (std::isnan(low.value[c])) refuse(c, "has a coefficient that is not finite; replace it before windowing");
      const BandValues values = values_by_band(irradiance, c, low.direction[c]);
      if (low.value[c] >= -kTolerance * std::abs(values[0])) continue;
      if (!(values[0] > 0.0)) {
        refuse(c, "has a mean of " + platform::number_text(values[0]) +
                      ", so no window can make its irradiance positive; remove the negative light first "
                      "(NegativePolicy::replace), or use another window");
      }
      next = std::max(next, first_lambda_at(values, -0.5 * kTolerance * values[0], lambda));
    }
    if (!(next > lambda)) return lambda;
    lambda = next;
    for (int l = 0; l < irradiance.bands(); ++l) {
      factors[static_cast<std::size_t>(l)] = min_laplacian_factor(l, lambda);
    }
  }
  return lambda;
}

}  // namespace welkin::harmonics

namespace welkin {
namespace {

// Bands times a window's factors, and what that does to the least irradiance.

double hanning(int l, double width) {
  if (l >= width) return 0.0;
  // (1 + cos(pi l / width)) / 2; a turn is 2 pi.
  return 0.5 * (1.0 + math::sine_cosine_of_turns(l / (2.0 * width)).cosine);
}

double lanczos(int l, double width) {
  if (l == 0) return 1.0;
  if (l >= width) return 0.0;
  // sin(x) / x, x = pi l / width.
  return math::sine_cosine_of_turns(l / (2.0 * width)).sine / (std::numbers::pi * l / width);
}

double factor(Window window, int l, double parameter) {
  switch (window) {
    case Window::hanning: return l == 0 ? 1.0 : hanning(l, parameter);
    case Window::lanczos: return lanczos(l, parameter);
    case Window::min_laplacian: return harmonics::min_laplacian_factor(l, parameter);
    default: return 1.0;
  }
}

}  // namespace

const char* name(Window window) noexcept {
  static constexpr std::array kNames{"none", "hanning", "lanczos", "min-laplacian"};
  return platform::name_in<Window::min_laplacian>(kNames, window, "none");
}

WindowResult apply_window(const SphericalHarmonics& radiance, Window window, double width) {
  const platform::FloatingPointScope floating_point;
  // 1e12 bands of width leave every factor 1; beyond it l / width could vanish.
  if (!(width >= 0.0 && width <= 1e12)) {
    throw Error(ErrorCode::invalid_argument, "the window's width is " + platform::number_text(width) +
                                                 " bands; it must be from 0 (the number of bands) to 1e12");
  }
  const SphericalHarmonics irradiance = irradiance_from_radiance(radiance);
  WindowResult result;
  if (window == Window::hanning || window == Window::lanczos) result.parameter = width > 0.0 ? width : radiance.bands();
  if (window == Window::min_laplacian) result.parameter = harmonics::min_laplacian_lambda(irradiance);
  for (int l = 0; l < radiance.bands(); ++l) result.factors.push_back(factor(window, l, result.parameter));
  result.radiance = harmonics::with_factors(radiance, result.factors);
  result.minimum_before = minimum(irradiance).value;
  result.minimum_after = minimum(harmonics::with_factors(irradiance, result.factors)).value;
  return result;
}

}  // namespace welkin
