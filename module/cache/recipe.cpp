// Which fields of the options a result depends on. Each struct is taken apart by a structured binding: a field that is
// added and not thought of here does not compile.
#include "cache/recipe.h"

#include "cache/payloads.h"
#include "welkin/content_hash.h"

namespace welkin {
namespace {

using cache::ByteWriter;

class OptionWriter {
 public:
  explicit OptionWriter(const char* kind) { writer_.put(kind); }

  template <class... Values>
  void all(const Values&... values) {
    (one(values), ...);
  }

  [[nodiscard]] ContentHash hash() const { return hash_bytes(writer_.bytes().data(), writer_.bytes().size()); }

 private:
  template <class Value>
  void one(const Value& value) {
    writer_.put(value);
  }
  template <class Value>
  void one(const std::optional<Value>& value) {
    writer_.put(value.has_value());
    if (value) one(*value);
  }
  void one(const ContentHash& hash) {
    writer_.put(hash.high);
    writer_.put(hash.low);
  }
  void one(const RadianceClamp& clamp) {
    const auto& [maximum, preserve_colour] = clamp;
    all(maximum, preserve_colour);
  }
  void one(const DensityLayer& layer) {
    const auto& [thickness, exponential, scale, linear, constant] = layer;
    all(thickness, exponential, scale, linear, constant);
  }
  void one(const Constituent& matter) {
    const auto& [density, scattering, absorption] = matter;
    list(density);
    all(scattering, absorption);
  }
  void one(const std::vector<Constituent>& matters) { list(matters); }

  template <class Value>
  void list(const std::vector<Value>& values) {
    writer_.put(values.size());
    for (const Value& value : values) one(value);
  }

  ByteWriter writer_;
};

}  // namespace

ContentHash hash_options(const ProjectionOptions& options) {
  const auto& [bands, quadrature, target_size, clamp, gamma, nan, infinity, negative] = options;
  OptionWriter writer("projection");
  writer.all(bands, quadrature, target_size, clamp, gamma, nan, infinity, negative);
  return writer.hash();
}

ContentHash cache::pixel_key(const ProjectionOptions& options) {
  ProjectionOptions used = options;
  used.bands = 1;
  used.quadrature = Quadrature::exact;
  used.target_size = 0;
  return hash_options(used);
}

ContentHash hash_options(const PrefilterOptions& options) {
  const auto& [size, mips, roughness, sharp, rough, method, rms_error, maximum_error, samples, pixels] = options;
  OptionWriter writer("prefilter");
  writer.all(size, mips, roughness, sharp, rough, method, rms_error, maximum_error, samples, cache::pixel_key(pixels));
  return writer.hash();
}

ContentHash hash_options(const BrdfTableOptions& options) {
  const auto& [width, height, model, sheen] = options;
  OptionWriter writer("brdf");
  writer.all(width, height, model, sheen);
  return writer.hash();
}

ContentHash hash_options(const BakeOptions& options) {
  const auto& [background_size, background, background_mips, mip_filter, specular, irradiance_size, irradiance_method,
               bands, projected_bands, total_radiance, brdf, pixels, memory_limit_bytes] = options;
  static_cast<void>(memory_limit_bytes);
  std::optional<ContentHash> prefilter;
  if (specular) {
    PrefilterOptions used = *specular;
    used.pixels = {};
    prefilter = hash_options(used);
  }
  std::optional<ContentHash> table;
  if (brdf) table = hash_options(*brdf);
  OptionWriter writer("bake");
  writer.all(background_size, background, background_mips, mip_filter, prefilter, irradiance_size, irradiance_method,
             bands, projected_bands, total_radiance, table, cache::pixel_key(pixels));
  return writer.hash();
}

ContentHash hash_options(const ReadOptions& options) {
  const auto& [layout, part, layer, level, transfer, primaries, memory_limit_bytes] = options;
  static_cast<void>(memory_limit_bytes);
  OptionWriter writer("read");
  writer.all(layout, part, layer, level, transfer, primaries);
  return writer.hash();
}

ContentHash hash_options(const SkyTableOptions& options) {
  const auto& [layout, heights, view_zeniths, sun_zeniths, sun_angles, transmittance_heights, transmittance_zeniths,
               irradiance_heights, irradiance_sun_zeniths, lowest_sun_degrees, orders, until_change, colour,
               memory_limit_bytes] = options;
  static_cast<void>(memory_limit_bytes);
  OptionWriter writer("sky tables");
  writer.all(layout, heights, view_zeniths, sun_zeniths, sun_angles, transmittance_heights, transmittance_zeniths,
             irradiance_heights, irradiance_sun_zeniths, lowest_sun_degrees, orders, until_change, colour);
  return writer.hash();
}

ContentHash hash_options(const Atmosphere& atmosphere) {
  const auto& [name, wavelengths, bottom_radius, top_radius, rayleigh, aerosol, aerosol_phase, aerosol_asymmetry,
               absorbers, ground_albedo, solar_irradiance, sun_angular_radius] = atmosphere;
  static_cast<void>(name);
  OptionWriter writer("atmosphere");
  writer.all(wavelengths, bottom_radius, top_radius, rayleigh, aerosol, aerosol_phase, aerosol_asymmetry, absorbers,
             ground_albedo, solar_irradiance, sun_angular_radius);
  return writer.hash();
}

}  // namespace welkin
