// With WELKIN_TEST_FILL_MEMORY set, working memory is filled with NaN before the program's calls get it: a read of
// memory that was never written, also in tables that are built once, changes recorded results.
#include <cstdlib>

#include "platform/memory.h"

namespace welkin::test {
namespace {

[[maybe_unused]] const bool filled = [] {
  const bool wanted = std::getenv("WELKIN_TEST_FILL_MEMORY") != nullptr;
  if (wanted) platform::fill_taken_memory(0xFF);
  return wanted;
}();

}  // namespace
}  // namespace welkin::test
