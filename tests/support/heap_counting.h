// Between the counters of heap.h and the functions of a system's heap that they count.
#pragma once

#include <cstddef>

namespace welkin::test::heap {

/// Whether this operator new is the one that is to fail.
[[nodiscard]] bool must_fail() noexcept;

/// An allocation.
void count() noexcept;

/// A block that was given, or is about to be taken back; `usable_size`: how many bytes a block has.
void* given(void* block, std::size_t (*usable_size)(void*)) noexcept;
void taken(void* block, std::size_t (*usable_size)(void*)) noexcept;

}  // namespace welkin::test::heap
