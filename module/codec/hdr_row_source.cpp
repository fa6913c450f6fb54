#include "codec/hdr_row_source.h"

#include <utility>
#include <vector>

#include "codec/hdr_columns.h"
#include "codec/hdr_header.h"
#include "codec/hdr_scanline_index.h"
#include "codec/hdr_texels.h"
#include "codec/layout.h"
#include "codec/stated_primaries.h"

namespace welkin::codec {
namespace {

// Decodes scanlines where they lie; the index says where that is when rows are asked for out of turn.
class ScanlineReader final : public RowReader {
 public:
  ScanlineReader(const EnvironmentInfo& info, const HdrHeader& header, const HdrTexels& texels, HdrScanlineIndex& index)
      : header_(header),
        texels_(texels),
        index_(index),
        scanlines_(info.path, header.width, header.height),
        planes_(std::size_t{4} * static_cast<std::size_t>(header.width)) {
    scanlines_.seek(0, header.first_byte);
  }

  void read(int first_row, int row_count, float* rgb) override {
    const int first_scanline = header_.bottom_first ? header_.height - first_row - row_count : first_row;
    if (scanlines_.scanline() != first_scanline) {
      scanlines_.seek(first_scanline, index_.position_of(first_scanline));
    }
    for (int i = 0; i < row_count; ++i) {
      scanlines_.decode(planes_.data());
      const int row = header_.bottom_first ? row_count - 1 - i : i;
      texels_.convert(planes_.data(), header_.width, header_.right_first,
                      rgb + static_cast<std::size_t>(row) * 3 * static_cast<std::size_t>(header_.width));
    }
  }

 private:
  const HdrHeader& header_;
  const HdrTexels& texels_;
  HdrScanlineIndex& index_;
  HdrScanlines scanlines_;
  std::vector<std::uint8_t> planes_;
};

class ColumnReader final : public RowReader {
 public:
  ColumnReader(int width, const HdrTexels& texels, HdrColumns& columns)
      : width_(width), texels_(texels), columns_(columns) {}

  void read(int first_row, int row_count, float* rgb) override {
    for (int i = 0; i < row_count; ++i) {
      texels_.convert(columns_.row(first_row + i), width_, false,
                      rgb + static_cast<std::size_t>(i) * 3 * static_cast<std::size_t>(width_));
    }
  }

 private:
  int width_;
  const HdrTexels& texels_;
  HdrColumns& columns_;
};

class HdrSource final : public RowSource {
 public:
  HdrSource(EnvironmentInfo info, const HdrHeader& header, const HdrTexels& texels, std::uint64_t memory_limit_bytes)
      : RowSource(std::move(info)),
        header_(header),
        texels_(texels),
        memory_limit_bytes_(memory_limit_bytes),
        index_(this->info().path, header.scanline_length(), header.scanlines(), header.first_byte),
        columns_(this->info().path, header) {}

  [[nodiscard]] int natural_rows() const override { return 1; }

  [[nodiscard]] std::uint64_t reader_bytes() const override {
    return header_.columns
               ? HdrColumns::memory_bytes(header_)
               : HdrScanlines::memory_bytes() + std::uint64_t{4} * static_cast<std::uint64_t>(header_.width) +
                     HdrScanlineIndex::memory_bytes(header_.height);
  }

  [[nodiscard]] const char* smaller_reader() const override {
    return header_.columns ? "save it as -Y +X: its scanlines are columns, so that it must be decoded whole"
                           : RowSource::smaller_reader();
  }

  [[nodiscard]] std::unique_ptr<RowReader> open_reader() const override {
    if (!header_.columns) {
      return std::make_unique<ScanlineReader>(info(), header_, texels_, index_);
    }
    if (reader_bytes() > memory_limit_bytes_) {
      throw file_error(ErrorCode::limit_exceeded, info().path,
                       "its scanlines are columns, so that it must be decoded whole: that takes " +
                           std::to_string(reader_bytes()) + " bytes, above the limit of " +
                           std::to_string(memory_limit_bytes_) + "; raise the limit, or save it as -Y +X");
    }
    return std::make_unique<ColumnReader>(header_.width, texels_, columns_);
  }

 private:
  HdrHeader header_;
  HdrTexels texels_;
  std::uint64_t memory_limit_bytes_;
  // What readers share. Both lock for themselves.
  mutable HdrScanlineIndex index_;
  mutable HdrColumns columns_;
};

// Told from the first scanline, as each says for itself. Fails if not even that is there.
const char* compression_of(const ByteFile& file, const HdrHeader& header) {
  HdrScanlines scanlines(file.path(), header.scanline_length(), header.scanlines());
  scanlines.seek(0, header.first_byte);
  switch (scanlines.skip()) {
    case HdrCoding::flat: return "none";
    case HdrCoding::old_rle: return "old rle";
    case HdrCoding::new_rle: return "rle";
  }
  return "none";
}

std::optional<glm::dmat3> matrix_of(const HdrHeader& header, Primaries wanted, EnvironmentInfo& info) {
  if (header.xyz) {
    return rec709_from_stored_xyz(wanted, info);
  }
  return header.primaries ? rec709_from_stated(*header.primaries, "the header's PRIMARIES line", wanted, info)
                          : std::nullopt;
}

// Two texels in a row take 8 bytes at the least: a texel and how often it comes again.
void require_plausible_size(const ByteFile& file, const HdrHeader& header) {
  const std::uint64_t least = header.scanline_length() == 1 ? 4 : 8;
  const std::uint64_t wanted = least * static_cast<std::uint64_t>(header.scanlines());
  const std::uint64_t found = file.size() - header.first_byte;
  if (wanted > found) {
    throw file_error(ErrorCode::corrupt_file, file.path(),
                     "ends too early: " + std::to_string(header.scanlines()) + " scanlines of " +
                         std::to_string(header.scanline_length()) + " texels take at least " + std::to_string(wanted) +
                         " bytes, " + std::to_string(found) + " follow the header; fetch or export it again");
  }
}

}  // namespace

std::unique_ptr<RowSource> open_hdr(ByteFile& file, const ReadOptions& options) {
  const HdrHeader header = read_hdr_header(file);
  require_plausible_size(file, header);

  EnvironmentInfo info;
  info.path = file.path();
  info.format = "Radiance";
  info.compression = compression_of(file, header);
  info.storage = header.columns ? "columns" : "scanline";
  info.width = header.width;
  info.height = header.height;
  info.notes = header.notes;
  const std::vector<const char*> names = header.xyz ? std::vector{"X", "Y", "Z"} : std::vector{"R", "G", "B"};
  for (const char* name : names) {
    info.channels.push_back({name, header.xyz ? "xyze" : "rgbe"});
  }
  const HdrTexels texels(header.divisor, matrix_of(header, options.primaries, info));
  decide_layout(info, options.layout, std::nullopt);
  return std::make_unique<HdrSource>(std::move(info), header, texels, options.memory_limit_bytes);
}

}  // namespace welkin::codec
