// The bake from the inside: for sources that bring a part of the results along, and for plans.
#pragma once

#include <span>

#include "bake/bake_plan.h"
#include "welkin/bake.h"

namespace welkin::baking {

/// Results that came with the pixels, in Welkin's axes; null where there are none. They must outlive the call, which
/// takes the chains for its own.
struct StoredResults {
  const SphericalHarmonics* harmonics = nullptr;  ///< radiance; used where it has all bands that are asked for
  PrefilteredSpecular* specular = nullptr;        ///< used where a specular cubemap is asked for
  CubemapChain* levels = nullptr;  ///< plain mips, level 0 the source: used where the background has its size

  [[nodiscard]] StoredKinds kinds() const noexcept;
};

/// `bake_into`. `planned`: passes whose reasons are taken over where the bake does the same; empty: the bake's own.
void bake_source(BakeResult& result, const CubemapView& source, const BakeOptions& options, const StoredResults& stored,
                 std::span<const PlannedPass> planned, const Control& control);
void bake_source(BakeResult& result, const LatLongView& source, const BakeOptions& options, const StoredResults& stored,
                 std::span<const PlannedPass> planned, const Control& control);

}  // namespace welkin::baking
