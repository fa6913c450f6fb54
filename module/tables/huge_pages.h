// Fewer page faults for large memory.
#pragma once

#include <cstddef>

namespace welkin::tables {

/// Asks the system to back large memory that is about to be filled by large pages: with pages of 4 KB the first touch
/// of a bake's results costs more than filling them. Does nothing below 4 MB, or where the system has no such call;
/// the contents stay as they are.
void advise_huge_pages(void* memory, std::size_t bytes) noexcept;

}  // namespace welkin::tables
