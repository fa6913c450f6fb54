// What cleaning a picture's pixels came to, kept so that what was made of them can be described without them.
#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <utility>

#include "cache/entry_format.h"
#include "cache/payloads.h"
#include "cache/pixel_key.h"
#include "cache/result_key.h"
#include "specular/clean_source.h"

namespace welkin::cache {

struct CleanedPixels {
  ProjectionDiagnostics diagnostics;  ///< its fluxes are not filled in
  glm::dvec3 clamped_flux{};          ///< that the clamp took away
};

[[nodiscard]] inline EntryName cleaned_name(const ContentHash& source, const ProjectionOptions& options) {
  return {EntryKind::projection, result_key("cleaned pixels", {source, pixel_key(options)})};
}

/// Store: `ResultCache::Store`. The entry is a projection's, whose flux before clamping is what the clamp took away.
template <class Store>
[[nodiscard]] std::optional<CleanedPixels> find_cleaned(Store& store, const EntryName& name) {
  constexpr int bands = 1;
  auto found = store.find(name, [](ByteSpan bytes) { return decode_projection(bytes, bands); });
  if (!found) return std::nullopt;
  CleanedPixels cleaned{std::move(found->value.diagnostics), {}};
  std::swap(cleaned.diagnostics.flux_before_clamp, cleaned.clamped_flux);
  return cleaned;
}

template <class Store>
CleanedPixels store_cleaned(Store& store, const EntryName& name, const specular::CleanSource& source) {
  Projection entry{SphericalHarmonics(1), source.diagnostics()};
  entry.diagnostics.flux_before_clamp = source.clamped_flux();
  store.store(name, encode(entry));
  return {source.diagnostics(), source.clamped_flux()};
}

}  // namespace welkin::cache
