// The one exception type that Welkin throws.
#pragma once

#include <stdexcept>
#include <string>

#include "welkin/export.h"

namespace WELKIN_EXPORT welkin {

/// What kind of thing went wrong; the message says what, where, and what would do instead.
enum class ErrorCode {
  invalid_argument,  ///< a view or an option that no call could accept (a null face, zero bands)
  rejected_pixel,    ///< a texel that the caller's policy rejects; the message names face, row and column
  file_access,       ///< a file that cannot be opened, read or written
  corrupt_file,      ///< a file that breaks its own format, or ends too early
  unsupported_file,  ///< a sound file of a kind that Welkin (so built) does not read, or whose layout is unclear
  limit_exceeded,    ///< a file or request that would need more memory than the stated limit
  cancelled,         ///< the caller asked for it: by a stop token, or by `JobHandle::cancel`
  replaced,          ///< a newer request with the same key took this job's place
  queue_full,        ///< a worker at its limits refused this job, or dropped it for another
  stopped,           ///< the worker was terminated before this job was done
};

/// Thrown by every public entry that can fail. Nothing else leaves the library, except
/// `std::bad_alloc` and whatever a caller's own callback throws.
class Error : public std::runtime_error {
 public:
  /// `message` names the file or argument, what was found and what would do.
  Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}

  /// For programs; `what()` is for people.
  [[nodiscard]] ErrorCode code() const noexcept { return code_; }

 private:
  ErrorCode code_;
};

}  // namespace welkin
