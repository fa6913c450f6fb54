#include "c_interface/versioned_struct.h"

#include <string>

#include "c_interface/error_status.h"

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
