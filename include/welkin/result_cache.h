// A cache of results, found by the contents of what they were computed from.
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
// XXH3-128 (https://xxhash.com, stable since version 0.8) is not cryptographic: anyone who can choose inputs freely can
// produce a collision. Among a million different inputs, the probability of an accidental one is 1e-26.

/// A 128-bit XXH3 hash: equal for equal contents.
struct ContentHash {
  std::uint64_t high = 0;  ///< the upper 64 bits
  std::uint64_t low = 0;   ///< the lower 64 bits

  friend auto operator<=>(const ContentHash&, const ContentHash&) = default;

  /// Returns 32 lower-case hexadecimal digits, `high` first.
  [[nodiscard]] std::string text() const;
};

/// Hashes `count` bytes from `bytes` on. Speed: 5 to 10 GB/s.
[[nodiscard]] ContentHash hash_bytes(const void* bytes, std::size_t count) noexcept;

/// Combines several hashes in their order.
[[nodiscard]] ContentHash combine(std::span<const ContentHash> parts) noexcept;

/// Hashes an environment's kind, size, format and texels, independently of row strides. Alpha, signs of zeros and bits
/// of NaNs count, although no result depends on them. Blocks of rows are hashed in parallel. Speed: 5 to 10 GB/s per
/// thread, limited by memory bandwidth. Throws `Error` (invalid_argument).
[[nodiscard]] ContentHash hash_pixels(const EnvironmentView& environment, const Control& control = {});

/// Hashes a file's bytes, independently of its name. Throws `Error` (file_access).
[[nodiscard]] ContentHash hash_file(const std::filesystem::path& path, const Control& control = {});

// ---- The cache

/// Location and limits of a cache.
struct CacheOptions {
  std::filesystem::path folder{};  ///< created if it does not exist; empty for no results on disk
  std::uint64_t memory_bytes = std::uint64_t{256} << 20U;  ///< limit in this process; 0 for no results in memory
  /// Limit in the folder. Each process counts what the folder held at its last scan, plus its own entries since then.
  /// Several processes may together exceed the limit until one of them scans again.
  std::uint64_t disk_bytes = std::uint64_t{4} << 30U;
};

/// Counts of requests. A bake makes one request per part, a chain one per mip.
struct CacheStatistics {
  std::uint64_t memory_hits = 0;     ///< results found in memory
  std::uint64_t disk_hits = 0;       ///< results found on disk
  std::uint64_t misses = 0;          ///< results that had to be computed
  std::uint64_t damaged = 0;         ///< damaged entries, which were removed and recomputed
  std::uint64_t write_failures = 0;  ///< entries that could not be stored, for instance because the disk was full
  std::string last_failure;          ///< the system's message for the last of those
  std::uint64_t memory_bytes = 0;    ///< bytes held now
};

/// A change of projected light.
struct LightTransform {
  double exposure = 1.0;  ///< factor of the light, after gamma and clamp; finite, at least 0
  dmat3 rotation{1.0};    ///< orthogonal: light from direction d then comes from rotation * d

  /// Also keeps the sums of each face (`FaceHarmonics`), so that a cubemap of which some faces changed is projected in
  /// those only. Has no effect for lat-longs, and for a target size with midpoint quadrature.
  bool keep_faces = false;
};

/// Changes projected light without its pixels: scales it by the exposure, and rotates coefficients as `rotate` does.
/// The diagnostics' total radiance is scaled, too. Throws `Error` (invalid_argument).
[[nodiscard]] Projection changed(const Projection& projection, const LightTransform& change);

/// Calls with a cache, in memory and on disk. Results are bit-identical to the call of the same name without a cache. A
/// result that was found differs in its passes (action "reuse"; pass "cache" states where), in times (0 ms for a mip)
/// and in a prefilter's `peak_bytes`. Keys are `ContentHash`es of pixels, options and the library's version. Arguments
/// are checked as without a cache. Thread-safe.
///
/// A specular chain is stored mip by mip, for prefilters and bakes alike. A stored mip is used in any chain in which
/// its bits are the same: same source, pixel policies, size, roughness and method, and
/// - for copied (roughness below 0.001), narrow and reference mips: nothing else;
/// - for spectral mips: the same error bounds, and the same narrowest lobe among the chain's spectral mips, which
///   decides which bright texels are extracted and through which rings a cubemap is transformed.
///
/// So if mips are added, removed or changed at the rough end, only the missing ones are computed, from the first to the
/// last of them. Spectral mips are recomputed when the narrowest lobe changes, and all except mip 0 when the number of
/// mips changes in a schedule that depends on it (linear, filament and unreal; not babylon, unity and lists).
///
/// Entries on disk are files with a checksum. They are renamed into place when complete, so a killed process or a power
/// failure leaves no partial entries. Any number of processes and threads may share a folder. Damaged, truncated and
/// foreign files are ignored, links are not followed, and sizes are checked before memory is allocated. Above the
/// limit, the least recently used entries are removed. Failures of the folder, and lack of memory for an entry, never
/// make a call fail: the entry is then not found, or not kept.
///
/// Two threads that miss the same entry at the same time both compute it. A hit costs hashing the source and copying
/// the result, from disk also reading and checking it: much less than a bake, a prefilter or sky tables. Projecting
/// pixels in memory costs about as much as hashing them, so caching projections pays for files, many bands and faces. A
/// miss also costs writing the entries, and for a file two more reads for its hash. Memory in addition: twice the
/// largest entry, and the part of a chain that was found.
class ResultCache {
 public:
  /// Opens the folder, or creates it. Throws `Error`: file_access, invalid_argument.
  explicit ResultCache(const CacheOptions& options = {});
  ~ResultCache();
  /// Moves a cache. The source can then only be assigned to or destroyed.
  ResultCache(ResultCache&&) noexcept;
  /// Moves a cache. The source can then only be assigned to or destroyed.
  ResultCache& operator=(ResultCache&&) noexcept;

  /// Projects an environment as `project` does, and applies `change`.
  [[nodiscard]] Projection project(const EnvironmentView& source, const ProjectionOptions& options = {},
                                   const LightTransform& change = {}, const Control& control = {});

  /// Projects a file as `welkin::project_file` does. The key is the hash of the file's bytes: a hit decodes nothing.
  /// Six files are projected without caching.
  [[nodiscard]] Projection project_file(const std::filesystem::path& path, const ReadOptions& read_options = {},
                                        const ProjectionOptions& options = {}, const Control& control = {});

  /// Prefilters an environment as `welkin::prefilter_specular` does.
  [[nodiscard]] PrefilteredSpecular prefilter_specular(const EnvironmentView& source,
                                                       const PrefilterOptions& options = {},
                                                       const Control& control = {});

  /// Bakes an environment. Background, mips of the specular cubemap, irradiance and coefficients are stored separately;
  /// only missing parts are computed.
  [[nodiscard]] BakeResult bake(const EnvironmentView& view, const BakeOptions& options = {},
                                const Control& control = {});
  /// Bakes according to a plan, which must be for this environment.
  [[nodiscard]] BakeResult bake(const EnvironmentView& view, const Plan& plan, const Control& control = {});
  /// Bakes a file according to its plan. Parts stored in the file are read from it; the others are found by the file's
  /// pixels, or computed.
  [[nodiscard]] BakeResult bake(const StoredEnvironment& file, const Plan& plan, const Control& control = {});

  /// Computes scattering tables as `welkin::precompute_sky` does.
  [[nodiscard]] SkyTables precompute_sky(const Atmosphere& atmosphere, const SkyTableOptions& options = {},
                                         const Control& control = {});

  /// Returns the bytes that `keep_bytes` stored under a key, for instance files made from results. Returns nothing if
  /// there are none, or more than `most_bytes`. The key must identify everything that the bytes depend on, including
  /// the caller's version.
  [[nodiscard]] std::optional<std::vector<std::byte>> find_bytes(const ContentHash& key, std::uint64_t most_bytes);
  /// Stores bytes under a key, subject to the limits like any entry.
  void keep_bytes(const ContentHash& key, std::span<const std::byte> bytes);

  /// Returns counts since the cache was opened.
  [[nodiscard]] CacheStatistics statistics() const;

 private:
  class WELKIN_HIDDEN Store;

  std::unique_ptr<Store> store_;
};

}  // namespace welkin
