// Chains of reflections, asked for and given.
#pragma once

#include "interface.h"
#include "welkin/reflections.h"

namespace welkin::wasm {

/// Throws `Error` (invalid_argument) for faces whose bytes 32 bits could not count.
void require_edge(const char* name, int size);

/// From `first` on. A number of mips or a size of 0 asks for the default; the schedule, the
/// lobe and the quality are numbers of `RoughnessSchedule`, `LobeFamily` and `Quality`; of Charlie sheen and Lambert
/// the schedule is not looked at.
enum ChainOption {
  kChainSize,
  kChainMips,
  kChainSchedule,
  kChainError,
  kChainLargestError,
  kChainFloats,
  kChainLobe,
  kChainQuality,
  kChainFitted,
  kChainOptions
};
[[nodiscard]] PrefilterOptions prefilter_options(const Options& options, int first);

/// Results: numbers (size, mips, then for each mip its size, roughness and estimated errors at it and between it and
/// the next, negative where there is none), then the texels level by level, face by face, RGBA.
void give_chain(const PrefilteredSpecular& chain, bool floats);
/// Only the numbers.
void give_numbers(const PrefilteredSpecular& chain);
/// Only the texels.
void give_texels(const Cubemap& chain, bool floats);

}  // namespace welkin::wasm
