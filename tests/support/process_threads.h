// The threads of this process, as the system has them, and the functions of the libraries that it has loaded.
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

/// A function of C that one of the libraries has; null: none does.
[[nodiscard]] void* loaded_function(const char* name);

}  // namespace welkin::test
