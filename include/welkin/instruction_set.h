// Which of the kernels' builds is in use.
#pragma once

#include <vector>

#include "welkin/export.h"

namespace WELKIN_EXPORT welkin {

/// The builds of the kernels that an x86-64 binary carries, narrowest first. All give the same bits.
enum class InstructionSet { sse2, avx2, avx512 };

[[nodiscard]] const char* name(InstructionSet set) noexcept;  ///< "sse2", "avx2", "avx512"

/// Those that this processor and operating system can run, narrowest first.
[[nodiscard]] std::vector<InstructionSet> available_instruction_sets();

/// The one in use: the widest available, unless the environment variable WELKIN_ISA (sse2, avx2 or avx512)
/// said otherwise when it was first asked for, or `force_instruction_set` did since.
/// Throws `Error` (invalid_argument) if WELKIN_ISA names none, or one that cannot run here.
[[nodiscard]] InstructionSet active_instruction_set();

/// Chooses for all calls that start from now on; for tests and benchmarks.
/// Throws `Error` (invalid_argument) if it cannot run here.
void force_instruction_set(InstructionSet set);

}  // namespace welkin
