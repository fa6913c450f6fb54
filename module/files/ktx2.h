// KTX 2.0 (Khronos, "KTX File Format Specification", version 2.0): the constants of its header, and the data format
// descriptors (Khronos Data Format Specification 1.3, basic descriptor block).
//
//   identifier, header, level index, descriptor, key/value data, levels from the smallest to the largest
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "files/supercompression.h"
#include "files/texel_formats.h"

namespace welkin::files {

inline constexpr std::array<std::uint8_t, 12> kKtx2Identifier{0xAB, 0x4B, 0x54, 0x58, 0x20, 0x32,
                                                              0x30, 0xBB, 0x0D, 0x0A, 0x1A, 0x0A};
inline constexpr std::size_t kKtx2HeaderBytes = 80;      ///< with the identifier, up to the level index
inline constexpr std::size_t kKtx2LevelIndexBytes = 24;  ///< per level: offset, bytes, unpacked bytes

/// VkFormat.
[[nodiscard]] std::uint32_t vulkan_format(TexelKind kind) noexcept;
[[nodiscard]] std::optional<TexelKind> kind_of_vulkan_format(std::uint32_t format) noexcept;

/// Bytes of what is turned for the other byte order: a channel, or a packed texel.
[[nodiscard]] std::uint32_t ktx2_type_size(TexelKind kind) noexcept;

/// supercompressionScheme.
[[nodiscard]] std::uint32_t ktx2_scheme(Supercompression supercompression) noexcept;
[[nodiscard]] std::optional<Supercompression> supercompression_of_ktx2(std::uint32_t scheme) noexcept;

/// The data format descriptor with its total size in front: linear light in Rec. 709 primaries, straight alpha.
[[nodiscard]] std::vector<std::uint8_t> ktx2_descriptor(TexelFormat format, Supercompression supercompression);

}  // namespace welkin::files
