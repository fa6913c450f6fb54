// A prefiltered chain mip by mip: what was made before, for whatever chain, is not made again.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "cache/entry_store.h"
#include "cache/result_cache.h"
#include "reflections/prefilter_plan.h"
#include "welkin/core.h"
#include "welkin/reflections.h"
#include "welkin/result_cache.h"

namespace welkin::cache {

/// A chain while it is put together.
class StoredChain {
 public:
  /// Looks for all mips that `plan` makes of a source. `source`: hash of its pixels.
  StoredChain(ResultStore& store, const ContentHash& source, const PixelPolicy& pixels,
              const reflections::PrefilterPlan& plan, memory_resource* memory);

  /// The plan of what is missing, from the first such mip to the last; nothing if the chain is complete.
  [[nodiscard]] std::optional<reflections::PrefilterPlan> missing() const;

  /// By what decides the bits of a mip.
  [[nodiscard]] const ContentHash& key(int mip) const { return names_[static_cast<std::size_t>(mip)].key; }

  /// Takes that chain over, and keeps its mips for others.
  void add(PrefilteredSpecular made);

  /// The whole chain; of its `pixels` only the passes are filled in. Once.
  [[nodiscard]] PrefilteredSpecular take();

  [[nodiscard]] double milliseconds() const noexcept { return milliseconds_; }  ///< that finding took
  [[nodiscard]] std::string found_text() const;  ///< "found on disk", "3 of 5 mips found on disk"; empty: none

 private:
  [[nodiscard]] bool spectral(std::size_t mip) const { return plan_.mips[mip].method == MipMethod::spectral; }

  ResultStore& store_;
  reflections::PrefilterPlan plan_;
  std::vector<EntryName> names_;
  Cubemap chain_;
  std::vector<std::optional<MipRecord>> mips_;
  std::size_t first_missing_ = 0;
  std::size_t end_missing_ = 0;
  std::string where_;
  double milliseconds_ = 0.0;
  PrefilteredSpecular made_;
};

}  // namespace welkin::cache
