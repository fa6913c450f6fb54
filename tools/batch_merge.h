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
  std::string problem;      ///< why it is not in order; empty: it is
  bool is_missing = false;  ///< it is not there, or its input cannot be read; else a problem is that it is damaged
};

struct MergedBatch {
  std::vector<MergedResult> results;  ///< of the plan's jobs, in its order
  std::size_t missing = 0;
  std::size_t damaged = 0;

  /// Over the hashes of all results' files, in the order of the plan; a missing one counts as one without files.
  [[nodiscard]] ContentHash hash() const;
};

/// Hashes every input and every file of its result. Throws `Error` (cancelled).
[[nodiscard]] MergedBatch check_batch(const BatchPlan& plan, const std::filesystem::path& results, int threads,
                                      const Control& control);

/// Throws `Error` (file_access) if the folder has an index.json or index.html that no merge has written.
void require_index_place(const std::filesystem::path& folder);

/// index.json and index.html, in a folder that is made; missing results are named in both. Throws `Error`
/// (file_access).
void write_batch_index(const BatchPlan& plan, const MergedBatch& merged, const std::filesystem::path& folder);

}  // namespace welkin::tool
