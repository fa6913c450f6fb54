#include "c_interface/job_priority.h"

#include <string>

#include "c_interface/error_status.h"

namespace welkin::c_interface {

Priority priority_of(welkin_priority priority) {
  switch (priority) {
    case WELKIN_PRIORITY_LOW: return Priority::low;
    case WELKIN_PRIORITY_NORMAL: return Priority::normal;
    case WELKIN_PRIORITY_HIGH: return Priority::high;
    default: refuse("priority is " + std::to_string(priority) + "; it must be -1 (low), 0 (normal) or 1 (high)");
  }
}

welkin_priority number_of(Priority priority) noexcept {
  switch (priority) {
    case Priority::low: return WELKIN_PRIORITY_LOW;
    case Priority::normal: return WELKIN_PRIORITY_NORMAL;
    case Priority::high: return WELKIN_PRIORITY_HIGH;
  }
  return WELKIN_PRIORITY_NORMAL;
}

}  // namespace welkin::c_interface
