#include "simd/kernels.h"

namespace welkin::simd {

// Defined once per instruction set by kernel_table.cpp.
namespace sse2 {
extern const Kernels table;
}
namespace avx2 {
extern const Kernels table;
}
namespace avx512 {
extern const Kernels table;
}

const Kernels& kernels(InstructionSet set) {
  switch (set) {
    case InstructionSet::sse2: return sse2::table;
    case InstructionSet::avx2: return avx2::table;
    case InstructionSet::avx512: return avx512::table;
  }
  return sse2::table;
}

}  // namespace welkin::simd
