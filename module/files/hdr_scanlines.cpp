#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <utility>
#include <vector>

#include "files/hdr.h"
#include "files/hdr_kernels.h"
#include "platform/standard_library.h"

namespace welkin::files {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{64} << 10U;
constexpr int kShortestNewForm = 8;
constexpr int kLongestNewForm = 0x7fff;

// Repeats of a repeat shift their counts by this much more each time; beyond three of them any count but 0 is
// longer than the longest scanline.
constexpr unsigned kShiftStep = 8;
constexpr unsigned kLargestShift = 24;

bool is_repeat(const std::uint8_t* texel) { return texel[0] == 1 && texel[1] == 1 && texel[2] == 1; }

}  // namespace

HdrScanlines::HdrScanlines(const FileInput& input, int length, int count)
    : file_(open_file(input)), length_(length), count_(count), buffer_(kBufferBytes) {}

std::uint64_t HdrScanlines::memory_bytes() noexcept {
  constexpr std::uint64_t kOfStream = std::uint64_t{16} << 10U;
  return kBufferBytes + kOfStream;
}

void HdrScanlines::seek(int scanline, std::uint64_t position) {
  scanline_ = scanline;
  if (position >= buffer_position_ && position <= buffer_position_ + filled_) {
    cursor_ = static_cast<std::size_t>(position - buffer_position_);
  } else {
    buffer_position_ = position;
    cursor_ = filled_ = 0;
  }
}

void HdrScanlines::fail(const std::string& what) const {
  throw platform::file_error(ErrorCode::corrupt_file, file_.path(),
                             "scanline " + std::to_string(scanline_) + " of " + std::to_string(count_) + ", at byte " +
                                 std::to_string(position()) + ": " + what + "; fetch or export the file again");
}

// The next `count` bytes, few against the buffer, side by side.
const std::uint8_t* HdrScanlines::peek(std::size_t count) {
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

const std::uint8_t* HdrScanlines::take(std::size_t count) {
  const std::uint8_t* bytes = peek(count);
  cursor_ += count;
  return bytes;
}

HdrCoding HdrScanlines::pass(std::uint8_t* planes) {
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

// Codes above 128 repeat the byte that follows (code - 128) times, others take as many bytes as they are.
void HdrScanlines::pass_component(std::uint8_t* plane) {
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

HdrCoding HdrScanlines::pass_texels(std::uint8_t* planes) {
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
        fail("a texel is repeated " + std::to_string(count) + " times where " + std::to_string(length - done) + " of " +
             std::to_string(length) + " are left");
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

namespace {

// Scanlines that are found before they are made known: the lock is for others to wait at.
constexpr std::size_t kBatch = 32;

}  // namespace

HdrScanlineIndex::HdrScanlineIndex(const FileInput& input, int length, int count, std::uint64_t first_byte)
    : count_(count), positions_{first_byte}, scanner_(input, length, count) {
  scanner_.seek(0, first_byte);
}

std::uint64_t HdrScanlineIndex::memory_bytes(int count) noexcept {
  return HdrScanlines::memory_bytes() + static_cast<std::uint64_t>(count) * sizeof(std::uint64_t);
}

std::size_t HdrScanlineIndex::known() {
  const std::lock_guard lock(positions_mutex_);
  return positions_.size();
}

std::uint64_t HdrScanlineIndex::position_of(int scanline) {
  const auto index = static_cast<std::size_t>(scanline);
  if (index >= known()) {
    scan_to(index);
  }
  const std::lock_guard lock(positions_mutex_);
  return positions_[index];
}

void HdrScanlineIndex::scan_to(std::size_t scanline) {
  const std::lock_guard scanning(scanner_mutex_);
  for (std::size_t next = known(); next <= scanline;) {
    // After an error the scanner stands within a scanline: it starts again where that one does, and fails again.
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
    // Whole, once: a scanline takes at least 4 bytes of the file, which were found to be there before.
    positions_.reserve(static_cast<std::size_t>(count_));
    positions_.insert(positions_.end(), found.begin(), found.begin() + static_cast<std::ptrdiff_t>(count));
    next += count;
  }
}

namespace {

// Columns that are turned at once: a row takes this many bytes of a component side by side.
constexpr int kTogether = 16;

std::uint64_t coded_bytes(std::uint64_t texels) { return 4 * texels; }

}  // namespace

HdrColumns::HdrColumns(FileInput input, HdrHeader header) : input_(std::move(input)), header_(std::move(header)) {}

std::uint64_t HdrColumns::memory_bytes(const HdrHeader& header) noexcept {
  const auto height = static_cast<std::uint64_t>(header.height);
  return coded_bytes(static_cast<std::uint64_t>(header.width) * height) + coded_bytes(kTogether * height) +
         HdrScanlines::memory_bytes();
}

const std::uint8_t* HdrColumns::row(int row) {
  const std::lock_guard lock(mutex_);
  if (planes_ == nullptr) {
    decode();
  }
  return planes_.get() + coded_bytes(static_cast<std::uint64_t>(header_.width)) * static_cast<std::uint64_t>(row);
}

void HdrColumns::decode() {
  const auto width = static_cast<std::size_t>(header_.width);
  const auto height = static_cast<std::size_t>(header_.height);
  // Not cleared: memory that nothing was decoded to is not touched, whatever the header claims.
  auto planes = platform::make_unique_for_overwrite<std::uint8_t[]>(coded_bytes(width * height));
  std::vector<std::uint8_t> columns(coded_bytes(kTogether * height));
  HdrScanlines scanlines(input_, header_.height, header_.width);
  scanlines.seek(0, header_.first_byte);
  for (std::size_t first = 0; first < width; first += kTogether) {
    const std::size_t count = std::min<std::size_t>(kTogether, width - first);
    for (std::size_t i = 0; i < count; ++i) {
      // From the left in memory, whichever way they come.
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

HdrTexels::HdrTexels(const glm::dvec3& divisor, const std::optional<glm::dmat3>& matrix)
    : plain_(divisor == glm::dvec3(1.0) && !matrix), matrix_(matrix) {
  constexpr int kBias = 128 + 8;
  for (int component = 0; component < 3; ++component) {
    auto& scales = scales_[static_cast<std::size_t>(component)];
    for (int exponent = 1; exponent < 256; ++exponent) {
      scales[static_cast<std::size_t>(exponent)] = std::ldexp(1.0, exponent - kBias) / divisor[component];
    }
  }
}

void HdrTexels::convert(const std::uint8_t* planes, int length, bool reversed, float* rgb) const noexcept {
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

}  // namespace welkin::files
