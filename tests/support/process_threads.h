// This process's threads as the system reports them, work on several threads, and functions of loaded libraries.
#pragma once

#include "support/catch.h"

namespace welkin::test {

/// Returns the system's numbers of all threads of the process.
[[nodiscard]] std::set<int> process_threads();

/// Returns a thread's name; empty if the thread is gone or the system has no names.
[[nodiscard]] std::string thread_name(int thread);

[[nodiscard]] std::string this_threads_name();

/// Returns the threads that are not in `before`.
[[nodiscard]] inline std::set<int> threads_since(const std::set<int>& before) {
  std::set<int> since;
  for (const int thread : process_threads()) {
    if (before.count(thread) == 0) since.insert(thread);
  }
  return since;
}

/// Calls `work(0)` to `work(count - 1)`, each on a separate thread, and waits for all.
template <class Work>
void on_threads(std::size_t count, const Work& work) {
  std::vector<std::thread> threads;
  for (std::size_t k = 0; k < count; ++k) threads.emplace_back([&work, k] { work(k); });
  for (std::thread& thread : threads) thread.join();
}

/// Returns a C function of a loaded library, or null if none has it.
[[nodiscard]] void* loaded_function(const char* name);

}  // namespace welkin::test
