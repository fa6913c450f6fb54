#include "codec/exr_file.h"

#include <ImfChannelList.h>
#include <ImfHeader.h>
#include <ImfPartType.h>

#include <algorithm>

#include "codec/exr_levels.h"

namespace welkin::codec {
namespace {

constexpr int kLibraryThreads = 0;

// A row of tiles must fit where one of the first picture's did, and its levels must be there.
bool are_same_tiles(const ExrPicture& picture, const Imf::Header& header) {
  const Imf::TileDescription& tiles = header.tileDescription();
  const LevelInfo& full = picture.info.levels.front();
  const std::vector<LevelInfo> levels = level_sizes(tiles, full.width, full.height);
  const bool same_levels = std::equal(levels.begin(), levels.end(), picture.info.levels.begin(),
                                      picture.info.levels.end(), [](const LevelInfo& one, const LevelInfo& other) {
                                        return one.width == other.width && one.height == other.height;
                                      });
  const auto height = static_cast<unsigned>(picture.data_height);
  return same_levels && std::min(tiles.ySize, height) == static_cast<unsigned>(picture.unit_rows);
}

// The level's size is the data window's only at level 0; the others follow from it.
bool is_same_picture(const ExrPicture& picture, const Imf::MultiPartInputFile& file) {
  if (picture.part >= file.parts()) {
    return false;
  }
  const Imf::Header& header = file.header(picture.part);
  const Imath::Box2i& window = header.dataWindow();
  const LevelInfo& full = picture.info.levels.front();
  const Imath::V2i size =
      picture.is_framed() ? Imath::V2i(picture.data_width, picture.data_height) : Imath::V2i(full.width, full.height);
  const std::string& luminance_or_green =
      picture.channels.names[picture.channels.kind == ExrChannels::Kind::luminance ? 0 : 1];
  return window.min == Imath::V2i(picture.first_column, picture.first_row) &&
         window.size() == size - Imath::V2i(1, 1) && header.channels().findChannel(luminance_or_green) != nullptr &&
         (header.type() == Imf::TILEDIMAGE) == picture.tiled && (!picture.tiled || are_same_tiles(picture, header));
}

}  // namespace

// Every reader opens the file anew. If it is another one by now, its rows may not fit where they would go.
ExrFile::ExrFile(const ExrPicture& picture) : bytes(picture.info.path), stream(bytes), file(stream, kLibraryThreads) {
  if (!is_same_picture(picture, file)) {
    throw file_error(ErrorCode::file_access, picture.info.path, "has changed while it was read; read it again");
  }
}

Imf::Slice exr_slice(Imf::PixelType type, void* first, int column, int row, std::size_t texel_bytes,
                     std::size_t row_bytes, int sampling) {
  const auto left = static_cast<std::intptr_t>(column / sampling) * static_cast<std::intptr_t>(texel_bytes);
  const auto top = static_cast<std::intptr_t>(row / sampling) * static_cast<std::intptr_t>(row_bytes);
  const std::intptr_t base = reinterpret_cast<std::intptr_t>(first) - left - top;
  return {type, reinterpret_cast<char*>(base), texel_bytes, row_bytes, sampling, sampling};
}

}  // namespace welkin::codec
