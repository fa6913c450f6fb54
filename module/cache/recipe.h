// Converts values to bytes for hashing and for entries, and back with every length checked.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <glm/vec3.hpp>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "cache/entry_store.h"
#include "platform/standard_library.h"
#include "projection/sanitized_pixels.h"
#include "projection/tile_sums.h"
#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"
#include "welkin/result_cache.h"
#include "welkin/sky.h"

namespace welkin::cache {

static_assert(std::endian::native == std::endian::little, "entries need their byte order turned here");

/// Appends values. Each has one form: integers and enumerators as 8 bytes, reals as a double, and a value with a length
/// states it first, so that no two lists of values have the same bytes.
class ByteWriter {
 public:
  /// Reserves memory, so that results of megabytes are appended without growing step by step.
  explicit ByteWriter(std::size_t expected_bytes = 0) { bytes_.reserve(expected_bytes); }

  template <class Value>
  requires std::is_arithmetic_v<Value> || std::is_enum_v<Value>
  void put(Value value) {
    if constexpr (std::is_floating_point_v<Value>) {
      append(platform::bit_cast<std::uint64_t>(static_cast<double>(value)));
    } else {
      append(static_cast<std::uint64_t>(value));
    }
  }
  void put(std::string_view text) {
    put(text.size());
    raw(text.data(), text.size());
  }
  void put(const char* text) { put(std::string_view(text)); }
  void put(const std::string& text) { put(std::string_view(text)); }
  void put(const ContentHash& hash) { all(hash.high, hash.low); }
  // Each struct is unpacked by a structured binding: a field that is added but not handled here does not compile.
  void put(const RadianceClamp& clamp) {
    const auto& [maximum, preserve_colour] = clamp;
    all(maximum, preserve_colour);
  }
  void put(const DensityLayer& layer) {
    const auto& [thickness, exponential, scale, linear, constant] = layer;
    all(thickness, exponential, scale, linear, constant);
  }
  void put(const Constituent& matter) {
    const auto& [density, scattering, absorption] = matter;
    all(density, scattering, absorption);
  }

  template <class Value>
  void put(const std::vector<Value>& values) {
    put(values.size());
    for (const Value& value : values) put(value);
  }
  template <class Value>
  void put(const std::optional<Value>& value) {
    put(value.has_value());
    if (value) put(*value);
  }

  template <class... Values>
  void all(const Values&... values) {
    (put(values), ...);
  }

  /// Appends floats as they lie in memory.
  void floats(std::span<const float> values) { raw(values.data(), values.size_bytes()); }
  /// Not inline: GCC 12 warns of writes past the end of vectors whose first capacity it can see.
  void raw(const void* bytes, std::size_t count);

  [[nodiscard]] ContentHash hash() const { return hash_bytes(bytes_.data(), bytes_.size()); }
  [[nodiscard]] std::vector<std::uint8_t> take() noexcept { return std::move(bytes_); }

 private:
  void append(std::uint64_t bits) { raw(&bits, sizeof bits); }

  std::vector<std::uint8_t> bytes_;
};

/// Reads values back in the same order. From the first missing value on, all are zero and `sound` returns false.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

  template <class Value>
  requires std::is_arithmetic_v<Value>
  void get(Value& value) {
    std::uint64_t bits = 0;
    raw(&bits, sizeof bits);
    if constexpr (std::is_floating_point_v<Value>) {
      value = static_cast<Value>(platform::bit_cast<double>(bits));
    } else {
      value = static_cast<Value>(bits);
      if (static_cast<std::uint64_t>(value) != bits) fail();
    }
  }
  void get(PassAction& action) { enumerator(action, PassAction::skip); }
  template <class Value>
  void get(std::optional<Value>& value) {
    bool there = false;
    get(there);
    value.reset();
    if (there) get(value.emplace());
  }
  void get(MipMethod& method) { enumerator(method, MipMethod::near_far); }
  void get(std::string& text) {
    const std::size_t length = count(1);
    text.resize(length);
    raw(text.data(), length);
  }

  /// Reads a count of values that take at least `value_bytes` each: at most as many as the remaining bytes can hold.
  [[nodiscard]] std::size_t count(std::size_t value_bytes) {
    std::uint64_t stated = 0;
    get(stated);
    if (stated > rest_.size() / value_bytes) fail();
    return sound_ ? static_cast<std::size_t>(stated) : 0;
  }

  void floats(std::span<float> values) { raw(values.data(), values.size_bytes()); }
  void raw(void* bytes, std::size_t wanted) {
    if (wanted == 0) return;
    if (wanted > rest_.size()) {
      fail();
      std::memset(bytes, 0, wanted);
      return;
    }
    std::memcpy(bytes, rest_.data(), wanted);
    rest_ = rest_.subspan(wanted);
  }

  void fail() noexcept {
    sound_ = false;
    rest_ = {};
  }
  [[nodiscard]] std::size_t remaining() const noexcept { return rest_.size(); }
  [[nodiscard]] bool sound() const noexcept { return sound_; }
  /// Returns whether every value was there and no bytes are left.
  [[nodiscard]] bool complete() const noexcept { return sound_ && rest_.empty(); }

 private:
  template <class Enumeration>
  void enumerator(Enumeration& value, Enumeration last) {
    int number = 0;
    get(number);
    if (number < 0 || number > static_cast<int>(last)) return fail();
    value = static_cast<Enumeration>(number);
  }

  std::span<const std::uint8_t> rest_;
  bool sound_ = true;
};

// Results as bytes, and back. Decoding accepts any bytes: it returns nothing unless they are a whole and sound result
// of the requested shape.

using Bytes = std::vector<std::uint8_t>;
using ByteSpan = std::span<const std::uint8_t>;

// Upper bounds on an entry's bytes: no more is read. In addition to the numbers there are the texts of passes.

inline constexpr std::uint64_t kSmallPayload = std::uint64_t{1} << 20U;

[[nodiscard]] std::uint64_t projection_bytes(int bands);
[[nodiscard]] std::uint64_t mip_bytes(int size);
[[nodiscard]] std::uint64_t cubemap_bytes(int size, int levels);
[[nodiscard]] std::uint64_t face_sums_bytes(int bands, std::size_t tiles);

[[nodiscard]] Bytes encode(const Projection& projection);
[[nodiscard]] Bytes encode(const Cubemap& chain);
/// `texels`: the six faces, 18 times the square of `mip.size`. `energies`: see `PrefilterPlan::energies`.
[[nodiscard]] Bytes encode_mip(const MipRecord& mip, const float* texels, const std::vector<float>& energies = {});
[[nodiscard]] Bytes encode(const projection::FaceSums& sums);
[[nodiscard]] Bytes encode(const OctahedralMap& map);

[[nodiscard]] std::optional<Projection> decode_projection(ByteSpan bytes, int bands);
[[nodiscard]] std::optional<Cubemap> decode_cubemap(ByteSpan bytes, int size, int levels,
                                                    memory_resource* memory = nullptr);
/// Decodes a map of the size that the options state.
[[nodiscard]] std::optional<OctahedralMap> decode_octahedral(ByteSpan bytes, const OctahedralOptions& options);
/// Decodes a mip into `texels`, which are written only if all of a mip of that size is there. Its time is 0. `energies`
/// receives the image's energies, if they were stored.
[[nodiscard]] std::optional<MipRecord> decode_mip(ByteSpan bytes, int size, float* texels,
                                                  std::vector<float>* energies = nullptr);
[[nodiscard]] std::optional<std::shared_ptr<const projection::FaceSums>> decode_face_sums(ByteSpan bytes, int bands,
                                                                                          std::size_t tiles);

// The keys that passes over the pixels share.

/// Hashes clamp, gamma and policies only.
[[nodiscard]] ContentHash pixel_key(const PixelPolicy& pixels);

// The name under which a result is kept.

/// Returns the key of a result of this version. `what`: the call. The number is the version of all keys: raise it with
/// every change of results' bits, of their form as bytes, or of the files and previews of `welkin bake`.
[[nodiscard]] inline ContentHash result_key(const std::string& what, std::initializer_list<ContentHash> parts) {
  const std::string call = what + " " WELKIN_VERSION_STRING " 8";
  std::vector<ContentHash> all{hash_bytes(call.data(), call.size())};
  all.insert(all.end(), parts);
  return combine(all);
}

/// Hashes each face, independently of which face it is. Throws `Error` (invalid_argument).
[[nodiscard]] std::array<ContentHash, 6> hash_faces(const CubemapView& cubemap, const Control& control);

/// Hashes every option that a result depends on: not memory limits, an atmosphere's name, or `pixels` that are ignored.
[[nodiscard]] ContentHash hash_options(const ProjectionOptions& options);
[[nodiscard]] ContentHash hash_options(const PrefilterOptions& options);
[[nodiscard]] ContentHash hash_options(const BrdfTableOptions& options);
[[nodiscard]] ContentHash hash_options(const BakeOptions& options);
[[nodiscard]] ContentHash hash_options(const ReadOptions& options);
[[nodiscard]] ContentHash hash_options(const SkyTableOptions& options);
[[nodiscard]] ContentHash hash_options(const Atmosphere& atmosphere);

/// Hashes values in their order.
template <class... Values>
[[nodiscard]] ContentHash hash_of(const Values&... values) {
  ByteWriter writer;
  writer.all(values...);
  return writer.hash();
}

}  // namespace welkin::cache
