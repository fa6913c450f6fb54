#pragma once

#include <vector>

namespace welkin::perf {

/// ProjectFile/FORMAT/2048x1024/THREADS: from a file in the page cache to coefficients, decoding overlapped. And
/// ReadFile for the same file's bytes, read and looked at once: the floor.
void add_project_file(const std::vector<int>& thread_counts);

}  // namespace welkin::perf
