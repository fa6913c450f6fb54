// KTX2's levels, packed by zlib or Zstandard.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <stop_token>
#include <string>
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

// One function a library and way; a build can leave out either library (codecs.h).

[[nodiscard]] std::vector<std::uint8_t> pack_zlib(const std::vector<std::uint8_t>& bytes, const std::stop_token& stop);
[[nodiscard]] std::vector<std::uint8_t> pack_zstd(const std::vector<std::uint8_t>& bytes, const std::stop_token& stop);
void unpack_zlib(const std::vector<std::uint8_t>& packed, const std::filesystem::path& path,
                 std::vector<std::uint8_t>& bytes, const std::stop_token& stop);
void unpack_zstd(const std::vector<std::uint8_t>& packed, const std::filesystem::path& path,
                 std::vector<std::uint8_t>& bytes);

inline constexpr std::size_t kPackedAtOnce = std::size_t{1} << 20U;  ///< bytes between two looks at the stop token

/// What a library says of a level that it cannot unpack.
[[noreturn]] void refuse_packed_level(const std::filesystem::path& path, const char* library,
                                      const std::string& reason);

/// The most bytes that so many packed ones can stand for.
[[nodiscard]] std::uint64_t most_unpacked(Supercompression supercompression, std::uint64_t packed_bytes) noexcept;

}  // namespace welkin::files
