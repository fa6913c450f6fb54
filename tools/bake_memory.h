// What a bake holds in memory beside the library's own work, against --memory-limit.
#pragma once

#include <cstdint>
#include <string>

#include "tools/bake_options.h"

namespace welkin::tool {

/// What each step of the work takes by itself.
struct BakeMemory {
  std::string path;               ///< of the source, for the message
  std::uint64_t source = 0;       ///< held until all is baked
  std::uint64_t bake = 0;         ///< `bake_bytes`
  std::uint64_t second_bake = 0;  ///< the same of the .env's chain; 0 if there is none
  int env_size = 0;               ///< of that chain
};

/// What `bake` alone makes of the .env's chain.
[[nodiscard]] BakeOptions second_bake_options(const PrefilterOptions& env);

/// Throws `Error` (limit_exceeded) if results, the .env's chain, lat-longs or cubemaps that are turned on the way out
/// would take more than the limit. Not counted: previews, and what an encoder holds of a file.
void check_memory(const BakeMemory& memory, const BakeCommandOptions& options, const BakeOptions& bake);

}  // namespace welkin::tool
