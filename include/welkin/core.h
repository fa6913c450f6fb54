// Version, vectors, errors, cancellation and progress, threads, working memory and instruction sets: the header on
// which all others build.
//
//   std::stop_source stop;
//   try {
//     light = welkin::project(view, {}, {.stop = stop.get_token(), .progress = [](double done) { show(done); }});
//   } catch (const welkin::Error& error) {
//     if (error.code() != welkin::ErrorCode::cancelled) log(error.what());
//   }
//
// The following holds for every call of the library, unless its own comment says otherwise:
// - Results are bit-identical on any number of threads, with every instruction set and on every supported platform.
// - Functions may be called from any thread at the same time. Objects follow the standard library's rule: concurrent
//   calls of const members are safe; a call that changes an object needs exclusive access.
// - A call runs in the TBB arena of the thread that calls it and returns when its result is complete.
// - Failures are thrown as `Error`. A comment lists the codes that depend on the arguments. Every call that takes a
//   `Control` also throws `ErrorCode::cancelled` once stop is requested. After an exception there is no result.
// - Lengths of spans, sizes and ranges are checked before anything is written.
#pragma once

#include <cstddef>
#include <functional>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "welkin/detail/standard_library.h"

#define WELKIN_VERSION_MAJOR 0
#define WELKIN_VERSION_MINOR 2
#define WELKIN_VERSION_PATCH 0
#define WELKIN_VERSION_STRING "0.2.0"

#if defined(__GNUC__) && !defined(_WIN32)
#define WELKIN_EXPORT [[gnu::visibility("default")]]
#define WELKIN_HIDDEN [[gnu::visibility("hidden")]]  // for classes that public headers name but users never call
#else  // Windows exports no namespace: there the build exports all functions (WINDOWS_EXPORT_ALL_SYMBOLS)
#define WELKIN_EXPORT
#define WELKIN_HIDDEN
#endif

namespace WELKIN_EXPORT welkin {

// ---- Vectors and matrices

// Without GLM's macros, these types are glm::vec3, glm::dvec3, glm::dvec4 and glm::dmat3.
// GLM_FORCE_DEFAULT_ALIGNED_GENTYPES gives GLM's own names another size, which the compiled library does not use.
// These aliases therefore name the packed types. A host's aligned vector converts to and from them when it is
// passed or assigned; with GLM_FORCE_EXPLICIT_CTOR, cast it. Spans and arrays must have these types. Sources
// compiled with GLM_FORCE_SIZE_T_LENGTH do not link, because that macro changes vec<3, double> to vec<3ul,
// double>.

/// Three floats without padding.
using vec3 = glm::vec<3, float, glm::packed_highp>;
/// Three doubles without padding: a direction (x, y, z) or a colour (r, g, b).
///
/// Directions and normals passed to a call may have any length above zero; they are normalized. A direction that is
/// zero or not finite throws `Error` (invalid_argument). Returned directions have length 1.
using dvec3 = glm::vec<3, double, glm::packed_highp>;
/// Four doubles without padding.
using dvec4 = glm::vec<4, double, glm::packed_highp>;
/// Nine doubles without padding, column by column.
using dmat3 = glm::mat<3, 3, double, glm::packed_highp>;

static_assert(sizeof(vec3) == 3 * sizeof(float) && alignof(vec3) == alignof(float));
static_assert(sizeof(dvec3) == 3 * sizeof(double) && alignof(dvec3) == alignof(double));
static_assert(sizeof(dvec4) == 4 * sizeof(double) && alignof(dvec4) == alignof(double));
static_assert(sizeof(dmat3) == 9 * sizeof(double) && alignof(dmat3) == alignof(double));

// ---- Errors

/// The kind of an error, for programs. The message of the `Error` names the input, the fault and the remedy.
enum class ErrorCode {
  invalid_argument,  ///< an argument that no call could accept, such as a null face or zero bands
  rejected_pixel,    ///< a texel that the caller's `PixelPolicy` rejects; the message names face, row and column
  file_access,       ///< a file that cannot be opened, read or written
  corrupt_file,      ///< a file that violates its own format, or is truncated
  unsupported_file,  ///< a valid file of a kind that this build does not read, or whose layout is ambiguous
  limit_exceeded,    ///< a request that exceeds its memory limit, or an error bound that no method reaches
  cancelled,         ///< the caller cancelled: by a stop token, or by `JobHandle::cancel`
  replaced,          ///< a newer job with the same key superseded this one
  queue_full,        ///< the worker was at its limits and refused this job
  stopped,           ///< the worker was terminated before this job completed
};

/// Returns the name of a code as it is spelled here, such as "invalid_argument".
[[nodiscard]] const char* name(ErrorCode code) noexcept;

/// The exception that every call throws on failure. The library throws nothing else, except `std::bad_alloc`,
/// `std::system_error` from the constructor of `Worker`, and whatever the caller's own callbacks throw.
class Error : public std::runtime_error {
 public:
  /// Creates an error. `message` should name the input, the fault and the remedy.
  Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}

  /// Returns the kind of the error, for programs. `what()` is for people.
  [[nodiscard]] ErrorCode code() const noexcept { return code_; }

 private:
  ErrorCode code_;
};

// ---- Cancellation, progress and threads

/// Cancellation, progress and memory of a call that can take longer than a frame. The default uses none of them.
struct Control {
  /// Cancels the call. The token is checked before every tile, that is every 0.05 to 0.6 ms for pixels in memory and
  /// once per block of rows or tiles of a file. Once stop is requested, the call throws `Error` (cancelled) and returns
  /// nothing.
  stop_token stop{};

  /// Receives the fraction of the work that is done, in [0, 1]. The values never decrease; the last one is 1. Calls
  /// come one at a time, from whichever thread finished a tile, with the default floating-point environment. The
  /// callback may use TBB. An exception that it throws ends the call and reaches the caller. An empty function costs
  /// nothing.
  std::function<void(double)> progress{};

  /// Allocates the `Cubemap`s that the call returns; null selects `std::pmr::get_default_resource()`. `allocate`
  /// may be called from several threads at the same time. The resource must outlive the results. All other results and
  /// working memory come from the heap (see `keep_working_memory`).
  memory_resource* memory = nullptr;
};

/// The priority of a worker's threads relative to all other threads of the machine.
enum class ThreadPriority {
  idle,          ///< runs only on processors that are otherwise idle (Linux SCHED_IDLE)
  below_normal,  ///< gets a tenth of a normal thread's CPU time when both compete (nice + 10)
  normal,        ///< the priority of the thread that created the worker
};

/// Runs `work` in a TBB arena of its own with `threads` threads, including the calling one. 0 uses
/// `available_threads()`; 1 runs everything on the calling thread. The arena has fewer threads if the system cannot
/// create them.
///
/// Programs that already use a TBB arena do not need this function: every call runs in the arena of its caller. Throws
/// `Error` (invalid_argument) unless 0 <= threads <= 1024, and whatever `work` throws.
void run_with_threads(int threads, const std::function<void()>& work);

/// Returns the number of threads that `run_with_threads(0, ...)` uses, at least 1: the processors of this process, or
/// fewer if the CPU quotas of its Linux control groups (cgroups, versions 1 and 2) grant fewer.
[[nodiscard]] int available_threads();

// ---- Working memory

// Buffers of at least 64 KiB, and chains of at least 1 MiB from the default resource, reuse blocks of earlier calls.
// Repeated calls therefore need no new pages. On Linux, blocks lie in huge pages of 2 MiB. These functions never change
// a result.

/// Sets how many bytes of unused blocks the process keeps, and frees the oldest blocks in excess. The default is 128
/// MiB; under an address sanitizer and in WebAssembly it is 0, which keeps none.
void keep_working_memory(std::size_t bytes) noexcept;

/// Frees all blocks and shared pages that neither a call nor a table uses, for instance after a level has loaded.
/// Running calls keep their blocks and leave them for later calls.
void release_working_memory() noexcept;

// ---- Instruction sets

/// Instruction sets for which kernels are compiled, narrowest first: sse2, avx2 and avx512 in an x86-64 binary, neon on
/// 64-bit ARM, simd128 in WebAssembly.
enum class InstructionSet { sse2, avx2, avx512, neon, simd128 };

[[nodiscard]] const char* name(InstructionSet set) noexcept;  ///< returns "sse2", "avx2", "avx512", "neon" or "simd128"

/// Returns the instruction sets that this processor and operating system can run, narrowest first.
[[nodiscard]] std::vector<InstructionSet> available_instruction_sets();

/// Returns the instruction set in use. The default is the widest one available. The environment variable WELKIN_ISA
/// (sse2, avx2, avx512, neon or simd128), read at the first call, and `force_instruction_set` override it. Throws
/// `Error` (invalid_argument) if WELKIN_ISA names no instruction set, or one that cannot run here.
[[nodiscard]] InstructionSet active_instruction_set();

/// Selects the instruction set for all calls that start from now on. For tests and benchmarks. Throws `Error`
/// (invalid_argument) if it cannot run here.
void force_instruction_set(InstructionSet set);

}  // namespace welkin
