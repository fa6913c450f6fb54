#include "report/stability/measures.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "image/texel_geometry.h"

namespace welkin::report::stability {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

double norm(const SphericalHarmonics& c, int first_band) {
  return distance(c, SphericalHarmonics(c.bands()), first_band);
}

double distance(const SphericalHarmonics& a, const SphericalHarmonics& truth, int first_band) {
  if (a.bands() != truth.bands()) return kInfinity;
  double sum = 0.0;
  for (std::size_t k = SphericalHarmonics::index(first_band, -first_band); k < truth.coefficients().size(); ++k) {
    const glm::dvec3 difference = a.coefficients()[k] - truth.coefficients()[k];
    sum += glm::dot(difference, difference);
  }
  return std::sqrt(sum);
}

double relative_error(const SphericalHarmonics& a, const SphericalHarmonics& truth, int first_band) {
  const double off = distance(a, truth, first_band);
  return off == 0.0 ? 0.0 : worse(off / norm(truth, first_band), 0.0);
}

double relative_error(double found, double truth) {
  return found == truth ? 0.0 : worse(std::abs(found - truth) / std::abs(truth), 0.0);
}

double relative_error(const glm::dvec3& found, const glm::dvec3& truth) {
  return found == truth ? 0.0 : worse(glm::length(found - truth) / glm::length(truth), 0.0);
}

double float_ulps(double found, double truth) {
  if (found == truth) return 0.0;
  const double largest = std::numeric_limits<float>::max();
  const double nearest = std::clamp(truth, -largest, largest);
  const int exponent = nearest == 0.0 ? -126 : std::max(std::ilogb(nearest), -126);
  return worse(std::abs(found - truth) / std::ldexp(1.0, exponent - 23), 0.0);
}

double rms_error(std::span<const glm::dvec3> found, std::span<const glm::dvec3> truth) {
  double off = 0.0;
  double whole = 0.0;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    off += glm::dot(found[k] - truth[k], found[k] - truth[k]);
    whole += glm::dot(truth[k], truth[k]);
  }
  return off == 0.0 ? 0.0 : worse(std::sqrt(off / whole), 0.0);
}

double worse(double a, double b) noexcept { return std::isnan(a) || std::isnan(b) ? kInfinity : std::max(a, b); }

double unsound(std::span<const float> values) noexcept {
  const auto is_unsound = [](float value) { return !(value >= 0.0F) || std::isinf(value); };
  return static_cast<double>(std::count_if(values.begin(), values.end(), is_unsound));
}

double wrong_unless_thrown(ErrorCode code, const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return wrong_if(error.code() != code);
  }
  return 1.0;
}

std::vector<glm::dvec3> texel_directions(int size) {
  std::vector<glm::dvec3> directions;
  for (int face = 0; face < 6; ++face) {
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column) {
        directions.push_back(image::face_direction(size, face, column + 0.5, row + 0.5));
      }
    }
  }
  return directions;
}

std::vector<glm::dvec3> spread_directions(int count) {
  const double golden_angle = std::numbers::pi * (3.0 - std::sqrt(5.0));
  std::vector<glm::dvec3> directions;
  for (int k = 0; k < count; ++k) {
    const double y = 1.0 - (2.0 * k + 1.0) / count;
    const double ring = std::sqrt(1.0 - y * y);
    directions.emplace_back(ring * std::sin(golden_angle * k), y, ring * std::cos(golden_angle * k));
  }
  return directions;
}

std::vector<glm::dvec3> texels(const CubemapChain& chain, int level) {
  const auto edge = static_cast<std::size_t>(chain.level_size(level));
  std::vector<glm::dvec3> values;
  for (int face = 0; face < 6; ++face) {
    const float* const pixels = chain.face(level, face);
    for (std::size_t k = 0; k < edge * edge; ++k) {
      values.emplace_back(pixels[3 * k], pixels[3 * k + 1], pixels[3 * k + 2]);
    }
  }
  return values;
}

double worst_relative_error(std::span<const glm::dvec3> found, std::span<const glm::dvec3> truth) {
  double worst = 0.0;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    for (int c = 0; c < 3; ++c) worst = worse(worst, relative_error(found[k][c], truth[k][c]));
  }
  return worst;
}

}  // namespace welkin::report::stability
