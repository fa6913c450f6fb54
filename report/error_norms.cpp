#include "report/error_norms.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "welkin/irradiance.h"

namespace welkin::report {
namespace {

constexpr int kNormals = 256;

/// Evenly over the sphere: a Fibonacci spiral.
glm::dvec3 normal(int index) {
  const double y = 1.0 - (2.0 * index + 1.0) / kNormals;
  const double azimuth = 2.0 * std::numbers::pi * index * (std::numbers::phi - 1.0);
  const double level = std::sqrt(1.0 - y * y);
  return {level * std::sin(azimuth), y, level * std::cos(azimuth)};
}

}  // namespace

double relative_error(const SphericalHarmonics& found, const SphericalHarmonics& truth) {
  double difference = 0.0;
  double total = 0.0;
  for (std::size_t k = 0; k < truth.coefficients().size(); ++k) {
    const glm::dvec3 d = found.coefficients()[k] - truth.coefficients()[k];
    difference += glm::dot(d, d);
    total += glm::dot(truth.coefficients()[k], truth.coefficients()[k]);
  }
  return std::sqrt(difference / total);
}

double worst_channel_error(const SphericalHarmonics& found, const SphericalHarmonics& truth) {
  double worst = 0.0;
  for (int channel = 0; channel < 3; ++channel) {
    double difference = 0.0;
    double total = 0.0;
    for (std::size_t k = 0; k < truth.coefficients().size(); ++k) {
      const double expected = truth.coefficients()[k][channel];
      const double off = found.coefficients()[k][channel] - expected;
      difference += off * off;
      total += expected * expected;
    }
    worst = std::max(worst, std::sqrt(difference / total));
  }
  return worst;
}

ErrorNorms harmonic_errors(const SphericalHarmonics& found, const SphericalHarmonics& truth) {
  const SphericalHarmonics irradiance = irradiance_from_radiance(found);
  const SphericalHarmonics expected = irradiance_from_radiance(truth);
  double largest = 0.0;
  double squares = 0.0;
  for (int k = 0; k < kNormals; ++k) {
    const glm::dvec3 true_value = evaluate(expected, normal(k));
    largest = std::max(largest, glm::length(evaluate(irradiance, normal(k)) - true_value));
    squares += glm::dot(true_value, true_value);
  }
  return {relative_error(found, truth), largest / std::sqrt(squares / kNormals)};
}

double rms_of_irradiance(const SphericalHarmonics& radiance) {
  const SphericalHarmonics irradiance = irradiance_from_radiance(radiance);
  double squares = 0.0;
  for (const glm::dvec3& value : irradiance.coefficients()) squares += glm::dot(value, value);
  return std::sqrt(squares / (4.0 * std::numbers::pi));
}

ErrorNorms together(std::span<const ErrorNorms> cases) {
  ErrorNorms all;
  for (const ErrorNorms& one : cases) {
    all.rms += one.rms * one.rms / static_cast<double>(cases.size());
    all.maximum = std::max(all.maximum, one.maximum);
  }
  return {std::sqrt(all.rms), all.maximum};
}

}  // namespace welkin::report
