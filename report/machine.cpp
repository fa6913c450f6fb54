#include "report/machine.h"

#include <chrono>
#include <ctime>
#include <fstream>
#include <thread>

#include "welkin/instruction_set.h"
#include "welkin/version.h"

namespace welkin::report {
namespace {

/// As Linux has it; else the number of processors alone.
std::string processor() {
  const std::string count = std::to_string(std::thread::hardware_concurrency()) + " x ";
  std::ifstream stream("/proc/cpuinfo");
  for (std::string line; std::getline(stream, line);) {
    if (line.rfind("model name", 0) != 0) continue;
    const std::size_t at = line.find(": ");
    if (at != std::string::npos) return count + line.substr(at + 2);
  }
  return count + "processor of no name";
}

std::string compiler() {
#if defined(__clang__)
  return "Clang " __clang_version__;
#elif defined(__GNUC__)
  return "GCC " __VERSION__;
#else
  return "a compiler of no name";
#endif
}

std::string date() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

}  // namespace

Machine this_machine(const Stopwatch& stopwatch) {
  return {processor(),
          compiler(),
          welkin::name(active_instruction_set()),
          WELKIN_VERSION_STRING,
          name(stopwatch.clock()),
          date(),
          stopwatch.threads};
}

}  // namespace welkin::report
