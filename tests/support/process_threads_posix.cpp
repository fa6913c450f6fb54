#include <dlfcn.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "support/catch.h"
#include "support/process_threads.h"

namespace welkin::test {

std::set<int> process_threads() {
  std::set<int> threads;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task")) {
    threads.insert(std::stoi(entry.path().filename().string()));
  }
  return threads;
}

std::string thread_name(int thread) {
  std::ifstream file("/proc/self/task/" + std::to_string(thread) + "/comm");
  std::string name;
  std::getline(file, name);
  return name;
}

std::string this_threads_name() { return thread_name(static_cast<int>(syscall(SYS_gettid))); }

void* loaded_function(const char* name) { return dlsym(RTLD_DEFAULT, name); }

}  // namespace welkin::test
