// Radiance .hdr: RGBE, run-length encoded.
#include "files/hdr.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "files/layout.h"
#include "files/primaries.h"
#include "files/write_environment.h"
#include "image/pixels.h"

namespace welkin::files {
namespace {

// Decodes scanlines where they lie; the index says where that is when rows are asked for out of turn.
class ScanlineReader final : public RowReader {
 public:
  ScanlineReader(const FileInput& input, const HdrHeader& header, const HdrTexels& texels, HdrScanlineIndex& index)
      : header_(header),
        texels_(texels),
        index_(index),
        scanlines_(input, header.width, header.height),
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
  HdrSource(EnvironmentInfo info, const FileInput& input, const HdrHeader& header, const HdrTexels& texels)
      : RowSource(std::move(info), input),
        header_(header),
        texels_(texels),
        index_(input, header.scanline_length(), header.scanlines(), header.first_byte),
        columns_(input, header) {}

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
    if (!header_.columns) return std::make_unique<ScanlineReader>(input(), header_, texels_, index_);
    return std::make_unique<ColumnReader>(header_.width, texels_, columns_);
  }

 private:
  HdrHeader header_;
  HdrTexels texels_;
  // What readers share. Both lock for themselves.
  mutable HdrScanlineIndex index_;
  mutable HdrColumns columns_;
};

// Told from the first scanline, as each says for itself. Fails if not even that is there.
const char* compression_of(const platform::ByteFile& file, const HdrHeader& header) {
  HdrScanlines scanlines(input_of(file), header.scanline_length(), header.scanlines());
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
void require_plausible_size(const platform::ByteFile& file, const HdrHeader& header) {
  const std::uint64_t least = header.scanline_length() == 1 ? 4 : 8;
  const std::uint64_t wanted = least * static_cast<std::uint64_t>(header.scanlines());
  const std::uint64_t found = file.size() - header.first_byte;
  if (wanted > found) {
    throw platform::file_error(ErrorCode::corrupt_file, file.path(),
                               "ends too early: " + std::to_string(header.scanlines()) + " scanlines of " +
                                   std::to_string(header.scanline_length()) + " texels take at least " +
                                   std::to_string(wanted) + " bytes, " + std::to_string(found) +
                                   " follow the header; fetch or export it again");
  }
}

}  // namespace

std::unique_ptr<RowSource> open_hdr(platform::ByteFile& file, const ReadOptions& options) {
  const HdrHeader header = read_hdr_header(file);
  require_plausible_size(file, header);

  EnvironmentInfo info;
  info.path = file.path();
  info.format = FileFormat::radiance;
  info.compression = compression_of(file, header);
  info.storage = header.columns ? "columns" : "scanline";
  info.width = header.width;
  info.height = header.height;
  info.notes = header.notes;
  add_channels(info, header.xyz ? "XYZ" : "RGB", header.xyz ? ChannelType::xyze : ChannelType::rgbe);
  const HdrTexels texels(header.divisor, matrix_of(header, options.primaries, info));
  decide_layout(info, options.layout, std::nullopt);
  return std::make_unique<HdrSource>(std::move(info), input_of(file), header, texels);
}

namespace {

constexpr int kNarrowestEncoded = 8;
constexpr int kWidestEncoded = 32767;
constexpr std::size_t kLongestRun = 127;
constexpr std::size_t kLongestDump = 128;
constexpr std::size_t kShortestRun = 4;  // shorter ones cost as much as they save

using Rgbe = std::array<std::uint8_t, 4>;

/// The largest value: mantissa 255 at the largest exponent.
constexpr float kLargest = 0xFFp119F;

/// Mantissas of 8 bits with a common exponent, value = mantissa 2^(exponent - 136) (Ward, "Real Pixels", Graphics Gems
/// II). Radiance itself cuts mantissas off and puts half a step back when it reads; most other readers do not put it
/// back, so mantissas are rounded to the nearest here, which is off by half a step at most for them.
Rgbe encode(const float* rgb, std::uint64_t& clamped) {
  std::array<float, 3> values{};
  for (std::size_t c = 0; c < 3; ++c) values[c] = image::bounded(rgb[c], kLargest, clamped);
  const float largest = *std::max_element(values.begin(), values.end());
  int exponent = 0;
  std::frexp(largest, &exponent);  // largest = f 2^exponent, f in [0.5, 1)
  // 255.5 and more would round to 256: the next exponent has room for it.
  if (std::ldexp(largest, 8 - exponent) >= 255.5F && exponent < 127) ++exponent;
  if (largest <= 0.0F || exponent < -127) return {0, 0, 0, 0};
  Rgbe result{};
  for (std::size_t c = 0; c < 3; ++c) {
    result[c] = static_cast<std::uint8_t>(std::floor(std::ldexp(values[c], 8 - exponent) + 0.5F));
  }
  result[3] = static_cast<std::uint8_t>(exponent + 128);
  return result;
}

std::size_t run_length(const std::vector<std::uint8_t>& values, std::size_t first) {
  const std::size_t end = std::min(values.size(), first + kLongestRun);
  std::size_t last = first + 1;
  while (last < end && values[last] == values[first]) ++last;
  return last - first;
}

/// Runs as 128 + length and the value, other values after their number.
void append_runs(const std::vector<std::uint8_t>& values, std::vector<std::uint8_t>& bytes) {
  std::size_t dumped = 0;  // values before it are written
  const auto dump_up_to = [&](std::size_t end) {
    while (dumped < end) {
      const std::size_t count = std::min(kLongestDump, end - dumped);
      bytes.push_back(static_cast<std::uint8_t>(count));
      bytes.insert(bytes.end(), values.begin() + static_cast<std::ptrdiff_t>(dumped),
                   values.begin() + static_cast<std::ptrdiff_t>(dumped + count));
      dumped += count;
    }
  };
  for (std::size_t at = 0; at < values.size();) {
    const std::size_t run = run_length(values, at);
    if (run >= kShortestRun) {
      dump_up_to(at);
      bytes.push_back(static_cast<std::uint8_t>(128 + run));
      bytes.push_back(values[at]);
      dumped = at + run;
    }
    at += run;
  }
  dump_up_to(values.size());
}

/// 2, 2 and the width, then the four components one after the other.
void append_encoded(const std::vector<Rgbe>& row, std::vector<std::uint8_t>& bytes) {
  bytes.insert(bytes.end(),
               {2, 2, static_cast<std::uint8_t>(row.size() >> 8U), static_cast<std::uint8_t>(row.size() & 0xFFU)});
  std::vector<std::uint8_t> component(row.size());
  for (std::size_t c = 0; c < 4; ++c) {
    std::transform(row.begin(), row.end(), component.begin(), [c](const Rgbe& texel) { return texel[c]; });
    append_runs(component, bytes);
  }
}

/// A flat texel of mantissas 1, 1, 1 is taken for the old run-length form's repetition: the least change avoids it.
void append_flat(const std::vector<Rgbe>& row, std::vector<std::uint8_t>& bytes) {
  for (Rgbe texel : row) {
    if (texel[0] == 1 && texel[1] == 1 && texel[2] == 1) texel[2] = 2;
    bytes.insert(bytes.end(), texel.begin(), texel.end());
  }
}

}  // namespace

std::uint64_t write_hdr(const OutputImage& image, const WriteJob& job) {
  const int width = image.width();
  const std::string header = "#?RADIANCE\nSOFTWARE=Welkin\nFORMAT=32-bit_rle_rgbe\n\n-Y " +
                             std::to_string(image.height()) + " +X " + std::to_string(width) + "\n";
  job.file.write(header.data(), header.size());
  const bool encoded = width >= kNarrowestEncoded && width <= kWidestEncoded;
  std::uint64_t clamped = 0;
  std::vector<float> rgb(std::size_t{3} * static_cast<std::size_t>(width));
  std::vector<Rgbe> texels(static_cast<std::size_t>(width));
  std::vector<std::uint8_t> bytes;
  for (int row = 0; row < image.height(); ++row) {
    report_rows(job, row, image.height());
    image.read_row(row, rgb.data());
    for (std::size_t i = 0; i < texels.size(); ++i) texels[i] = encode(rgb.data() + 3 * i, clamped);
    bytes.clear();
    if (encoded) {
      append_encoded(texels, bytes);
    } else {
      append_flat(texels, bytes);
    }
    job.file.write(bytes.data(), bytes.size());
  }
  return clamped;
}

}  // namespace welkin::files
