#include "codec/texture_reader.h"

#include <algorithm>
#include <limits>

#include "codec/stop.h"
#include "codec/supercompression.h"
#include "jobs/tiles.h"
#include "welkin/cubemap_chain.h"

namespace welkin {
namespace codec {
namespace {

constexpr int kRowsAtOnce = 64;

/// Of the whole chain as floats. Sizes are bounded, so that this cannot overflow.
std::uint64_t chain_bytes(const TextureLayout& layout) {
  std::uint64_t texels = 0;
  for (int level = 0; level < static_cast<int>(layout.levels.size()); ++level) {
    const auto edge = static_cast<std::uint64_t>(layout.level_size(level));
    texels += 6 * edge * edge;
  }
  return texels * 3 * sizeof(float);
}

/// A packed level is one tile, the faces of others six.
struct Tiles {
  explicit Tiles(const TextureLayout& layout)
      : faces(layout.supercompression == Supercompression::none ? 1 : 6), count(layout.levels.size() * 6 / faces) {}

  std::size_t faces;  ///< of a tile
  std::size_t count;
};

/// The largest number instead of a wrap: packed levels have the bytes that the file says, and a sparse file says much.
std::uint64_t sum(std::uint64_t a, std::uint64_t b) {
  constexpr std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
  return a > most - b ? most : a + b;
}

/// Beside the chain, with `workers` readers: each level is unpacked by one of them.
std::uint64_t working_bytes(const TextureLayout& layout, std::size_t workers) {
  std::uint64_t bytes = 0;
  for (int level = 0; level < static_cast<int>(layout.levels.size()); ++level) {
    const std::uint64_t one = texture_reader_bytes(layout, level, kRowsAtOnce);
    if (layout.supercompression == Supercompression::none) return one * workers;
    bytes = sum(bytes, one);
  }
  return bytes;
}

void check_memory(const std::filesystem::path& path, const TextureLayout& layout, std::uint64_t limit,
                  std::size_t workers) {
  const std::uint64_t wanted = sum(chain_bytes(layout), working_bytes(layout, workers));
  if (wanted <= limit) return;
  throw file_error(ErrorCode::limit_exceeded, path,
                   "its " + std::to_string(layout.levels.size()) + " levels from " + std::to_string(layout.size) +
                       " texels take " + std::to_string(wanted) + " bytes, above the limit of " +
                       std::to_string(limit) + "; raise the limit");
}

std::string words_for(const TextureLayout& layout) {
  std::string words = layout.container + " " + name(layout.kind);
  if (layout.supercompression != Supercompression::none) words += std::string(" ") + name(layout.supercompression);
  return words;
}

void read_face(TextureReader& reader, CubemapChain& chain, int level, int face, const std::stop_token& stop) {
  const int size = chain.level_size(level);
  for (int row = 0; row < size; row += kRowsAtOnce) {
    throw_if_stopped(stop);
    const std::ptrdiff_t offset = std::ptrdiff_t{3} * size * row;
    reader.read(level, face, row, std::min(kRowsAtOnce, size - row), chain.face(level, face) + offset);
  }
}

}  // namespace

std::uint64_t texture_reader_bytes(const TextureLayout& layout, int level, int rows) noexcept {
  const int size = layout.level_size(level);
  const auto& place = layout.levels[static_cast<std::size_t>(level)];
  if (layout.supercompression != Supercompression::none) return level_bytes(layout.kind, size) + place.packed_bytes;
  return static_cast<std::uint64_t>(rows) * static_cast<std::uint64_t>(size) * texel_bytes(layout.kind);
}

void TextureReader::unpack_level(int level) {
  const TextureLayout::Level& place = layout_.levels[static_cast<std::size_t>(level)];
  unpacked_level_ = -1;
  std::vector<std::uint8_t> packed(place.packed_bytes);
  file_.seek(place.first_byte);
  file_.read(packed.data(), packed.size());
  texels_.resize(level_bytes(layout_.kind, layout_.level_size(level)));
  unpack(layout_.supercompression, packed, file_.path(), texels_, stop_);
  unpacked_level_ = level;
}

void TextureReader::read(int level, int face, int first_row, int rows, float* rgb) {
  const auto size = static_cast<std::size_t>(layout_.level_size(level));
  const std::size_t row_bytes = size * texel_bytes(layout_.kind);
  const std::size_t count = size * static_cast<std::size_t>(rows);
  const std::size_t offset = row_bytes * static_cast<std::size_t>(first_row);
  if (layout_.supercompression != Supercompression::none) {
    if (unpacked_level_ != level) unpack_level(level);
    decode_texels(layout_.kind, texels_.data() + row_bytes * size * static_cast<std::size_t>(face) + offset, count,
                  rgb);
    return;
  }
  texels_.resize(row_bytes * static_cast<std::size_t>(rows));
  file_.seek(layout_.levels[static_cast<std::size_t>(level)].faces[static_cast<std::size_t>(face)] + offset);
  file_.read(texels_.data(), texels_.size());
  decode_texels(layout_.kind, texels_.data(), count, rgb);
}

}  // namespace codec

CubemapTexture read_texture(const std::filesystem::path& path, std::uint64_t memory_limit_bytes,
                            const Control& control) {
  codec::ByteFile file(path);
  const codec::TextureLayout layout = codec::read_texture_layout(file);
  const codec::Tiles tiles(layout);
  const jobs::Placement placement = jobs::placement_for(std::int64_t{6} * layout.size * layout.size);
  const std::size_t workers = jobs::worker_count(placement);
  codec::check_memory(path, layout, memory_limit_bytes, workers);

  CubemapTexture texture{CubemapChain(layout.size, static_cast<int>(layout.levels.size())), codec::words_for(layout),
                         layout.metadata};
  std::vector<std::unique_ptr<codec::TextureReader>> readers(workers);
  jobs::run_tiles(tiles.count, placement, workers, control, [&](std::size_t tile, std::size_t worker) {
    auto& reader = readers[worker];
    if (!reader) reader = std::make_unique<codec::TextureReader>(path, layout, control.stop);
    const std::size_t first = tile * tiles.faces;
    for (std::size_t face = first; face < first + tiles.faces; ++face) {
      codec::read_face(*reader, texture.cubemap, static_cast<int>(face / 6), static_cast<int>(face % 6), control.stop);
    }
  });
  return texture;
}

}  // namespace welkin
