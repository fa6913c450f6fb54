// A 64-bit hash of the bits of results: FNV-1a (Fowler, Noll and Vo), one byte at a time, lowest byte first.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "welkin/bake.h"
#include "welkin/engines.h"
#include "welkin/environment_file.h"
#include "welkin/image.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"
#include "welkin/result_cache.h"
#include "welkin/sky.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {

class BitHash {
 public:
  void add_byte(std::uint8_t byte) noexcept { value_ = (value_ ^ byte) * 0x100000001b3U; }

  /// Adds 8 bytes for every type, so that a changed width of an integer does not change the hash.
  void add_word(std::uint64_t word) noexcept {
    for (int shift = 0; shift < 64; shift += 8) add_byte(static_cast<std::uint8_t>(word >> shift));
  }

  [[nodiscard]] std::uint64_t value() const noexcept { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325U;
};

/// Adds several values in order.
template <class... Values>
requires(sizeof...(Values) > 1) void add_bits(BitHash& hash, const Values&... values) { (add_bits(hash, values), ...); }

template <std::integral Number>
void add_bits(BitHash& hash, Number number) {
  hash.add_word(static_cast<std::uint64_t>(number));
}

/// Zeros keep their sign. All NaNs count as one: the processor chooses the bits of a NaN that an operation gives.
inline void add_bits(BitHash& hash, double number) {
  hash.add_word(std::bit_cast<std::uint64_t>(std::isnan(number) ? std::numeric_limits<double>::quiet_NaN() : number));
}

inline void add_bits(BitHash& hash, float number) {
  const auto bits = std::bit_cast<std::uint32_t>(std::isnan(number) ? std::numeric_limits<float>::quiet_NaN() : number);
  for (unsigned shift = 0; shift < 32; shift += 8) hash.add_byte(static_cast<std::uint8_t>(bits >> shift));
}

inline void add_bits(BitHash& hash, const glm::dvec3& v) {
  for (int c = 0; c < 3; ++c) add_bits(hash, v[c]);
}
inline void add_bits(BitHash& hash, const glm::vec3& v) {
  for (int c = 0; c < 3; ++c) add_bits(hash, v[c]);
}
inline void add_bits(BitHash& hash, const glm::dvec4& v) {
  for (int c = 0; c < 4; ++c) add_bits(hash, v[c]);
}
inline void add_bits(BitHash& hash, const glm::dmat3& m) {
  for (int c = 0; c < 3; ++c) add_bits(hash, m[c]);
}
inline void add_bits(BitHash& hash, const std::string& text) {
  hash.add_word(text.size());
  for (const char c : text) hash.add_byte(static_cast<std::uint8_t>(c));
}
/// Adds a file's bytes.
inline void add_bits(BitHash& hash, const std::vector<char>& bytes) {
  hash.add_word(bytes.size());
  for (const char c : bytes) hash.add_byte(static_cast<std::uint8_t>(c));
}

inline void add_bits(BitHash& hash, const SphericalHarmonics& harmonics) {
  hash.add_word(static_cast<std::uint64_t>(harmonics.bands()));
  for (const glm::dvec3& value : harmonics.coefficients()) add_bits(hash, value);
}
inline void add_bits(BitHash& hash, const BabylonPolynomial& p) {
  for (const glm::dvec3& term : {p.x, p.y, p.z, p.xx, p.yy, p.zz, p.yz, p.zx, p.xy}) add_bits(hash, term);
}
inline void add_bits(BitHash& hash, const ContentHash& content) { add_bits(hash, content.high, content.low); }

inline void add_bits(BitHash& hash, const LatLongImage& image) {
  add_bits(hash, image.width, image.height);
  for (const float value : image.pixels) add_bits(hash, value);
}
inline void add_bits(BitHash& hash, const Cubemap& cubemap) {
  if (cubemap.levels() != 1) hash.add_word(static_cast<std::uint64_t>(cubemap.levels()));
  for (int level = 0; level < cubemap.levels(); ++level) {
    const auto edge = static_cast<std::size_t>(cubemap.level_size(level));
    hash.add_word(edge);
    for (const float value : std::span(cubemap.face(level, 0), 18 * edge * edge)) add_bits(hash, value);
  }
}
/// Adds pixels, size and layout; text about the file is left out.
inline void add_bits(BitHash& hash, const Environment& environment) {
  hash.add_word(static_cast<std::uint64_t>(environment.info.layout));
  add_bits(hash, environment.info.width, environment.info.height);
  // A cross has the width and height of its image, but holds no more than its faces.
  const auto size = static_cast<std::size_t>(environment.face_size());
  const std::size_t texels =
      size > 0 ? 6 * size * size
               : static_cast<std::size_t>(environment.info.width) * static_cast<std::size_t>(environment.info.height);
  for (const float value : std::span(environment.pixels.get(), 3 * texels)) add_bits(hash, value);
}
inline void add_bits(BitHash& hash, const EnvironmentStatistics& s) {
  add_bits(hash, s.texels, s.nans, s.infinities, s.negatives, s.minimum, s.maximum, s.mean, s.total_radiance,
           s.brightest, s.brightest_direction, s.brightest_column, s.brightest_row);
}

inline void add_counts(BitHash& hash, const ProjectionDiagnostics& d) {
  add_bits(hash, d.texels, d.nans_replaced, d.infinities_replaced, d.negatives_replaced, d.texels_clamped);
}
/// Adds the numbers about the pixels; passes, their names and their times are left out.
inline void add_bits(BitHash& hash, const ProjectionDiagnostics& d) {
  add_counts(hash, d);
  add_bits(hash, d.total_radiance_before_clamp, d.total_radiance, d.error_estimate);
}
inline void add_bits(BitHash& hash, const Projection& projection) {
  add_bits(hash, projection.radiance, projection.diagnostics);
}
/// Method and times are left out. The 0 stands for a removed number, so that recorded hashes stay the same.
inline void add_bits(BitHash& hash, const MipRecord& mip) {
  add_bits(hash, mip.size, mip.bands, mip.bright_texels, 0, mip.roughness, mip.error_estimate.value_or(0.0), mip.mean);
}
inline void add_bits(BitHash& hash, const PrefilteredSpecular& specular) {
  add_bits(hash, specular.cubemap);
  for (const MipRecord& mip : specular.mips) add_bits(hash, mip);
  add_counts(hash, specular.pixels);
}
inline void add_bits(BitHash& hash, const BrdfTable& table) {
  add_bits(hash, table.channels);
  for (const float value : table.values) add_bits(hash, value);
}
inline void add_bits(BitHash& hash, const Sun& sun) {
  add_bits(hash, sun.direction, sun.irradiance, sun.radiance, sun.total_radiance_before, sun.total_radiance_after,
           sun.solid_angle, sun.angular_radius_degrees, sun.texels);
}
inline void add_bits(BitHash& hash, const SkyTables& tables) {
  for (const auto* table : {&tables.transmittance, &tables.scattering, &tables.single_mie, &tables.irradiance}) {
    hash.add_word(table->size());
    for (const float value : *table) add_bits(hash, value);
  }
  add_bits(hash, tables.orders, tables.last_change);
}

template <class Value>
void add_bits(BitHash& hash, const std::vector<Value>& values);
template <class Value>
void add_bits(BitHash& hash, const std::shared_ptr<Value>& value);

template <class Value>
void add_bits(BitHash& hash, const std::optional<Value>& value) {
  hash.add_byte(value ? 1 : 0);
  if (value) add_bits(hash, *value);
}
template <class Value>
void add_bits(BitHash& hash, const std::vector<Value>& values) {
  hash.add_word(values.size());
  for (const Value& value : values) add_bits(hash, value);
}
template <class Value>
void add_bits(BitHash& hash, const std::shared_ptr<Value>& value) {
  hash.add_byte(value ? 1 : 0);
  if (value) add_bits(hash, *value);
}

/// Adds a result that was not optional when hashes were recorded: an absent one was empty then.
template <class Image>
void add_bits_or_empty(BitHash& hash, const std::optional<Image>& image) {
  if (image) {
    add_bits(hash, *image);
  } else {
    add_bits(hash, Image());
  }
}

inline void add_bits(BitHash& hash, const BakeResult& result) {
  add_bits_or_empty(hash, result.background);
  add_bits(hash, result.specular);
  add_bits_or_empty(hash, result.irradiance);
  add_bits(hash, result.radiance, result.brdf, result.stored_polynomial, result.diagnostics);
}

inline void add_bits(BitHash& hash, const EngineLight& light) {
  for (const EngineTerm& term : light.terms) {
    add_bits(hash, term.name);
    add_bits(hash, term.rgb);
  }
  for (const EngineVector& vector : light.vectors) {
    add_bits(hash, vector.name);
    add_bits(hash, vector.value);
  }
}
inline void add_bits(BitHash& hash, const HarmonicMinimum& minimum) {
  add_bits(hash, minimum.value);
  for (const glm::dvec3& direction : minimum.direction) add_bits(hash, direction);
}
inline void add_bits(BitHash& hash, const WindowResult& windowed) {
  add_bits(hash, windowed.radiance);
  add_bits(hash, windowed.parameter);
  add_bits(hash, windowed.minimum_before);
  add_bits(hash, windowed.minimum_after);
  add_bits(hash, windowed.factors);
}
inline void add_bits(BitHash& hash, const DominantLight& light) {
  add_bits(hash, light.direction);
  add_bits(hash, light.irradiance);
}
inline void add_bits(BitHash& hash, const IrradianceError& error) {
  add_bits(hash, error.bands);
  for (const double value : {error.rms, error.maximum, error.relative}) add_bits(hash, value);
  add_bits(hash, error.worst_normal);
}

/// Returns the hash of several values in order.
template <class... Values>
[[nodiscard]] std::uint64_t bits_of(const Values&... values) {
  BitHash hash;
  (add_bits(hash, values), ...);
  return hash.value();
}

}  // namespace welkin::test
