// Textures of halves that are filled from probes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "image/pixels.h"
#include "jobs/tiles.h"
#include "probes/probe_arrays.h"
#include "welkin/core.h"
#include "welkin/probes.h"

namespace welkin::probes {

using Texel = std::array<float, 4>;

inline constexpr int kMaxTexels = 2048;  // along an edge of a texture

/// A texture that is being filled.
class Filling {
 public:
  Filling(PackedProbes& packed, const char* name, std::array<int, 3> size, bool is_array = false)
      : size_(size), index_(packed.textures.size()) {
    for (const int edge : size)
      image::require_range("texels along an edge of a texture of probes", edge, 1, kMaxTexels);
    packed.textures.push_back(
        {name, size,
         std::vector<std::uint16_t>(std::size_t{4} * static_cast<std::size_t>(size[0]) *
                                    static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(size[2])),
         is_array});
  }

  /// Returns how many values did not fit.
  std::uint64_t set(PackedProbes& packed, int x, int y, int z, const Texel& texel) const {
    const std::size_t place =
        (static_cast<std::size_t>(z) * static_cast<std::size_t>(size_[1]) + static_cast<std::size_t>(y)) *
            static_cast<std::size_t>(size_[0]) +
        static_cast<std::size_t>(x);
    auto* halves = reinterpret_cast<std::uint8_t*>(packed.textures[index_].halves.data() + 4 * place);
    return image::encode_texels(texel.data(), 2, 2, {.channels = 2, .halves = true}, halves);
  }

 private:
  std::array<int, 3> size_;
  std::size_t index_;
};

/// Calls work(slice) for each slice of a texture; returns the sum of what it returns.
template <class Work>
std::uint64_t for_each_slice(int slices, std::int64_t texels, const Control& control, const Work& work) {
  std::vector<std::uint64_t> clamped(static_cast<std::size_t>(slices));
  const auto placement = jobs::placement_for(texels);
  jobs::run_tiles(clamped.size(), placement, jobs::worker_count(placement), control,
                  [&](std::size_t slice, std::size_t /*worker*/) { clamped[slice] = work(static_cast<int>(slice)); });
  std::uint64_t sum = 0;
  for (const std::uint64_t each : clamped) sum += each;
  return sum;
}

[[nodiscard]] inline dvec3 coefficient(const BakedProbes& probes, std::size_t probe, std::size_t index) {
  const std::size_t functions = squared(probes.bands);
  return index < functions ? probes.coefficients[probe * functions + index] : dvec3(0.0);
}

[[nodiscard]] inline std::size_t number_of(const ProbeGrid& grid, int x, int y, int z) {
  return static_cast<std::size_t>(x) +
         static_cast<std::size_t>(grid.counts[0]) *
             (static_cast<std::size_t>(y) + static_cast<std::size_t>(grid.counts[1]) * static_cast<std::size_t>(z));
}

/// Each packs a layout (packing_volumes.cpp).
[[nodiscard]] PackedProbes pack_bevy(const BakedProbes& probes, const Control& control);
[[nodiscard]] PackedProbes pack_rtxgi(const BakedProbes& probes, const Control& control);

}  // namespace welkin::probes
