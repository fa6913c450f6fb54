#include "modes.h"

#include <unistd.h>
#include <xmmintrin.h>

#include <atomic>
#include <csignal>
#include <cstring>
#include <stdexcept>
#include <string>

namespace welkin::test {
namespace {

struct Mode {
  const char* name;
  FloatEnvironment environment;
};

// MXCSR: bits 7 to 12 mask exceptions, 13 and 14 say how to round, 15 flushes results to zero, 6 takes denormal
// operands for zero. x87: bits 0 to 5 mask exceptions, 8 and 9 say how precisely, 10 and 11 how to round.
constexpr Mode kModes[] = {
    {"default", {0x1F80, 0x037F}},     {"downward", {0x3F80, 0x077F}}, {"upward", {0x5F80, 0x0B7F}},
    {"toward_zero", {0x7F80, 0x0F7F}}, {"flushed", {0x9FC0, 0x037F}},  {"unmasked", {0x0000, 0x0340}},
};

constexpr unsigned kFlags = 0x003F;  // of past exceptions

std::atomic<const char*> called{"no public function"};

void trap(int /*signal*/) {
  const char* const name = called.load();
  for (const char* const text : {"a floating-point operation ran with the caller's environment in ", name, "\n"}) {
    static_cast<void>(!write(STDERR_FILENO, text, std::strlen(text)));
  }
  _exit(1);
}

}  // namespace

FloatEnvironment mode_named(std::string_view name) {
  for (const Mode& mode : kModes) {
    if (mode.name == name) return mode.environment;
  }
  throw std::invalid_argument("there is no mode " + std::string(name));
}

FloatEnvironment current_environment() noexcept {
  FloatEnvironment environment;
  environment.mxcsr = _mm_getcsr() & ~kFlags;
  __asm__ volatile("fnstcw %0" : "=m"(environment.control_word));
  return environment;
}

void set_environment(const FloatEnvironment& environment) noexcept {
  _mm_setcsr(environment.mxcsr);
  __asm__ volatile("fnclex\n\tfldcw %0" : : "m"(environment.control_word));
}

void report_traps() noexcept { std::signal(SIGFPE, trap); }

void name_call(const char* name) noexcept { called = name; }

}  // namespace welkin::test
