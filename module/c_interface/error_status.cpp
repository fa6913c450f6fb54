#include "c_interface/error_status.h"

#include <array>
#include <new>

namespace welkin::c_interface {
namespace {

/// A thread's last error. The text is kept apart from its storage: there may be no memory to say so.
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
