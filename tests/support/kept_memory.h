// How much working memory the process keeps, for one test.
#pragma once

#include <cstddef>

#include "welkin/core.h"

namespace welkin::test {

/// While it lives, `bytes` of working memory are kept: none of it is left from before, and none afterwards.
class KeptMemory {
 public:
  explicit KeptMemory(std::size_t bytes) noexcept {
    release_working_memory();
    keep_working_memory(bytes);
  }
  ~KeptMemory() {
    release_working_memory();
    keep_working_memory(kDefault);
  }
  KeptMemory(const KeptMemory&) = delete;
  KeptMemory& operator=(const KeptMemory&) = delete;

 private:
#if defined(__SANITIZE_ADDRESS__)
  static constexpr std::size_t kDefault = 0;
#else
  static constexpr std::size_t kDefault = std::size_t{128} << 20U;
#endif
};

}  // namespace welkin::test
