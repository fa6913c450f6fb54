#include "welkin/core.h"

namespace welkin {

const char* name(ErrorCode code) noexcept {
  switch (code) {
    case ErrorCode::invalid_argument: return "invalid_argument";
    case ErrorCode::rejected_pixel: return "rejected_pixel";
    case ErrorCode::file_access: return "file_access";
    case ErrorCode::corrupt_file: return "corrupt_file";
    case ErrorCode::unsupported_file: return "unsupported_file";
    case ErrorCode::limit_exceeded: return "limit_exceeded";
    case ErrorCode::cancelled: return "cancelled";
    case ErrorCode::replaced: return "replaced";
    case ErrorCode::queue_full: return "queue_full";
    case ErrorCode::stopped: return "stopped";
  }
  return "unknown";
}

}  // namespace welkin
