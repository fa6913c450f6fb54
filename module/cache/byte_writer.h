// Values to bytes, and back with every length looked at: what is hashed, and what entries hold.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace welkin::cache {

static_assert(std::endian::native == std::endian::little, "entries need their byte order turned here");

/// Appends. Every value has one form: whole numbers and enumerators 8 bytes, real ones those of a double, and what has
/// a length states it first, so that no two lists of values have the same bytes.
class ByteWriter {
 public:
  /// Results that are megabytes are appended without growing step by step.
  explicit ByteWriter(std::size_t expected_bytes = 0) { bytes_.reserve(expected_bytes); }

  template <class Value>
  requires std::is_arithmetic_v<Value> || std::is_enum_v<Value>
  void put(Value value) {
    if constexpr (std::is_floating_point_v<Value>) {
      append(std::bit_cast<std::uint64_t>(static_cast<double>(value)));
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

  /// As they lie in memory.
  void floats(std::span<const float> values) { raw(values.data(), values.size_bytes()); }
  /// Not inline: GCC 12 warns of writes past the end of vectors whose first capacity it knows.
  void raw(const void* bytes, std::size_t count);

  [[nodiscard]] const std::vector<std::uint8_t>& bytes() const noexcept { return bytes_; }
  [[nodiscard]] std::vector<std::uint8_t> take() noexcept { return std::move(bytes_); }

 private:
  void append(std::uint64_t bits) { raw(&bits, sizeof bits); }

  std::vector<std::uint8_t> bytes_;
};

/// Takes values back in the same order. Once something was not there, everything is zero and `sound` says so.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

  template <class Value>
  requires std::is_arithmetic_v<Value>
  void get(Value& value) {
    std::uint64_t bits = 0;
    raw(&bits, sizeof bits);
    if constexpr (std::is_floating_point_v<Value>) {
      value = static_cast<Value>(std::bit_cast<double>(bits));
    } else {
      value = static_cast<Value>(bits);
      if (static_cast<std::uint64_t>(value) != bits) fail();
    }
  }
  void get(std::string& text) {
    const std::size_t length = count(1);
    text.resize(length);
    raw(text.data(), length);
  }

  /// A length of values that take at least `value_bytes` each: no more than the rest could hold.
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
  /// Everything was there and nothing is left.
  [[nodiscard]] bool complete() const noexcept { return sound_ && rest_.empty(); }

 private:
  std::span<const std::uint8_t> rest_;
  bool sound_ = true;
};

}  // namespace welkin::cache
