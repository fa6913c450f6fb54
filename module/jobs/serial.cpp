// Loops on the calling thread alone.
#include <cstddef>
#include <functional>

#include "jobs/backend.h"
#include "jobs/tiles.h"
#include "welkin/core.h"

namespace welkin::jobs::backend {

int concurrency() noexcept { return 1; }

void loop(std::size_t count, Call<std::size_t> part) {
  for (std::size_t index = 0; index < count; ++index) part(index);
}

}  // namespace welkin::jobs::backend

namespace welkin {

int available_threads() { return 1; }

void run_with_threads(int threads, const std::function<void()>& work) {
  jobs::require_thread_count(threads);
  work();
}

}  // namespace welkin
