// Radiance images (.hdr, .pic, .rgbe, .xyze) as rows.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "files/hdr.h"
#include "files/hdr_kernels.h"
#include "files/layout.h"
#include "files/primaries.h"
#include "platform/standard_library.h"

namespace welkin::files {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{64} << 10U;
constexpr int kShortestNewForm = 8;
constexpr int kLongestNewForm = 0x7fff;

// Each repeat of a repeat shifts its count by this much more; beyond three of them any count but 0 is longer than the
// longest scanline.
constexpr unsigned kShiftStep = 8;
constexpr unsigned kLargestShift = 24;

bool is_repeat(const std::uint8_t* texel) { return texel[0] == 1 && texel[1] == 1 && texel[2] == 1; }

// The coded scanlines of an image, one after the other.

/// The coding of a scanline, which each scanline of a file states. `flat` is the old form without a repeat.
enum class HdrCoding { flat, old_rle, new_rle };

/// Reads scanlines through its own handle and buffer. Not for two threads at once.
///
/// A scanline is either four runs of bytes, one per component, after the bytes 2, 2 and its length (the "new" form, of
/// lengths from 8 to 32767), or texels of four bytes each, among which (1, 1, 1, n) means "the last texel, n times
/// more", and the next such one right after it "256 n times more", and so on (the "old" form). A new-looking start
/// whose length has its highest bit set is an old texel. (Radiance's `color.c`: freadcolrs, oldreadcolrs.)
///
/// Two inputs are refused that Radiance reads silently, or past the end of its memory: repeats that leave the scanline,
/// and a repeat before any texel.
class HdrScanlines {
 public:
  /// Opens a file with `count` scanlines of `length` texels.
  HdrScanlines(const FileInput& input, int length, int count)
      : file_(open_file(input)), length_(length), count_(count), buffer_(kBufferBytes) {}

  /// Returns the bytes of one object.
  [[nodiscard]] static std::uint64_t memory_bytes() noexcept {
    constexpr std::uint64_t kOfStream = std::uint64_t{16} << 10U;
    return kBufferBytes + kOfStream;
  }

  /// Makes `scanline`, whose code starts at `position` in the file, the next one.
  void seek(int scanline, std::uint64_t position) {
    scanline_ = scanline;
    if (position >= buffer_position_ && position <= buffer_position_ + filled_) {
      cursor_ = static_cast<std::size_t>(position - buffer_position_);
    } else {
      buffer_position_ = position;
      cursor_ = filled_ = 0;
    }
  }

  [[nodiscard]] int scanline() const noexcept { return scanline_; }

  /// Returns the offset of the next scanline.
  [[nodiscard]] std::uint64_t position() const noexcept { return buffer_position_ + cursor_; }

  /// Decodes the next scanline to four planes of `length` bytes: the components' mantissas and the exponents.
  /// Throws `Error`: corrupt_file naming scanline and byte, file_access.
  HdrCoding decode(std::uint8_t* planes) { return pass(planes); }

  /// Skips the next scanline. Throws the errors of `decode`.
  HdrCoding skip() { return pass(nullptr); }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw platform::file_error(ErrorCode::corrupt_file, file_.path(),
                               "scanline " + std::to_string(scanline_) + " of " + std::to_string(count_) +
                                   ", at byte " + std::to_string(position()) + ": " + what +
                                   "; fetch or export the file again");
  }

  // Returns the next `count` bytes, few against the buffer, contiguously.
  const std::uint8_t* peek(std::size_t count) {
    if (filled_ - cursor_ < count) {
      std::memmove(buffer_.data(), buffer_.data() + cursor_, filled_ - cursor_);
      buffer_position_ += cursor_;
      filled_ -= cursor_;
      cursor_ = 0;
      file_.seek(buffer_position_ + filled_);
      const auto more = static_cast<std::size_t>(std::min<std::uint64_t>(file_.remaining(), kBufferBytes - filled_));
      file_.read(buffer_.data() + filled_, more);
      filled_ += more;
      if (filled_ < count) {
        fail("the file ends, at " + std::to_string(file_.size()) + " bytes");
      }
    }
    return buffer_.data() + cursor_;
  }

  const std::uint8_t* take(std::size_t count) {
    const std::uint8_t* bytes = peek(count);
    cursor_ += count;
    return bytes;
  }

  HdrCoding pass(std::uint8_t* planes) {
    HdrCoding coding = HdrCoding::new_rle;
    const std::uint8_t* start = peek(4);
    const bool can_be_new = length_ >= kShortestNewForm && length_ <= kLongestNewForm;
    if (can_be_new && start[0] == 2 && start[1] == 2 && start[2] < 128) {
      const int stated = start[2] * 256 + start[3];
      if (stated != length_) {
        fail("it says that it has " + std::to_string(stated) + " texels, and must have " + std::to_string(length_));
      }
      take(4);
      for (std::size_t component = 0; component < 4; ++component) {
        pass_component(planes == nullptr ? nullptr : planes + component * static_cast<std::size_t>(length_));
      }
    } else {
      coding = pass_texels(planes);
    }
    ++scanline_;
    return coding;
  }

  // Codes above 128 repeat the byte that follows (code - 128) times; other codes are followed by that many bytes.
  void pass_component(std::uint8_t* plane) {
    const auto length = static_cast<std::size_t>(length_);
    for (std::size_t done = 0; done < length;) {
      const std::size_t code = *take(1);
      const bool repeats = code > 128;
      const std::size_t count = repeats ? code - 128 : code;
      if (count > length - done) {
        fail("a run of " + std::to_string(count) + " values where " + std::to_string(length - done) + " of " +
             std::to_string(length) + " are left");
      }
      const std::uint8_t* bytes = take(repeats ? 1 : count);
      if (plane != nullptr) {
        repeats ? std::memset(plane + done, *bytes, count) : std::memcpy(plane + done, bytes, count);
      }
      done += count;
    }
  }

  HdrCoding pass_texels(std::uint8_t* planes) {
    const auto length = static_cast<std::size_t>(length_);
    HdrCoding coding = HdrCoding::flat;
    std::array<std::uint8_t, 4> last{};
    unsigned shift = 0;
    for (std::size_t done = 0; done < length;) {
      const std::uint8_t* texel = take(4);
      std::size_t count = 1;
      if (is_repeat(texel)) {
        coding = HdrCoding::old_rle;
        count = std::size_t{texel[3]} << shift;
        shift = std::min(shift + kShiftStep, kLargestShift);
        if (done == 0) {
          fail("it starts with a repeat, but there is no texel to repeat");
        }
        if (count > length - done) {
          fail("a texel is repeated " + std::to_string(count) + " times where " + std::to_string(length - done) +
               " of " + std::to_string(length) + " are left");
        }
      } else {
        shift = 0;
        std::copy_n(texel, 4, last.begin());
      }
      if (planes != nullptr && count == 1) {
        for (std::size_t component = 0; component < 4; ++component) {
          planes[component * length + done] = last[component];
        }
      } else if (planes != nullptr) {
        for (std::size_t component = 0; component < 4; ++component) {
          std::memset(planes + component * length + done, last[component], count);
        }
      }
      done += count;
    }
    return coding;
  }

  platform::ByteFile file_;
  int length_;
  int count_;
  int scanline_ = 0;
  std::vector<std::uint8_t> buffer_;
  std::uint64_t buffer_position_ = 0;  // file offset of the buffer's first byte
  std::size_t cursor_ = 0;             // offset in the buffer
  std::size_t filled_ = 0;
};

// The offsets of an image's scanlines.

// Scanlines that are found before they are published: other threads wait for the lock.
constexpr std::size_t kBatch = 32;

/// The offset of each scanline. The file has no table of them: a scanline's start follows only from the codes of all
/// before it. The index skips over the codes as far as requested, and stores the offsets: 8 bytes per scanline.
///
/// For any number of threads at once. One of them searches for new offsets; the others get known ones without waiting
/// for it.
class HdrScanlineIndex {
 public:
  HdrScanlineIndex(const FileInput& input, int length, int count, std::uint64_t first_byte)
      : count_(count), positions_{first_byte}, scanner_(input, length, count) {
    scanner_.seek(0, first_byte);
  }

  [[nodiscard]] static std::uint64_t memory_bytes(int count) noexcept {
    return HdrScanlines::memory_bytes() + static_cast<std::uint64_t>(count) * sizeof(std::uint64_t);
  }

  /// Throws `Error` (corrupt_file, file_access) for the first scanline before `scanline` that cannot be skipped.
  [[nodiscard]] std::uint64_t position_of(int scanline) {
    const auto index = static_cast<std::size_t>(scanline);
    if (index >= known()) {
      scan_to(index);
    }
    const std::lock_guard lock(positions_mutex_);
    return positions_[index];
  }

 private:
  [[nodiscard]] std::size_t known() {
    const std::lock_guard lock(positions_mutex_);
    return positions_.size();
  }

  void scan_to(std::size_t scanline) {
    const std::lock_guard scanning(scanner_mutex_);
    for (std::size_t next = known(); next <= scanline;) {
      // After an error the scanner is within a scanline: it restarts at that scanline's beginning, and fails again.
      {
        const std::lock_guard lock(positions_mutex_);
        scanner_.seek(static_cast<int>(next) - 1, positions_.back());
      }
      std::array<std::uint64_t, kBatch> found{};
      const std::size_t wanted = std::min(kBatch, scanline + 1 - next);
      std::size_t count = 0;
      for (; count < wanted; ++count) {
        scanner_.skip();
        found[count] = scanner_.position();
      }
      const std::lock_guard lock(positions_mutex_);
      // Reserved once for all: a scanline takes at least 4 bytes of the file, whose presence was checked before.
      positions_.reserve(static_cast<std::size_t>(count_));
      positions_.insert(positions_.end(), found.begin(), found.begin() + static_cast<std::ptrdiff_t>(count));
      next += count;
    }
  }

  int count_;
  std::mutex positions_mutex_;
  std::vector<std::uint64_t> positions_;  // guarded; offsets of the scanlines from 0 on
  std::mutex scanner_mutex_;
  HdrScanlines scanner_;  // guarded; at the last known scanline
};

// An image whose scanlines are columns, held in memory as rows.

// Columns that are transposed at once: a row takes this many adjacent bytes of a component.
constexpr int kTogether = 16;

std::uint64_t coded_bytes(std::uint64_t texels) { return 4 * texels; }

/// Every row has a texel of every column, so the whole image is decoded once, at the first request for a row. For any
/// number of threads at once.
class HdrColumns {
 public:
  HdrColumns(FileInput input, HdrHeader header) : input_(std::move(input)), header_(std::move(header)) {}

  /// Returns the bytes of the image and of decoding it.
  [[nodiscard]] static std::uint64_t memory_bytes(const HdrHeader& header) noexcept {
    const auto height = static_cast<std::uint64_t>(header.height);
    return coded_bytes(static_cast<std::uint64_t>(header.width) * height) + coded_bytes(kTogether * height) +
           HdrScanlines::memory_bytes();
  }

  /// Returns row `row` of the upright image: four planes of `width` bytes. Throws the errors of `HdrScanlines::decode`.
  [[nodiscard]] const std::uint8_t* row(int row) {
    const std::lock_guard lock(mutex_);
    if (planes_ == nullptr) {
      decode();
    }
    return planes_.get() + coded_bytes(static_cast<std::uint64_t>(header_.width)) * static_cast<std::uint64_t>(row);
  }

 private:
  void decode() {
    const auto width = static_cast<std::size_t>(header_.width);
    const auto height = static_cast<std::size_t>(header_.height);
    // Not cleared: memory that receives no decoded bytes is not touched, whatever the header claims.
    auto planes = platform::make_unique_for_overwrite<std::uint8_t[]>(coded_bytes(width * height));
    std::vector<std::uint8_t> columns(coded_bytes(kTogether * height));
    HdrScanlines scanlines(input_, header_.height, header_.width);
    scanlines.seek(0, header_.first_byte);
    for (std::size_t first = 0; first < width; first += kTogether) {
      const std::size_t count = std::min<std::size_t>(kTogether, width - first);
      for (std::size_t i = 0; i < count; ++i) {
        // Stored from the left in memory, whatever their order in the file.
        const std::size_t slot = header_.right_first ? count - 1 - i : i;
        scanlines.decode(columns.data() + coded_bytes(slot * height));
      }
      const std::size_t left = header_.right_first ? width - first - count : first;
      for (std::size_t component = 0; component < 4; ++component) {
        for (std::size_t row = 0; row < height; ++row) {
          const std::size_t from = header_.bottom_first ? height - 1 - row : row;
          std::uint8_t* to = planes.get() + coded_bytes(width * row) + component * width + left;
          for (std::size_t i = 0; i < count; ++i) {
            to[i] = columns[coded_bytes(i * height) + component * height + from];
          }
        }
      }
    }
    planes_ = std::move(planes);
  }

  FileInput input_;
  HdrHeader header_;
  std::mutex mutex_;
  std::unique_ptr<std::uint8_t[]> planes_;  // guarded until it is set
};

// Conversion of an image's bytes to RGB floats.

/// A component is mantissa * 2^(exponent - 136); with exponent 0, all three are 0. Radiance's programs add a half to
/// the mantissa, to undo the mean loss by truncation. Every other reader and the writers that round do not, and neither
/// does this: a float holds each such value exactly.
class HdrTexels {
 public:
  /// Components are divided by `divisor` (the quotient is rounded to double, then to float), then multiplied by
  /// `matrix` in double, if there is one.
  HdrTexels(const glm::dvec3& divisor, const std::optional<glm::dmat3>& matrix)
      : plain_(divisor == glm::dvec3(1.0) && !matrix), matrix_(matrix) {
    constexpr int kBias = 128 + 8;
    for (int component = 0; component < 3; ++component) {
      auto& scales = scales_[static_cast<std::size_t>(component)];
      for (int exponent = 1; exponent < 256; ++exponent) {
        scales[static_cast<std::size_t>(exponent)] = std::ldexp(1.0, exponent - kBias) / divisor[component];
      }
    }
  }

  /// `planes`: four of `length` bytes, mantissas and exponents. Texels are written to `rgb` from the last to the first
  /// if `reversed`.
  void convert(const std::uint8_t* planes, int length, bool reversed, float* rgb) const noexcept {
    if (plain_ && !reversed) return hdr_kernels().floats_from_rgbe(planes, length, rgb);
    const std::uint8_t* red = planes;
    const std::uint8_t* green = red + length;
    const std::uint8_t* blue = green + length;
    const std::uint8_t* exponents = blue + length;
    const std::ptrdiff_t step = reversed ? -3 : 3;
    float* texel = reversed ? rgb + std::ptrdiff_t{3} * (length - 1) : rgb;
    for (int i = 0; i < length; ++i, texel += step) {
      const std::size_t exponent = exponents[i];
      glm::dvec3 value(red[i] * scales_[0][exponent], green[i] * scales_[1][exponent], blue[i] * scales_[2][exponent]);
      if (matrix_) {
        value = *matrix_ * value;
      }
      texel[0] = static_cast<float>(value.r);
      texel[1] = static_cast<float>(value.g);
      texel[2] = static_cast<float>(value.b);
    }
  }

 private:
  bool plain_;                                       // values are used as stored
  std::array<std::array<double, 256>, 3> scales_{};  // per component and exponent
  std::optional<glm::dmat3> matrix_;
};

// Decodes scanlines directly from the file; the index finds them when rows are requested out of order.
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

RowTraits hdr_traits(const HdrHeader& header) {
  RowTraits traits;
  if (header.columns) {
    traits.reader_bytes = HdrColumns::memory_bytes(header);
    traits.smaller_reader = "save it as -Y +X: its scanlines are columns, so that it must be decoded whole";
  } else {
    traits.reader_bytes = HdrScanlines::memory_bytes() + std::uint64_t{4} * static_cast<std::uint64_t>(header.width) +
                          HdrScanlineIndex::memory_bytes(header.height);
  }
  return traits;
}

/// Returns a function that makes readers. Their shared state has its own locks.
RowSource::Open readers_of(const FileInput& input, const HdrHeader& header, const HdrTexels& texels) {
  if (header.columns) {
    return [columns = std::make_shared<HdrColumns>(input, header), width = header.width, texels] {
      return std::make_unique<ColumnReader>(width, texels, *columns);
    };
  }
  const auto index =
      std::make_shared<HdrScanlineIndex>(input, header.scanline_length(), header.scanlines(), header.first_byte);
  return [input, header, texels, index] { return std::make_unique<ScanlineReader>(input, header, texels, *index); };
}

// Decided by the first scanline, as each states its coding. Throws if even that is missing.
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
  if (header.xyz) return rec709_from_stated(kCieXyz, "the header's FORMAT line", wanted, info);
  return header.primaries ? rec709_from_stated(*header.primaries, "the header's PRIMARIES line", wanted, info)
                          : std::nullopt;
}

// Two texels in a row take at least 8 bytes: a texel and its repeat count.
void require_plausible_size(const platform::ByteFile& file, const HdrHeader& header) {
  const std::uint64_t minimum = header.scanline_length() == 1 ? 4 : 8;
  const std::uint64_t wanted = minimum * static_cast<std::uint64_t>(header.scanlines());
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
  return std::make_unique<RowSource>(std::move(info), hdr_traits(header), readers_of(input_of(file), header, texels));
}

}  // namespace welkin::files
