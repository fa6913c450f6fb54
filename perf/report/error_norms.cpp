#include "perf/report/error_norms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <numeric>

#include "welkin/projection.h"

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

ErrorNorms relative_errors(std::span<const float> found, std::span<const float> given) {
  constexpr double floor = 1.0 / 16384.0;
  constexpr double largest_half = 65504.0;
  double squares = 0.0;
  double largest = 0.0;
  for (std::size_t k = 0; k < given.size(); ++k) {
    const double value = std::clamp(static_cast<double>(given[k]), 0.0, largest_half);
    const double error = std::abs(static_cast<double>(found[k]) - value) / std::max(value, floor);
    squares += error * error;
    largest = std::max(largest, error);
  }
  return {std::sqrt(squares / static_cast<double>(given.size())), largest};
}

ErrorNorms together(std::span<const ErrorNorms> cases) {
  ErrorNorms all;
  for (const ErrorNorms& one : cases) {
    all.rms += one.rms * one.rms / static_cast<double>(cases.size());
    all.maximum = std::max(all.maximum, one.maximum);
  }
  return {std::sqrt(all.rms), all.maximum};
}

namespace {

constexpr double kFloor = 1e-6;

struct Place {
  double u, v;
  int face;
};

/// Of a texel's centre.
Place place_of(std::int64_t texel, int size) {
  const std::int64_t face = texel / (std::int64_t{size} * size);
  return {(2.0 * static_cast<double>(texel % size) + 1.0) / size - 1.0,
          (2.0 * static_cast<double>(texel / size % size) + 1.0) / size - 1.0, static_cast<int>(face)};
}

/// Face axes as the table at `CubemapView` has them.
glm::dvec3 direction_of(const Place& at) {
  const std::array<glm::dvec3, 6> all{{{1.0, -at.v, -at.u},
                                       {-1.0, -at.v, at.u},
                                       {at.u, 1.0, at.v},
                                       {at.u, -1.0, -at.v},
                                       {at.u, -at.v, 1.0},
                                       {-at.u, -at.v, -1.0}}};
  return all[static_cast<std::size_t>(at.face)] / std::sqrt(1.0 + at.u * at.u + at.v * at.v);
}

double solid_angle(std::int64_t texel, int size) {
  const Place at = place_of(texel, size);
  return std::pow(1.0 + at.u * at.u + at.v * at.v, -1.5);
}

}  // namespace

std::vector<Probe> probes_of(const Cubemap& chain, int level, int count, std::mt19937& random) {
  const int size = chain.level_size(level);
  const std::int64_t texels = std::int64_t{6} * size * size;
  std::vector<Probe> probes;
  if (texels <= count + 16) {
    for (std::int64_t k = 0; k < texels; ++k) probes.push_back({k, solid_angle(k, size)});
    return probes;
  }
  for (std::int64_t k = 0; k < count; ++k) {
    const std::int64_t first = texels * k / count;
    const std::int64_t length = texels * (k + 1) / count - first;
    const std::int64_t texel = first + static_cast<std::int64_t>(random()) % length;
    probes.push_back({texel, solid_angle(texel, size)});
  }
  const float* const rgb = chain.face(level, 0);
  std::vector<std::int64_t> order(static_cast<std::size_t>(texels));
  std::iota(order.begin(), order.end(), std::int64_t{0});
  const auto less = [&](std::int64_t a, std::int64_t b) { return rgb[3 * a + 1] < rgb[3 * b + 1]; };
  std::nth_element(order.begin(), order.begin() + 8, order.end(), less);
  for (int k = 0; k < 8; ++k) probes.push_back({order[static_cast<std::size_t>(k)], 0.0});
  std::nth_element(order.begin(), order.end() - 8, order.end(), less);
  for (int k = 1; k <= 8; ++k) probes.push_back({*(order.end() - k), 0.0});
  return probes;
}

std::vector<glm::dvec3> directions_of(const std::vector<Probe>& probes, int size) {
  std::vector<glm::dvec3> directions;
  directions.reserve(probes.size());
  for (const Probe& probe : probes) directions.push_back(direction_of(place_of(probe.texel, size)));
  return directions;
}

ProbeErrors errors_at(const Cubemap& chain, int level, const std::vector<Probe>& probes,
                      const std::vector<glm::dvec3>& truth, const glm::dvec3& mean) {
  const float* const rgb = chain.face(level, 0);
  double squares = 0.0;
  double whole = 0.0;
  ProbeErrors errors;
  for (std::size_t k = 0; k < probes.size(); ++k) {
    for (int c = 0; c < 3; ++c) {
      const double error = std::abs(static_cast<double>(rgb[3 * probes[k].texel + c]) - truth[k][c]);
      squares += probes[k].weight * error * error;
      whole += probes[k].weight * truth[k][c] * truth[k][c];
      const double relative = error / std::max(truth[k][c], kFloor * mean[c]);
      if (relative > errors.norms.maximum) {
        errors.norms.maximum = relative;
        errors.truth_there = truth[k][c] / mean[c];
      }
    }
  }
  errors.norms.rms = std::sqrt(squares / whole);
  return errors;
}

}  // namespace welkin::report
