// Enumerations arrive as numbers, and any number can arrive.
#pragma once

#include <cstdint>

namespace welkin::c_interface {

/// Throws `Error` (invalid_argument) unless 0 <= value <= last.
void require_enumerator(const char* what, std::int32_t value, std::int32_t last);

/// The enumerator of that value; `last` is the one with the greatest.
template <class Enumeration>
[[nodiscard]] Enumeration enumerator(const char* what, std::int32_t value, Enumeration last) {
  require_enumerator(what, value, static_cast<std::int32_t>(last));
  return static_cast<Enumeration>(value);
}

/// 0 or 1.
[[nodiscard]] bool flag(const char* what, std::int32_t value);

}  // namespace welkin::c_interface
