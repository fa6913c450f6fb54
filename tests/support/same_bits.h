// Whether two results are the same, bit by bit. Times are left out.
#pragma once

#include "support/catch.h"
#include "welkin/environment_file.h"
#include "welkin/image.h"
#include "welkin/projection.h"

namespace welkin::test {

template <class Value>
bool same_bytes(std::span<const Value> a, std::span<const Value> b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

inline bool same_bits(const glm::dvec3& a, const glm::dvec3& b) { return std::memcmp(&a, &b, sizeof a) == 0; }
inline bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

/// Compares `wanted` with as many values from `found` on.
inline bool same_bits(std::span<const float> wanted, const float* found) {
  return std::memcmp(wanted.data(), found, wanted.size() * sizeof(float)) == 0;
}

/// Compares the counts and sums of pixels, without the passes.
inline bool same_pixels(const ProjectionDiagnostics& a, const ProjectionDiagnostics& b) {
  return a.texels == b.texels && a.nans_replaced == b.nans_replaced && a.infinities_replaced == b.infinities_replaced &&
         a.negatives_replaced == b.negatives_replaced && a.texels_clamped == b.texels_clamped &&
         same_bits(a.total_radiance_before_clamp, b.total_radiance_before_clamp) &&
         same_bits(a.total_radiance, b.total_radiance) && same_bits(a.error_estimate, b.error_estimate);
}

/// Compares everything except the passes.
inline bool same_light(const Projection& a, const Projection& b) {
  return same_bytes(a.radiance.coefficients(), b.radiance.coefficients()) && same_pixels(a.diagnostics, b.diagnostics);
}

inline bool same_bits(const Projection& a, const Projection& b) {
  return same_light(a, b) &&
         std::ranges::equal(a.diagnostics.passes, b.diagnostics.passes, [](const PassRecord& p, const PassRecord& q) {
           return p.name == q.name && p.action == q.action && p.reason == q.reason;
         });
}

inline bool same_bits(const Cubemap& a, const Cubemap& b) {
  return a.size() == b.size() && a.levels() == b.levels() && same_bytes<float>(a.pixels(), b.pixels());
}

inline bool same_bits(const LatLongImage& a, const LatLongImage& b) {
  return a.width == b.width && a.height == b.height && same_bytes<float>(a.pixels, b.pixels);
}

/// Returns all pixels of an image, or of six faces.
inline std::span<const float> values_of(const Environment& read) {
  const auto face = static_cast<std::size_t>(read.face_size());
  const std::size_t image = static_cast<std::size_t>(read.info.width) * static_cast<std::size_t>(read.info.height);
  return {read.pixels.get(), 3 * (face > 0 ? 6 * face * face : image)};
}

inline bool same_bits(const Environment& a, const Environment& b) {
  return a.info.layout == b.info.layout && a.info.width == b.info.width && a.info.height == b.info.height &&
         same_bytes(values_of(a), values_of(b));
}

inline bool same_bits(const EnvironmentStatistics& a, const EnvironmentStatistics& b) {
  return a.texels == b.texels && same_bits(a.minimum, b.minimum) && same_bits(a.maximum, b.maximum) &&
         same_bits(a.mean, b.mean) && same_bits(a.total_radiance, b.total_radiance) && a.nans == b.nans &&
         a.infinities == b.infinities && a.negatives == b.negatives && a.brightest_column == b.brightest_column &&
         a.brightest_row == b.brightest_row && same_bits(a.brightest, b.brightest) &&
         same_bits(a.brightest_direction, b.brightest_direction);
}

}  // namespace welkin::test
