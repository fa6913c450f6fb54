#include "cache/result_cache.h"

#include <array>
#include <cmath>
#include <system_error>
#include <type_traits>

#include "cache/recipe.h"
#include "jobs/tiles.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "projection/cubemap_projection.h"
#include "projection/projection_error.h"
#include "projection/sanitizer.h"
#include "sky/table_sizes.h"
#include "welkin/bake_file.h"
#include "welkin/core.h"
#include "welkin/projection.h"
#include "welkin/result_cache.h"
#include "welkin/spherical_harmonics.h"

namespace welkin {
namespace {

using cache::EntryKind;
using cache::EntryName;
using cache::kHashing;
using cache::projection_name;

void finished(const Control& control) {
  if (control.progress) control.progress(1.0);
}

bool keeps_faces(const CubemapView& cubemap, const ProjectionOptions& options, const LightTransform& change) {
  return change.keep_faces && !projection::effective_target(cubemap.size, options);
}

EntryName face_name(const ContentHash& face, const ProjectionOptions& options) {
  return {EntryKind::face_sums, cache::result_key("face sums", {face, cache::hash_options(options)})};
}

/// Projects from the sums of faces, of which `found_faces` were in the store.
Projection project_by_faces(cache::ResultStore& store, const CubemapView& cubemap,
                            const std::array<ContentHash, 6>& hashes, const ProjectionOptions& options,
                            std::size_t& found_faces, const Control& control) {
  FaceHarmonics faces(cubemap.size, options);
  ProjectionOptions effective = options;
  effective.target_size = projection::effective_target(cubemap.size, options);
  const std::size_t tiles = projection::tiles_of_face(cubemap.size, effective);
  const auto decode = [&](cache::ByteSpan bytes) { return cache::decode_face_sums(bytes, options.bands, tiles); };
  std::vector<int> missing;
  for (int face = 0; face < 6; ++face) {
    const EntryName name = face_name(hashes[static_cast<std::size_t>(face)], options);
    if (auto found = store.find(name, cache::face_sums_bytes(options.bands, tiles), decode)) {
      faces.set_face(face, std::move(found->value));
    } else {
      missing.push_back(face);
    }
  }
  update_faces(faces, cubemap, missing, control);
  for (const int face : missing) {
    store.store(face_name(hashes[static_cast<std::size_t>(face)], options),
                [&] { return cache::encode(*faces.face(face)); });
  }
  found_faces = 6 - missing.size();
  return combine(faces);
}

/// Returns whether a file still has the hashed bytes. If not, what was made of them is sound all the same.
bool is_still(const std::filesystem::path& path, const ContentHash& bytes) {
  try {
    return hash_file(path) == bytes;
  } catch (const Error&) {
    return false;
  }
}

void check(const LightTransform& change) {
  if (!(change.exposure >= 0.0) || !std::isfinite(change.exposure)) {
    throw Error(ErrorCode::invalid_argument,
                "exposure is " + platform::number_text(change.exposure) + "; it must be a finite factor of at least 0");
  }
  // Throws unless it is a rotation.
  static_cast<void>(rotate(SphericalHarmonics(1), change.rotation));
}

}  // namespace

Projection changed(const Projection& projection, const LightTransform& change) {
  const platform::FloatingPointScope floating_point;
  check(change);
  Projection result = projection;
  if (change.exposure != 1.0) {
    result.radiance = scale(result.radiance, glm::dvec3(change.exposure));
    result.diagnostics.total_radiance *= change.exposure;
    result.diagnostics.total_radiance_before_clamp *= change.exposure;
    result.diagnostics.passes.push_back({"exposure", PassAction::run, "scales the coefficients"});
  }
  if (change.rotation != dmat3(1.0)) {
    result.radiance = rotate(result.radiance, change.rotation);
    result.diagnostics.passes.push_back({"rotation", PassAction::run, "rotates the coefficients"});
  }
  return result;
}

ResultCache::ResultCache(const CacheOptions& options) {
  const platform::FloatingPointScope floating_point;
  store_ = std::make_unique<Store>(options);
}
ResultCache::~ResultCache() = default;
ResultCache::ResultCache(ResultCache&&) noexcept = default;
ResultCache& ResultCache::operator=(ResultCache&&) noexcept = default;

CacheStatistics ResultCache::statistics() const { return store_->statistics(); }

Projection ResultCache::project(const EnvironmentView& source, const ProjectionOptions& options,
                                const LightTransform& change, const Control& control) {
  const platform::FloatingPointScope floating_point;
  projection::check_options(options);
  check(change);
  const Control hashing = jobs::part_of(control, 0.0, kHashing);
  const bool by_faces = source.kind() == EnvironmentKind::cubemap && keeps_faces(source.cubemap(), options, change);
  std::array<ContentHash, 6> faces{};
  if (by_faces) faces = cache::hash_faces(source.cubemap(), hashing);
  const ContentHash pixels = by_faces ? combine(faces) : hash_pixels(source, hashing);
  const EntryName name = projection_name(pixels, options);
  if (auto found = cache::find_projection(*store_, name, options.bands)) {
    finished(control);
    return changed(*found, change);
  }
  const Control rest = jobs::part_of(control, kHashing, 1.0);
  std::size_t found_faces = 0;
  Projection projection = by_faces ? project_by_faces(*store_, source.cubemap(), faces, options, found_faces, rest)
                                   : welkin::project(source, options, rest);
  store_->store(name, [&] { return cache::encode(projection); });
  if (found_faces > 0) {
    std::vector<PassRecord>& passes = projection.diagnostics.passes;
    const std::string words = std::to_string(found_faces) + " of 6 faces were projected before";
    passes.insert(passes.begin(), {"faces", PassAction::reuse, words});
  }
  return changed(projection, change);
}

Projection ResultCache::project_file(const std::filesystem::path& path, const ReadOptions& read_options,
                                     const ProjectionOptions& options, const Control& control) {
  const platform::FloatingPointScope floating_point;
  projection::check_options(options);
  std::error_code none;
  const bool whole = std::filesystem::is_regular_file(path, none) &&
                     inspect_environment(path, read_options).layout != Layout::six_files;
  if (!whole) return welkin::project_file(path, read_options, options, control);
  const ContentHash bytes = hash_file(path, {control.stop, {}});
  // The name decides the format of some files, and the face of a cubemap. The limit decides whether one is refused.
  const std::string ending = platform::utf8(path.extension());
  const std::uint64_t limit = read_options.memory_limit_bytes;
  const EntryName name{
      EntryKind::projection,
      cache::result_key("project file",
                        {bytes, hash_bytes(ending.data(), ending.size()), hash_bytes(&limit, sizeof limit),
                         cache::hash_options(read_options), cache::hash_options(options)})};
  if (auto found = cache::find_projection(*store_, name, options.bands)) {
    finished(control);
    return std::move(*found);
  }
  Projection projection = welkin::project_file(path, read_options, options, control);
  if (is_still(path, bytes)) store_->store(name, [&] { return cache::encode(projection); });
  return projection;
}

namespace {

// An entry of sky tables is a file of sky tables.

cache::Bytes encode_sky(const SkyTables& tables) {
  std::vector<std::byte> file;
  save_sky_tables(tables, {file, "sky tables"});
  const auto* const first = reinterpret_cast<const std::uint8_t*>(file.data());
  return {first, first + file.size()};
}

/// Decodes tables, with the caller's atmosphere and options.
std::optional<SkyTables> decode_sky(cache::ByteSpan entry, const Atmosphere& atmosphere,
                                    const SkyTableOptions& options) {
  try {
    SkyTables tables = load_sky_tables({std::as_bytes(entry), "sky tables"}, options.memory_limit_bytes);
    if (cache::hash_options(tables.atmosphere) != cache::hash_options(atmosphere) ||
        cache::hash_options(tables.options) != cache::hash_options(options))
      return std::nullopt;
    tables.atmosphere = atmosphere;
    tables.options = options;
    tables.passes.clear();
    return tables;
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace

SkyTables ResultCache::precompute_sky(const Atmosphere& atmosphere, const SkyTableOptions& options,
                                      const Control& control) {
  const platform::FloatingPointScope floating_point;
  const EntryName name{EntryKind::sky_tables, cache::result_key("sky tables", {cache::hash_options(atmosphere),
                                                                               cache::hash_options(options)})};
  // Checks the arguments: what is refused without a cache is refused here.
  const std::uint64_t most_bytes = sky::sky_table_bytes(atmosphere, options);
  const bool within_limit = most_bytes <= options.memory_limit_bytes;
  const auto decode = [&](cache::ByteSpan entry) { return decode_sky(entry, atmosphere, options); };
  if (auto found = within_limit ? store_->find(name, most_bytes + cache::kSmallPayload, decode) : std::nullopt) {
    cache::mark_reused(found->value.passes, found->where, found->milliseconds);
    finished(control);
    return std::move(found->value);
  }
  SkyTables tables = welkin::precompute_sky(atmosphere, options, control);
  std::string planet = std::exchange(tables.atmosphere.name, {});  // not part of the key
  store_->store(name, [&] { return encode_sky(tables); });
  tables.atmosphere.name = std::move(planet);
  return tables;
}

std::optional<std::vector<std::byte>> ResultCache::find_bytes(const ContentHash& key, std::uint64_t most_bytes) {
  const auto copy = [](cache::ByteSpan bytes) {
    const auto* const first = reinterpret_cast<const std::byte*>(bytes.data());
    return std::optional(std::vector<std::byte>(first, first + bytes.size()));
  };
  auto found = store_->find({EntryKind::bytes, cache::result_key("bytes", {key})}, most_bytes, copy);
  if (!found) return std::nullopt;
  return std::move(found->value);
}

void ResultCache::keep_bytes(const ContentHash& key, std::span<const std::byte> bytes) {
  store_->store({EntryKind::bytes, cache::result_key("bytes", {key})}, [bytes] {
    const auto* const first = reinterpret_cast<const std::uint8_t*>(bytes.data());
    return cache::Bytes(first, first + bytes.size());
  });
}

}  // namespace welkin
