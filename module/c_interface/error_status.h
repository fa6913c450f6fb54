// No exception crosses the C interface: what a call throws becomes a status, and a message that the thread keeps.
#pragma once

#include <exception>
#include <stdexcept>
#include <string>

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

}  // namespace welkin::c_interface
