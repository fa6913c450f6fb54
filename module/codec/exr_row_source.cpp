#include "codec/exr_row_source.h"

#include <ImfChromaticities.h>  // clang-tidy takes its forward declaration for ours
#include <ImfInputPart.h>
#include <ImfTiledInputPart.h>

#include <algorithm>
#include <vector>

#include "codec/exr_file.h"
#include "codec/exr_luminance_chroma.h"
#include "codec/exr_picture.h"
#include "codec/primaries.h"

namespace welkin::codec {
namespace {

using Kind = ExrChannels::Kind;

// The stored texel (first_column, row) goes to `rgb`, as float; uint channels become the numbers that they state.
Imf::FrameBuffer frame_buffer(const ExrPicture& picture, int row, float* rgb) {
  constexpr std::size_t kTexel = 3 * sizeof(float);
  const std::size_t stride = kTexel * static_cast<std::size_t>(picture.data_width);
  Imf::FrameBuffer buffer;
  for (std::size_t i = 0; i < (picture.channels.kind == Kind::luminance ? 1 : 3); ++i) {
    buffer.insert(picture.channels.names[i], exr_slice(Imf::FLOAT, rgb + i, picture.first_column, row, kTexel, stride));
  }
  return buffer;
}

class ScanlineReader final : public RowReader {
 public:
  explicit ScanlineReader(const ExrPicture& picture)
      : picture_(picture), file_(picture), input_(file_.file, picture.part) {}

  void read(int first_row, int row_count, float* rgb) override {
    const int top = picture_.first_row + first_row;
    call_openexr(picture_.info.path, [&] {
      input_.setFrameBuffer(frame_buffer(picture_, top, rgb));
      input_.readPixels(top, top + row_count - 1);
    });
  }

 private:
  const ExrPicture& picture_;
  ExrFile file_;
  Imf::InputPart input_;
};

// Reads one level of any tiled file, a row of tiles at a time.
class TiledReader final : public RowReader {
 public:
  explicit TiledReader(const ExrPicture& picture)
      : picture_(picture), file_(picture), input_(file_.file, picture.part) {}

  void read(int first_row, int row_count, float* rgb) override {
    const int tile_rows = picture_.unit_rows;
    const int end = first_row + row_count;
    const std::size_t row_floats = std::size_t{3} * static_cast<std::size_t>(picture_.data_width);
    for (int tile = first_row / tile_rows; tile * tile_rows < end; ++tile) {
      const int tile_first = tile * tile_rows;
      const int tile_end = std::min(tile_first + tile_rows, picture_.data_height);
      const int from = std::max(first_row, tile_first);
      const int to = std::min(end, tile_end);
      float* place = rgb + static_cast<std::size_t>(from - first_row) * row_floats;
      if (from == tile_first && to == tile_end) {
        read_tiles(tile, tile_first, place);
      } else {
        edge_.resize(row_floats * static_cast<std::size_t>(tile_rows));
        read_tiles(tile, tile_first, edge_.data());
        const float* wanted = edge_.data() + static_cast<std::size_t>(from - tile_first) * row_floats;
        std::copy_n(wanted, static_cast<std::size_t>(to - from) * row_floats, place);
      }
    }
  }

 private:
  void read_tiles(int tile, int tile_first, float* rgb) {
    const int level = picture_.level;
    call_openexr(picture_.info.path, [&] {
      input_.setFrameBuffer(frame_buffer(picture_, picture_.first_row + tile_first, rgb));
      input_.readTiles(0, input_.numXTiles(level) - 1, tile, tile, level, level);
    });
  }

  const ExrPicture& picture_;
  ExrFile file_;
  Imf::TiledInputPart input_;
  std::vector<float> edge_;  // a row of tiles of which not all rows are wanted
};

// What is done to rows as they are stored: Y alone is spread to three channels, primaries are converted.
class ColourReader final : public RowReader {
 public:
  ColourReader(std::unique_ptr<RowReader> reader, const ExrPicture& picture)
      : reader_(std::move(reader)), picture_(picture) {}

  void read(int first_row, int row_count, float* rgb) override {
    reader_->read(first_row, row_count, rgb);
    const std::size_t texels = static_cast<std::size_t>(picture_.data_width) * static_cast<std::size_t>(row_count);
    if (picture_.channels.kind == Kind::luminance) {
      for (std::size_t i = 0; i < texels; ++i) {
        rgb[3 * i + 1] = rgb[3 * i + 2] = rgb[3 * i];
      }
    }
    if (picture_.to_rec709) {
      apply(*picture_.to_rec709, rgb, texels);
    }
  }

 private:
  std::unique_ptr<RowReader> reader_;
  const ExrPicture& picture_;
};

// Rows of a picture that is another rectangle than what is stored, from rows of the latter.
class FramedReader final : public RowReader {
 public:
  FramedReader(std::unique_ptr<RowReader> reader, const ExrPicture& picture)
      : reader_(std::move(reader)), picture_(picture) {}

  void read(int first_row, int row_count, float* rgb) override {
    const std::size_t row_floats = std::size_t{3} * static_cast<std::size_t>(picture_.info.width);
    std::fill_n(rgb, row_floats * static_cast<std::size_t>(row_count), 0.0F);
    const int first = std::max(first_row + picture_.row_offset, 0);
    const int end = std::min(first_row + row_count + picture_.row_offset, picture_.data_height);
    for (int row = first; row < end;) {
      // As far as one block of the file reaches, so that each is decoded once.
      const int count = std::min(end, (row / picture_.unit_rows + 1) * picture_.unit_rows) - row;
      stored_.resize(std::size_t{3} * static_cast<std::size_t>(picture_.data_width) *
                     static_cast<std::size_t>(picture_.unit_rows));
      reader_->read(row, count, stored_.data());
      const int picture_row = row - picture_.row_offset - first_row;
      place(count, rgb + static_cast<std::size_t>(picture_row) * row_floats);
      row += count;
    }
  }

 private:
  void place(int row_count, float* rgb) const {
    const int from = std::max(picture_.column_offset, 0);
    const int to = std::min(picture_.column_offset + picture_.info.width, picture_.data_width);
    const auto floats = [](int texels) { return 3 * static_cast<std::ptrdiff_t>(texels); };
    for (int row = 0; row < row_count; ++row) {
      const float* stored = stored_.data() + floats(picture_.data_width) * row;
      std::copy(stored + floats(from), stored + floats(to),
                rgb + floats(picture_.info.width) * row + floats(from - picture_.column_offset));
    }
  }

  std::unique_ptr<RowReader> reader_;
  const ExrPicture& picture_;
  std::vector<float> stored_;  // one unit's rows
};

class ExrSource final : public RowSource {
 public:
  explicit ExrSource(const ExrPicture& picture) : RowSource(picture.info), picture_(picture) {}

  [[nodiscard]] int natural_rows() const override {
    const int rows = picture_.channels.kind == Kind::luminance_chroma ? luminance_chroma_rows(picture_.unit_rows)
                                                                      : picture_.unit_rows;
    return std::min(rows, picture_.info.height);
  }

  [[nodiscard]] bool has_openexr_cube_frames() const override { return picture_.cube_frames; }
  [[nodiscard]] bool has_prefiltered_levels() const override { return picture_.prefiltered; }

  // The library holds a unit as it is in the file, as it is uncompressed, and one to three more while it
  // undoes the compression; we perhaps a row of tiles and the rows of a frame; the rest is small beside them.
  [[nodiscard]] std::uint64_t reader_bytes() const override {
    const std::uint64_t rows = rgb_bytes(picture_.data_width, picture_.unit_rows);
    return 5 * picture_.unit_bytes + (picture_.tiled ? rows : 0) + (picture_.is_framed() ? rows : 0) +
           (picture_.channels.kind == Kind::luminance_chroma ? luminance_chroma_bytes(picture_.data_width) : 0) +
           picture_.table_bytes + (std::uint64_t{1} << 20U);
  }

  [[nodiscard]] std::unique_ptr<RowReader> open_reader() const override {
    return call_openexr(picture_.info.path, [&] {
      std::unique_ptr<RowReader> reader = open_stored_rows();
      if (picture_.channels.kind == Kind::luminance || picture_.to_rec709) {
        reader = std::make_unique<ColourReader>(std::move(reader), picture_);
      }
      if (picture_.is_framed()) {
        reader = std::make_unique<FramedReader>(std::move(reader), picture_);
      }
      return reader;
    });
  }

 private:
  [[nodiscard]] std::unique_ptr<RowReader> open_stored_rows() const {
    if (picture_.channels.kind == Kind::luminance_chroma) {
      return open_luminance_chroma(picture_);
    }
    if (picture_.tiled) {
      return std::make_unique<TiledReader>(picture_);
    }
    return std::make_unique<ScanlineReader>(picture_);
  }

  ExrPicture picture_;
};

}  // namespace

std::unique_ptr<RowSource> open_exr(ByteFile& file, const ReadOptions& options) {
  return std::make_unique<ExrSource>(inspect_exr(file, options));
}

}  // namespace welkin::codec
