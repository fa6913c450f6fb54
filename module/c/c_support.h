// No exception crosses the C interface: what a call throws becomes a status, and a message that the thread keeps.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#include "welkin/control.h"
#include "welkin/error.h"
#include "welkin/welkin.h"

namespace welkin::c_interface {

/// A failure that has a status but no `ErrorCode`: one that a caller's own function returned.
class StatusError : public std::runtime_error {
 public:
  StatusError(welkin_status status, const std::string& message) : std::runtime_error(message), status_(status) {}

  [[nodiscard]] welkin_status status() const noexcept { return status_; }

 private:
  welkin_status status_;
};

/// A status and what goes with it.
struct Outcome {
  welkin_status status = WELKIN_OK;
  std::string message;
};

[[nodiscard]] welkin_status status_of(ErrorCode code) noexcept;

/// Throws std::bad_alloc if there is no memory for the message.
[[nodiscard]] Outcome outcome_of(const std::exception_ptr& error);

/// What `welkin_last_error` gives from now on, and the status that it belongs to.
welkin_status set_last_error(welkin_status status, const std::string& message) noexcept;
/// The same from the exception that is being handled.
welkin_status set_last_error_from_exception() noexcept;
void clear_last_error() noexcept;
/// The status that the thread's last error belongs to; WELKIN_OK if there is none.
[[nodiscard]] welkin_status last_error_status() noexcept;

[[noreturn]] void refuse(const std::string& message);

/// Throws `Error` (invalid_argument) if it is null.
void require(const void* pointer, const char* name);

/// Around the body of every entry that can fail; the body returns a status.
template <class Body>
welkin_status guarded(const Body& body) noexcept {
  try {
    return body();
  } catch (...) {
    return set_last_error_from_exception();
  }
}

// Structures of callers that were compiled against an older or a newer header than this library.

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

// Enumerations arrive as numbers, and any number can arrive.

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

// How the job that a caller's function runs for is steered.

/// Lives on the stack of whoever calls the function.
struct welkin_control {
  const welkin::Control& control;
};

namespace welkin::c_interface {

/// One that asks for nothing if it is null.
[[nodiscard]] Control control_of(const welkin_control* control);

// What a caller hands over together with the function that frees it.

/// Calls `release(user)` when it goes: once, wherever it was moved to.
class HandedOver {
 public:
  using Release = void (*)(void* user);

  HandedOver() = default;
  HandedOver(Release release, void* user) noexcept : release_(release), user_(user) {}
  ~HandedOver() {
    if (release_ == nullptr) return;
    try {
      release_(user_);
    } catch (...) {  // NOLINT(bugprone-empty-catch): it may not throw, and there is nobody who could be told
    }
  }
  HandedOver(HandedOver&& other) noexcept : release_(std::exchange(other.release_, nullptr)), user_(other.user_) {}
  HandedOver& operator=(HandedOver&& other) noexcept {
    std::swap(release_, other.release_);
    std::swap(user_, other.user_);
    return *this;
  }
  HandedOver(const HandedOver&) = delete;
  HandedOver& operator=(const HandedOver&) = delete;

  [[nodiscard]] bool empty() const noexcept { return release_ == nullptr; }

 private:
  Release release_ = nullptr;
  void* user_ = nullptr;
};

/// Null if nothing is handed over. An owner is equal to no other, also if both free the same thing: whoever compares
/// sources then takes no post's pixels for another's, and none is released while a run for its job reads them.
/// Throws std::bad_alloc; `handed_over` keeps what it has then.
[[nodiscard]] inline std::shared_ptr<const void> make_owner(HandedOver&& handed_over) {
  if (handed_over.empty()) return nullptr;
  return std::make_shared<HandedOver>(std::move(handed_over));
}

}  // namespace welkin::c_interface
