#include <ImfChannelList.h>
#include <ImfChromaticities.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfRgbaYca.h>
#include <ImfStandardAttributes.h>
#include <ImfTiledInputPart.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "files/codecs.h"
#include "files/exr.h"
#include "files/primaries.h"
#include "files/textures.h"

namespace welkin::files {
namespace {

constexpr int kLibraryThreads = 0;

// Returns whether a row of tiles fits where one of the first image's did, and its levels exist.
bool are_same_tiles(const ExrImage& image, const Imf::Header& header) {
  const Imf::TileDescription& tiles = header.tileDescription();
  const LevelInfo& full = image.info.levels.front();
  const std::vector<LevelInfo> levels = level_sizes(tiles, full.width, full.height);
  const bool same_levels = std::equal(levels.begin(), levels.end(), image.info.levels.begin(), image.info.levels.end(),
                                      [](const LevelInfo& one, const LevelInfo& other) {
                                        return one.width == other.width && one.height == other.height;
                                      });
  const auto height = static_cast<unsigned>(image.data_height);
  return same_levels && std::min(tiles.ySize, height) == static_cast<unsigned>(image.unit_rows);
}

// The level's size is the data window's only at level 0; the others follow from it.
bool is_same_image(const ExrImage& image, const Imf::MultiPartInputFile& file) {
  if (image.part >= file.parts()) {
    return false;
  }
  const Imf::Header& header = file.header(image.part);
  const Imath::Box2i& window = header.dataWindow();
  const LevelInfo& full = image.info.levels.front();
  const Imath::V2i size =
      image.is_framed() ? Imath::V2i(image.data_width, image.data_height) : Imath::V2i(full.width, full.height);
  const std::string& luminance_or_green =
      image.channels.names[image.channels.kind == ExrChannels::Kind::luminance ? 0 : 1];
  return window.min == Imath::V2i(image.first_column, image.first_row) && window.size() == size - Imath::V2i(1, 1) &&
         header.channels().findChannel(luminance_or_green) != nullptr &&
         (header.type() == Imf::TILEDIMAGE) == image.tiled && (!image.tiled || are_same_tiles(image, header));
}

// A handle on one part of an OpenEXR file, one per reader, which opens the file again. If the file was replaced
// meanwhile, its rows may not fit their memory.
//
// The calling threads decode, each with its reader: the program's settings of the library's thread pool are unchanged,
// and no reader uses it.
//
// Where the table of offsets is incomplete (all zero by OpenImageIO if `textureformat` is set, or in a file whose
// writer was stopped), the library finds the blocks itself on opening.
struct ExrFile {
  // Throws `Error`: file_access if the file is not the one that `image` was made from.
  explicit ExrFile(const ExrImage& image)
      : bytes(open_file(image.input)), stream(bytes), file(stream, kLibraryThreads) {
    if (!is_same_image(image, file)) {
      throw platform::file_error(ErrorCode::file_access, image.info.path,
                                 "has changed while it was read; read it again");
    }
  }

  platform::ByteFile bytes;
  ExrStream stream;
  Imf::MultiPartInputFile file;
};

/// Returns how many of the positions first to last are multiples of `step`.
std::size_t samples(int first, int last, int step) {
  const auto below = [step](int position) {  // multiples up to this one, from an arbitrary one on
    return position >= 0 ? position / step : -((-position + step - 1) / step);
  };
  return static_cast<std::size_t>(below(last) - below(first - 1));
}

/// Returns the bytes of one row, all channels.
std::uint64_t row_bytes(const Imf::ChannelList& channels, int row, int first_column, int last_column) {
  std::uint64_t bytes = 0;
  for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
    const Imf::Channel& one = channel.channel();
    if (samples(row, row, one.ySampling) == 0) continue;
    bytes += samples(first_column, last_column, one.xSampling) * (one.type == Imf::HALF ? 2U : 4U);
  }
  return bytes;
}

/// Returns how many bytes OpenEXR's run lengths give: a count below 0 precedes that many bytes; a count from 0 on
/// precedes a byte that is repeated once more than that (ImfRle.cpp).
std::uint64_t unpacked_rle_bytes(std::span<const char> packed) {
  std::uint64_t bytes = 0;
  for (std::size_t at = 0; at + 1 < packed.size();) {
    constexpr std::size_t kMinNegative = 128;  // of bytes that stand for numbers in two's complement
    const std::size_t count = static_cast<unsigned char>(packed[at]);
    const bool negative = count >= kMinNegative;
    const std::size_t length = negative ? 2 * kMinNegative - count : count + 1;
    bytes += length;
    at += negative ? 1 + length : 2;
  }
  return bytes;
}

/// Checks that blocks that the library has just decoded hold all of their texels. The library (3.1) checks the length
/// that most of its codecs return, but not of ZIP's, RLE's and uncompressed blocks: the rest of their texels would be
/// stale memory.
class ExrBlocks {
 public:
  /// Both must outlive this object.
  ExrBlocks(const ExrImage& image, const Imf::Header& header) : image_(image), header_(header) {}

  /// Throws `Error` (corrupt_file) if the block of rows that the library has read since the last call unpacks to less
  /// than its texels take. `row`: any of its rows, in the file's coordinates. Costs undoing ZIP once more.
  void check_rows(ExrStream& stream, int row) const {
    const std::optional<std::span<const char>> block = stream.take_block();
    if (!block) return;
    const Imath::Box2i& window = header_.dataWindow();
    const int first = row - (row - window.min.y) % image_.unit_rows;
    std::uint64_t expected = 0;
    for (int each = first; each <= std::min(first + image_.unit_rows - 1, window.max.y); ++each) {
      expected += row_bytes(header_.channels(), each, window.min.x, window.max.x);
    }
    check(*block, expected, "the block of row " + std::to_string(first));
  }

  /// Checks a tile of the image's level as `check_rows` checks rows.
  void check_tile(ExrStream& stream, int column, int row) const {
    const std::optional<std::span<const char>> block = stream.take_block();
    if (!block) return;
    const Imf::TileDescription& tiles = header_.tileDescription();
    const auto width = static_cast<int>(tiles.xSize);
    const int columns = std::min(width, image_.data_width - column * width);
    const int rows = std::min(image_.unit_rows, image_.data_height - row * image_.unit_rows);
    const std::uint64_t expected = static_cast<std::uint64_t>(rows) * row_bytes(header_.channels(), 0, 0, columns - 1);
    check(*block, expected, "tile " + std::to_string(column) + ", " + std::to_string(row));
  }

 private:
  void check(std::span<const char> block, std::uint64_t expected, const std::string& what) const {
    std::optional<std::uint64_t> unpacked = block.size();
    if (block.size() < expected) {  // a longer one is not packed, whatever the header says
      switch (header_.compression()) {
        case Imf::NO_COMPRESSION: break;
        case Imf::RLE_COMPRESSION: unpacked = unpacked_rle_bytes(block); break;
        case Imf::ZIP_COMPRESSION:
        case Imf::ZIPS_COMPRESSION: unpacked = unpacked_zlib_bytes(block, expected); break;
        default: return;
      }
    }
    if (!unpacked || *unpacked >= expected) return;
    throw platform::file_error(ErrorCode::corrupt_file, image_.info.path,
                               what + " unpacks to " + std::to_string(*unpacked) + " bytes, its texels take " +
                                   std::to_string(expected) + "; fetch or export it again");
  }

  const ExrImage& image_;
  const Imf::Header& header_;
};

using Kind = ExrChannels::Kind;

// The stored texel (first_column, row) goes to `rgb`, as float; uint channels become the numbers that they state.
Imf::FrameBuffer frame_buffer(const ExrImage& image, int row, float* rgb) {
  constexpr std::size_t kTexel = 3 * sizeof(float);
  const std::size_t stride = kTexel * static_cast<std::size_t>(image.data_width);
  Imf::FrameBuffer buffer;
  for (std::size_t i = 0; i < (image.channels.kind == Kind::luminance ? 1 : 3); ++i) {
    buffer.insert(image.channels.names[i], exr_slice(Imf::FLOAT, rgb + i, image.first_column, row, kTexel, stride));
  }
  return buffer;
}

class ScanlineReader final : public RowReader {
 public:
  explicit ScanlineReader(const ExrImage& image)
      : image_(image), file_(image), input_(file_.file, image.part), blocks_(image, input_.header()) {}

  void read(int first_row, int row_count, float* rgb) override {
    const int top = image_.first_row + first_row;
    const int end = first_row + row_count;
    call_openexr(image_.info.path, [&] {
      input_.setFrameBuffer(frame_buffer(image_, top, rgb));
      for (int row = first_row; row < end;) {
        const int next = std::min(end, (row / image_.unit_rows + 1) * image_.unit_rows);
        input_.readPixels(image_.first_row + row, image_.first_row + next - 1);
        blocks_.check_rows(file_.stream, image_.first_row + row);
        row = next;
      }
    });
  }

 private:
  const ExrImage& image_;
  ExrFile file_;
  Imf::InputPart input_;
  ExrBlocks blocks_;
};

// Reads one level of any tiled file, a row of tiles at a time.
class TiledReader final : public RowReader {
 public:
  explicit TiledReader(const ExrImage& image)
      : image_(image), file_(image), input_(file_.file, image.part), blocks_(image, input_.header()) {}

  void read(int first_row, int row_count, float* rgb) override {
    const int tile_rows = image_.unit_rows;
    const int end = first_row + row_count;
    const std::size_t row_floats = std::size_t{3} * static_cast<std::size_t>(image_.data_width);
    for (int tile = first_row / tile_rows; tile * tile_rows < end; ++tile) {
      const int tile_first = tile * tile_rows;
      const int tile_end = std::min(tile_first + tile_rows, image_.data_height);
      const int from = std::max(first_row, tile_first);
      const int to = std::min(end, tile_end);
      float* target = rgb + static_cast<std::size_t>(from - first_row) * row_floats;
      if (from == tile_first && to == tile_end) {
        read_tiles(tile, tile_first, target);
      } else {
        edge_.resize(row_floats * static_cast<std::size_t>(tile_rows));
        read_tiles(tile, tile_first, edge_.data());
        const float* wanted = edge_.data() + static_cast<std::size_t>(from - tile_first) * row_floats;
        std::copy_n(wanted, static_cast<std::size_t>(to - from) * row_floats, target);
      }
    }
  }

 private:
  void read_tiles(int tile, int tile_first, float* rgb) {
    const int level = image_.level;
    call_openexr(image_.info.path, [&] {
      input_.setFrameBuffer(frame_buffer(image_, image_.first_row + tile_first, rgb));
      for (int column = 0; column < input_.numXTiles(level); ++column) {
        input_.readTile(column, tile, level, level);
        blocks_.check_tile(file_.stream, column, tile);
      }
    });
  }

  const ExrImage& image_;
  ExrFile file_;
  Imf::TiledInputPart input_;
  ExrBlocks blocks_;
  std::vector<float> edge_;  // a row of tiles of which only some rows are requested
};

// Converts stored rows: Y alone is spread to three channels, and primaries are converted.
class ColourReader final : public RowReader {
 public:
  ColourReader(std::unique_ptr<RowReader> reader, const ExrImage& image) : reader_(std::move(reader)), image_(image) {}

  void read(int first_row, int row_count, float* rgb) override {
    reader_->read(first_row, row_count, rgb);
    const std::size_t texels = static_cast<std::size_t>(image_.data_width) * static_cast<std::size_t>(row_count);
    if (image_.channels.kind == Kind::luminance) {
      for (std::size_t i = 0; i < texels; ++i) {
        rgb[3 * i + 1] = rgb[3 * i + 2] = rgb[3 * i];
      }
    }
    if (image_.to_rec709) {
      apply(*image_.to_rec709, rgb, texels);
    }
  }

 private:
  std::unique_ptr<RowReader> reader_;
  const ExrImage& image_;
};

// Reads an image whose rectangle differs from the stored one, from stored rows.
class FramedReader final : public RowReader {
 public:
  FramedReader(std::unique_ptr<RowReader> reader, const ExrImage& image) : reader_(std::move(reader)), image_(image) {}

  void read(int first_row, int row_count, float* rgb) override {
    const std::size_t row_floats = std::size_t{3} * static_cast<std::size_t>(image_.info.width);
    std::fill_n(rgb, row_floats * static_cast<std::size_t>(row_count), 0.0F);
    const int first = std::max(first_row + image_.row_offset, 0);
    const int end = std::min(first_row + row_count + image_.row_offset, image_.data_height);
    for (int row = first; row < end;) {
      // As far as one block of the file reaches, so that each is decoded once.
      const int count = std::min(end, (row / image_.unit_rows + 1) * image_.unit_rows) - row;
      stored_.resize(std::size_t{3} * static_cast<std::size_t>(image_.data_width) *
                     static_cast<std::size_t>(image_.unit_rows));
      reader_->read(row, count, stored_.data());
      const int image_row = row - image_.row_offset - first_row;
      place(count, rgb + static_cast<std::size_t>(image_row) * row_floats);
      row += count;
    }
  }

 private:
  void place(int row_count, float* rgb) const {
    const int from = std::max(image_.column_offset, 0);
    const int to = std::min(image_.column_offset + image_.info.width, image_.data_width);
    const auto floats = [](int texels) { return 3 * static_cast<std::ptrdiff_t>(texels); };
    for (int row = 0; row < row_count; ++row) {
      const float* stored = stored_.data() + floats(image_.data_width) * row;
      std::copy(stored + floats(from), stored + floats(to),
                rgb + floats(image_.info.width) * row + floats(from - image_.column_offset));
    }
  }

  std::unique_ptr<RowReader> reader_;
  const ExrImage& image_;
  std::vector<float> stored_;  // one unit's rows
};

// Images of luminance and subsampled chroma.

namespace yca = Imf::RgbaYca;

constexpr int kBlockRows = 32;
constexpr int kMargin = yca::N2 + 1;  // the filter's half width, and one row for the saturation of its neighbours
constexpr int kHeldRows = kBlockRows + 2 * kMargin;
constexpr int kNaturalRows = 128;

const Imf::Rgba kBlack(0.0F, 0.0F, 0.0F, 0.0F);

// Reads the stored rows (data_width x data_height) as RGB in the file's primaries, bit-identical to the half floats of
// OpenEXR's RgbaInputFile: the same functions (ImfRgbaYca.h) in the same order. Rows decode in blocks, and a block
// needs 14 more rows above and below, which the next block reuses.
//
// Positions are rows of the file's coordinates, of which even ones have chroma. They may lie outside of the data window
// by the margin; the nearest row with chroma stands in there.
class LuminanceChromaReader final : public RowReader {
 public:
  explicit LuminanceChromaReader(const ExrImage& image)
      : image_(image),
        width_(static_cast<std::size_t>(image.data_width)),
        file_(image),
        input_(file_.file, image.part),
        blocks_(image, input_.header()),
        weights_(luminance_weights(input_.header())),
        line_(width_ + yca::N - 1, kBlack),
        held_(width_ * kHeldRows, kBlack),
        rgb_(width_ * 3, kBlack),
        saturated_(width_, kBlack) {
    set_frame_buffer();
  }

  void read(int first_row, int row_count, float* rgb) override {
    call_openexr(image_.info.path, [&] {
      for (int row = 0; row < row_count; row += kBlockRows) {
        read_block(image_.first_row + first_row + row, std::min(kBlockRows, row_count - row),
                   rgb + 3 * width_ * static_cast<std::size_t>(row));
      }
    });
  }

 private:
  static Imath::V3f luminance_weights(const Imf::Header& header) {
    return yca::computeYw(Imf::hasChromaticities(header) ? Imf::chromaticities(header) : Imf::Chromaticities());
  }

  // Holds one line, wherever it is in the image, with half a filter's width free at both ends.
  void set_frame_buffer() {
    Imf::Rgba* first = line_.data() + yca::N2;
    const auto slice = [&](half* component, int sampling) {
      return exr_slice(Imf::HALF, component, image_.first_column, 0,
                       static_cast<std::size_t>(sampling) * sizeof(Imf::Rgba), 0, sampling);
    };
    Imf::FrameBuffer buffer;
    buffer.insert(image_.channels.names[0], slice(&first->r, 2));
    buffer.insert(image_.channels.names[1], slice(&first->g, 1));
    buffer.insert(image_.channels.names[2], slice(&first->b, 2));
    input_.setFrameBuffer(buffer);
  }

  [[nodiscard]] Imf::Rgba* held(int position) {
    return held_.data() + width_ * static_cast<std::size_t>(position - held_first_);
  }

  // The row's luminance, and chroma at every texel if its row has any.
  void decode(int position, Imf::Rgba* row) {
    const int top = image_.first_row;
    const int bottom = top + image_.data_height - 1;
    const int nearest = position < top ? top : position > bottom ? bottom - 1 : position;
    input_.readPixels(nearest);
    blocks_.check_rows(file_.stream, nearest);
    if (nearest % 2 != 0) {
      std::copy_n(line_.begin() + yca::N2, width_, row);
      return;
    }
    std::fill_n(line_.begin(), yca::N2, line_[yca::N2]);
    std::fill_n(line_.end() - yca::N2, yca::N2, line_[width_ + yca::N2 - 2]);
    yca::reconstructChromaHoriz(image_.data_width, line_.data(), row);
  }

  // Holds the positions [first, end): those that are here already are moved, the others decoded.
  void hold(int first, int end) {
    const int kept_first = std::max(first, held_first_);
    const int kept_end = std::min(end, held_end_);
    const bool keeps = kept_first == first && kept_first < kept_end;
    if (keeps) {
      std::copy(held(kept_first), held(kept_first) + width_ * static_cast<std::size_t>(kept_end - kept_first),
                held_.data());
    }
    held_first_ = first;
    held_end_ = first;  // should decoding throw
    for (int position = keeps ? kept_end : first; position < end; ++position) {
      decode(position, held(position));
    }
    held_end_ = end;
  }

  void reconstruct(int position, Imf::Rgba* rgb) {
    if (position % 2 == 0) {
      yca::YCAtoRGBA(weights_, image_.data_width, held(position), rgb);
      return;
    }
    std::array<const Imf::Rgba*, yca::N> rows{};
    for (int i = 0; i < yca::N; ++i) {
      rows[static_cast<std::size_t>(i)] = held(position - yca::N2 + i);
    }
    yca::reconstructChromaVert(image_.data_width, rows.data(), rgb);
    yca::YCAtoRGBA(weights_, image_.data_width, rgb, rgb);
  }

  void read_block(int first, int count, float* rgb) {
    hold(first - kMargin, first + count + kMargin);
    std::array<Imf::Rgba*, 3> rows{rgb_.data(), rgb_.data() + width_, rgb_.data() + 2 * width_};
    reconstruct(first - 1, rows[1]);
    reconstruct(first, rows[2]);
    for (int row = first; row < first + count; ++row) {
      std::rotate(rows.begin(), rows.begin() + 1, rows.end());
      reconstruct(row + 1, rows[2]);
      yca::fixSaturation(weights_, image_.data_width, rows.data(), saturated_.data());
      for (const Imf::Rgba& texel : saturated_) {
        *rgb++ = texel.r;
        *rgb++ = texel.g;
        *rgb++ = texel.b;
      }
    }
  }

  const ExrImage& image_;
  std::size_t width_;
  ExrFile file_;
  Imf::InputPart input_;
  ExrBlocks blocks_;
  Imath::V3f weights_;
  std::vector<Imf::Rgba> line_;  // as stored: r = RY, g = Y, b = BY
  std::vector<Imf::Rgba> held_;  // decoded rows, kHeldRows of them
  std::vector<Imf::Rgba> rgb_;   // three rows
  std::vector<Imf::Rgba> saturated_;
  int held_first_ = 0;
  int held_end_ = 0;
};

// Returns the bytes that such a reader holds in addition to the library's blocks.
std::uint64_t luminance_chroma_bytes(int width) noexcept {
  return sizeof(Imf::Rgba) * (static_cast<std::uint64_t>(width) * (kHeldRows + 5) + yca::N);
}

// Returns the rows worth decoding together: the 28 rows around them cost little. At least `unit_rows`.
int luminance_chroma_rows(int unit_rows) noexcept { return (kNaturalRows + unit_rows - 1) / unit_rows * unit_rows; }

RowTraits exr_traits(const ExrImage& image) {
  const bool chroma = image.channels.kind == Kind::luminance_chroma;
  const int together = chroma ? luminance_chroma_rows(image.unit_rows) : image.unit_rows;
  const std::uint64_t rows = rgb_bytes(image.data_width, image.unit_rows);
  RowTraits traits{.natural_rows = std::min(together, image.info.height),
                   .openexr_cube_frames = image.cube_frames,
                   .prefiltered_levels = image.prefiltered};
  // The library holds a unit as stored in the file, as uncompressed, and one to three more while it undoes the
  // compression; we perhaps a row of tiles and the rows of a frame; the rest is small in comparison.
  traits.reader_bytes = 5 * image.unit_bytes + (image.tiled ? rows : 0) + (image.is_framed() ? rows : 0) +
                        (chroma ? luminance_chroma_bytes(image.data_width) : 0) + image.table_bytes +
                        (std::uint64_t{1} << 20U);
  return traits;
}

std::unique_ptr<RowReader> open_stored_rows(const ExrImage& image) {
  if (image.channels.kind == Kind::luminance_chroma) return std::make_unique<LuminanceChromaReader>(image);
  if (image.tiled) return std::make_unique<TiledReader>(image);
  return std::make_unique<ScanlineReader>(image);
}

std::unique_ptr<RowReader> open_rows(const ExrImage& image) {
  return call_openexr(image.info.path, [&] {
    std::unique_ptr<RowReader> reader = open_stored_rows(image);
    if (image.channels.kind == Kind::luminance || image.to_rec709) {
      reader = std::make_unique<ColourReader>(std::move(reader), image);
    }
    if (image.is_framed()) {
      reader = std::make_unique<FramedReader>(std::move(reader), image);
    }
    return reader;
  });
}

}  // namespace

std::unique_ptr<RowSource> open_exr(platform::ByteFile& file, const ReadOptions& options) {
  const ExrImage image = inspect_exr(file, options);
  return std::make_unique<RowSource>(image.info, exr_traits(image), [image] { return open_rows(image); });
}

}  // namespace welkin::files
