// Results as bytes, and back. Decoding takes any bytes: what is not a whole and sound result of the shape that was
// asked for is nothing.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sh/face_sums.h"
#include "welkin/cubemap_chain.h"
#include "welkin/projection.h"
#include "welkin/sky_tables.h"
#include "welkin/specular.h"

namespace welkin::cache {

using Bytes = std::vector<std::uint8_t>;
using ByteSpan = std::span<const std::uint8_t>;

[[nodiscard]] Bytes encode(const Projection& projection);
[[nodiscard]] Bytes encode(const CubemapChain& chain);
/// `texels`: the six faces, 18 times the square of `mip.size`.
[[nodiscard]] Bytes encode_mip(const MipRecord& mip, const float* texels);
[[nodiscard]] Bytes encode(const sh::FaceSums& sums);
/// Without atmosphere and options, which whoever asks has.
[[nodiscard]] Bytes encode(const SkyTables& tables);

[[nodiscard]] std::optional<Projection> decode_projection(ByteSpan bytes, int bands);
[[nodiscard]] std::optional<CubemapChain> decode_cubemap(ByteSpan bytes, int size, int levels);
/// Into its place. Nothing is written unless all of a mip of that size is there. It took no time this time.
[[nodiscard]] std::optional<MipRecord> decode_mip(ByteSpan bytes, int size, float* texels);
[[nodiscard]] std::optional<std::shared_ptr<const sh::FaceSums>> decode_face_sums(ByteSpan bytes, int bands,
                                                                                  std::size_t tiles);
/// With their atmosphere and options.
[[nodiscard]] std::optional<SkyTables> decode_sky_tables(ByteSpan bytes, const Atmosphere& atmosphere,
                                                         const SkyTableOptions& options);

}  // namespace welkin::cache
