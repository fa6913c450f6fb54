// Where each scanline of a Radiance picture starts.
#pragma once

#include <mutex>
#include <vector>

#include "codec/hdr_scanlines.h"

namespace welkin::codec {

/// The file has no such table, and where a scanline starts is known only from the codes of all before it. This finds
/// as many as are asked for, by passing over the codes, and remembers them: 8 bytes a scanline.
///
/// For any number of threads at once. One of them looks for new places; the others get those that are known without
/// waiting for it.
class HdrScanlineIndex {
 public:
  HdrScanlineIndex(const std::filesystem::path& path, int length, int count, std::uint64_t first_byte);

  /// Throws `Error` (corrupt_file, file_access) for the first scanline before `scanline` that cannot be passed over.
  [[nodiscard]] std::uint64_t position_of(int scanline);

  [[nodiscard]] static std::uint64_t memory_bytes(int count) noexcept;

 private:
  void scan_to(std::size_t scanline);
  [[nodiscard]] std::size_t known();

  int count_;
  std::mutex positions_mutex_;
  std::vector<std::uint64_t> positions_;  // guarded; of the scanlines from 0 on
  std::mutex scanner_mutex_;
  HdrScanlines scanner_;  // guarded; stands at the last known scanline
};

}  // namespace welkin::codec
