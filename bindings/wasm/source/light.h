// Light of pixels: what a bake of a file's or a sky's hands out.
#pragma once

#include <cstdint>

#include "chains.h"
#include "interface.h"

namespace welkin::wasm {

/// A module has at most 4 GiB. Results are copied out of it one after the other.
inline constexpr std::uint64_t kMaxBytes = std::uint64_t{3} << 30U;

/// Flags of the results of a bake, from `first` on, after the options of a chain. Chains for .env and KTX2 files are
/// returned as floats: another module packs them (textures.cpp).
enum LightOption { kLightBands = kChainOptions, kLightEnv, kLightKtx2, kLightTexels, kLightBackground, kLightOptions };

/// The share of a call's progress between two others.
[[nodiscard]] Control part(double from, double to);

/// Bakes one of the two images. Results: radiance; the polynomial in Babylon.js's axes; then, each empty where it was
/// not asked for, the chain's numbers, its texels, packed RGB floats of an .env's chain and of the chain itself, the
/// background's texels. Progress begins at `from`.
void bake_pixels(const LatLongView* wide, const CubemapView* cube, const Options& options, int first,
                 const PixelPolicy& pixels, double from);

}  // namespace welkin::wasm
