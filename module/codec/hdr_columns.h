// A Radiance picture whose scanlines are columns, held in memory as rows.
#pragma once

#include <memory>
#include <mutex>

#include "codec/hdr_header.h"

namespace welkin::codec {

/// Every row has a texel of every column, so the whole picture is decoded, once, when the first row is asked for.
/// For any number of threads at once.
class HdrColumns {
 public:
  HdrColumns(std::filesystem::path path, HdrHeader header);

  /// Row `row` of the upright picture: four planes of `width` bytes. Throws as `HdrScanlines::decode`.
  [[nodiscard]] const std::uint8_t* row(int row);

  /// What all of it takes, in bytes: the picture and what decoding needs.
  [[nodiscard]] static std::uint64_t memory_bytes(const HdrHeader& header) noexcept;

 private:
  void decode();

  std::filesystem::path path_;
  HdrHeader header_;
  std::mutex mutex_;
  std::unique_ptr<std::uint8_t[]> planes_;  // guarded until it is there
};

}  // namespace welkin::codec
