#include "codec/hdr_scanlines.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace welkin::codec {
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

HdrScanlines::HdrScanlines(const std::filesystem::path& path, int length, int count)
    : file_(path), length_(length), count_(count), buffer_(kBufferBytes) {}

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
  throw file_error(ErrorCode::corrupt_file, file_.path(),
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
        fail("it starts with a repeat, and there is no texel to repeat");
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

}  // namespace welkin::codec
