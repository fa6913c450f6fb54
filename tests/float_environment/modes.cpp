#include "modes.h"

#include <unistd.h>
#if !defined(__aarch64__)
#include <xmmintrin.h>
#endif

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

#if defined(__aarch64__)
// FPCR: bits 8 to 12 and 15 trap exceptions, on processors that can; 22 and 23 set the rounding mode, 24 flushes
// denormals, both operands and results.
constexpr Mode kModes[] = {
    {"default", {0}},       {"downward", {0x800000}}, {"upward", {0x400000}}, {"toward_zero", {0xC00000}},
    {"flushed", {1 << 24}}, {"unmasked", {0x9F00}},   {"raising", {0x0700}},
};
#else
// MXCSR: bits 7 to 12 mask exceptions, 13 and 14 set the rounding mode, 15 flushes results to zero, 6 treats denormal
// operands as zero. x87: bits 0 to 5 mask exceptions, 8 and 9 set the precision, 10 and 11 the rounding mode.
constexpr Mode kModes[] = {
    {"default", {0x1F80, 0x037F}},     {"downward", {0x3F80, 0x077F}}, {"upward", {0x5F80, 0x0B7F}},
    {"toward_zero", {0x7F80, 0x0F7F}}, {"flushed", {0x9FC0, 0x037F}},  {"unmasked", {0x0000, 0x0340}},
    {"raising", {0x1900, 0x037F}},
};

constexpr unsigned kFlags = 0x003F;  // of past exceptions
#endif

std::atomic<const char*> called{"no public function"};

void trap(int /*signal*/) {
  const char* const name = called.load();
  for (const char* const text : {"a floating-point operation ran with the caller's environment in ", name, "\n"}) {
    static_cast<void>(!write(STDERR_FILENO, text, static_cast<unsigned>(std::strlen(text))));
  }
  _exit(1);
}

}  // namespace

FloatEnvironment mode_named(std::string_view name) {
  for (const Mode& mode : kModes) {
    if (mode.name != name) continue;
    // A processor that cannot trap keeps no such bits.
    const InEnvironment tried(mode.environment);
    return current_environment();
  }
  throw std::invalid_argument("there is no mode " + std::string(name));
}

#if defined(__aarch64__)

FloatEnvironment flushing(FloatEnvironment environment) noexcept {
  environment.control |= std::uint64_t{1} << 24U;
  return environment;
}

FloatEnvironment current_environment() noexcept {
  FloatEnvironment environment;
  __asm__ volatile("mrs %0, fpcr" : "=r"(environment.control) : : "memory");
  return environment;
}

void set_environment(const FloatEnvironment& environment) noexcept {
  __asm__ volatile("msr fpsr, xzr\n\tmsr fpcr, %0" : : "r"(environment.control) : "memory");
}

#else

FloatEnvironment flushing(FloatEnvironment environment) noexcept {
  environment.mxcsr |= 0x8040U;
  return environment;
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

#endif

void report_traps() noexcept { std::signal(SIGFPE, trap); }

void name_call(const char* name) noexcept { called = name; }

}  // namespace welkin::test
