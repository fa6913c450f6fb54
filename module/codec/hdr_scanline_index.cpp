#include "codec/hdr_scanline_index.h"

#include <algorithm>
#include <array>

namespace welkin::codec {
namespace {

// Scanlines that are found before they are made known: the lock is for others to wait at.
constexpr std::size_t kBatch = 32;

}  // namespace

HdrScanlineIndex::HdrScanlineIndex(const std::filesystem::path& path, int length, int count, std::uint64_t first_byte)
    : count_(count), positions_{first_byte}, scanner_(path, length, count) {
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

}  // namespace welkin::codec
