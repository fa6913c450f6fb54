// The threads of this process, as the system has them, work on several at once, and the functions of the libraries that
// it has loaded.
#pragma once

#include "support/catch.h"

namespace welkin::test {

/// The system's numbers of all threads that there are.
[[nodiscard]] std::set<int> process_threads();

/// Empty if the thread is gone, or the system names none.
[[nodiscard]] std::string thread_name(int thread);

[[nodiscard]] std::string this_threads_name();

/// Those that were not there `before`.
[[nodiscard]] inline std::set<int> threads_since(const std::set<int>& before) {
  std::set<int> since;
  for (const int thread : process_threads()) {
    if (before.count(thread) == 0) since.insert(thread);
  }
  return since;
}

/// Calls `work(0)` to `work(count - 1)`, each on a thread of its own, and waits for all.
template <class Work>
void on_threads(std::size_t count, const Work& work) {
  std::vector<std::thread> threads;
  for (std::size_t k = 0; k < count; ++k) threads.emplace_back([&work, k] { work(k); });
  for (std::thread& thread : threads) thread.join();
}

/// A function of C that one of the libraries has; null: none does.
[[nodiscard]] void* loaded_function(const char* name);

}  // namespace welkin::test
