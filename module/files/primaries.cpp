#include "files/primaries.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>
#include <string>

#include "platform/text.h"

namespace welkin::files {
namespace {

struct NamedPrimaries {
  const char* name;
  Chromaticities primaries;
};

constexpr glm::dvec2 kD65{0.3127, 0.3290};

constexpr std::array kNamed{
    NamedPrimaries{"Rec. 709", kRec709},
    NamedPrimaries{"CIE XYZ", kCieXyz},
    NamedPrimaries{"Rec. 2020", {{0.708, 0.292}, {0.170, 0.797}, {0.131, 0.046}, kD65}},   // ITU-R BT.2020-2
    NamedPrimaries{"Display P3", {{0.680, 0.320}, {0.265, 0.690}, {0.150, 0.060}, kD65}},  // SMPTE EG 432-1
    NamedPrimaries{"Adobe RGB", {{0.64, 0.33}, {0.21, 0.71}, {0.15, 0.06}, kD65}},
    NamedPrimaries{"ACES AP0",  // SMPTE ST 2065-1
                   {{0.7347, 0.2653}, {0.0, 1.0}, {0.0001, -0.0770}, {0.32168, 0.33767}}},
    NamedPrimaries{"ACES AP1", {{0.713, 0.293}, {0.165, 0.830}, {0.128, 0.044}, {0.32168, 0.33767}}},  // S-2014-004
};

// From X, Y, Z to the responses that the Bradford transform scales (Lam 1985), written by columns.
constexpr glm::dmat3 kBradford{{0.8951, -0.7502, 0.0389}, {0.2664, 1.7135, -0.0685}, {-0.1614, 0.0367, 1.0296}};

// Below this a triangle of primaries is a line. Rec. 709's determinant is 0.11.
constexpr double kSmallestDeterminant = 1e-4;
constexpr double kSmallestWhite = 1e-4;  // of y

bool is_close(const glm::dvec2& a, const glm::dvec2& b) noexcept {
  constexpr double kTolerance = 1e-3;
  return std::abs(a.x - b.x) <= kTolerance && std::abs(a.y - b.y) <= kTolerance;
}

glm::dvec3 with_z(const glm::dvec2& xy) noexcept { return {xy.x, xy.y, 1.0 - xy.x - xy.y}; }

// Returns false for coordinates so large that no colour, real or imaginary, has them.
bool is_sound(const glm::dvec2& xy) noexcept {
  constexpr double kLargestCoordinate = 100.0;
  return std::abs(xy.x) <= kLargestCoordinate && std::abs(xy.y) <= kLargestCoordinate;  // false for NaN
}

// Returns the matrix that maps `from` to `to` by scaling the three Bradford responses.
std::optional<glm::dmat3> adaptation(const glm::dvec2& from, const glm::dvec2& to) noexcept {
  if (!is_sound(from) || from.y < kSmallestWhite) {
    return std::nullopt;
  }
  const glm::dvec3 source = kBradford * (with_z(from) / from.y);
  const glm::dvec3 target = kBradford * (with_z(to) / to.y);
  if (!(source.x > kSmallestWhite && source.y > kSmallestWhite && source.z > kSmallestWhite)) {
    return std::nullopt;
  }
  glm::dmat3 scaled = kBradford;
  for (int column = 0; column < 3; ++column) {
    scaled[column] *= target / source;
  }
  return glm::inverse(kBradford) * scaled;
}

}  // namespace

bool nearly_same(const Chromaticities& a, const Chromaticities& b) noexcept {
  return is_close(a.red, b.red) && is_close(a.green, b.green) && is_close(a.blue, b.blue) && is_close(a.white, b.white);
}

// The columns are the primaries' x, y, z, each times the factor with which they add up to the white.
std::optional<glm::dmat3> rgb_to_xyz(const Chromaticities& primaries) noexcept {
  if (!is_sound(primaries.red) || !is_sound(primaries.green) || !is_sound(primaries.blue) ||
      !is_sound(primaries.white) || primaries.white.y < kSmallestWhite) {
    return std::nullopt;
  }
  const glm::dmat3 corners(with_z(primaries.red), with_z(primaries.green), with_z(primaries.blue));
  if (!(std::abs(glm::determinant(corners)) >= kSmallestDeterminant)) {
    return std::nullopt;
  }
  const glm::dvec3 shares = glm::inverse(corners) * (with_z(primaries.white) / primaries.white.y);
  glm::dmat3 matrix;
  for (int column = 0; column < 3; ++column) {
    if (std::abs(shares[column]) < kSmallestWhite) {
      return std::nullopt;  // a primary that the white does not need is no channel
    }
    matrix[column] = corners[column] * shares[column];
  }
  return matrix;
}

std::optional<glm::dmat3> to_rec709(const Chromaticities& primaries, std::optional<glm::dvec2> neutral) noexcept {
  const std::optional<glm::dmat3> to_xyz = rgb_to_xyz(primaries);
  if (!to_xyz) {
    return std::nullopt;
  }
  const glm::dmat3 from_xyz = glm::inverse(*rgb_to_xyz(kRec709));
  if (!neutral && nearly_same(primaries, kCieXyz)) {
    return from_xyz * *to_xyz;
  }
  const std::optional<glm::dmat3> adapted = adaptation(neutral.value_or(primaries.white), kRec709.white);
  if (!adapted) {
    return std::nullopt;
  }
  return from_xyz * *adapted * *to_xyz;
}

void apply(const glm::dmat3& matrix, float* rgb, std::size_t texels) noexcept {
  for (std::size_t i = 0; i < texels; ++i, rgb += 3) {
    const glm::dvec3 colour = matrix * glm::dvec3(rgb[0], rgb[1], rgb[2]);
    rgb[0] = static_cast<float>(colour.x);
    rgb[1] = static_cast<float>(colour.y);
    rgb[2] = static_cast<float>(colour.z);
  }
}

std::string describe(const Chromaticities& primaries) {
  const auto* known = std::find_if(kNamed.begin(), kNamed.end(), [&](const NamedPrimaries& named) {
    return nearly_same(named.primaries, primaries);
  });
  if (known != kNamed.end()) {
    return known->name;
  }
  const auto described = [](const char* name, const auto& point) {
    const auto text = [](double number) { return platform::number_text(number, std::chars_format::general, 4); };
    return std::string(name) + " (" + text(point.x) + ' ' + text(point.y) + ')';
  };
  return described("red", primaries.red) + described(" green", primaries.green) + described(" blue", primaries.blue) +
         described(" white", primaries.white);
}

std::optional<glm::dmat3> rec709_from_stated(const Chromaticities& stated, const char* where, Primaries wanted,
                                             EnvironmentInfo& info) {
  if (nearly_same(stated, kRec709)) {
    return std::nullopt;
  }
  const std::string said = describe(stated) + " (" + where + ")";
  if (wanted == Primaries::as_stored) {
    info.notes.push_back("primaries are left as stored: " + said);
    return std::nullopt;
  }
  const std::optional<glm::dmat3> matrix = to_rec709(stated);
  info.notes.push_back(matrix ? "primaries were converted to Rec. 709 from " + said
                              : "primaries that span no colours are ignored: " + said);
  return matrix;
}

}  // namespace welkin::files
