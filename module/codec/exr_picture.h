// What an OpenEXR header promises, checked before any pixel memory is made for it.
#pragma once

#include <cstdint>
#include <glm/mat3x3.hpp>
#include <optional>

#include "codec/byte_file.h"
#include "codec/exr_channels.h"
#include "welkin/environment_file.h"

namespace welkin::codec {

/// The largest block of scanlines or tile, uncompressed and with all channels, that is decoded. 65536 texels
/// of four float channels at DWAB's 256 scanlines take half of it.
inline constexpr std::uint64_t kMaximumUnitBytes = std::uint64_t{512} << 20U;

/// One part, layer and level of a scanline or tiled file. The picture is `info.width` x `info.height`; what is
/// stored is data_width x data_height, and usually the same rectangle (see exr_windows.h).
struct ExrPicture {
  EnvironmentInfo info;  ///< complete, layout included
  int part = 0;
  bool tiled = false;
  int level = 0;  ///< (level, level) of a mip or rip map
  ExrChannels channels;
  std::optional<glm::dmat3> to_rec709;
  bool prefiltered = false;  ///< an attribute speaks of roughness
  bool cube_frames = false;  ///< a strip whose faces are turned as OpenEXR's envmap attribute means them
  int first_column = 0;      ///< the data window's left and top, in the file's coordinates
  int first_row = 0;
  int data_width = 0;  ///< at the level
  int data_height = 0;
  int column_offset = 0;  ///< of the picture's (0, 0) in the stored texels; negative if that is not stored
  int row_offset = 0;
  int unit_rows = 1;              ///< rows that decode together, at most the data's height
  std::uint64_t unit_bytes = 0;   ///< of one block of scanlines or tile, uncompressed, all channels
  std::uint64_t table_bytes = 0;  ///< of all parts' headers and tables of offsets, which every reader holds

  [[nodiscard]] bool is_framed() const noexcept {
    return column_offset != 0 || row_offset != 0 || data_width != info.width || data_height != info.height;
  }
};

/// Reads and checks all of a file's headers and chooses part, layer, level and window. `file` stands at its beginning.
/// Throws as `inspect_environment`.
[[nodiscard]] ExrPicture inspect_exr(ByteFile& file, const ReadOptions& options);

}  // namespace welkin::codec
