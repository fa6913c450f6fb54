// Microsoft's DDS with the DX10 header (Windows documentation, "DDS file layout"): the constants.
//
//   "DDS ", header, DX10 header, then face after face, each with its levels from the largest to the smallest
#pragma once

#include <cstdint>
#include <optional>

#include "files/texel_formats.h"

namespace welkin::files {

inline constexpr std::uint32_t kDdsMagic = 0x20534444;    // "DDS "
inline constexpr std::uint32_t kFourCcDx10 = 0x30315844;  // "DX10"
inline constexpr std::uint32_t kDdsHeaderBytes = 124;
inline constexpr std::uint32_t kDdsPixelFormatBytes = 32;
inline constexpr std::uint64_t kDdsFirstTexel = 4 + kDdsHeaderBytes + 20;

// dwFlags, ddspf.dwFlags, dwCaps, dwCaps2.
inline constexpr std::uint32_t kDdsCaps = 0x1, kDdsHeight = 0x2, kDdsWidth = 0x4, kDdsPitch = 0x8;
inline constexpr std::uint32_t kDdsPixelFormat = 0x1000, kDdsMipMapCount = 0x20000;
inline constexpr std::uint32_t kDdsHasFourCc = 0x4;
inline constexpr std::uint32_t kDdsComplex = 0x8, kDdsTexture = 0x1000, kDdsMipMap = 0x400000;
inline constexpr std::uint32_t kDdsCubemap = 0x200, kDdsAllFaces = 0xFC00;

// resourceDimension, miscFlag.
inline constexpr std::uint32_t kDdsTexture2d = 3, kDdsTextureCube = 0x4;

/// DXGI_FORMAT.
[[nodiscard]] std::uint32_t dxgi_format(TexelKind kind) noexcept;
[[nodiscard]] std::optional<TexelKind> kind_of_dxgi_format(std::uint32_t format) noexcept;

}  // namespace welkin::files
