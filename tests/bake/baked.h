// Comparing bakes, and measuring their memory.
#pragma once

#include "support/catch.h"
#include "support/chains.h"
#include "support/heap.h"
#include "support/same_bits.h"
#include "support/trials.h"
#include "welkin/bake.h"
#include "welkin/core.h"

namespace welkin::test {

/// Compares everything except passes, times and memory.
inline bool same_results(const BakeResult& a, const BakeResult& b) {
  const auto same = [](const auto& x, const auto& y, const auto& compare) {
    return static_cast<bool>(x) == static_cast<bool>(y) && (!x || compare(*x, *y));
  };
  const auto cubemaps = [](const Cubemap& x, const Cubemap& y) { return same_bits(x, y); };
  return same(a.background, b.background, cubemaps) && same(a.irradiance, b.irradiance, cubemaps) &&
         same(a.specular, b.specular, [](const auto& x, const auto& y) { return same_bits(x.cubemap, y.cubemap); }) &&
         same(a.octahedral, b.octahedral,
              [](const auto& x, const auto& y) {
                return x.size == y.size && x.border == y.border && x.levels == y.levels;
              }) &&
         same(a.radiance, b.radiance,
              [](const auto& x, const auto& y) { return same_bytes(x.coefficients(), y.coefficients()); }) &&
         same(a.brdf, b.brdf, [](const auto& x, const auto& y) { return same_bytes<float>(x.values, y.values); }) &&
         same(a.stored_polynomial, b.stored_polynomial,
              [](const auto& x, const auto& y) { return std::memcmp(&x, &y, sizeof x) == 0; }) &&
         same_pixels(a.diagnostics, b.diagnostics);
}

/// Compares the reasons of passes too, except whether a table was made before.
inline bool same_bits(const BakeResult& a, const BakeResult& b) {
  return same_results(a, b) &&
         std::ranges::equal(a.diagnostics.passes, b.diagnostics.passes, [](const PassRecord& p, const PassRecord& q) {
           return p.name == q.name && (p.name == "brdf" || (p.action == q.action && p.reason == q.reason));
         });
}

inline const PassRecord& pass_named(const BakeResult& result, const std::string& name) {
  const auto& passes = result.diagnostics.passes;
  const auto found = std::find_if(passes.begin(), passes.end(), [&](const PassRecord& p) { return p.name == name; });
  if (found == passes.end()) throw std::runtime_error("no pass is called " + name);
  return *found;
}

/// Small and quick, with every pass.
inline BakeOptions small_bake(int size = 16) {
  BakeOptions options{.specular = PrefilterOptions{.size = size}};
  options.irradiance->size = 5;
  options.brdf = BrdfTableOptions{.width = 9, .height = 7};
  return options;
}

/// Three cubemaps and harmonics, of different sizes.
inline BakeOptions quick_bake(int size = 8) {
  BakeOptions options{.background = BackgroundOptions{.size = 16},
                      .specular = PrefilterOptions{.size = size, .roughness = {0.0, 0.3, 0.9}},
                      .irradiance = IrradianceOptions{.size = 5}};
  options.brdf.reset();
  return options;
}

/// Memory that bakes may take beyond the prediction: tables per size that are kept between calls (weights, rules),
/// TBB's memory, and blocks too small to be predicted.
constexpr std::uint64_t kBesides = std::uint64_t{6} << 20U;

/// Checks that a bake takes no more memory than is predicted, and that the prediction is at most `most_times` as much.
/// (Sanitizers have their own heap: under them the check is left out and the result is empty.)
inline BakeResult check_memory(const EnvironmentView& view, const BakeOptions& options, std::uint64_t most_times) {
  if (kSanitized) return {};
  const std::uint64_t predicted = bake_bytes(view, options);
  release_working_memory();  // memory that an earlier bake left would not be allocated again
  const HeapWatch heap;
  BakeResult result = bake(view, options);
  const auto peak = static_cast<std::uint64_t>(heap.peak_bytes());
  INFO("peak " << peak << " predicted " << predicted);
  CHECK(peak <= predicted + kBesides);
  CHECK(predicted <= most_times * (peak + kBesides));
  return result;
}

constexpr std::byte kUntouched{0xcd};

/// The unwritten memory of one chain, and targets in it.
struct TargetMemory {
  explicit TargetMemory(const UploadLayout& layout)
      : memory(upload_bytes(layout), kUntouched), targets(upload_targets(layout, memory)) {}

  [[nodiscard]] bool untouched() const {
    return std::ranges::all_of(memory, [](std::byte byte) { return byte == kUntouched; });
  }

  std::vector<std::byte> memory;
  std::vector<CubemapTarget> targets;
};

/// Returns the bytes that `store_texels` makes of a chain; `layout` receives the chain's size and levels.
inline std::vector<std::byte> stored(const Cubemap& chain, UploadLayout layout = {.format = TexelFormat::rgba32f}) {
  layout.size = chain.size();
  layout.levels = chain.levels();
  TargetMemory block(layout);
  static_cast<void>(store_texels(chain, block.targets));
  return block.memory;
}

}  // namespace welkin::test
