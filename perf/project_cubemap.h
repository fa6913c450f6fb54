#pragma once

#include <vector>

namespace welkin::perf {

/// ProjectCubemap/FORMAT/SIZE/THREADS with default options; the same with other options, formats and
/// instruction sets at a few sizes; ProjectMany, in one call and in single ones; and ReferenceTwin, the readable scalar
/// version.
void add_project_cubemap(const std::vector<int>& sizes, const std::vector<int>& thread_counts);

}  // namespace welkin::perf
