#pragma once

#include <vector>

namespace welkin::perf {

/// Analyse/BANDS/1024x512/THREADS, Synthesise/BANDS-samples or -spline/GRID/THREADS (the grid that the bands ask for),
/// and TransformTables/BANDS/1024x512/1: what the first call at a size costs more.
void add_transform(const std::vector<int>& thread_counts);

}  // namespace welkin::perf
