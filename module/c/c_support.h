// Helpers of the whole C interface. No exception crosses it: an exception becomes a status and a message that the
// thread keeps. Structures are read and written by their stated size. Pixels are read in place, and results are written
// to the caller's memory.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "image/pixels.h"
#include "platform/float_environment.h"
#include "platform/thread.h"
#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/projection.h"
#include "welkin/spherical_harmonics.h"
#include "welkin/welkin.h"

namespace welkin::c_interface {

/// A failure with a status but no `ErrorCode`: a status that a caller's own function returned.
class StatusError : public std::runtime_error {
 public:
  StatusError(welkin_status status, const std::string& message) : std::runtime_error(message), status_(status) {}

  [[nodiscard]] welkin_status status() const noexcept { return status_; }

 private:
  welkin_status status_;
};

/// A status and its message.
struct Outcome {
  welkin_status status = WELKIN_OK;
  std::string message;
};

[[nodiscard]] welkin_status status_of(ErrorCode code) noexcept;

/// Converts an exception. Throws std::bad_alloc if there is no memory for the message.
[[nodiscard]] Outcome outcome_of(const std::exception_ptr& error);

/// Sets the text that `welkin_last_error` returns and its status, which it returns.
welkin_status set_last_error(welkin_status status, const std::string& message) noexcept;
/// Sets both from the exception that is being handled.
welkin_status set_last_error_from_exception() noexcept;
void clear_last_error() noexcept;
/// Returns the status of the thread's last error; WELKIN_OK if there is none.
[[nodiscard]] welkin_status last_error_status() noexcept;

[[noreturn]] void refuse(const std::string& message);

/// Throws `Error` (invalid_argument) if the pointer is null.
void require(const void* pointer, const char* name);

/// Wraps the body of an entry that can fail and that calls the caller's own functions, which keep the caller's
/// floating-point environment. The body returns a status, or nothing for WELKIN_OK.
template <class Body>
welkin_status guarded_as_called(const Body& body) noexcept {
  try {
    if constexpr (std::is_void_v<std::invoke_result_t<Body>>) {
      body();
      return WELKIN_OK;
    } else {
      return body();
    }
  } catch (...) {
    return set_last_error_from_exception();
  }
}

/// Wraps the body of every other entry that can fail: it computes with the default floating-point environment.
template <class Body>
welkin_status guarded(const Body& body) noexcept {
  const platform::FloatingPointScope floating_point;
  return guarded_as_called(body);
}

// Structures of callers that were compiled against an older or a newer header than this library.

/// Returns the size that a caller's structure states. `alignment` is that of this library's version of the structure:
/// no compiler makes a size that is not a multiple of it, so a shorter structure ends between two fields. Throws
/// `Error` (invalid_argument) for null, and for a size that no version of the structure can have.
[[nodiscard]] std::size_t stated_size(const void* given, std::size_t known, std::size_t alignment, const char* name);

/// Throws `Error` (invalid_argument) unless all bytes from `known` to `size` are zero.
void require_zeros_behind(const void* given, std::size_t known, std::size_t size, const char* name);

template <class Struct>
inline constexpr bool kVersioned = std::is_trivially_copyable_v<Struct>&& std::is_standard_layout_v<Struct>&&
    std::is_same_v<decltype(Struct::struct_size), std::uint32_t>;

/// Returns the part of the structure that is known, with zeros for missing fields. Throws the errors of `stated_size`.
template <class Struct>
[[nodiscard]] Struct read_known(const Struct* given, const char* name) {
  static_assert(kVersioned<Struct>);
  const std::size_t size = stated_size(given, sizeof(Struct), alignof(Struct), name);
  Struct known{};
  std::memcpy(&known, given, std::min(size, sizeof(Struct)));
  return known;
}

/// Throws `Error` (invalid_argument) if the structure sets fields that this library does not know.
template <class Struct>
void require_known(const Struct* given, const char* name) {
  require_zeros_behind(given, sizeof(Struct), stated_size(given, sizeof(Struct), alignof(Struct), name), name);
}

/// Does both.
template <class Struct>
[[nodiscard]] Struct read_struct(const Struct* given, const char* name) {
  const Struct known = read_known(given, name);
  require_known(given, name);
  return known;
}

/// Reads a structure as `read_struct` does; null selects all defaults.
template <class Struct>
[[nodiscard]] Struct read_options(const Struct* given, const char* name) {
  return given == nullptr ? Struct{} : read_struct(given, name);
}

/// Writes the fields of `values` that the caller's structure includes, and zeros to its unknown fields; `struct_size`
/// stays. Throws the errors of `stated_size`.
template <class Struct>
void write_struct(Struct* target, Struct values, const char* name) {
  static_assert(kVersioned<Struct>);
  const std::size_t size = stated_size(target, sizeof(Struct), alignof(Struct), name);
  values.struct_size = static_cast<std::uint32_t>(size);
  std::memcpy(target, &values, std::min(size, sizeof(Struct)));
  if (size > sizeof(Struct))
    std::memset(reinterpret_cast<std::byte*>(target) + sizeof(Struct), 0, size - sizeof(Struct));
}

// Enumerations arrive as numbers, of any value.

/// Throws `Error` (invalid_argument) unless 0 <= value <= last.
void require_enumerator(const char* what, std::int32_t value, std::int32_t last);

/// Returns the enumerator of a value; `last` is the one with the greatest value.
template <class Enumeration>
[[nodiscard]] Enumeration enumerator(const char* what, std::int32_t value, Enumeration last) {
  require_enumerator(what, value, static_cast<std::int32_t>(last));
  return static_cast<Enumeration>(value);
}

/// Converts 0 or 1.
[[nodiscard]] bool flag(const char* what, std::int32_t value);

/// Sets `target` unless `value` is zero, which selects the default.
template <class Number>
void set_unless_zero(Number& target, Number value) noexcept {
  if (value != Number{}) target = value;
}

}  // namespace welkin::c_interface

// Progress and cancellation of the job that runs a caller's function.

/// Lives on the stack of the code that calls the function.
struct welkin_control {
  const welkin::Control& control;
};

namespace welkin::c_interface {

/// Returns the caller's control; for null one that never stops and reports nothing.
[[nodiscard]] Control control_of(const welkin_control* control);

// Functions of the caller.

/// Calls a function that must not end its thread. Returns false if it called `pthread_exit`; the thread goes on.
template <class Call>
[[nodiscard]] bool returns(Call call) {
  return welkin::detail::returns_from([](void* argument) { (*static_cast<Call*>(argument))(); }, &call);
}

/// Throws the error for a caller's function that called `pthread_exit`.
[[noreturn]] void refuse_thread_exit(const char* function);

// Data that a caller hands over together with the function that frees it.

/// Calls `release(user)` once, when it is destroyed, wherever it was moved to.
class HandedOver {
 public:
  using Release = void (*)(void* user);

  HandedOver() = default;
  HandedOver(Release release, void* user) noexcept : release_(release), user_(user) {}
  ~HandedOver() {
    if (release_ == nullptr) return;
    try {
      static_cast<void>(returns([this] { release_(user_); }));
    } catch (...) {  // NOLINT(bugprone-empty-catch): a destructor cannot report the error
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

/// Returns null if nothing is handed over. No two owners are equal, even if both free the same thing, so that sources
/// of different posts never compare equal and none is released while a run for its job reads it. Throws std::bad_alloc;
/// `handed_over` then keeps what it holds.
[[nodiscard]] inline std::shared_ptr<const void> make_owner(HandedOver&& handed_over) {
  if (handed_over.empty()) return nullptr;
  return std::make_shared<HandedOver>(std::move(handed_over));
}

// The caller's pixels. Their values are checked by the functions that read them.

/// Returns a cubemap or a lat-long. Throws `Error` (invalid_argument) for null, for sizes that no image has, and for
/// unknown formats. `name` is the argument's.
[[nodiscard]] EnvironmentView environment_view(const welkin_environment* environment, const char* name = "environment");
/// Returns a cubemap's levels. Throws the same errors, also for a lat-long and for structures whose stated sizes
/// differ.
[[nodiscard]] std::vector<CubemapView> cubemap_views(const welkin_environment* mips, std::int32_t mip_count);
[[nodiscard]] std::vector<CubemapView> probe_views(const welkin_environment* probes, std::int64_t probe_count);

// Options for pixels. Null selects all defaults, and zero a field's default. These throw `Error` (invalid_argument) for
// values that no option can have; ranges are checked by the functions that use the options.

[[nodiscard]] ProjectionOptions projection_options(const welkin_projection_options* options);
/// Returns clamp, gamma and the policies alone.
[[nodiscard]] PixelPolicy pixel_policy(const welkin_pixel_policy* policy);

// Vectors and coefficients as plain numbers.

/// Reads three doubles. Throws `Error` (invalid_argument) for null.
[[nodiscard]] glm::dvec3 read_triple(const double* values, const char* name);
/// Returns consecutive triples of doubles as the calls of C++ read and write them.
template <class Double>
[[nodiscard]] auto triples(Double* values, std::size_t count) noexcept {
  using Triple = std::conditional_t<std::is_const_v<Double>, const glm::dvec3, glm::dvec3>;
  static_assert(sizeof(Triple) == 3 * sizeof(double));
  return std::span<Triple>(reinterpret_cast<Triple*>(values), count);
}
/// Returns the same; throws `Error` (invalid_argument) for null.
template <class Double>
[[nodiscard]] auto triples(Double* values, std::size_t count, const char* name) {
  require(values, name);
  return triples(values, count);
}
void write_triple(const glm::dvec3& values, double* target) noexcept;
/// Writes nine doubles, column by column.
void write_matrix(const glm::dmat3& matrix, double* target) noexcept;

/// Reads 3 bands^2 doubles. Throws `Error` (invalid_argument) for null or for bands out of range.
[[nodiscard]] SphericalHarmonics read_harmonics(std::int32_t bands, const double* coefficients, const char* name);
void write_harmonics(const SphericalHarmonics& harmonics, double* target) noexcept;

// A projection, written to the caller's structure.

/// Throws `Error` (invalid_argument) for null, and if the structure ends before the coefficients of that many bands.
/// `Struct` ends with `coefficients`.
template <class Struct>
void require_room_for_bands(const Struct* given, int bands, const char* name);
void require_room(const welkin_projection* projection, int bands);

/// Throws the same errors, and then writes nothing.
void write_projection(welkin_projection* projection, const SphericalHarmonics& radiance,
                      const ProjectionDiagnostics& diagnostics);
/// Writes diagnostics with no bands, and zeros as coefficients.
void write_diagnostics(welkin_projection* totals, const ProjectionDiagnostics& diagnostics);

// The caller's memory for results.

/// One or six checked images of one size: each has an address, rows that do not overlap, and aligned channels.
struct Target {
  std::array<std::byte*, 6> images{};  ///< first texel of the top row
  int count = 0;
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride = 0;  ///< bytes from a row to the next
  image::TexelLayout layout{};
};

/// Returns a cubemap or a flat image. Throws `Error` (invalid_argument) for null, for formats that are not written, for
/// too short a stride, and for addresses that are not aligned.
[[nodiscard]] Target target_of(const welkin_target* target);
/// These throw the same errors, also for the other kind.
[[nodiscard]] Target cubemap_target(const welkin_target* target);
[[nodiscard]] Target flat_target(const welkin_target* target);
/// Returns targets that the library writes directly, RGBA of F16 and F32, from `count` structures of one size.
[[nodiscard]] std::vector<CubemapTarget> cubemap_targets(const welkin_target* targets, std::int64_t count,
                                                         const std::string& name = "targets");
/// Throws unless the target has that size.
void require_size(const Target& target, int width, int height);

/// Writes an image of `channels` packed floats per texel; returns the number of values that a half cannot hold.
std::uint64_t write_image(const Target& target, int image, const float* values, int channels) noexcept;
/// Writes the six faces of a cubemap of packed RGB floats, whose size the target has.
std::uint64_t write_faces(const Target& target, const CubemapView& cubemap) noexcept;

/// Writes the count unless the pointer is null.
inline void tell(std::uint64_t count, std::uint64_t* wanted) noexcept {
  if (wanted != nullptr) *wanted = count;
}

template <class Struct>
void require_room_for_bands(const Struct* given, int bands, const char* name) {
  const std::size_t size = stated_size(given, sizeof(Struct), alignof(Struct), name);
  const auto count = static_cast<std::size_t>(std::clamp(bands, 1, kMaximumBands));
  const std::size_t needed = offsetof(Struct, coefficients) + 3 * count * count * sizeof(double);
  if (size >= needed) return;
  refuse(std::string(name) + "->struct_size is " + std::to_string(size) + "; " + std::to_string(count) +
         " bands need " + std::to_string(needed));
}

}  // namespace welkin::c_interface
