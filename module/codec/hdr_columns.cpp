#include "codec/hdr_columns.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "codec/hdr_scanlines.h"

namespace welkin::codec {
namespace {

// Columns that are turned at once: a row takes this many bytes of a component side by side.
constexpr int kTogether = 16;

std::uint64_t coded_bytes(std::uint64_t texels) { return 4 * texels; }

}  // namespace

HdrColumns::HdrColumns(std::filesystem::path path, HdrHeader header)
    : path_(std::move(path)), header_(std::move(header)) {}

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
  auto planes = std::make_unique_for_overwrite<std::uint8_t[]>(coded_bytes(width * height));
  std::vector<std::uint8_t> columns(coded_bytes(kTogether * height));
  HdrScanlines scanlines(path_, header_.height, header_.width);
  scanlines.seek(0, header_.first_byte);
  for (std::size_t first = 0; first < width; first += kTogether) {
    const std::size_t count = std::min<std::size_t>(kTogether, width - first);
    for (std::size_t i = 0; i < count; ++i) {
      // From the left in memory, whichever way they come.
      const std::size_t place = header_.right_first ? count - 1 - i : i;
      scanlines.decode(columns.data() + coded_bytes(place * height));
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

}  // namespace welkin::codec
