// Babylon.js's .env files, which one of the modules can write.
#pragma once

#include <cstddef>
#include <vector>

#include "interface.h"

namespace welkin::wasm {

/// Pixels as one of the two.
struct Pixels {
  const LatLongView* wide;
  const CubemapView* cube;
};

/// An .env file of a picture's light; a chain's options are those from `first` on. Its chain has mips of its own, all
/// down to one texel. Throws `Error`; unsupported_file in a module without PNG.
[[nodiscard]] std::vector<std::byte> env_file(const Pixels& picture, const Options& options, int first,
                                              const PixelPolicy& policy, const SphericalHarmonics& radiance,
                                              const Control& control);

}  // namespace welkin::wasm
