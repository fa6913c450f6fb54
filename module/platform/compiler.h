// Macros for what differs between compilers. Nothing else of the library names an attribute.
#pragma once

// WELKIN_INLINE: a function that is inlined wherever it is called, whatever the compiler's heuristics. Kernels need it
// for their speed, and so that no instruction set's copy of a function can stand in for another's.
// WELKIN_INLINE_LAMBDA does the same for a lambda; it follows the parameters.
//
// WELKIN_INLINE_UNLESS_SENT: WELKIN_INLINE, except where code is sent over a network before it can run (WebAssembly in
// a page): there large kernels are called, not inlined, and have fewer variants (`kCodeIsSent`).
//
// WELKIN_IN_REGISTER(v): a statement that makes the vector v a value in a register, so that the compiler does not
// repeat the load that it came from. It changes no bits, and does nothing in WebAssembly or without GCC or Clang.
//
// WELKIN_FETCH(p): a statement that prefetches the cache line at p, which is read soon. It reads nothing: p need not be
// a valid address.
//
// WELKIN_RUN_BEFORE_STATIC_OBJECTS stands before a function without arguments: it runs before the static objects of the
// whole program are made, so what it makes is destroyed after them. 101 is the first priority that the compiler does
// not reserve. Where there is no such attribute the function is not called, and the objects are made at first use.
//
// WELKIN_ADDRESS_SANITIZER is 1 in a build with that sanitizer, from which memory kept for reuse would hide errors.
#if defined(__SANITIZE_ADDRESS__)
#define WELKIN_ADDRESS_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define WELKIN_ADDRESS_SANITIZER 1
#endif
#endif
#ifndef WELKIN_ADDRESS_SANITIZER
#define WELKIN_ADDRESS_SANITIZER 0
#endif

#if defined(__GNUC__)
#define WELKIN_INLINE inline __attribute__((always_inline))
#define WELKIN_INLINE_LAMBDA __attribute__((always_inline))
#if defined(__aarch64__)
#define WELKIN_IN_REGISTER(v) __asm__("" : "+w"(v))
#elif defined(__wasm__)
#define WELKIN_IN_REGISTER(v) static_cast<void>(v)
#else
#define WELKIN_IN_REGISTER(v) __asm__("" : "+v"(v))
#endif
#if defined(__wasm__)  // no such instruction
#define WELKIN_FETCH(p) static_cast<void>(p)
#else
#define WELKIN_FETCH(p) __builtin_prefetch(p, 0, 3)
#endif
#define WELKIN_RUN_BEFORE_STATIC_OBJECTS __attribute__((constructor(101)))
#elif defined(_MSC_VER)
#define WELKIN_INLINE __forceinline
#define WELKIN_INLINE_LAMBDA
#define WELKIN_IN_REGISTER(v) static_cast<void>(v)
#define WELKIN_FETCH(p) static_cast<void>(p)
#define WELKIN_RUN_BEFORE_STATIC_OBJECTS [[maybe_unused]]
#else
#define WELKIN_INLINE inline
#define WELKIN_INLINE_LAMBDA
#define WELKIN_IN_REGISTER(v) static_cast<void>(v)
#define WELKIN_FETCH(p) static_cast<void>(p)
#define WELKIN_RUN_BEFORE_STATIC_OBJECTS [[maybe_unused]]
#endif

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
