// The options of one bake among many, as words: those that hold for all, and those of its own.
#pragma once

#include <string>
#include <vector>

#include "tools/bake_options.h"

namespace welkin::tool {

/// Options of `welkin bake` that say what comes out; input, place, threads and the like are the batch's business.
/// `bake` must outlive them.
[[nodiscard]] Options job_options(BakeCommandOptions& bake);

/// Those of a command's words that are such options with their values, as they were written.
[[nodiscard]] std::vector<std::string> words_for_jobs(const std::vector<std::string>& words);

/// `all`, less the options that stand in `own`, and then `own`.
[[nodiscard]] std::vector<std::string> with_own(const std::vector<std::string>& all,
                                                const std::vector<std::string>& own);

}  // namespace welkin::tool
