// Every field of a structure of options arrives: a table of values, whose bytes are all that a structure has.
#include "c/c_calls.h"
#include "c/c_worker.h"
#include "files/c_files.h"
#include "support/catch.h"
#include "welkin/bake.h"
#include "welkin/welkin.h"

namespace welkin::test {

namespace {

template <class Options>
struct FieldValue {
  const char* name;
  std::function<void(Options&)> set;
};

/// Requires that each value changes what is read of the structure, and that the values together change every word but
/// those that align the others.
template <class Options, class Read>
void check_fields(const Options& base, const Read& read, const std::vector<FieldValue<Options>>& fields,
                  std::ptrdiff_t padding = 0) {
  constexpr std::size_t kWords = sizeof(Options) / sizeof(std::uint32_t);
  const auto words = [](const Options& options) {
    std::array<std::uint32_t, kWords> values{};
    std::memcpy(values.data(), &options, sizeof options);
    return values;
  };
  std::array<bool, kWords> named{true};  // struct_size
  for (const FieldValue<Options>& field : fields) {
    INFO(field.name);
    Options changed = base;
    field.set(changed);
    for (std::size_t k = 0; k < kWords; ++k) named[k] = named[k] || words(changed)[k] != words(base)[k];
    CHECK(!(read(&changed) == read(&base)));
  }
  CHECK(std::ranges::count(named, false) == padding);
}

constexpr double kAllBytes = 0.1;  // a double of which no word is 0

}  // namespace

TEST_CASE("C: every field of pixel policies, projections and sky tables is read", "[c_interface]") {
  using Pixels = welkin_pixel_policy;
  auto clamped = c_struct<Pixels>();
  clamped.clamp_maximum = 2.0F;
  check_fields<Pixels>(clamped, c_interface::pixel_policy,
                       {{"clamp_maximum", [](Pixels& p) { p.clamp_maximum = 0.5F; }},
                        {"clamp_preserve_colour", [](Pixels& p) { p.clamp_preserve_colour = 1; }},
                        {"gamma", [](Pixels& p) { p.gamma = 1; }},
                        {"reject_nan", [](Pixels& p) { p.reject_nan = 1; }},
                        {"reject_infinity", [](Pixels& p) { p.reject_infinity = 1; }},
                        {"negative", [](Pixels& p) { p.negative = WELKIN_NEGATIVE_REJECT; }}});
  using Projecting = welkin_projection_options;
  check_fields<Projecting>(c_struct<Projecting>(), c_interface::projection_options,
                           {{"bands", [](Projecting& p) { p.bands = 5; }},
                            {"midpoint", [](Projecting& p) { p.midpoint = 1; }},
                            {"target_size", [](Projecting& p) { p.target_size = 8; }},
                            {"pixels", [&](Projecting& p) { p.pixels = &clamped; }}});
  using Tables = welkin_sky_table_options;
  check_fields<Tables>(
      c_struct<Tables>(), c_interface::table_options,
      {{"compact", [](Tables& t) { t.compact = 1; }},
       {"heights", [](Tables& t) { t.heights = 5; }},
       {"view_zeniths", [](Tables& t) { t.view_zeniths = 6; }},
       {"sun_zeniths", [](Tables& t) { t.sun_zeniths = 5; }},
       {"sun_angles", [](Tables& t) { t.sun_angles = 5; }},
       {"transmittance_heights", [](Tables& t) { t.transmittance_heights = 5; }},
       {"transmittance_zeniths", [](Tables& t) { t.transmittance_zeniths = 5; }},
       {"irradiance_heights", [](Tables& t) { t.irradiance_heights = 5; }},
       {"irradiance_sun_zeniths", [](Tables& t) { t.irradiance_sun_zeniths = 5; }},
       {"orders", [](Tables& t) { t.orders = 5; }},
       {"linear_srgb", [](Tables& t) { t.linear_srgb = 1; }},
       {"minimum_sun_elevation_degrees", [](Tables& t) { t.minimum_sun_elevation_degrees = -kAllBytes; }},
       {"convergence_threshold", [](Tables& t) { t.convergence_threshold = kAllBytes; }},
       {"memory_limit_bytes", [](Tables& t) { t.memory_limit_bytes = (std::uint64_t{1} << 33U) + 1; }},
       {"truncate_orders", [](Tables& t) { t.truncate_orders = 1; }}},
      1);
  using Curve = welkin_sky_harmonics_options;
  check_fields<Curve>(c_struct<Curve>(), c_interface::curve_options,
                      {{"bands", [](Curve& c) { c.bands = 5; }},
                       {"zeniths", [](Curve& c) { c.zeniths = 5; }},
                       {"azimuths", [](Curve& c) { c.azimuths = 5; }},
                       {"nodes", [](Curve& c) { c.nodes = 9; }}});
}

TEST_CASE("C: every field of prefilters and bakes is read", "[c_interface]") {
  const std::array roughness{0.0, 0.5};
  const std::array other{0.0, 0.7};
  const std::array spectra{1.0, 0.5, 1.0, 0.25};
  auto clamped = c_struct<welkin_pixel_policy>();
  clamped.clamp_maximum = 2.0F;
  using Prefilter = welkin_prefilter_options;
  const auto prefilter = [](const Prefilter* options) { return c_interface::prefilter_options(options, 256, true); };
  auto named = c_struct<Prefilter>();
  named.mips = 3;
  check_fields<Prefilter>(named, prefilter,
                          {{"size", [](Prefilter& p) { p.size = 8; }},
                           {"mips", [](Prefilter& p) { p.mips = 2; }},
                           {"roughness",
                            [&](Prefilter& p) {
                              p.roughness_count = 2;
                              p.roughness = roughness.data();
                            }},
                           {"method", [](Prefilter& p) { p.method = WELKIN_PREFILTER_REFERENCE; }},
                           {"rms_error", [](Prefilter& p) { p.rms_error = kAllBytes; }},
                           {"maximum_error", [](Prefilter& p) { p.maximum_error = kAllBytes; }},
                           {"pixels", [&](Prefilter& p) { p.pixels = &clamped; }},
                           {"lobe", [](Prefilter& p) { p.lobe = WELKIN_LOBE_FAMILY_CHARLIE; }},
                           {"spectra",
                            [&](Prefilter& p) {
                              p.lobe = WELKIN_LOBE_FAMILY_SPECTRA;
                              p.mips = 2;
                              p.spectrum_bands = 2;
                              p.spectra = spectra.data();
                            }},
                           {"quality", [](Prefilter& p) { p.quality = WELKIN_QUALITY_FAST; }},
                           {"lobe_roughness",
                            [&](Prefilter& p) {
                              p.roughness_count = 2;
                              p.roughness = roughness.data();
                              p.lobe_roughness = other.data();
                            }},
                           {"schedule", [](Prefilter& p) { p.schedule = WELKIN_ROUGHNESS_UNITY; }},
                           {"fitted", [](Prefilter& p) { p.fitted = 1; }}},
                          2);
  auto specular = c_struct<Prefilter>();
  specular.size = 8;
  auto brdf = c_struct<welkin_brdf_options>();
  brdf.width = 8;
  using Bake = welkin_bake_options;
  const auto bake = [](const Bake* options) { return c_interface::bake_options(options); };
  auto with_map = c_struct<Bake>();
  with_map.octahedral_size = 64;
  check_fields<Bake>(with_map, bake,
                     {{"leave_out", [](Bake& b) { b.leave_out = WELKIN_PART_BRDF; }},
                      {"background_size", [](Bake& b) { b.background_size = 8; }},
                      {"background_without_mips", [](Bake& b) { b.background_without_mips = 1; }},
                      {"background_box_filter", [](Bake& b) { b.background_box_filter = 1; }},
                      {"irradiance_size", [](Bake& b) { b.irradiance_size = 8; }},
                      {"irradiance_method", [](Bake& b) { b.irradiance_method = WELKIN_IRRADIANCE_DIRECT; }},
                      {"bands", [](Bake& b) { b.bands = 5; }},
                      {"specular", [&](Bake& b) { b.specular = &specular; }},
                      {"brdf", [&](Bake& b) { b.brdf = &brdf; }},
                      {"pixels", [&](Bake& b) { b.pixels = &clamped; }},
                      {"memory_limit_bytes", [](Bake& b) { b.memory_limit_bytes = (std::uint64_t{1} << 32U) + 1; }},
                      {"irradiance_rms_error", [](Bake& b) { b.irradiance_rms_error = kAllBytes; }},
                      {"octahedral_size", [](Bake& b) { b.octahedral_size = 32; }},
                      {"octahedral_levels", [](Bake& b) { b.octahedral_levels = 2; }},
                      {"octahedral_border", [](Bake& b) { b.octahedral_border = 2; }},
                      {"quality", [](Bake& b) { b.quality = WELKIN_QUALITY_FAST; }}});
  using Table = welkin_brdf_options;
  const auto of_bake = [](const Table* options) {
    auto given = c_struct<Bake>();
    given.brdf = options;
    return c_interface::bake_options(&given).brdf;
  };
  check_fields<Table>(c_struct<Table>(), of_bake,
                      {{"width", [](Table& t) { t.width = 8; }},
                       {"height", [](Table& t) { t.height = 8; }},
                       {"multiple_scattering", [](Table& t) { t.multiple_scattering = 1; }},
                       {"without_sheen", [](Table& t) { t.without_sheen = 1; }}});
}

TEST_CASE("C: every field of atmospheres and constituents is read", "[c_interface]") {
  const std::array layers{100.0, 1.0, -0.1, 0.0, 0.0};
  const std::array other_layers{100.0, 0.5, -0.1, 0.0, 0.0};
  const std::array wavelengths{700.0, 600.0, 500.0, 400.0};
  const std::array numbers{0.31, 0.32, 0.33, 0.34};
  auto matter = c_struct<welkin_constituent>();
  matter.layer_count = 1;
  matter.layers = layers.data();
  using Air = welkin_atmosphere;
  auto mars = c_struct<Air>();
  mars.planet = WELKIN_PLANET_MARS;
  check_fields<Air>(mars, c_interface::atmosphere_of,
                    {{"planet", [](Air& a) { a.planet = WELKIN_PLANET_EARTH_HILLAIRE; }},
                     {"wavelengths_nm",
                      [&](Air& a) {
                        a.planet = WELKIN_PLANET_EARTH;
                        a.wavelength_count = 4;
                        a.wavelengths_nm = wavelengths.data();
                      }},
                     {"rayleigh", [&](Air& a) { a.rayleigh = &matter; }},
                     {"aerosol", [&](Air& a) { a.aerosol = &matter; }},
                     {"aerosol_optics", [&](Air& a) { a.aerosol_optics = numbers.data(); }},
                     {"aerosol_phase", [](Air& a) { a.aerosol_phase = WELKIN_PHASE_CORNETTE_SHANKS; }},
                     {"aerosol_asymmetry", [](Air& a) { a.aerosol_asymmetry = kAllBytes; }},
                     {"aerosol_asymmetries", [&](Air& a) { a.aerosol_asymmetries = numbers.data(); }},
                     {"absorbers",
                      [&](Air& a) {
                        a.absorber_count = 4;
                        std::fill(std::begin(a.absorbers), std::end(a.absorbers), &matter);
                      }},
                     {"bottom_radius_m", [](Air& a) { a.bottom_radius_m = 3e6 + kAllBytes; }},
                     {"top_radius_m", [](Air& a) { a.top_radius_m = 4e6 + kAllBytes; }},
                     {"ground_albedo", [&](Air& a) { a.ground_albedo = numbers.data(); }},
                     {"sun_irradiance", [&](Air& a) { a.sun_irradiance = numbers.data(); }},
                     {"sun_angular_radius_degrees", [](Air& a) { a.sun_angular_radius_degrees = kAllBytes; }},
                     {"night_zenith_luminance", [](Air& a) { a.night_zenith_luminance = kAllBytes; }}},
                    1);
  using Matter = welkin_constituent;
  const auto of_air = [](const Matter* constituent) {
    auto air = c_struct<Air>();
    air.rayleigh = constituent;
    return c_interface::atmosphere_of(&air).rayleigh;
  };
  check_fields<Matter>(matter, of_air,
                       {{"layer_count", [](Matter& m) { m.layer_count = 0; }},
                        {"layers", [&](Matter& m) { m.layers = other_layers.data(); }},
                        {"scattering_per_m", [&](Matter& m) { m.scattering_per_m = numbers.data(); }},
                        {"absorption_per_m", [&](Matter& m) { m.absorption_per_m = numbers.data(); }}},
                       1);  // pointers to two arrays here share their upper halves
}

TEST_CASE("C: every field of options of files and textures is read", "[c_interface]") {
  using Read = welkin_read_options;
  check_fields<Read>(c_struct<Read>(), c_interface::file_options,
                     {{"layout", [](Read& r) { r.layout = WELKIN_LAYOUT_VERTICAL_CROSS; }},
                      {"part", [](Read& r) { r.part = "beauty"; }},
                      {"layer", [](Read& r) { r.layer = "sky"; }},
                      {"transfer", [](Read& r) { r.transfer = WELKIN_TRANSFER_LINEAR; }},
                      {"primaries_as_stored", [](Read& r) { r.primaries_as_stored = 1; }},
                      {"memory_limit_bytes", [](Read& r) { r.memory_limit_bytes = (std::uint64_t{1} << 32U) + 1; }},
                      {"level", [](Read& r) { r.level = 1; }},
                      {"element", [](Read& r) { r.element = 1; }}},
                     2);  // `level` and `element` are numbers of 32 bits in fields of 64
  using Texture = welkin_texture_options;
  const auto texture = [](const Texture* options) {
    const TextureOptions read = c_interface::texture_options(options);
    return std::tuple(read.format, read.supercompression, read.bc6h_effort, read.astc_effort);
  };
  check_fields<Texture>(c_struct<Texture>(), texture,
                        {{"format", [](Texture& t) { t.format = WELKIN_TEXEL_E5B9G9R9; }},
                         {"supercompression", [](Texture& t) { t.supercompression = WELKIN_SUPERCOMPRESSION_ZSTD; }},
                         {"effort", [](Texture& t) { t.effort = WELKIN_EFFORT_SLOW; }}});
}

TEST_CASE("C: every field of options of workers and posts is read", "[c_interface]") {
  using Workers = welkin_worker_options;
  const auto worker = [](const Workers* options) {
    const WorkerOptions read = c_interface::worker_options(options);
    void* user = nullptr;  // what `enqueue` receives
    if (read.executor) read.executor->enqueue([](void*) {}, &user);
    return std::tuple(read.threads, read.thread_priority, read.name, user, read.max_jobs, read.max_bytes);
  };
  int user = 0;
  check_fields<Workers>(c_struct<Workers>(), worker,
                        {{"threads", [](Workers& w) { w.threads = 3; }},
                         {"thread_priority", [](Workers& w) { w.thread_priority = WELKIN_THREAD_PRIORITY_IDLE; }},
                         {"name", [](Workers& w) { w.name = "sky"; }},
                         {"enqueue and enqueue_user",
                          [&](Workers& w) {
                            w.enqueue = [](void* given, void (*)(void*), void* told) {
                              *static_cast<void**>(told) = given;
                            };
                            w.enqueue_user = &user;
                          }},
                         {"max_jobs", [](Workers& w) { w.max_jobs = (std::uint64_t{1} << 32U) + 1; }},
                         {"max_bytes", [](Workers& w) { w.max_bytes = (std::uint64_t{1} << 33U) + 1; }}},
                        1);
  using Post = welkin_post_options;
  const auto post = [&](const Post* options) {
    user = 0;
    const auto [priority, key, bytes] = c_interface::Posting(options).options();
    const auto& given = c_interface::Posting(options).given;
    return std::tuple(priority, std::string(key), bytes, user, given.completed, given.completed_user);
  };
  check_fields<Post>(c_struct<Post>(), post,
                     {{"priority", [](Post& p) { p.priority = WELKIN_PRIORITY_LOW; }},
                      {"key", [](Post& p) { p.key = "sun"; }},
                      {"bytes", [](Post& p) { p.bytes = (std::uint64_t{1} << 32U) + 1; }},
                      {"release and release_user",
                       [&](Post& p) {
                         p.release = [](void* count) { ++*static_cast<int*>(count); };
                         p.release_user = &user;
                       }},
                      {"completed", [](Post& p) { p.completed = [](welkin_job*, void*) {}; }},
                      {"completed_user", [&](Post& p) { p.completed_user = &user; }}});
}

TEST_CASE("C: every field of options of dynamic skies and probes is read", "[c_interface]") {
  auto tables = c_struct<welkin_sky_table_options>();
  tables.heights = 5;
  auto curve = c_struct<welkin_sky_harmonics_options>();
  curve.bands = 5;
  auto specular = c_struct<welkin_prefilter_options>();
  specular.size = 8;
  using Light = welkin_sky_light_options;
  const auto light = [](const Light* options) {
    const SkyLightOptions read = c_interface::light_options(options);
    return std::tuple(read.tables, read.curve, read.altitude_m, read.specular, read.sun_threshold_degrees,
                      read.specular_threshold_degrees, read.altitude_threshold_m, read.blend_seconds, read.priority);
  };
  check_fields<Light>(c_struct<Light>(), light,
                      {{"priority", [](Light& l) { l.priority = WELKIN_PRIORITY_HIGH; }},
                       {"tables", [&](Light& l) { l.tables = &tables; }},
                       {"curve", [&](Light& l) { l.curve = &curve; }},
                       {"specular", [&](Light& l) { l.specular = &specular; }},
                       {"without_specular", [](Light& l) { l.without_specular = 1; }},
                       {"altitude_m", [](Light& l) { l.altitude_m = kAllBytes; }},
                       {"sun_threshold_degrees", [](Light& l) { l.sun_threshold_degrees = kAllBytes; }},
                       {"specular_threshold_degrees", [](Light& l) { l.specular_threshold_degrees = kAllBytes; }},
                       {"altitude_threshold_m", [](Light& l) { l.altitude_threshold_m = kAllBytes; }},
                       {"blend_seconds", [](Light& l) { l.blend_seconds = kAllBytes; }}},
                      1);
  using Grid = welkin_probe_grid;
  auto unit = c_struct<Grid>();
  std::fill(std::begin(unit.counts), std::end(unit.counts), 2);
  std::fill(std::begin(unit.spacing), std::end(unit.spacing), 1.0);
  std::vector<FieldValue<Grid>> axes;
  for (std::size_t k = 0; k < 3; ++k) {
    axes.push_back({"counts", [k](Grid& g) { g.counts[k] = 3; }});
    axes.push_back({"origin", [k](Grid& g) { g.origin[k] = kAllBytes; }});
    axes.push_back({"spacing", [k](Grid& g) { g.spacing[k] = kAllBytes; }});
  }
  check_fields<Grid>(unit, c_interface::probe_grid, axes);
  using Probes = welkin_probe_options;
  check_fields<Probes>(c_struct<Probes>(), c_interface::probe_options,
                       {{"bands", [](Probes& p) { p.bands = 2; }},
                        {"distance_size", [](Probes& p) { p.distance_size = -1; }},
                        {"dilation_passes", [](Probes& p) { p.dilation_passes = 2; }},
                        {"environment_bands", [](Probes& p) { p.environment_bands = 2; }},
                        {"near_share", [](Probes& p) { p.near_share = 0.3; }},
                        {"valid_share", [](Probes& p) { p.valid_share = 0.3; }}},
                       1);
}

TEST_CASE("C: every field of environments and targets is read", "[c_interface]") {
  std::array<float, 6 * 8 * 8 * 4> memory{};
  const auto fill_faces = [&](auto& faces, std::size_t step) {
    for (std::size_t face = 0; face < 6; ++face) faces[face] = memory.data() + step * (face + 1);
  };
  // Pointers into one array share their upper halves (faces[0] is never null), and sizes have 32 bits in fields of 64.
  const auto check = [&]<class Picture>(Picture picture, const auto& read, std::ptrdiff_t padding) {
    picture.size = 4;
    fill_faces(picture.faces, 64);
    check_fields<Picture>(picture, read,
                          {{"format", [](Picture& p) { p.format = WELKIN_FORMAT_RGBA_F16; }},
                           {"row_stride_bytes", [](Picture& p) { p.row_stride_bytes = -64; }},
                           {"faces", [&](Picture& p) { fill_faces(p.faces, 68); }},
                           {"size, width and height",
                            [](Picture& p) {
                              p.size = 0;
                              p.width = 8;
                              p.height = 4;
                              std::fill(std::begin(p.faces) + 1, std::end(p.faces), nullptr);
                            }}},
                          padding);
  };
  check(
      c_struct<welkin_environment>(), [](const welkin_environment* e) { return c_interface::environment_view(e); }, 2);
  const auto target = [](const welkin_target* given) {
    const c_interface::Target read = c_interface::target_of(given);
    return std::tuple(read.pictures, read.count, read.width, read.height, read.stride, read.layout.channels,
                      read.layout.halves);
  };
  check(c_struct<welkin_target>(), target, 2);
}

}  // namespace welkin::test
