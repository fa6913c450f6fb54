#include "tools/bake_memory.h"

#include <algorithm>
#include <glm/mat3x3.hpp>

#include "tools/turn_chain.h"
#include "welkin/cubemap_chain.h"
#include "welkin/error.h"

namespace welkin::tool {
namespace {

constexpr std::uint64_t kTexelBytes = 3 * sizeof(float);

std::uint64_t cubemap_bytes(int size) {
  return 6 * kTexelBytes * static_cast<std::uint64_t>(size) * static_cast<std::uint64_t>(size);
}

std::uint64_t chain_bytes(int size, int levels) {
  std::uint64_t bytes = 0;
  for (int level = 0; level < levels; ++level) bytes += cubemap_bytes(std::max(1, size >> level));
  return bytes;
}

/// 0: there is none.
int background_size(const BakeOptions& bake) {
  if (!bake.background) return 0;
  return bake.background_size > 0 || !bake.specular ? bake.background_size : bake.specular->size;
}

struct Step {
  std::uint64_t bytes;
  const char* what;
};

}  // namespace

BakeOptions second_bake_options(const PrefilterOptions& env) {
  BakeOptions options;
  options.background = false;
  options.specular = env;
  options.irradiance_size = 0;
  options.bands = 0;
  options.brdf = std::nullopt;
  options.pixels = env.pixels;
  return options;
}

void check_memory(const BakeMemory& memory, const BakeCommandOptions& options, const BakeOptions& bake) {
  const int size = background_size(bake);
  const std::uint64_t background = chain_bytes(size, size > 0 ? full_chain_levels(size) : 0);
  const std::uint64_t specular = bake.specular ? chain_bytes(bake.specular->size, bake.specular->mips) : 0;
  const std::uint64_t results = background + specular + cubemap_bytes(bake.irradiance_size);
  // 4 size x 2 size texels.
  const std::uint64_t lat_long = 8 * cubemap_bytes(size) / 6;
  const bool has_lat_long = options.containers.contains(Container::exr) ||
                            options.containers.contains(Container::hdr) || options.containers.contains(Container::pfm);
  const bool turns = faces_of(options.turn.to) != glm::dmat3(1.0);
  const std::uint64_t env =
      memory.second_bake > 0 ? chain_bytes(memory.env_size, full_chain_levels(memory.env_size)) : 0;

  Step worst{memory.source + memory.bake, "source, results and working memory"};
  const auto consider = [&worst](bool happens, const Step& step) {
    if (happens && step.bytes > worst.bytes) worst = step;
  };
  consider(memory.second_bake > 0, {memory.source + results + memory.second_bake,
                                    "source, results and the .env's specular chain, whose roughness is its own"});
  consider(memory.second_bake > 0, {results + 2 * env, "results, the .env's chain and its faces turned"});
  consider(has_lat_long, {results + lat_long, "results and the background as a lat-long"});
  consider(turns, {results + std::max(background, specular), "results and one of them turned to the engine's faces"});
  const std::uint64_t limit = options.common.read.memory_limit_bytes;
  if (worst.bytes <= limit) return;
  throw Error(ErrorCode::limit_exceeded, memory.path + ": " + worst.what + " take " + std::to_string(worst.bytes) +
                                             " bytes, above the limit of " + std::to_string(limit) +
                                             "; raise --memory-limit, or make --size or --background-size less");
}

}  // namespace welkin::tool
