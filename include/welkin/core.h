// What all other headers build on: the version, vectors, errors, the control of long calls, threads and instruction
// sets.
//
//   std::stop_source stop;
//   try {
//     light = welkin::project(view, {}, {.stop = stop.get_token(), .progress = [](double share) { show(share); }});
//   } catch (const welkin::Error& error) {
//     if (error.code() != welkin::ErrorCode::cancelled) log(error.what());
//   }
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
#define WELKIN_VERSION_MINOR 1
#define WELKIN_VERSION_PATCH 0
#define WELKIN_VERSION_STRING "0.1.0"

#if defined(__GNUC__) && !defined(_WIN32)
#define WELKIN_EXPORT [[gnu::visibility("default")]]
#define WELKIN_HIDDEN [[gnu::visibility("hidden")]]  // of a class that public headers name and no user calls
#else  // Windows exports no namespace: there the build exports all functions (WINDOWS_EXPORT_ALL_SYMBOLS)
#define WELKIN_EXPORT
#define WELKIN_HIDDEN
#endif

namespace WELKIN_EXPORT welkin {

// ---- Vectors and matrices

// In a host without GLM's macros these are glm::vec3, glm::dvec3, glm::dvec4 and glm::dmat3. Under
// GLM_FORCE_DEFAULT_ALIGNED_GENTYPES GLM's own names stand for types of another size, with which the library was not
// built; so the precision is spelled out here. A host's aligned vector converts to these and back where it is passed or
// assigned (with GLM_FORCE_EXPLICIT_CTOR it has to be cast); spans and arrays need these types themselves. Sources with
// GLM_FORCE_SIZE_T_LENGTH do not link with the library: that macro makes vec<3ul, double> of vec<3, double>.

/// Three floats without padding.
using vec3 = glm::vec<3, float, glm::packed_highp>;
/// Three doubles without padding: a direction (x, y, z) or a colour (r, g, b).
///
/// A direction or normal that a call takes may have any length: it is normalised, unless its length is 1 already. One
/// that is zero or not finite is refused with an `Error` (invalid_argument). Returned directions have length 1.
using dvec3 = glm::vec<3, double, glm::packed_highp>;
/// Four doubles without padding.
using dvec4 = glm::vec<4, double, glm::packed_highp>;
/// Nine doubles without padding, column after column.
using dmat3 = glm::mat<3, 3, double, glm::packed_highp>;

static_assert(sizeof(vec3) == 3 * sizeof(float) && alignof(vec3) == alignof(float));
static_assert(sizeof(dvec3) == 3 * sizeof(double) && alignof(dvec3) == alignof(double));
static_assert(sizeof(dvec4) == 4 * sizeof(double) && alignof(dvec4) == alignof(double));
static_assert(sizeof(dmat3) == 9 * sizeof(double) && alignof(dmat3) == alignof(double));

// ---- Errors

/// What kind of thing went wrong; the message says what, where, and what would do instead.
enum class ErrorCode {
  invalid_argument,  ///< a view or an option that no call could accept (a null face, zero bands)
  rejected_pixel,    ///< a texel that the caller's policy rejects; the message names face, row and column
  file_access,       ///< a file that cannot be opened, read or written
  corrupt_file,      ///< a file that breaks its own format, or ends too early
  unsupported_file,  ///< a sound file of a kind that Welkin (so built) does not read, or whose layout is unclear
  limit_exceeded,    ///< a file or request that would need more memory than the stated limit
  cancelled,         ///< the caller asked for it: by a stop token, or by `JobHandle::cancel`
  replaced,          ///< a newer request with the same key took this job's place
  queue_full,        ///< a worker at its limits refused this job
  stopped,           ///< the worker was terminated before this job was done
};

/// The code as it is spelled here: "invalid_argument", "rejected_pixel", and so on.
[[nodiscard]] const char* name(ErrorCode code) noexcept;

/// The one exception type that Welkin throws, from every call that can fail. Nothing else leaves the library, except
/// `std::bad_alloc` and whatever a caller's own callback throws.
class Error : public std::runtime_error {
 public:
  /// `message` names the file or argument, what was found and what would do.
  Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}

  /// For programs; `what()` is for people.
  [[nodiscard]] ErrorCode code() const noexcept { return code_; }

 private:
  ErrorCode code_;
};

// ---- Cancellation, progress and threads

/// Passed to every call that can take longer than a frame. The default asks for nothing.
struct Control {
  /// Checked before every tile: 0.05 to 0.6 ms of work on pixels in memory, one block of rows or tiles of a file
  /// (docs/notes/threads.md has what was measured). Once stop is requested the call throws `Error` with
  /// `ErrorCode::cancelled`; nothing that the call would have returned exists.
  stop_token stop{};

  /// Called with the share of the work that is done, in [0, 1], never falling, the last call being 1.
  /// It comes from whichever thread finished a tile, one call at a time, with the default floating-point
  /// environment, and may use TBB itself; what it throws ends the call and reaches the caller. Left empty, progress
  /// costs nothing.
  std::function<void(double)> progress{};

  /// Where the call takes the memory of the `Cubemap`s that it returns; null: `std::pmr::get_default_resource()`.
  /// Passes run side by side, so that `allocate` may be called from several threads at once. It must outlive the
  /// results. Images and coefficients come from the heap, and so does working memory (see `keep_working_memory`).
  memory_resource* memory = nullptr;
};

/// How the system ranks a worker's threads against all others.
enum class ThreadPriority {
  idle,    ///< runs only on processors that nothing else wants (Linux SCHED_IDLE)
  below,   ///< a tenth of a normal thread's share when both want a processor (nice + 10)
  normal,  ///< as the thread that made the worker
};

/// Runs `work` in an arena of its own with `threads` threads, the calling one among them (0: as many as the process may
/// use; 1: on the calling thread alone), or fewer where the system makes no more.
///
/// Every Welkin call works in the arena of the thread that calls it, so an engine that lives in a TBB
/// arena keeps its thread budget without this function. It is for programs that have no arena.
/// The number of threads never changes a result's bits.
/// Throws `Error` (invalid_argument) unless 0 <= threads <= 1024, and whatever `work` throws.
void run_with_threads(int threads, const std::function<void()>& work);

/// How many threads `run_with_threads(0, ...)` uses: the processors of this process, or fewer where
/// the CPU quotas of its control groups (Linux cgroups, versions 1 and 2) grant fewer. At least 1.
[[nodiscard]] int available_threads();

// ---- Working memory

// Buffers of 64 KiB and more, and default chains of 1 MiB and more, come from blocks that earlier ones left, so that a
// warm call clears no pages. On Linux they lie in huge pages of 2 MiB: blocks of 1 MiB and more in whole ones, smaller
// blocks share pages. Any thread may call these functions at any time. They change no result.

/// Sets how many bytes of blocks that no call uses the process keeps, 128 MiB by default, and frees the oldest blocks
/// beyond that. 0 keeps none. Under an address sanitizer and in WebAssembly the default is 0.
void keep_working_memory(std::size_t bytes) noexcept;

/// Frees all blocks and shared pages that neither a call nor a table uses, after a level is loaded for instance. Calls
/// that run keep theirs and leave them for later calls.
void release_working_memory() noexcept;

// ---- Instruction sets

/// The builds of the kernels: the first three are what an x86-64 binary carries, narrowest first, the others
/// what one for 64-bit ARM and one for WebAssembly carry. All give the same bits.
enum class InstructionSet { sse2, avx2, avx512, neon, simd128 };

[[nodiscard]] const char* name(InstructionSet set) noexcept;  ///< "sse2", "avx2", "avx512", "neon", "simd128"

/// Those that this processor and operating system can run, narrowest first.
[[nodiscard]] std::vector<InstructionSet> available_instruction_sets();

/// The one in use: the widest available, unless the environment variable WELKIN_ISA (sse2, avx2, avx512, neon or
/// simd128) said otherwise when it was first asked for, or `force_instruction_set` did since.
/// Throws `Error` (invalid_argument) if WELKIN_ISA names none, or one that cannot run here.
[[nodiscard]] InstructionSet active_instruction_set();

/// Chooses for all calls that start from now on; for tests and benchmarks.
/// Throws `Error` (invalid_argument) if it cannot run here.
void force_instruction_set(InstructionSet set);

}  // namespace welkin
