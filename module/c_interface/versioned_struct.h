// Structures of callers that were compiled against an older or a newer header than this library.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace welkin::c_interface {

/// What a structure of the caller says of its own size. `alignment` is that of the structure, as this library knows it:
/// no compiler makes a size that is not a multiple of it, and a shorter structure then ends between two fields.
/// Throws `Error` (invalid_argument) for null, and for a size that no version of the structure can have.
[[nodiscard]] std::size_t stated_size(const void* given, std::size_t known, std::size_t alignment, const char* name);

/// Throws `Error` (invalid_argument) unless all bytes from `known` to `size` are zero.
void require_zeros_behind(const void* given, std::size_t known, std::size_t size, const char* name);

template <class Struct>
inline constexpr bool kVersioned = std::is_trivially_copyable_v<Struct>&& std::is_standard_layout_v<Struct>&&
    std::is_same_v<decltype(Struct::struct_size), std::uint32_t>;

/// The structure's known part, what it lacks as zero. Throws as `stated_size`.
template <class Struct>
[[nodiscard]] Struct read_known(const Struct* given, const char* name) {
  static_assert(kVersioned<Struct>);
  const std::size_t size = stated_size(given, sizeof(Struct), alignof(Struct), name);
  Struct known{};
  std::memcpy(&known, given, std::min(size, sizeof(Struct)));
  return known;
}

/// Throws `Error` (invalid_argument) if the structure asks for something that this library does not know.
template <class Struct>
void require_known(const Struct* given, const char* name) {
  require_zeros_behind(given, sizeof(Struct), stated_size(given, sizeof(Struct), alignof(Struct), name), name);
}

/// Both of these.
template <class Struct>
[[nodiscard]] Struct read_struct(const Struct* given, const char* name) {
  const Struct known = read_known(given, name);
  require_known(given, name);
  return known;
}

/// The same, all defaults for null.
template <class Struct>
[[nodiscard]] Struct read_options(const Struct* given, const char* name) {
  return given == nullptr ? Struct{} : read_struct(given, name);
}

/// Writes as much of `values` as the caller's structure has room for, zeros to what is unknown here; `struct_size`
/// stays. Throws as `stated_size`.
template <class Struct>
void write_struct(Struct* target, Struct values, const char* name) {
  static_assert(kVersioned<Struct>);
  const std::size_t size = stated_size(target, sizeof(Struct), alignof(Struct), name);
  values.struct_size = static_cast<std::uint32_t>(size);
  std::memcpy(target, &values, std::min(size, sizeof(Struct)));
  if (size > sizeof(Struct))
    std::memset(reinterpret_cast<std::byte*>(target) + sizeof(Struct), 0, size - sizeof(Struct));
}

}  // namespace welkin::c_interface
