// A finished batch: every byte checked, an index for programs and a page for people.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/batch_plan.h"
#include "tools/batch_results.h"
#include "welkin/core.h"

namespace welkin::tool {

/// A job's result.
struct MergedResult {
  std::filesystem::path folder;
  ResultFiles files;
  std::string problem;  ///< why it is not in order; empty: it is
};

struct MergedBatch {
  std::vector<MergedResult> results;  ///< of the plan's jobs, in its order
  std::size_t problems = 0;

  /// Over the hashes of all results' files, in the order of the plan.
  [[nodiscard]] ContentHash hash() const;
};

/// Hashes every input and every file of its result. Throws `Error` (cancelled).
[[nodiscard]] MergedBatch check_batch(const BatchPlan& plan, const std::filesystem::path& results, int threads,
                                      const Control& control);

/// Throws `Error` (file_access) if the folder has an index.json or index.html that no merge has written.
void require_index_place(const std::filesystem::path& folder);

/// index.json and index.html, in a folder that is made. Throws `Error` (file_access).
void write_batch_index(const BatchPlan& plan, const MergedBatch& merged, const std::filesystem::path& folder);

}  // namespace welkin::tool
