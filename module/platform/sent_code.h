// Tells targets whose code is sent over a network before it can run, as WebAssembly is to a page. Kernels have fewer
// variants there, and large ones are called instead of inlined.
#pragma once

#include "platform/compiler.h"

#if defined(__wasm__)
#define WELKIN_INLINE_UNLESS_SENT __attribute__((noinline))
#else
#define WELKIN_INLINE_UNLESS_SENT WELKIN_INLINE
#endif

namespace welkin::platform {

#if defined(__wasm__)
inline constexpr bool kCodeIsSent = true;
#else
inline constexpr bool kCodeIsSent = false;
#endif

}  // namespace welkin::platform
