// Results that were computed before, found again by the contents of what they were computed from.
//
//   welkin::ResultCache cache({.folder = "cache"});
//   welkin::BakeResult light = cache.bake(panorama, options);   // the second time, in any process, it is read
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "welkin/bake.h"
#include "welkin/bake_file.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"
#include "welkin/image.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"
#include "welkin/sky.h"

namespace WELKIN_EXPORT welkin {

// ---- Hashes of pixels, options and files
//
// XXH3-128 (https://xxhash.com, fixed since version 0.8) is not for secrets. Among a million different inputs two share
// a hash by chance once in 10^26 times; whoever can choose inputs freely can make two that do.

/// 128 bits of XXH3: equal for equal contents.
struct ContentHash {
  std::uint64_t high = 0;  ///< the upper 64 bits
  std::uint64_t low = 0;   ///< the lower 64 bits

  friend auto operator<=>(const ContentHash&, const ContentHash&) = default;

  /// 32 digits, lower case, `high` first.
  [[nodiscard]] std::string text() const;
};

/// Of `count` bytes from `bytes` on; 5 to 10 GB/s.
[[nodiscard]] ContentHash hash_bytes(const void* bytes, std::size_t count) noexcept;

/// Of several in their order.
[[nodiscard]] ContentHash combine(std::span<const ContentHash> parts) noexcept;

/// Of a picture's kind, size, format and texels: not of where rows lie in memory. Alpha counts although no result
/// depends on it; so do the signs of zeros and the bits of NaNs. Blocks of rows are hashed side by side, and their
/// hashes in order: the same for any number of threads. Bounded by memory: 5 to 10 GB/s a thread. Throws `Error`:
/// invalid_argument, cancelled.
[[nodiscard]] ContentHash hash_pixels(const EnvironmentView& environment, const Control& control = {});

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

// ---- The cache

/// Where results are kept, and how much of them.
struct CacheOptions {
  std::filesystem::path folder{};                          ///< made if it is not there; empty: nothing on disk
  std::uint64_t memory_bytes = std::uint64_t{256} << 20U;  ///< held in this process; 0: nothing
  /// In the folder. Each process goes by what it held at the last look and its own entries since: several may be above
  /// it together until one of them looks again.
  std::uint64_t disk_bytes = std::uint64_t{4} << 30U;
};

/// What has become of requests so far. A bake asks once for each of its parts, a chain once for each of its mips.
struct CacheStatistics {
  std::uint64_t memory_hits = 0;     ///< results found in memory
  std::uint64_t disk_hits = 0;       ///< results found on disk
  std::uint64_t misses = 0;          ///< results that had to be computed
  std::uint64_t damaged = 0;         ///< entries that were not what they should be; taken away, and computed anew
  std::uint64_t write_failures = 0;  ///< entries that could not be stored: the disk is full, or the folder is a file
  std::string last_failure;          ///< of those, in the system's words
  std::uint64_t memory_bytes = 0;    ///< held now
};

/// What is done to light that was projected before.
struct LightChange {
  double exposure = 1.0;  ///< factor to the light as gamma and clamp have left it; finite, >= 0
  dmat3 turn{1.0};        ///< orthogonal: what came from direction d comes from turn * d

  /// Keeps the sums of faces too, which `FaceHarmonics` holds: of a cubemap that is seen again with some faces changed,
  /// those alone are projected. No use for lat-longs, nor for a target size with the midpoint rule.
  bool keep_faces = false;
};

/// A light changed without a look at its pixels: exposure is a factor, and the coefficients are turned as by `turned`.
/// The diagnostics' total radiance follows the exposure. Throws `Error` (invalid_argument).
[[nodiscard]] Projection changed(const Projection& projection, const LightChange& change);

/// Each call gives the bits of the call of the same name without a cache; hits differ in their passes (action "reuse",
/// and "cache" says what was found where), in times (a mip that was found took 0 ms) and in a prefilter's `peak_bytes`.
/// Keys are `ContentHash`es of pixels, of options and of the library's version. What is refused without a cache is
/// refused with one.
///
/// A specular chain is kept mip by mip, for prefilters and bakes alike. Whatever chain a mip was made for, it serves
/// all in which its bits are the same: same source and policies for its pixels, same size and roughness, same method,
/// and
/// - copied (roughness below 0.001), narrow and reference mips: nothing else;
/// - spectral ones: same error bounds, and the same narrowest lobe among all spectral mips of the chain. It decides
///   which bright texels are taken out, and which rings a cubemap goes through.
/// So a mip can be added, removed or changed at the rough end: only what is missing is made, from the first such mip to
/// the last. What cannot be served: the spectral mips of a chain whose narrowest
/// lobe became another; and all but mip 0 where the schedule spreads roughness by the number of mips (linear,
/// filament, the default, and unreal), as every roughness changes with it. By babylon, unity or a list none does.
///
/// Entries on disk are files of their own with a checksum, which are on the disk before they get their name: a killed
/// process and a power failure leave whole entries or none. Any number of processes and threads may share a folder; a
/// damaged, cut or foreign file is never believed, no link is followed, and no memory is taken for more bytes than an
/// entry of its kind can have. Above the limit the entries that were used least recently go. Nothing that happens to
/// the folder makes a call fail, nor that there is no memory for an entry: it is not found then, or not kept.
///
/// Thread-safe. Two threads that miss the same entry at the same time both compute it. A hit costs hashing the source
/// (bounded by memory) and copying the result, from disk also reading and checking it: far less than a bake, a
/// prefilter or sky tables. A projection of pixels in memory is about as fast as their hash: there it is files, many
/// bands and faces that are worth keeping. A miss costs writing the entries besides, and of a file reading it twice
/// more for its hash. Memory beside the call's own: the largest entry twice, and of a chain of which a part was found
/// that part.
class ResultCache {
 public:
  /// Opens the folder, or makes it. Throws `Error`: file_access, invalid_argument.
  explicit ResultCache(const CacheOptions& options = {});
  ~ResultCache();
  /// The source can only be assigned to or destroyed afterwards.
  ResultCache(ResultCache&&) noexcept;
  /// As above.
  ResultCache& operator=(ResultCache&&) noexcept;

  /// As `project`, of light that is changed as `change` says.
  [[nodiscard]] Projection project(const EnvironmentView& source, const ProjectionOptions& options = {},
                                   const LightChange& change = {}, const Control& control = {});

  /// By the file's bytes: a hit decodes nothing. A folder of six faces is not kept.
  [[nodiscard]] Projection project_file(const std::filesystem::path& path, const ReadOptions& read_options = {},
                                        const ProjectionOptions& options = {}, const Control& control = {});

  /// As `prefilter_specular`, kept mip by mip.
  [[nodiscard]] PrefilteredSpecular prefilter_specular(const EnvironmentView& source,
                                                       const PrefilterOptions& options = {},
                                                       const Control& control = {});

  /// Part by part: background, mips of the specular cubemap, irradiance, coefficients. What was there is read, the rest
  /// is baked.
  [[nodiscard]] BakeResult bake(const EnvironmentView& view, const BakeOptions& options = {},
                                const Control& control = {});
  /// The same of a plan, which must be of these pixels.
  [[nodiscard]] BakeResult bake(const EnvironmentView& view, const Plan& plan, const Control& control = {});
  /// And of a file: what it carries is taken from it, of the rest what was made before is found by its pixels.
  [[nodiscard]] BakeResult bake(const StoredEnvironment& file, const Plan& plan, const Control& control = {});

  /// As `precompute_sky`.
  [[nodiscard]] SkyTables precompute_sky(const Atmosphere& atmosphere, const SkyTableOptions& options = {},
                                         const Control& control = {});

  /// What `keep_bytes` was given under that key: files that were made of results, say. Nothing if it is not there, or
  /// longer than `most_bytes`. The caller's key must name all that decides the bytes, its own version among it.
  [[nodiscard]] std::optional<std::vector<std::byte>> find_bytes(const ContentHash& key, std::uint64_t most_bytes);
  /// Keeps them as any entry, for as long as there is room.
  void keep_bytes(const ContentHash& key, std::span<const std::byte> bytes);

  /// Since the cache was opened.
  [[nodiscard]] CacheStatistics statistics() const;

 private:
  class WELKIN_HIDDEN Store;

  std::unique_ptr<Store> store_;
};

}  // namespace welkin
