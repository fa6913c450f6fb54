#include "c/c_support.h"

#include <array>
#include <new>
#include <string>

namespace welkin::c_interface {
namespace {

/// A thread's last error. The text is kept separate from its storage: there may be no memory to say so.
struct LastError {
  welkin_status status = WELKIN_OK;
  const char* text = "";
  std::string storage;
};

thread_local LastError last_error;

struct Name {
  welkin_status status;
  const char* name;
};

constexpr std::array kNames{
    Name{WELKIN_OK, "ok"},
    Name{WELKIN_INVALID_ARGUMENT, "invalid_argument"},
    Name{WELKIN_REJECTED_PIXEL, "rejected_pixel"},
    Name{WELKIN_FILE_ACCESS, "file_access"},
    Name{WELKIN_CORRUPT_FILE, "corrupt_file"},
    Name{WELKIN_UNSUPPORTED_FILE, "unsupported_file"},
    Name{WELKIN_LIMIT_EXCEEDED, "limit_exceeded"},
    Name{WELKIN_CANCELLED, "cancelled"},
    Name{WELKIN_REPLACED, "replaced"},
    Name{WELKIN_QUEUE_FULL, "queue_full"},
    Name{WELKIN_STOPPED, "stopped"},
    Name{WELKIN_OUT_OF_MEMORY, "out_of_memory"},
    Name{WELKIN_NOT_READY, "not_ready"},
    Name{WELKIN_INTERNAL, "internal"},
};

}  // namespace

welkin_status status_of(ErrorCode code) noexcept {
  switch (code) {
    case ErrorCode::invalid_argument: return WELKIN_INVALID_ARGUMENT;
    case ErrorCode::rejected_pixel: return WELKIN_REJECTED_PIXEL;
    case ErrorCode::file_access: return WELKIN_FILE_ACCESS;
    case ErrorCode::corrupt_file: return WELKIN_CORRUPT_FILE;
    case ErrorCode::unsupported_file: return WELKIN_UNSUPPORTED_FILE;
    case ErrorCode::limit_exceeded: return WELKIN_LIMIT_EXCEEDED;
    case ErrorCode::cancelled: return WELKIN_CANCELLED;
    case ErrorCode::replaced: return WELKIN_REPLACED;
    case ErrorCode::queue_full: return WELKIN_QUEUE_FULL;
    case ErrorCode::stopped: return WELKIN_STOPPED;
  }
  return WELKIN_INTERNAL;
}

Outcome outcome_of(const std::exception_ptr& error) {
  try {
    std::rethrow_exception(error);
  } catch (const Error& known) {
    return {status_of(known.code()), known.what()};
  } catch (const StatusError& returned) {
    return {returned.status(), returned.what()};
  } catch (const std::bad_alloc&) {
    return {WELKIN_OUT_OF_MEMORY, "there is not enough memory"};
  } catch (const std::exception& other) {
    return {WELKIN_INTERNAL, other.what()};
  } catch (...) {
    return {WELKIN_INTERNAL, "something that is no std::exception was thrown, by a callback perhaps"};
  }
}

welkin_status set_last_error(welkin_status status, const std::string& message) noexcept {
  last_error.status = status;
  try {
    last_error.storage = message;
    last_error.text = last_error.storage.c_str();
  } catch (...) {
    last_error.text = "there is not enough memory for the message";
  }
  return status;
}

welkin_status set_last_error_from_exception() noexcept {
  try {
    const Outcome outcome = outcome_of(std::current_exception());
    return set_last_error(outcome.status, outcome.message);
  } catch (...) {
    last_error.status = WELKIN_OUT_OF_MEMORY;
    last_error.text = "there is not enough memory, not even to say for what";
    return WELKIN_OUT_OF_MEMORY;
  }
}

void clear_last_error() noexcept {
  last_error.status = WELKIN_OK;
  last_error.text = "";
}

welkin_status last_error_status() noexcept { return last_error.status; }

void refuse(const std::string& message) { throw Error(ErrorCode::invalid_argument, message); }

void require(const void* pointer, const char* name) {
  if (pointer == nullptr) refuse(std::string(name) + " is null");
}

}  // namespace welkin::c_interface

const char* welkin_status_name(welkin_status status) {
  for (const auto& known : welkin::c_interface::kNames) {
    if (known.status == status) return known.name;
  }
  return "unknown";
}

const char* welkin_last_error() { return welkin::c_interface::last_error.text; }

namespace welkin::c_interface {
namespace {

/// By how much a structure may grow until it must be taken for one whose size was never set.
constexpr std::size_t kMostSurplus = 4096;

}  // namespace

std::size_t stated_size(const void* given, std::size_t known, std::size_t alignment, const char* name) {
  require(given, name);
  std::uint32_t size = 0;
  std::memcpy(&size, given, sizeof size);
  const std::size_t least = std::max(sizeof size, alignment);
  if (size < least || size % alignment != 0 || size > known + kMostSurplus) {
    refuse(std::string(name) + "->struct_size is " + std::to_string(size) +
           "; it must be the structure's sizeof, which is " + std::to_string(known) + " in version " +
           std::to_string(WELKIN_C_VERSION));
  }
  return size;
}

void require_zeros_behind(const void* given, std::size_t known, std::size_t size, const char* name) {
  const auto* bytes = static_cast<const unsigned char*>(given);
  for (std::size_t i = known; i < size; ++i) {
    if (bytes[i] == 0) continue;
    refuse(std::string(name) + " asks for something that version " + std::to_string(WELKIN_C_VERSION) +
           " of this interface does not know: byte " + std::to_string(i) + " of the structure is not zero");
  }
}

}  // namespace welkin::c_interface

uint32_t welkin_c_version() { return WELKIN_C_VERSION; }

namespace welkin::c_interface {

void require_enumerator(const char* what, std::int32_t value, std::int32_t last) {
  if (value >= 0 && value <= last) return;
  refuse(std::string(what) + " is " + std::to_string(value) + "; it must be one of the named values, 0 to " +
         std::to_string(last));
}

bool flag(const char* what, std::int32_t value) {
  if (value != 0 && value != 1) refuse(std::string(what) + " is " + std::to_string(value) + "; it must be 0 or 1");
  return value == 1;
}

Control control_of(const welkin_control* control) { return control == nullptr ? Control{} : control->control; }

}  // namespace welkin::c_interface

using namespace welkin::c_interface;  // NOLINT(google-build-using-namespace,google-global-names-in-headers)

int32_t welkin_control_stop_requested(const welkin_control* control) {
  return control != nullptr && control->control.stop.stop_requested() ? 1 : 0;
}

welkin_status welkin_control_report_progress(const welkin_control* control, double done) {
  return guarded([&] {
    require(control, "control");
    if (!(done >= 0.0 && done <= 1.0)) refuse("done is " + std::to_string(done) + "; it must be from 0 to 1");
    if (control->control.progress) control->control.progress(done);
    return WELKIN_OK;
  });
}
