// --cache: results that are kept from run to run.
#pragma once

#include <string>
#include <vector>

#include "tools/number_text.h"
#include "tools/options.h"
#include "welkin/result_cache.h"

namespace welkin::tool {

inline void add_cache_option(CLI::App& command, CommonOptions& options) {
  command
      .add_option("--cache", options.cache,
                  "A folder that keeps results, found again by the contents of what they were made from; it is made if "
                  "it is not there")
      ->type_name("DIR");
}

/// Calls `work` with the cache that was asked for, or with null. What was damaged or could not be kept is noted:
/// results are right without it.
template <class Work>
void with_cache(const CommonOptions& options, std::vector<std::string>& notes, const Work& work) {
  if (options.cache.empty()) {
    work(static_cast<ResultCache*>(nullptr));
    return;
  }
  ResultCache cache({.folder = options.cache, .memory_bytes = 0});
  work(&cache);
  const CacheStatistics statistics = cache.statistics();
  if (statistics.damaged > 0)
    notes.push_back("the cache: " + counted(statistics.damaged, "damaged result") + " computed anew");
  if (statistics.write_failures > 0)
    notes.push_back("the cache could not keep all results: " + statistics.last_failure);
}

}  // namespace welkin::tool
