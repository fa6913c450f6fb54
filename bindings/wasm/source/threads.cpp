// Threads of the module that has some.
#include "interface.h"
#include "welkin/core.h"

/// Asks the system for threads until there are `threads` with the caller's; they stay. JavaScript starts them
/// (package/threads.js), and until it has, loops are the caller's alone.
WELKIN_ENTRY(welkin_make_threads) void welkin_make_threads(int threads) {
  welkin::run_with_threads(threads, [] {});
}
