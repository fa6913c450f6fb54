// Processes on POSIX.
#include <fcntl.h>
#include <sched.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <ctime>

#include "perf/report/measuring.h"
#include "welkin/core.h"

extern char** environ;  // NOLINT(readability-redundant-declaration): POSIX leaves declaring it to the program

namespace welkin::report {
namespace {

/// Binds this thread and the processes that it starts to its first few processors during its lifetime.
class BoundToProcessors {
 public:
  explicit BoundToProcessors(int threads) {
    if (threads <= 0 || sched_getaffinity(0, sizeof before_, &before_) != 0) return;
    cpu_set_t few;
    CPU_ZERO(&few);
    for (int processor = 0; processor < CPU_SETSIZE && CPU_COUNT(&few) < threads; ++processor) {
      if (CPU_ISSET(processor, &before_)) CPU_SET(processor, &few);
    }
    bound_ = sched_setaffinity(0, sizeof few, &few) == 0;
  }
  ~BoundToProcessors() {
    if (bound_) sched_setaffinity(0, sizeof before_, &before_);
  }
  BoundToProcessors(const BoundToProcessors&) = delete;
  BoundToProcessors& operator=(const BoundToProcessors&) = delete;

 private:
  cpu_set_t before_{};
  bool bound_ = false;
};

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

pid_t start(const std::vector<std::string>& arguments, int threads, const std::string& output) {
  std::vector<char*> words;
  std::vector<std::string> copies = arguments;
  words.reserve(copies.size() + 1);
  for (std::string& word : copies) words.push_back(word.data());
  words.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = -1;
  {
    const BoundToProcessors bound(threads);
    if (posix_spawnp(&child, words[0], &files, nullptr, words.data(), environ) != 0) child = -1;
  }
  posix_spawn_file_actions_destroy(&files);
  return child;
}

}  // namespace

double processor_seconds() {
  std::timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

std::filesystem::path make_temporary_folder() {
  std::string name = (std::filesystem::temp_directory_path() / "welkin-report-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr)
    throw Error(ErrorCode::file_access, name + ": cannot be made (" + std::strerror(errno) + ")");
  return name;
}

ProcessResult run_process(const std::vector<std::string>& arguments, int threads, Clock clock,
                          const std::optional<std::filesystem::path>& output) {
  using Steady = std::chrono::steady_clock;
  const Steady::time_point begin = Steady::now();
  const pid_t child = start(arguments, threads, output ? output->string() : "/dev/null");
  if (child < 0) return {};
  int status = 0;
  rusage usage{};
  while (wait4(child, &status, 0, &usage) < 0) {
    if (errno != EINTR) return {};
  }
  const double wall = std::chrono::duration<double>(Steady::now() - begin).count();
  const double processor = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, clock == Clock::processor ? processor : wall};
}

bool on_path(const std::string& program) {
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (access((std::filesystem::path(folder) / program).c_str(), X_OK) == 0) return true;
  }
  return false;
}

/// Returns the name from Linux (on ARM numbers replace names: of the designer and of the design); else only the number
/// of processors.
std::string processor_name() {
  std::string name = std::to_string(std::thread::hardware_concurrency()) + " x ";
  std::ifstream stream("/proc/cpuinfo");
  std::string implementer;
  for (std::string line; std::getline(stream, line);) {
    const std::size_t at = line.find(": ");
    if (at == std::string::npos) continue;
    if (line.rfind("model name", 0) == 0) return name.append(line, at + 2);
    if (line.rfind("CPU implementer", 0) == 0) implementer = line.substr(at + 2);
    if (line.rfind("CPU part", 0) == 0) {
      return name.append("64-bit ARM, implementer ").append(implementer).append(", part ").append(line, at + 2);
    }
  }
  return name.append("processor of no name");
}

}  // namespace welkin::report
