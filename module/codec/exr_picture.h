// What an OpenEXR header promises, checked before any pixel memory is made for it.
#pragma once

#include <cstdint>

#include "codec/byte_file.h"
#include "welkin/environment_file.h"

namespace welkin::codec {

/// The largest block of scanlines or tile, uncompressed and with all channels, that is decoded. 65536 texels
/// of four float channels at DWAB's 256 scanlines take half of it.
inline constexpr std::uint64_t kMaximumUnitBytes = std::uint64_t{512} << 20U;

/// A single-part scanline or tiled picture that has R, G and B, or Y alone, as half or float.
struct ExrPicture {
  EnvironmentInfo info;  ///< complete, layout included
  bool tiled = false;
  bool grey = false;         ///< Y alone
  bool cube_frames = false;  ///< a strip whose faces are turned as OpenEXR's envmap attribute means them
  int first_column = 0;      ///< the data window's left and top: the picture's (0, 0)
  int first_row = 0;
  int unit_rows = 1;             ///< rows that decode together, at most the height
  std::uint64_t unit_bytes = 0;  ///< of one block of scanlines or tile, uncompressed, all channels
};

/// Reads and checks a header. The picture is the data window, wherever it lies: the display window says
/// how a picture is framed on a screen, which means nothing for a sphere (and OpenEXR's own cube maps have
/// the display window of one face).
/// Throws as `inspect_environment`.
[[nodiscard]] ExrPicture inspect_exr(ByteFile& file, const ReadOptions& options);

}  // namespace welkin::codec
