// The instruction sets that this machine can run. Compiled for the baseline, so that the query never faults.
#include <array>
#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "platform/text.h"
#include "welkin/core.h"

// Instruction sets that this build has no kernels for (cmake/instruction_sets.cmake), as words.
#if !defined(WELKIN_LEFT_OUT_SETS)
#define WELKIN_LEFT_OUT_SETS ""
#endif

#if defined(__x86_64__) || defined(_M_X64)
#define WELKIN_ASKS_PROCESSOR
#if defined(_MSC_VER)
#include <intrin.h>
#else
#include <cpuid.h>
#endif
#endif

namespace welkin {
namespace {

#if defined(WELKIN_ASKS_PROCESSOR)

struct CpuidRegisters {
  unsigned eax, ebx, ecx, edx;
};

/// Returns zeros for a leaf that the processor does not have.
CpuidRegisters cpuid(unsigned leaf, unsigned subleaf) {
  CpuidRegisters r{};
#if defined(_MSC_VER)
  int words[4] = {};
  __cpuid(words, 0);
  if (static_cast<unsigned>(words[0]) < leaf) return r;
  __cpuidex(words, static_cast<int>(leaf), static_cast<int>(subleaf));
  r = {static_cast<unsigned>(words[0]), static_cast<unsigned>(words[1]), static_cast<unsigned>(words[2]),
       static_cast<unsigned>(words[3])};
#else
  if (__get_cpuid_count(leaf, subleaf, &r.eax, &r.ebx, &r.ecx, &r.edx) == 0) return {};
#endif
  return r;
}

/// Returns the register state that the operating system saves on a context switch (XCR0). An instruction set whose bits
/// are not set must not be used even if the processor has it. Needs OSXSAVE.
std::uint64_t saved_register_state() {
#if defined(_MSC_VER)
  return _xgetbv(0);
#else
  std::uint32_t low = 0;
  std::uint32_t high = 0;
  __asm__ volatile("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
  return (std::uint64_t{high} << 32U) | low;
#endif
}

constexpr bool bit(unsigned value, unsigned position) { return ((value >> position) & 1U) != 0; }

struct WideSets {
  bool avx2 = false;
  bool avx512 = false;
};

WideSets ask_processor() {
  // Intel SDM volume 2, CPUID: leaf 1 ECX 27 OSXSAVE, 28 AVX, 29 F16C; leaf 7 EBX 5 AVX2, 16 AVX512F,
  // 17 AVX512DQ, 30 AVX512BW, 31 AVX512VL.
  const CpuidRegisters basic = cpuid(1, 0);
  if (!bit(basic.ecx, 27) || !bit(basic.ecx, 28) || !bit(basic.ecx, 29)) return {};
  const CpuidRegisters extended = cpuid(7, 0);
  const std::uint64_t state = saved_register_state();
  constexpr std::uint64_t avx_state = 0x6;      // XMM and YMM
  constexpr std::uint64_t avx512_state = 0xE6;  // and opmask, upper ZMM, ZMM16 to 31
  if (!bit(extended.ebx, 5) || (state & avx_state) != avx_state) return {};
  return {true, bit(extended.ebx, 16) && bit(extended.ebx, 17) && bit(extended.ebx, 30) && bit(extended.ebx, 31) &&
                    (state & avx512_state) == avx512_state};
}

/// SSE2 is part of x86-64. All the others are queried once: on a virtual machine every CPUID exits to the host, which
/// takes 5 to 20 microseconds.
bool runs(InstructionSet set) {
  static const WideSets wide = ask_processor();
  switch (set) {
    case InstructionSet::sse2: return true;
    case InstructionSet::avx2: return wide.avx2;
    case InstructionSet::avx512: return wide.avx512;
    case InstructionSet::neon:
    case InstructionSet::simd128: return false;
  }
  return false;
}

#else

/// A binary for another processor carries one set, which all of its processors run: NEON is part of 64-bit ARM
/// (AArch64), and the kernels use only what its first version has; a WebAssembly module that uses vectors loads only
/// where there are any.
#if defined(__wasm__)
constexpr InstructionSet kOnly = InstructionSet::simd128;
#else
constexpr InstructionSet kOnly = InstructionSet::neon;
#endif

bool runs(InstructionSet set) { return set == kOnly; }

#endif

constexpr InstructionSet kAll[] = {InstructionSet::sse2, InstructionSet::avx2, InstructionSet::avx512,
                                   InstructionSet::neon, InstructionSet::simd128};

bool is_left_out(InstructionSet set) { return std::string(WELKIN_LEFT_OUT_SETS).find(name(set)) != std::string::npos; }

/// Throws only in a build made for a newer machine, without the kernels that older ones can run.
InstructionSet widest() {
  const std::vector<InstructionSet> sets = available_instruction_sets();
  if (!sets.empty()) return sets.back();
  throw Error(ErrorCode::invalid_argument,
              "this build has no kernels for this machine: it leaves out " WELKIN_LEFT_OUT_SETS);
}

void require_runnable(InstructionSet set, const std::string& asked_by) {
  if (is_left_out(set)) {
    throw Error(ErrorCode::invalid_argument,
                asked_by + ": this build has no kernels for it: it leaves out " WELKIN_LEFT_OUT_SETS);
  }
  if (runs(set)) return;
  throw Error(ErrorCode::invalid_argument,
              asked_by + ": this machine cannot run " + name(set) + " code; it can run up to " + name(widest()));
}

InstructionSet initial_choice() {
  const char* const wanted = std::getenv("WELKIN_ISA");
  if (wanted == nullptr || *wanted == '\0') return widest();
  for (const InstructionSet set : kAll) {
    if (std::string(wanted) != name(set)) continue;
    require_runnable(set, std::string("WELKIN_ISA=") + wanted);
    return set;
  }
  throw Error(
      ErrorCode::invalid_argument,
      std::string("WELKIN_ISA=") + wanted + ": not an instruction set; it may be sse2, avx2, avx512, neon or simd128");
}

constexpr int kUndecided = -1;
std::atomic<int> active{kUndecided};

}  // namespace

const char* name(InstructionSet set) noexcept {
  constexpr std::array names{"sse2", "avx2", "avx512", "neon", "simd128"};
  return platform::name_in<InstructionSet::simd128>(names, set, "unknown");
}

std::vector<InstructionSet> available_instruction_sets() {
  std::vector<InstructionSet> sets;
  for (const InstructionSet set : kAll) {
    if (runs(set) && !is_left_out(set)) sets.push_back(set);
  }
  return sets;
}

InstructionSet active_instruction_set() {
  const int chosen = active.load(std::memory_order_relaxed);
  if (chosen != kUndecided) return static_cast<InstructionSet>(chosen);
  // Two threads that get here at once make the same choice.
  const InstructionSet set = initial_choice();
  int expected = kUndecided;
  active.compare_exchange_strong(expected, static_cast<int>(set), std::memory_order_relaxed);
  return static_cast<InstructionSet>(active.load(std::memory_order_relaxed));
}

void force_instruction_set(InstructionSet set) {
  require_runnable(set, "force_instruction_set");
  active.store(static_cast<int>(set), std::memory_order_relaxed);
}

}  // namespace welkin
