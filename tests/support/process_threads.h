// The threads of this process, as the system has them.
#pragma once

#include <sys/syscall.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <string>

namespace welkin::test {

/// The system's numbers of all threads that there are.
inline std::set<int> process_threads() {
  std::set<int> threads;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task")) {
    threads.insert(std::stoi(entry.path().filename().string()));
  }
  return threads;
}

/// Empty if the thread is gone.
inline std::string thread_name(int thread) {
  std::ifstream file("/proc/self/task/" + std::to_string(thread) + "/comm");
  std::string name;
  std::getline(file, name);
  return name;
}

inline std::string this_threads_name() { return thread_name(static_cast<int>(syscall(SYS_gettid))); }

/// Those that were not there `before`.
inline std::set<int> threads_since(const std::set<int>& before) {
  std::set<int> since;
  for (const int thread : process_threads()) {
    if (before.count(thread) == 0) since.insert(thread);
  }
  return since;
}

}  // namespace welkin::test
