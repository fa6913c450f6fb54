// Prints hashes of results, one per line, so that builds for any processor and system can be compared with the record.
// Uses only public headers and nothing that a small standard library may lack.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "welkin/image.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::portability {

/// The sizes of results: odd ones, and one on either side of the size at which tables or tiles begin to matter.
inline constexpr int kSizes[] = {1, 2, 7, 64, 257};

/// An FNV-1a hash, byte by byte.
class Hash {
 public:
  void add(const void* bytes, std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) {
      value_ = (value_ ^ static_cast<const std::uint8_t*>(bytes)[k]) * 0x100000001b3U;
    }
  }
  /// Zeros keep their sign; all NaNs hash alike, because the processor chooses their bits.
  void add(double number) {
    if (std::isnan(number)) number = 0x7FFp9;
    add(&number, sizeof number);
  }
  void add(float number) { add(static_cast<double>(number)); }
  void add(const dvec3& triple) {
    for (int c = 0; c < 3; ++c) add(triple[c]);
  }
  void add(const SphericalHarmonics& harmonics) {
    for (const dvec3& coefficient : harmonics.coefficients()) add(coefficient);
  }
  void add(std::span<const float> numbers) {
    for (const float number : numbers) add(number);
  }
  void add(const std::vector<std::byte>& file) { add(file.data(), file.size()); }
  void add(const Cubemap& chain) {
    for (int level = 0; level < chain.levels(); ++level) {
      const auto values = std::size_t{3} * static_cast<std::size_t>(chain.level_size(level) * chain.level_size(level));
      for (int face = 0; face < 6; ++face) {
        for (std::size_t k = 0; k < values; ++k) add(chain.face(level, face)[k]);
      }
    }
  }

  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325U;
};

template <class... Results>
[[nodiscard]] std::uint64_t hash_of(const Results&... results) {
  Hash hash;
  (hash.add(results), ...);
  return hash.value();
}

/// Prints a line of the record: `name hash`.
template <class... Results>
void print(const std::string& name, const Results&... results) {
  std::printf("%s %016llx\n", name.c_str(), static_cast<unsigned long long>(hash_of(results...)));
}

/// Pseudo-random numbers that are the same on every platform.
class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : state_(seed * 2 + 1) {}

  std::uint32_t bits() {
    state_ = state_ * 6364136223846793005U + 1442695040888963407U;
    return static_cast<std::uint32_t>(state_ >> 33U);
  }
  /// Returns a number in [0, 1) with 24 bits.
  float unit() { return static_cast<float>(bits() & 0xFFFFFFU) * 0x1p-24F; }

 private:
  std::uint64_t state_;
};

/// Values of a sky with a sun: most are below 1, one in 509 is several hundred, and all are scaled by `scale`.
inline std::vector<float> radiances(std::size_t count, std::uint64_t seed, float scale = 1.0F) {
  Numbers numbers(seed);
  std::vector<float> values(count);
  for (float& value : values) {
    value = numbers.unit();
    if (numbers.bits() % 509 == 0) value *= 700.0F;
    value *= scale;
  }
  return values;
}

inline Cubemap cubemap(int size, std::uint64_t seed, float scale = 1.0F) {
  return {size, radiances(std::size_t{18} * static_cast<std::size_t>(size * size), seed, scale)};
}

inline LatLongImage lat_long(int height, std::uint64_t seed, float scale = 1.0F) {
  return {2 * height, height, radiances(std::size_t{6} * static_cast<std::size_t>(height * height), seed, scale)};
}

/// Interprets bytes as faces of a format.
inline CubemapView faces_of(const std::vector<std::uint8_t>& bytes, int size, PixelFormat format) {
  CubemapView view{{}, size, 0, format};
  const std::size_t face = static_cast<std::size_t>(size * size) * bytes_per_texel(format);
  for (std::size_t k = 0; k < 6; ++k) view.faces[k] = bytes.data() + k * face;
  return view;
}

/// Returns bytes for `faces_of`. Halves keep their exponent below that of infinities.
inline std::vector<std::uint8_t> texel_bytes(int size, PixelFormat format, std::uint64_t seed) {
  Numbers numbers(seed);
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(6 * size * size) * bytes_per_texel(format));
  const bool halves = format == PixelFormat::rgb16f || format == PixelFormat::rgba16f;
  for (std::size_t k = 0; k < bytes.size(); ++k) {
    bytes[k] = static_cast<std::uint8_t>(numbers.bits() >> 8U);
    if (halves && k % 2 == 1) bytes[k] &= 0x3FU;
  }
  return bytes;
}

inline std::string sized(const char* what, int size) { return std::string(what) + "_" + std::to_string(size); }

}  // namespace welkin::portability
