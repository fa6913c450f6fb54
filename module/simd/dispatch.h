// Tables of kernels, one for each instruction set, and the choice between them.
//
// A room declares its kernels in one header: a struct of function pointers, and with WELKIN_KERNEL_TABLES the functions
// that find the struct's instances. The kernels' source, which is compiled once per instruction set, defines one of
// them.
#pragma once

#include "welkin/core.h"

namespace welkin::simd {

/// Kernels count in groups of as many logical lanes: 1 register of AVX-512, 2 of AVX2, 4 of SSE2 or NEON.
inline constexpr int kLanes = 16;

#if defined(__aarch64__) || defined(_M_ARM64)
#define WELKIN_ONLY_INSTRUCTION_SET neon
#elif defined(__wasm__)
#define WELKIN_ONLY_INSTRUCTION_SET simd128
#endif

#if defined(WELKIN_ONLY_INSTRUCTION_SET)

/// Returns the only table, for any instruction set.
template <class Table>
[[nodiscard]] const Table& table_for(InstructionSet /*set*/, const Table& only) {
  return only;
}

#else

/// Returns that one of three tables which is for an instruction set.
template <class Table>
[[nodiscard]] const Table& table_for(InstructionSet set, const Table& sse2, const Table& avx2, const Table& avx512) {
  switch (set) {
    case InstructionSet::sse2:
    case InstructionSet::neon:
    case InstructionSet::simd128: return sse2;  // these two are of other processors, and never in use
    case InstructionSet::avx2: return avx2;
    case InstructionSet::avx512: return avx512;
  }
  return sse2;
}

#endif

}  // namespace welkin::simd

/// Declares in a room's namespace, for a struct `Table` of kernels:
///   extern const Table name_table;           in the namespaces sse2, avx2 and avx512, or neon, or simd128: what a
///                                            kernels' source defines
///   const Table& name(InstructionSet set);   the table for an instruction set, which this machine must be able to run
///   const Table& name();                     the table in use; throws like `active_instruction_set`
#if defined(WELKIN_ONLY_INSTRUCTION_SET)
#define WELKIN_KERNEL_TABLES(Table, name)                                   \
  namespace WELKIN_ONLY_INSTRUCTION_SET {                                   \
  extern const Table name##_table;                                          \
  }                                                                         \
  [[nodiscard]] inline const Table& name(InstructionSet set) {              \
    return simd::table_for(set, WELKIN_ONLY_INSTRUCTION_SET::name##_table); \
  }                                                                         \
  [[nodiscard]] inline const Table& name() { return name(active_instruction_set()); }
#else
#if defined(WELKIN_KERNELS_LEFT_OUT)  // in the source that stands for a set's kernels (cmake/instruction_sets.cmake)
#define WELKIN_EMPTY_TABLE(Table, name) \
  namespace WELKIN_KERNELS_LEFT_OUT {   \
  const Table name##_table{};           \
  }
#else
#define WELKIN_EMPTY_TABLE(Table, name)
#endif
#define WELKIN_KERNEL_TABLES(Table, name)                                                      \
  namespace sse2 {                                                                             \
  extern const Table name##_table;                                                             \
  }                                                                                            \
  namespace avx2 {                                                                             \
  extern const Table name##_table;                                                             \
  }                                                                                            \
  namespace avx512 {                                                                           \
  extern const Table name##_table;                                                             \
  }                                                                                            \
  WELKIN_EMPTY_TABLE(Table, name)                                                              \
  [[nodiscard]] inline const Table& name(InstructionSet set) {                                 \
    return simd::table_for(set, sse2::name##_table, avx2::name##_table, avx512::name##_table); \
  }                                                                                            \
  [[nodiscard]] inline const Table& name() { return name(active_instruction_set()); }
#endif
