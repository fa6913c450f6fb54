#include "cache/recipe.h"

#include <utility>

#include "bake/bake_plan.h"
#include "reflections/prefilter_plan.h"
#include "welkin/result_cache.h"

namespace welkin::cache {

void ByteWriter::raw(const void* bytes, std::size_t count) {
  if (count == 0) return;
  const auto* const first = static_cast<const std::uint8_t*>(bytes);
  bytes_.insert(bytes_.end(), first, first + count);
}

namespace {

constexpr std::size_t kSmallChange = 4096;

// One list of fields for both directions. Archive: `Saver` or `Loader`.
template <class Archive, class Vector>
void vector_3(Archive& archive, Vector& value) {
  archive(value.x, value.y, value.z);
}

template <class Archive, class Pass>
void one(Archive& archive, Pass& pass) requires std::is_same_v<std::remove_const_t<Pass>, PassRecord> {
  archive(pass.name, pass.action, pass.reason, pass.milliseconds);
}

template <class Archive, class Mip>
void one(Archive& archive, Mip& mip) requires std::is_same_v<std::remove_const_t<Mip>, MipRecord> {
  archive(mip.size, mip.roughness, mip.lobe_roughness, mip.method, mip.bands, mip.bright_texels, mip.error_estimate,
          mip.milliseconds);
  vector_3(archive, mip.mean);
}

template <class Archive, class Diagnostics>
void diagnostics(Archive& archive, Diagnostics& value) {
  archive(value.texels, value.nans_replaced, value.infinities_replaced, value.negatives_replaced, value.texels_clamped,
          value.error_estimate);
  vector_3(archive, value.total_radiance_before_clamp);
  vector_3(archive, value.total_radiance);
  archive.list(value.passes);
}

class Saver : public ByteWriter {
 public:
  explicit Saver(std::size_t expected_bytes) : ByteWriter(expected_bytes + kSmallChange) {}
  template <class... Values>
  void operator()(const Values&... values) {
    all(values...);
  }
  template <class Value>
  void list(const std::vector<Value>& values) {
    put(values.size());
    for (const Value& value : values) one(*this, value);
  }
  void counted(const std::vector<float>& values) {
    put(values.size());
    floats(values);
  }
};

class Loader : public ByteReader {
 public:
  using ByteReader::ByteReader;
  template <class... Values>
  void operator()(Values&... values) {
    (get(values), ...);
  }
  template <class Value>
  void list(std::vector<Value>& values) {
    values.resize(count(8));
    for (Value& value : values) one(*this, value);
  }
  void counted(std::vector<float>& values) {
    values.resize(count(sizeof(float)));
    floats(values);
  }
};

std::uint64_t texels(int size) { return static_cast<std::uint64_t>(size) * static_cast<std::uint64_t>(size); }

std::size_t mip_values(int size) { return static_cast<std::size_t>(18 * texels(size)); }

std::uint64_t chain_bytes(int size, int levels) { return 12 * baking::chain_texels(size, levels); }

std::size_t chain_values(const Cubemap& chain) { return chain.bytes() / sizeof(float); }

/// Loads a chain. `size` and `levels` are valid ones.
Cubemap load_chain(Loader& loader, int size, int levels, memory_resource* memory) {
  int stored_size = 0;
  int stored_levels = 0;
  loader(stored_size, stored_levels);
  // Checked before any memory is allocated for it.
  if (stored_size != size || stored_levels != levels || chain_bytes(size, levels) > loader.remaining()) {
    loader.fail();
    return {};
  }
  Cubemap chain(size, levels, memory);
  loader.floats({chain.face(0, 0), chain_values(chain)});
  return chain;
}

template <class Result>
std::optional<Result> if_complete(const Loader& loader, Result result) {
  if (!loader.complete()) return std::nullopt;
  return std::optional<Result>(std::move(result));
}

}  // namespace

std::uint64_t projection_bytes(int bands) { return 24 * texels(bands) + kSmallPayload; }
std::uint64_t mip_bytes(int size) { return 6 * 12 * texels(size) + kSmallPayload; }
std::uint64_t cubemap_bytes(int size, int levels) { return chain_bytes(size, levels) + kSmallPayload; }
std::uint64_t face_sums_bytes(int bands, std::size_t tiles) {
  constexpr std::uint64_t record = 64;
  return tiles * (24 * texels(bands) + record) + kSmallPayload;
}

Bytes encode(const Projection& projection) {
  Saver saver(24 * projection.radiance.coefficients().size());
  saver(projection.radiance.bands());
  for (const glm::dvec3& coefficient : projection.radiance.coefficients()) vector_3(saver, coefficient);
  diagnostics(saver, projection.diagnostics);
  return saver.take();
}

std::optional<Projection> decode_projection(ByteSpan bytes, int bands) {
  Loader loader(bytes);
  int stored_bands = 0;
  loader(stored_bands);
  if (stored_bands != bands) return std::nullopt;
  Projection projection{SphericalHarmonics(bands), {}};
  for (glm::dvec3& coefficient : projection.radiance.coefficients()) vector_3(loader, coefficient);
  diagnostics(loader, projection.diagnostics);
  return if_complete(loader, std::move(projection));
}

Bytes encode(const Cubemap& chain) {
  Saver saver(chain.bytes());
  saver(chain.size(), chain.levels());
  if (chain.levels() > 0) saver.floats({chain.face(0, 0), chain_values(chain)});
  return saver.take();
}

std::optional<Cubemap> decode_cubemap(ByteSpan bytes, int size, int levels, memory_resource* memory) {
  Loader loader(bytes);
  Cubemap chain = load_chain(loader, size, levels, memory);
  return if_complete(loader, std::move(chain));
}

Bytes encode(const OctahedralMap& map) {
  Saver saver(0);
  saver(map.size, map.border, map.levels.size());
  for (const std::vector<float>& level : map.levels) saver.counted(level);
  return saver.take();
}

std::optional<OctahedralMap> decode_octahedral(ByteSpan bytes, const OctahedralOptions& options) {
  Loader loader(bytes);
  OctahedralMap map;
  std::size_t levels = 0;
  loader(map.size, map.border, levels);
  if (map.size != options.size || levels != static_cast<std::size_t>(options.levels)) return std::nullopt;
  for (int level = 0; level < options.levels; ++level) {
    loader.counted(map.levels.emplace_back());
    const auto edge = static_cast<std::size_t>(map.level_size(level));
    if (map.levels.back().size() != 3 * edge * edge) return std::nullopt;
  }
  return if_complete(loader, std::move(map));
}

Bytes encode_mip(const MipRecord& mip, const float* texels, const std::vector<float>& energies) {
  const std::size_t values = mip_values(mip.size);
  Saver saver(values * sizeof(float));
  one(saver, mip);
  saver.counted(energies);
  saver.floats({texels, values});
  return saver.take();
}

std::optional<MipRecord> decode_mip(ByteSpan bytes, int size, float* texels, std::vector<float>* energies) {
  Loader loader(bytes);
  MipRecord mip;
  one(loader, mip);
  std::vector<float> stored;
  loader.counted(stored);
  mip.milliseconds = 0.0;
  const std::size_t values = mip_values(size);
  if (mip.size != size || loader.remaining() != values * sizeof(float)) return std::nullopt;
  loader.floats({texels, values});
  if (energies != nullptr && !stored.empty()) *energies = std::move(stored);
  return if_complete(loader, mip);
}

Bytes encode(const projection::FaceSums& sums) {
  Saver saver(sums.bytes());
  saver(sums.functions, sums.records.size());
  saver.raw(sums.values.data(), sums.values.size() * sizeof(double));
  for (const projection::SanitizeRecord& record : sums.records) {
    saver(record.nans, record.infinities, record.negatives, record.clamped);
    vector_3(saver, record.radiance_removed);
  }
  return saver.take();
}

std::optional<std::shared_ptr<const projection::FaceSums>> decode_face_sums(ByteSpan bytes, int bands,
                                                                            std::size_t tiles) {
  Loader loader(bytes);
  std::size_t functions = 0;
  loader(functions);
  if (functions != static_cast<std::size_t>(bands) * static_cast<std::size_t>(bands)) return std::nullopt;
  if (loader.count(3 * functions * sizeof(double)) != tiles) return std::nullopt;
  auto sums = std::make_shared<projection::FaceSums>(tiles, bands);
  loader.raw(sums->values.data(), sums->values.size() * sizeof(double));
  for (projection::SanitizeRecord& record : sums->records) {
    loader(record.nans, record.infinities, record.negatives, record.clamped);
    vector_3(loader, record.radiance_removed);
  }
  return if_complete(loader, std::shared_ptr<const projection::FaceSums>(std::move(sums)));
}

}  // namespace welkin::cache

namespace welkin {

// The fields of the options that a result depends on. Each struct is unpacked by a structured binding: a field that is
// added but not handled here does not compile.

ContentHash cache::hash_options(const ProjectionOptions& options) {
  const auto& [bands, quadrature, target_size, pixels] = options;
  const auto& [clamp, gamma, nan, infinity, negative] = pixels;
  return hash_of("projection", bands, quadrature, target_size.value_or(0), clamp, gamma, nan, infinity, negative);
}

ContentHash cache::pixel_key(const PixelPolicy& pixels) {
  return hash_options(ProjectionOptions{.bands = 1, .pixels = pixels});
}

ContentHash cache::hash_options(const PrefilterOptions& options) {
  const auto& [size, mips, roughness, lobe_roughness, lobe, spectra, method, rms_error, maximum_error, pixels] =
      options;
  const reflections::ErrorBounds bounds = reflections::bounds_of(options);
  static_cast<void>(rms_error);
  static_cast<void>(maximum_error);
  return hash_of("prefilter", size, mips.value_or(0), roughness, lobe_roughness, lobe, spectra, method, bounds.rms,
                 bounds.maximum, cache::pixel_key(pixels));
}

ContentHash cache::hash_options(const BrdfTableOptions& options) {
  const auto& [width, height, model, sheen] = options;
  return hash_of("brdf", width, height, model, sheen);
}

ContentHash cache::hash_options(const BakeOptions& options) {
  const auto& [background, specular, octahedral, irradiance, bands, total_radiance, brdf, pixels, memory_limit_bytes] =
      options;
  static_cast<void>(memory_limit_bytes);
  const auto& [background_size, background_mips, mip_filter] = background.value_or(BackgroundOptions{});
  const auto& [irradiance_size, irradiance_method, irradiance_error] = irradiance.value_or(IrradianceOptions{});
  std::optional<ContentHash> prefilter;
  if (specular) {
    PrefilterOptions used = *specular;
    used.pixels = {};
    prefilter = hash_options(used);
  }
  std::optional<ContentHash> table;
  if (brdf) table = hash_options(*brdf);
  cache::ByteWriter writer;
  writer.all("bake", background_size.value_or(0), background.has_value(), background_mips, mip_filter, prefilter,
             irradiance ? irradiance_size : 0, irradiance_method, irradiance_error, bands, total_radiance, table,
             cache::pixel_key(pixels));
  if (octahedral) {
    const auto& [size, levels, border] = *octahedral;
    writer.all(size, levels, border);
  }
  return writer.hash();
}

ContentHash cache::hash_options(const ReadOptions& options) {
  const auto& [layout, part, layer, level, element, transfer, primaries, memory_limit_bytes] = options;
  static_cast<void>(memory_limit_bytes);
  return hash_of("read", layout, part, layer, level, element, transfer, primaries);
}

ContentHash cache::hash_options(const SkyTableOptions& options) {
  const auto& [layout, heights, view_zeniths, sun_zeniths, sun_angles, transmittance_heights, transmittance_zeniths,
               irradiance_heights, irradiance_sun_zeniths, minimum_sun_elevation_degrees, orders, convergence_threshold,
               truncate_orders, colour, memory_limit_bytes] = options;
  static_cast<void>(memory_limit_bytes);
  return hash_of("sky tables", layout, heights, view_zeniths, sun_zeniths, sun_angles, transmittance_heights,
                 transmittance_zeniths, irradiance_heights, irradiance_sun_zeniths, minimum_sun_elevation_degrees,
                 orders, convergence_threshold, truncate_orders, colour);
}

ContentHash cache::hash_options(const Atmosphere& atmosphere) {
  const auto& [name, wavelengths, bottom_radius, top_radius, rayleigh, aerosol, aerosol_phase, aerosol_asymmetry,
               aerosol_asymmetries, absorbers, ground_albedo, solar_irradiance, sun_angular_radius, night] = atmosphere;
  static_cast<void>(name);
  return hash_of("atmosphere", wavelengths, bottom_radius, top_radius, rayleigh, aerosol, aerosol_phase,
                 aerosol_asymmetry, aerosol_asymmetries, absorbers, ground_albedo, solar_irradiance, sun_angular_radius,
                 night);
}

}  // namespace welkin
