// What passes over the pixels have in common.
#pragma once

#include <glm/vec3.hpp>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cache/entry_store.h"
#include "cache/payloads.h"
#include "projection/sanitized_pixels.h"
#include "welkin/content_hash.h"
#include "welkin/version.h"

namespace welkin::cache {

/// Of clamp, gamma and policies alone.
[[nodiscard]] ContentHash pixel_key(const ProjectionOptions& options);

// The name under which a result is kept.

/// The key of a result of this version. `what`: the call. Raise the number with every change of results' bits.
[[nodiscard]] inline ContentHash result_key(const std::string& what, std::initializer_list<ContentHash> parts) {
  const std::string call = what + " " WELKIN_VERSION_STRING " 1";
  std::vector<ContentHash> all{hash_bytes(call.data(), call.size())};
  all.insert(all.end(), parts);
  return combine(all);
}

/// Of values in their order.
template <class... Values>
[[nodiscard]] ContentHash hash_of(const Values&... values) {
  ByteWriter writer;
  (writer.put(values), ...);
  return hash_bytes(writer.bytes().data(), writer.bytes().size());
}

// What sanitizing a picture's pixels came to, kept so that what was made of them can be described without them.

struct SanitizedPixels {
  ProjectionDiagnostics diagnostics;  ///< its total radiances are not filled in
  glm::dvec3 clamped_radiance{};      ///< that the clamp took away
};

[[nodiscard]] inline EntryName sanitized_name(const ContentHash& source, const ProjectionOptions& options) {
  return {EntryKind::projection, result_key("cleaned pixels", {source, pixel_key(options)})};
}

/// Store: `ResultCache::Store`. The entry is a projection's, whose total radiance before clamping is what the clamp
/// took away.
template <class Store>
[[nodiscard]] std::optional<SanitizedPixels> find_sanitized(Store& store, const EntryName& name) {
  constexpr int bands = 1;
  auto found = store.find(name, [](ByteSpan bytes) { return decode_projection(bytes, bands); });
  if (!found) return std::nullopt;
  SanitizedPixels sanitized{std::move(found->value.diagnostics), {}};
  std::swap(sanitized.diagnostics.total_radiance_before_clamp, sanitized.clamped_radiance);
  return sanitized;
}

template <class Store>
SanitizedPixels store_sanitized(Store& store, const EntryName& name, const projection::SanitizedSource& source) {
  Projection entry{SphericalHarmonics(1), source.diagnostics()};
  entry.diagnostics.total_radiance_before_clamp = source.clamped_radiance();
  store.store(name, encode(entry));
  return {source.diagnostics(), source.clamped_radiance()};
}

}  // namespace welkin::cache
