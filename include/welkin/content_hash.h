// What pixels and options are, in 128 bits: the name under which a result is found again.
//
// XXH3-128 (https://xxhash.com, fixed since version 0.8): not for secrets. Two different inputs share a hash by chance
// once in 10^26 results for a million of them; whoever can choose inputs freely can make two that do.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "welkin/bake.h"
#include "welkin/control.h"
#include "welkin/environment_file.h"
#include "welkin/export.h"
#include "welkin/image_view.h"
#include "welkin/sky_tables.h"

namespace WELKIN_EXPORT welkin {

/// 128 bits of XXH3: equal for equal contents.
struct ContentHash {
  std::uint64_t high = 0;  ///< the upper 64 bits
  std::uint64_t low = 0;   ///< the lower 64 bits

  friend auto operator<=>(const ContentHash&, const ContentHash&) = default;

  /// 32 digits, lower case, `high` first.
  [[nodiscard]] std::string text() const;
};

[[nodiscard]] ContentHash hash_bytes(const void* bytes, std::size_t count) noexcept;

/// Of several in their order.
[[nodiscard]] ContentHash combine(std::span<const ContentHash> parts) noexcept;

/// Of a picture's kind, size, format and texels: not of where rows lie in memory. Alpha counts although no result
/// depends on it; so do the signs of zeros and the bits of NaNs. Blocks of rows are hashed side by side, and their
/// hashes in order: the same for any number of threads. Bounded by memory: 5 to 10 GB/s a thread. Throws `Error`:
/// invalid_argument, cancelled.
[[nodiscard]] ContentHash hash_pixels(const CubemapView& cubemap, const Control& control = {});
[[nodiscard]] ContentHash hash_pixels(const LatLongView& lat_long, const Control& control = {});

/// Of each face by itself, whichever it is. Throws likewise.
[[nodiscard]] std::array<ContentHash, 6> hash_faces(const CubemapView& cubemap, const Control& control = {});
/// What `hash_pixels` says of a cubemap with these faces.
[[nodiscard]] ContentHash hash_of_faces(const std::array<ContentHash, 6>& faces) noexcept;

/// Of a file's bytes, whatever its name. Throws `Error`: file_access, cancelled.
[[nodiscard]] ContentHash hash_file(const std::filesystem::path& path, const Control& control = {});

/// Of every field that a result depends on. Left out are `memory_limit_bytes`, the atmosphere's name, and of the
/// `pixels` of a bake or a prefilter what is not used there.
[[nodiscard]] ContentHash hash_options(const ProjectionOptions& options);
[[nodiscard]] ContentHash hash_options(const PrefilterOptions& options);
[[nodiscard]] ContentHash hash_options(const BrdfTableOptions& options);
[[nodiscard]] ContentHash hash_options(const BakeOptions& options);
[[nodiscard]] ContentHash hash_options(const ReadOptions& options);
[[nodiscard]] ContentHash hash_options(const SkyTableOptions& options);
[[nodiscard]] ContentHash hash_options(const Atmosphere& atmosphere);

}  // namespace welkin
