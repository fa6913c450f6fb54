// Cubemaps into memory of the caller's, as Vulkan and D3D12 take them: an upload buffer that is mapped, say.
//
//   const welkin::UploadLayout layout{.format = welkin::TexelFormat::rgba16f, .size = 256, .levels = 9};
//   std::span<std::byte> memory = map(upload_bytes(layout));
//   welkin::store_texels(light.specular->cubemap, upload_targets(layout, memory));
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "welkin/control.h"
#include "welkin/cubemap_chain.h"
#include "welkin/export.h"
#include "welkin/image_view.h"

namespace WELKIN_EXPORT welkin {

/// How a texel is stored; each value is rounded to the nearest that there is, and what a format cannot hold is clamped
/// and counted: what is above its largest value becomes that, NaN becomes 0, negatives become 0 where there are none.
/// Alpha, where there is one, is 1.
enum class TexelFormat {
  rgba16f,    ///< halves, -65504 to 65504
  rgba32f,    ///< floats, as they are: NaN and infinities too
  b10g11r11,  ///< unsigned floats of 11, 11 and 10 bits, up to 65024 and 64512: 1 part in 64 and 32
  e5b9g9r9,   ///< mantissas of 9 bits, one exponent, up to 65408: 1 part in 512 of the largest channel
};

/// One level of a cubemap in memory that is written to. Rows of a face lie `row_pitch_bytes` apart, row 0 first; what
/// lies between them is not touched. Faces are those of `CubemapView`, and need not lie one after the other.
struct CubemapTarget {
  std::array<void*, 6> faces{};
  int size = 0;                        ///< texels along an edge
  std::ptrdiff_t row_pitch_bytes = 0;  ///< 0: rows are packed; negative: bottom-up
  TexelFormat format = TexelFormat::rgba16f;
};

/// Writes a cubemap of the same size. Returns how many channel values the format could not hold. The same bytes on any
/// number of threads. Throws `Error`: invalid_argument (a null face, another size, rows that overlap), cancelled.
std::uint64_t store_texels(const CubemapView& from, const CubemapTarget& to, const Control& control = {});

/// Writes all levels of a chain, each to its target; nothing is written if one of them is refused.
std::uint64_t store_texels(const CubemapChain& from, std::span<const CubemapTarget> to, const Control& control = {});

/// Which of the images of six faces and several levels come one after the other.
enum class UploadOrder {
  level_by_level,  ///< six faces of level 0, six of level 1, ...: KTX2, and one copy a level in Vulkan
  face_by_face,    ///< all levels of +X, then of -X, ...: D3D12's subresources, DDS
};

/// How a chain lies in one block of memory.
struct UploadLayout {
  TexelFormat format = TexelFormat::rgba16f;
  int size = 0;    ///< texels along an edge of level 0: 1 to 16384
  int levels = 1;  ///< 1 to `full_chain_levels(size)`
  UploadOrder order = UploadOrder::level_by_level;
  std::uint64_t row_alignment_bytes = 1;    ///< of the distance between rows; D3D12 wants 256
  std::uint64_t level_alignment_bytes = 1;  ///< of the start of each face of each level; D3D12 wants 512
};

/// Bytes of such a block. Throws `Error` (invalid_argument) for members out of range.
[[nodiscard]] std::uint64_t upload_bytes(const UploadLayout& layout);

/// The targets of such a block, one a level. Throws `Error` (invalid_argument) as above, and if the memory is too
/// small.
[[nodiscard]] std::vector<CubemapTarget> upload_targets(const UploadLayout& layout, std::span<std::byte> memory);

}  // namespace welkin
