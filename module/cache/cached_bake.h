// A prefiltered chain mip by mip: what was made before, for whatever chain, is not made again.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "cache/entry_store.h"
#include "cache/recipe.h"
#include "welkin/reflections.h"
#include "welkin/result_cache.h"

namespace welkin::cache {

/// The entries of the mips that are made of a source: one for all chains in which a mip has the same bits. Throws as
/// `prefilter_specular` for options that it refuses.
[[nodiscard]] std::vector<EntryName> mip_names(const ContentHash& source, const PrefilterOptions& options);

/// A chain while it is put together.
class StoredChain {
 public:
  StoredChain(const ContentHash& source, const PrefilterOptions& options);

  /// Looks for all mips in a `ResultCache::Store`.
  template <class Store>
  void find(Store& store) {
    for (std::size_t mip = 0; mip < names_.size(); ++mip) {
      const auto level = static_cast<int>(mip);
      auto found = store.find(names_[mip], [&](ByteSpan bytes) {
        return decode_mip(bytes, chain_.level_size(level), chain_.face(level, 0));
      });
      if (!found) continue;
      mips_[mip] = std::move(found->value);
      where_ = where_.empty() || where_ == found->where ? found->where : "in memory and on disk";
      milliseconds_ += found->milliseconds;
    }
    settle();
  }

  [[nodiscard]] bool complete() const noexcept { return first_missing_ == names_.size(); }

  /// The chain of what is missing, from the first such mip to the last. Not of a complete chain.
  [[nodiscard]] PrefilterOptions missing() const;

  /// Takes that chain over, and keeps its mips for others.
  template <class Store>
  void add(Store& store, PrefilteredSpecular made) {
    for (std::size_t mip = first_missing_; mip < end_missing_; ++mip) {
      const auto level = static_cast<int>(mip - first_missing_);
      const MipRecord& record = made.mips[mip - first_missing_];
      store.store(names_[mip], encode_mip(record, made.cubemap.face(level, 0)));
    }
    take_over(std::move(made));
  }

  /// The whole chain; of its `pixels` only the passes are filled in. Once.
  [[nodiscard]] PrefilteredSpecular take();

  [[nodiscard]] double milliseconds() const noexcept { return milliseconds_; }  ///< that finding took
  [[nodiscard]] std::string found_text() const;  ///< "found on disk", "3 of 5 mips found on disk"; empty: none

 private:
  /// Which mips are missing, once all have been looked for.
  void settle();
  void take_over(PrefilteredSpecular made);

  PrefilterOptions options_;
  std::vector<EntryName> names_;
  CubemapChain chain_;
  std::vector<std::optional<MipRecord>> mips_;
  std::size_t first_missing_ = 0;
  std::size_t end_missing_ = 0;
  std::string where_;
  double milliseconds_ = 0.0;
  PrefilteredSpecular made_;
};

}  // namespace welkin::cache
