#include "c_interface/enumeration.h"

#include <string>

#include "c_interface/error_status.h"

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

}  // namespace welkin::c_interface
