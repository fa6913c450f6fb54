// KTX2's levels, packed by zlib or Zstandard.
#pragma once

#include <cstdint>
#include <filesystem>
#include <stop_token>
#include <vector>

#include "welkin/texture_file.h"

namespace welkin::files {

/// Not for `none`. A megabyte at a time, and `stop` is looked at before each. Throws `Error` (cancelled),
/// `std::bad_alloc`.
[[nodiscard]] std::vector<std::uint8_t> pack(Supercompression supercompression, const std::vector<std::uint8_t>& bytes,
                                             const std::stop_token& stop = {});

/// Fills `bytes`, whose size is what must come out; nothing is written or allocated beyond it. `path` is for messages.
/// `stop` is looked at before each megabyte that zlib unpacks, and before all that Zstandard does, which is some ten
/// times as fast. Throws `Error` (corrupt_file, cancelled).
void unpack(Supercompression supercompression, const std::vector<std::uint8_t>& packed,
            const std::filesystem::path& path, std::vector<std::uint8_t>& bytes, const std::stop_token& stop = {});

/// The most bytes that so many packed ones can stand for.
[[nodiscard]] std::uint64_t most_unpacked(Supercompression supercompression, std::uint64_t packed_bytes) noexcept;

}  // namespace welkin::files
