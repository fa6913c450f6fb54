#include "codec/exr_row_source.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfTiledInputFile.h>

#include <algorithm>
#include <vector>

#include "codec/cube_orientation.h"
#include "codec/exr_picture.h"
#include "codec/exr_stream.h"

namespace welkin::codec {
namespace {

// Decoding is done by whoever calls, on as many readers as it likes: the library's own thread pool is left
// as the program has it, and no reader asks for any of it.
constexpr int kLibraryThreads = 0;

// Tells the library to convert to float and where the texel (first_column, row) goes. It expects the
// address that texel (0, 0) would have, which may lie outside of anything: integers, not pointers.
Imf::FrameBuffer frame_buffer(const ExrPicture& picture, int row, float* rgb) {
  constexpr std::size_t kTexel = 3 * sizeof(float);
  const std::size_t stride = kTexel * static_cast<std::size_t>(picture.info.width);
  const auto left = static_cast<std::intptr_t>(picture.first_column) * static_cast<std::intptr_t>(kTexel);
  const auto top = static_cast<std::intptr_t>(row) * static_cast<std::intptr_t>(stride);
  const std::intptr_t origin = reinterpret_cast<std::intptr_t>(rgb) - left - top;

  Imf::FrameBuffer buffer;
  const auto insert = [&](const char* name, std::size_t channel) {
    const std::intptr_t base = origin + static_cast<std::intptr_t>(channel * sizeof(float));
    buffer.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(base), kTexel, stride));
  };
  if (picture.grey) {
    insert("Y", 0);
  } else {
    insert("R", 0);
    insert("G", 1);
    insert("B", 2);
  }
  return buffer;
}

void spread_grey(float* rgb, std::size_t texels) {
  for (std::size_t i = 0; i < texels; ++i) {
    rgb[3 * i + 1] = rgb[3 * i + 2] = rgb[3 * i];
  }
}

// Every reader opens the file anew. If it is another one by now, its rows may not fit where they would go.
void require_same_picture(const ExrPicture& picture, const Imf::Header& header) {
  const Imath::Box2i& window = header.dataWindow();
  if (window.min != Imath::V2i(picture.first_column, picture.first_row) ||
      window.size() != Imath::V2i(picture.info.width - 1, picture.info.height - 1) ||
      header.channels().findChannel(picture.grey ? "Y" : "G") == nullptr) {
    throw file_error(ErrorCode::file_access, picture.info.path, "has changed while it was read; read it again");
  }
}

class ScanlineReader final : public RowReader {
 public:
  explicit ScanlineReader(const ExrPicture& picture)
      : picture_(picture), bytes_(picture.info.path), stream_(bytes_), file_(stream_, kLibraryThreads) {
    require_same_picture(picture, file_.header());
  }

  void read(int first_row, int row_count, float* rgb) override {
    const int top = picture_.first_row + first_row;
    call_openexr(picture_.info.path, [&] {
      file_.setFrameBuffer(frame_buffer(picture_, top, rgb));
      file_.readPixels(top, top + row_count - 1);
    });
  }

 private:
  const ExrPicture& picture_;
  ByteFile bytes_;
  ExrStream stream_;
  Imf::InputFile file_;
};

// Reads level (0, 0), the full size, of any tiled file, a row of tiles at a time.
class TiledReader final : public RowReader {
 public:
  explicit TiledReader(const ExrPicture& picture)
      : picture_(picture), bytes_(picture.info.path), stream_(bytes_), file_(stream_, kLibraryThreads) {
    require_same_picture(picture, file_.header());
  }

  void read(int first_row, int row_count, float* rgb) override {
    const int tile_rows = picture_.unit_rows;
    const int end = first_row + row_count;
    const std::size_t row_floats = std::size_t{3} * static_cast<std::size_t>(picture_.info.width);
    for (int tile = first_row / tile_rows; tile * tile_rows < end; ++tile) {
      const int tile_first = tile * tile_rows;
      const int tile_end = std::min(tile_first + tile_rows, picture_.info.height);
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
    call_openexr(picture_.info.path, [&] {
      file_.setFrameBuffer(frame_buffer(picture_, picture_.first_row + tile_first, rgb));
      file_.readTiles(0, file_.numXTiles(0) - 1, tile, tile, 0, 0);
    });
  }

  const ExrPicture& picture_;
  ByteFile bytes_;
  ExrStream stream_;
  Imf::TiledInputFile file_;
  std::vector<float> edge_;  // a row of tiles of which not all rows are wanted
};

// Y alone: one channel decoded, three handed out.
class GreyReader final : public RowReader {
 public:
  GreyReader(std::unique_ptr<RowReader> reader, int width) : reader_(std::move(reader)), width_(width) {}

  void read(int first_row, int row_count, float* rgb) override {
    reader_->read(first_row, row_count, rgb);
    spread_grey(rgb, static_cast<std::size_t>(width_) * static_cast<std::size_t>(row_count));
  }

 private:
  std::unique_ptr<RowReader> reader_;
  int width_;
};

class ExrSource final : public RowSource {
 public:
  explicit ExrSource(const ExrPicture& picture) : RowSource(picture.info), picture_(picture) {}

  [[nodiscard]] int natural_rows() const override { return picture_.unit_rows; }

  // The library holds a unit as it is in the file, as it is uncompressed, and one to three more while it
  // undoes the compression; we perhaps a row of tiles; the table of offsets is small beside them.
  [[nodiscard]] std::uint64_t reader_bytes() const override {
    const std::uint64_t edge = picture_.tiled ? rgb_bytes(picture_.info.width, picture_.unit_rows) : 0;
    return 5 * picture_.unit_bytes + edge + (std::uint64_t{1} << 20U);
  }

  [[nodiscard]] std::unique_ptr<RowReader> open_reader() const override {
    return call_openexr(picture_.info.path, [&] {
      std::unique_ptr<RowReader> reader;
      if (picture_.tiled) {
        reader = std::make_unique<TiledReader>(picture_);
      } else {
        reader = std::make_unique<ScanlineReader>(picture_);
      }
      if (picture_.grey) {
        reader = std::make_unique<GreyReader>(std::move(reader), picture_.info.width);
      }
      if (picture_.cube_frames) {
        reader = reframe_openexr_cube(std::move(reader), picture_.info.width);
      }
      return reader;
    });
  }

 private:
  ExrPicture picture_;
};

}  // namespace

std::unique_ptr<RowSource> open_exr(ByteFile& file, const ReadOptions& options) {
  return std::make_unique<ExrSource>(inspect_exr(file, options));
}

}  // namespace welkin::codec
