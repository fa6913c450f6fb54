// Tests that every field of every options structure arrives: tables of values that cover all bytes of a structure.
#include "c/c_calls.h"
#include "c/c_worker.h"
#include "files/c_files.h"
#include "support/catch.h"
#include "welkin/bake.h"
#include "welkin/probes.h"
#include "welkin/reflections.h"
#include "welkin/sky.h"
#include "welkin/welkin.h"

namespace welkin::test {

namespace {

/// A value of a field, and the change that it makes to the options that the library reads; any change without `want`.
template <class Options, class Wanted>
struct FieldValue {
  const char* name;
  std::function<void(Options&)> set;
  std::function<void(Wanted&)> want{};
};

/// A field, its value, and the assignment to the library's `options`: `FIELD(midpoint, 1, quadrature = ...)`.
#define FIELD(field, value, ...)                                                                       \
  {                                                                                                    \
#field, [&](auto& options) { options.field = value; }, [&](auto& options) { options.__VA_ARGS__; } \
  }

/// Requires that `base` is read as `wanted`, that each value makes its expected change, and that the values together
/// change every word except padding.
template <class Options, class Wanted, class Read>
void check_fields(const Options& base, const Wanted& wanted, const Read& read,
                  const std::vector<FieldValue<Options, Wanted>>& fields, std::ptrdiff_t padding = 0) {
  constexpr std::size_t kWords = sizeof(Options) / sizeof(std::uint32_t);
  const auto words = [](const Options& options) {
    std::array<std::uint32_t, kWords> values{};
    std::memcpy(values.data(), &options, sizeof options);
    return values;
  };
  CHECK((read(&base) == wanted));
  std::array<bool, kWords> named{true};  // struct_size
  for (const FieldValue<Options, Wanted>& field : fields) {
    INFO(field.name);
    Options changed = base;
    field.set(changed);
    for (std::size_t k = 0; k < kWords; ++k) named[k] = named[k] || words(changed)[k] != words(base)[k];
    CHECK(!(read(&changed) == wanted));
    if (!field.want) continue;
    Wanted changed_wanted = wanted;
    field.want(changed_wanted);
    CHECK((read(&changed) == changed_wanted));
  }
  CHECK(std::ranges::count(named, false) == padding);
}

constexpr double kAllBytes = 0.1;  // a double of which no word is 0
constexpr std::uint64_t kBothWords = (std::uint64_t{1} << 33U) + 1;

}  // namespace

TEST_CASE("C: every field of pixel policies, projections and sky tables is read", "[c_interface]") {
  using Pixels = welkin_pixel_policy;
  auto clamped = c_struct<Pixels>();
  clamped.clamp_maximum = 2.0F;
  check_fields<Pixels>(clamped, PixelPolicy{.clamp = RadianceClamp{2.0F}}, c_interface::pixel_policy,
                       {FIELD(clamp_maximum, 0.5F, clamp->maximum = 0.5F),
                        FIELD(clamp_preserve_colour, 1, clamp->preserve_colour = true), FIELD(gamma, 1, gamma = true),
                        FIELD(reject_nan, 1, nan = NonFinitePolicy::reject),
                        FIELD(reject_infinity, 1, infinity = NonFinitePolicy::reject),
                        FIELD(negative, WELKIN_NEGATIVE_REPLACE, negative = NegativePolicy::replace),
                        FIELD(negative, WELKIN_NEGATIVE_REJECT, negative = NegativePolicy::reject)});
  using Projecting = welkin_projection_options;
  check_fields<Projecting>(
      c_struct<Projecting>(), ProjectionOptions{}, c_interface::projection_options,
      {FIELD(bands, 5, bands = 5), FIELD(midpoint, 1, quadrature = Quadrature::midpoint),
       FIELD(target_size, 8, target_size = 8), FIELD(pixels, &clamped, pixels.clamp = RadianceClamp{2.0F})});
  using Tables = welkin_sky_table_options;
  check_fields<Tables>(
      c_struct<Tables>(), SkyTableOptions{}, c_interface::table_options,
      {FIELD(compact, 1, layout = ScatteringLayout::compact), FIELD(heights, 5, heights = 5),
       FIELD(view_zeniths, 6, view_zeniths = 6), FIELD(sun_zeniths, 5, sun_zeniths = 5),
       FIELD(sun_angles, 5, sun_angles = 5), FIELD(transmittance_heights, 5, transmittance_heights = 5),
       FIELD(transmittance_zeniths, 5, transmittance_zeniths = 5), FIELD(irradiance_heights, 5, irradiance_heights = 5),
       FIELD(irradiance_sun_zeniths, 5, irradiance_sun_zeniths = 5), FIELD(orders, 5, orders = 5),
       FIELD(linear_srgb, 1, colour = SkyColour::linear_srgb),
       FIELD(minimum_sun_elevation_degrees, -kAllBytes, minimum_sun_elevation_degrees = -kAllBytes),
       FIELD(convergence_threshold, kAllBytes, convergence_threshold = kAllBytes),
       FIELD(memory_limit_bytes, kBothWords, memory_limit_bytes = kBothWords),
       FIELD(truncate_orders, 1, truncate_orders = true)},
      1);
  using Curve = welkin_sky_harmonics_options;
  check_fields<Curve>(c_struct<Curve>(), SkyCurveOptions{}, c_interface::curve_options,
                      {FIELD(bands, 5, bands = 5), FIELD(zeniths, 5, projection.zeniths = 5),
                       FIELD(azimuths, 5, projection.azimuths = 5), FIELD(nodes, 9, nodes = 9)});
}

TEST_CASE("C: every field of prefilters and bakes is read", "[c_interface]") {
  const std::array roughness{0.0, 0.5};
  const std::array other{0.0, 0.7};
  const std::array spectra{1.0, 0.5, 1.0, 0.25};
  auto clamped = c_struct<welkin_pixel_policy>();
  clamped.clamp_maximum = 2.0F;
  using Prefilter = welkin_prefilter_options;
  const auto prefilter = [](const Prefilter* options) { return c_interface::prefilter_options(options, 256, true); };
  CHECK(prefilter(nullptr) == PrefilterOptions{});
  auto named = c_struct<Prefilter>();
  named.mips = 3;
  check_fields<Prefilter>(
      named, PrefilterOptions{.mips = 3}, prefilter,
      {FIELD(size, 8, size = 8),
       FIELD(mips, 2, mips = 2),
       FIELD(method, WELKIN_PREFILTER_REFERENCE, method = PrefilterMethod::reference),
       FIELD(rms_error, kAllBytes, rms_error = kAllBytes),
       FIELD(maximum_error, kAllBytes, maximum_error = kAllBytes),
       FIELD(pixels, &clamped, pixels.clamp = RadianceClamp{2.0F}),
       FIELD(lobe, WELKIN_LOBE_FAMILY_CHARLIE, lobe = LobeFamily::charlie),
       FIELD(quality, WELKIN_QUALITY_FAST, rms_error = 1e-2),
       FIELD(quality, WELKIN_QUALITY_REFERENCE, method = PrefilterMethod::reference),
       FIELD(schedule, WELKIN_ROUGHNESS_UNITY, roughness = mip_roughness(RoughnessSchedule::unity, 3, 256)),
       {"rms_error wins over quality",
        [](Prefilter& p) {
          p.rms_error = 2e-3;
          p.quality = WELKIN_QUALITY_REFERENCE;
        },
        [](PrefilterOptions& p) { p.rms_error = 2e-3; }},
       {"fitted", [](Prefilter& p) { p.fitted = 1; },
        [](PrefilterOptions& p) {
          p.roughness = mip_roughness(RoughnessSchedule::filament, 3, 256);
          p.lobe_roughness = fitted_mip_roughness(RoughnessSchedule::filament, 3, 256);
        }},
       {"roughness and lobe_roughness",
        [&](Prefilter& p) {
          p.roughness_count = 2;
          p.roughness = roughness.data();
          p.lobe_roughness = other.data();
        },
        [](PrefilterOptions& p) {
          p.roughness = {0.0, 0.5};
          p.lobe_roughness = {0.0, 0.7};
        }},
       {"spectra",
        [&](Prefilter& p) {
          p.lobe = WELKIN_LOBE_FAMILY_SPECTRA;
          p.mips = 2;
          p.spectrum_bands = 2;
          p.spectra = spectra.data();
        },
        [](PrefilterOptions& p) {
          p.lobe = LobeFamily::spectra;
          p.mips = 2;
          p.spectra = {{1.0, 0.5}, {1.0, 0.25}};
        }}},
      2);
  for (const auto schedule : {RoughnessSchedule::linear, RoughnessSchedule::filament, RoughnessSchedule::babylon,
                              RoughnessSchedule::unity, RoughnessSchedule::unreal}) {
    auto options = c_struct<Prefilter>();
    options.schedule = static_cast<welkin_roughness_schedule>(schedule) + 1;
    const int mips = default_mip_count(schedule, 256);
    CHECK(prefilter(&options) == PrefilterOptions{.mips = mips, .roughness = mip_roughness(schedule, mips, 256)});
  }
  auto specular = c_struct<Prefilter>();
  specular.size = 8;
  auto brdf = c_struct<welkin_brdf_options>();
  brdf.width = 8;
  using Bake = welkin_bake_options;
  const auto bake = [](const Bake* options) { return c_interface::bake_options(options); };
  CHECK(bake(nullptr) == BakeOptions{});
  auto with_map = c_struct<Bake>();
  with_map.octahedral_size = 64;
  check_fields<Bake>(with_map, BakeOptions{.octahedral = OctahedralOptions{.size = 64}}, bake,
                     {FIELD(leave_out, WELKIN_PART_BACKGROUND, background.reset()),
                      FIELD(leave_out, WELKIN_PART_SPECULAR, specular.reset()),
                      FIELD(leave_out, WELKIN_PART_IRRADIANCE, irradiance.reset()),
                      FIELD(leave_out, WELKIN_PART_HARMONICS, bands = 0),
                      FIELD(leave_out, WELKIN_PART_BRDF, brdf.reset()),
                      FIELD(background_size, 8, background->size = 8),
                      FIELD(background_without_mips, 1, background->mips = false),
                      FIELD(background_box_filter, 1, background->mip_filter = MipFilter::box),
                      FIELD(irradiance_size, 8, irradiance->size = 8),
                      FIELD(irradiance_method, WELKIN_IRRADIANCE_DIRECT, irradiance->method = IrradianceMethod::direct),
                      FIELD(bands, 5, bands = 5),
                      FIELD(specular, &specular, specular->size = 8),
                      FIELD(brdf, &brdf, brdf->width = 8),
                      FIELD(pixels, &clamped, pixels.clamp = RadianceClamp{2.0F}),
                      FIELD(memory_limit_bytes, kBothWords, memory_limit_bytes = kBothWords),
                      FIELD(irradiance_rms_error, kAllBytes, irradiance->rms_error = kAllBytes),
                      FIELD(octahedral_size, 32, octahedral->size = 32),
                      FIELD(octahedral_levels, 2, octahedral->levels = 2),
                      FIELD(octahedral_border, 2, octahedral->border = 2),
                      FIELD(quality, WELKIN_QUALITY_FAST, specular->rms_error = options.irradiance->rms_error = 1e-2)});
  using Table = welkin_brdf_options;
  const auto of_bake = [](const Table* options) {
    auto given = c_struct<Bake>();
    given.brdf = options;
    return c_interface::bake_options(&given).brdf.value();
  };
  check_fields<Table>(
      c_struct<Table>(), BrdfTableOptions{}, of_bake,
      {FIELD(width, 8, width = 8), FIELD(height, 8, height = 8),
       FIELD(multiple_scattering, 1, model = BrdfModel::multiple_scattering), FIELD(without_sheen, 1, sheen = false)});
}

TEST_CASE("C: every field of atmospheres and constituents is read", "[c_interface]") {
  const std::array layers{100.0, 1.0, -0.1, 0.2, 0.3, 0.0, 0.5, -0.4, 0.6, 0.7};
  const std::array other_layers{200.0, 0.5, -0.2, 0.4, 0.6};
  const DensityLayer lower{100.0, 1.0, -0.1, 0.2, 0.3};
  const std::array wavelengths{700.0, 600.0, 500.0, 400.0};
  const std::array numbers{0.31, 0.32, 0.33, 0.34};
  const std::vector<double> three{0.31, 0.32, 0.33};  // at Mars's wavelengths
  auto matter = c_struct<welkin_constituent>();
  matter.layer_count = 1;
  matter.layers = layers.data();
  const Constituent wanted{{lower}, {}, {}};
  using Air = welkin_atmosphere;
  auto on_mars = c_struct<Air>();
  on_mars.planet = WELKIN_PLANET_MARS;
  check_fields<Air>(
      on_mars, mars(), c_interface::atmosphere_of,
      {{"planet", [](Air& a) { a.planet = WELKIN_PLANET_EARTH_HILLAIRE; }, [](Atmosphere& a) { a = earth_hillaire(); }},
       {"wavelengths_nm",
        [&](Air& a) {
          a.planet = WELKIN_PLANET_EARTH;
          a.wavelength_count = 4;
          a.wavelengths_nm = wavelengths.data();
        },
        [&](Atmosphere& a) {
          a = earth({wavelengths.begin(), wavelengths.end()});
        }},
       FIELD(rayleigh, &matter, rayleigh = wanted),
       FIELD(aerosol, &matter, aerosol = wanted),
       {"aerosol_optics", [&](Air& a) { a.aerosol_optics = numbers.data(); },
        [](Atmosphere& a) {
          a = with_aerosol(
              a,
              {.optical_depth = 0.31, .angstrom_exponent = 0.32, .single_scattering_albedo = 0.33, .asymmetry = 0.34});
        }},
       FIELD(aerosol_phase, WELKIN_PHASE_CORNETTE_SHANKS, aerosol_phase = AerosolPhase::cornette_shanks),
       {"aerosol_asymmetry", [](Air& a) { a.aerosol_asymmetry = kAllBytes; },
        [](Atmosphere& a) {
          a.aerosol_asymmetry = kAllBytes;
          a.aerosol_asymmetries.clear();
        }},
       FIELD(aerosol_asymmetries, numbers.data(), aerosol_asymmetries = three),
       {"absorbers",
        [&](Air& a) {
          a.absorber_count = 4;
          std::fill(std::begin(a.absorbers), std::end(a.absorbers), &matter);
        },
        [&](Atmosphere& a) { a.absorbers.assign(4, wanted); }},
       FIELD(bottom_radius_m, 3e6 + kAllBytes, bottom_radius_m = 3e6 + kAllBytes),
       FIELD(top_radius_m, 4e6 + kAllBytes, top_radius_m = 4e6 + kAllBytes),
       FIELD(ground_albedo, numbers.data(), ground_albedo = three),
       FIELD(sun_irradiance, numbers.data(), solar_irradiance = three),
       FIELD(sun_angular_radius_degrees, kAllBytes, sun_angular_radius_degrees = kAllBytes),
       FIELD(night_zenith_luminance, kAllBytes, night_zenith_luminance = kAllBytes)},
      1);
  auto without_absorbers = c_struct<Air>();  // Earth's air has ozone
  without_absorbers.absorber_count = -1;
  Atmosphere without_ozone = earth();
  without_ozone.absorbers.clear();
  CHECK((c_interface::atmosphere_of(&without_absorbers) == without_ozone));
  using Matter = welkin_constituent;
  const auto of_air = [](const Matter* constituent) {
    auto air = c_struct<Air>();
    air.rayleigh = constituent;
    return c_interface::atmosphere_of(&air).rayleigh;
  };
  check_fields<Matter>(
      matter, wanted, of_air,
      {FIELD(layer_count, 0, density.clear()), FIELD(layer_count, 2, density.push_back({0.0, 0.5, -0.4, 0.6, 0.7})),
       FIELD(layers, other_layers.data(), density[0] = {200.0, 0.5, -0.2, 0.4, 0.6}),
       FIELD(scattering_per_m, numbers.data(), scattering_per_m = three),
       FIELD(absorption_per_m, numbers.data(), absorption_per_m = three)},
      1);  // pointers to two arrays here share their upper halves
}

TEST_CASE("C: every field of options of files and textures is read", "[c_interface]") {
  using Read = welkin_read_options;
  check_fields<Read>(c_struct<Read>(), ReadOptions{}, c_interface::file_options,
                     {FIELD(layout, WELKIN_LAYOUT_VERTICAL_CROSS, layout = Layout::vertical_cross),
                      FIELD(part, "beauty", part = "beauty"), FIELD(layer, "sky", layer = "sky"),
                      FIELD(transfer, WELKIN_TRANSFER_LINEAR, transfer = Transfer::linear),
                      FIELD(primaries_as_stored, 1, primaries = Primaries::as_stored),
                      FIELD(memory_limit_bytes, kBothWords, memory_limit_bytes = kBothWords),
                      FIELD(level, 1, level = 1), FIELD(element, 2, element = 2)},
                     2);  // `level` and `element` are numbers of 32 bits in fields of 64
  using Texture = welkin_texture_options;
  struct Wanted {
    TexelFormat format = TexelFormat::rgba16f;
    Supercompression supercompression = Supercompression::none;
    Bc6hEffort bc6h = Bc6hEffort::normal;
    AstcEffort astc = AstcEffort::medium;
    bool operator==(const Wanted&) const = default;
  };
  const auto texture = [](const Texture* options) {
    const TextureOptions read = c_interface::texture_options(options);
    return Wanted{read.format, read.supercompression, read.bc6h_effort, read.astc_effort};
  };
  check_fields<Texture>(
      c_struct<Texture>(), Wanted{}, texture,
      {FIELD(format, WELKIN_TEXEL_E5B9G9R9, format = TexelFormat::e5b9g9r9),
       FIELD(supercompression, WELKIN_SUPERCOMPRESSION_ZSTD, supercompression = Supercompression::zstd),
       FIELD(effort, WELKIN_EFFORT_FASTEST, bc6h = Bc6hEffort::fast, options.astc = AstcEffort::fastest),
       FIELD(effort, WELKIN_EFFORT_FAST, bc6h = Bc6hEffort::fast, options.astc = AstcEffort::fast),
       FIELD(effort, WELKIN_EFFORT_SLOW, bc6h = Bc6hEffort::slow, options.astc = AstcEffort::thorough)});
  auto normal = c_struct<Texture>();
  normal.effort = WELKIN_EFFORT_NORMAL;
  CHECK((texture(&normal) == Wanted{}));
}

TEST_CASE("C: every field of options of workers and posts is read", "[c_interface]") {
  using Workers = welkin_worker_options;
  struct Task {
    int concurrency = 0;
    void* user = nullptr;
    int runs = 0;
    bool operator==(const Task&) const = default;
  };
  const auto worker = [](const Workers* options) {
    const WorkerOptions read = c_interface::worker_options(options);
    Task task;  // what `enqueue` receives
    if (read.executor) {
      task.concurrency = read.executor->concurrency();
      read.executor->enqueue([](void* given) { ++static_cast<Task*>(given)->runs; }, &task);
    }
    return std::tuple(read.threads, read.thread_priority, read.name, task, read.max_jobs, read.max_bytes);
  };
  int user = 0;
  const auto of_worker = c_struct<Workers>();
  check_fields<Workers>(of_worker, worker(&of_worker), worker,
                        {{"threads", [](Workers& w) { w.threads = 3; }},
                         {"thread_priority", [](Workers& w) { w.thread_priority = WELKIN_THREAD_PRIORITY_IDLE; }},
                         {"name", [](Workers& w) { w.name = "sky"; }},
                         {"threads, enqueue and enqueue_user",
                          [&](Workers& w) {
                            w.threads = 3;
                            w.enqueue = [](void* given, void (*run)(void*), void* argument) {
                              static_cast<Task*>(argument)->user = given;
                              run(argument);
                            };
                            w.enqueue_user = &user;
                          },
                          [&](auto& wanted) {
                            std::get<int>(wanted) = 3;
                            std::get<Task>(wanted) = Task{3, &user, 1};
                          }},
                         {"max_jobs", [](Workers& w) { w.max_jobs = kBothWords; }},
                         {"max_bytes", [](Workers& w) { w.max_bytes = kBothWords; }}},
                        1);
  using Post = welkin_post_options;
  const auto post = [&](const Post* options) {
    user = 0;
    const auto [priority, key, bytes] = c_interface::Posting(options).options();
    const auto& given = c_interface::Posting(options).given;
    return std::tuple(priority, std::string(key), bytes, user, given.completed, given.completed_user);
  };
  const auto of_post = c_struct<Post>();
  check_fields<Post>(of_post, post(&of_post), post,
                     {{"priority", [](Post& p) { p.priority = WELKIN_PRIORITY_LOW; }},
                      {"key", [](Post& p) { p.key = "sun"; }},
                      {"bytes", [](Post& p) { p.bytes = kBothWords; }},
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
  struct Wanted : SkyLightOptions {
    [[nodiscard]] auto fields() const {
      return std::tie(tables, curve, altitude_m, specular, sun_threshold_degrees, specular_threshold_degrees,
                      altitude_threshold_m, blend_seconds, priority);
    }
    bool operator==(const Wanted& other) const { return fields() == other.fields(); }
  };
  const auto light = [](const Light* options) { return Wanted{c_interface::light_options(options)}; };
  check_fields<Light>(
      c_struct<Light>(), Wanted{}, light,
      {FIELD(priority, WELKIN_PRIORITY_HIGH, priority = TaskPriority::high), FIELD(tables, &tables, tables.heights = 5),
       FIELD(curve, &curve, curve.bands = 5), FIELD(specular, &specular, specular.size = 8),
       FIELD(without_specular, 1, specular.size = 0), FIELD(altitude_m, kAllBytes, altitude_m = kAllBytes),
       FIELD(sun_threshold_degrees, kAllBytes, sun_threshold_degrees = kAllBytes),
       FIELD(specular_threshold_degrees, kAllBytes, specular_threshold_degrees = kAllBytes),
       FIELD(altitude_threshold_m, kAllBytes, altitude_threshold_m = kAllBytes),
       FIELD(blend_seconds, kAllBytes, blend_seconds = kAllBytes),
       // below zero: none
       FIELD(sun_threshold_degrees, -1.0, sun_threshold_degrees = 0.0),
       FIELD(specular_threshold_degrees, -1.0, specular_threshold_degrees = 0.0),
       FIELD(altitude_threshold_m, -1.0, altitude_threshold_m = 0.0), FIELD(blend_seconds, -1.0, blend_seconds = 0.0)},
      1);
  using Grid = welkin_probe_grid;
  auto unit = c_struct<Grid>();
  std::fill(std::begin(unit.counts), std::end(unit.counts), 2);
  std::fill(std::begin(unit.spacing), std::end(unit.spacing), 1.0);
  check_fields<Grid>(
      unit, ProbeGrid{.counts = {2, 2, 2}}, c_interface::probe_grid,
      {FIELD(counts[0], 3, counts[0] = 3), FIELD(counts[1], 3, counts[1] = 3), FIELD(counts[2], 3, counts[2] = 3),
       FIELD(origin[0], kAllBytes, origin.x = kAllBytes), FIELD(origin[1], kAllBytes, origin.y = kAllBytes),
       FIELD(origin[2], kAllBytes, origin.z = kAllBytes), FIELD(spacing[0], kAllBytes, spacing.x = kAllBytes),
       FIELD(spacing[1], kAllBytes, spacing.y = kAllBytes), FIELD(spacing[2], kAllBytes, spacing.z = kAllBytes)});
  using Probes = welkin_probe_options;
  check_fields<Probes>(
      c_struct<Probes>(), ProbeOptions{}, c_interface::probe_options,
      {FIELD(bands, 2, projection.bands = 2), FIELD(distance_size, -1, distance_size = 0),
       FIELD(dilation_passes, 2, dilation_passes = 2), FIELD(environment_bands, 2, environment_bands = 2),
       FIELD(near_share, 0.3, near_share = 0.3), FIELD(valid_share, 0.3, valid_share = 0.3)},
      1);
}

TEST_CASE("C: every field of environments and targets is read", "[c_interface]") {
  std::array<float, 6 * 8 * 8 * 4> memory{};
  const auto fill_faces = [&](auto& faces, std::size_t step) {
    for (std::size_t face = 0; face < 6; ++face) faces[face] = memory.data() + step * (face + 1);
  };
  // Pointers into one array share their upper halves (faces[0] is never null), and sizes have 32 bits in fields of 64.
  const auto check = [&]<class Image>(Image image, const auto& read, std::ptrdiff_t padding) {
    image.size = 4;
    fill_faces(image.faces, 64);
    check_fields<Image>(image, read(&image), read,
                        {{"format", [](Image& p) { p.format = WELKIN_FORMAT_RGBA_F16; }},
                         {"row_stride_bytes", [](Image& p) { p.row_stride_bytes = -64; }},
                         {"faces", [&](Image& p) { fill_faces(p.faces, 68); }},
                         {"size, width and height",
                          [](Image& p) {
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
    return std::tuple(read.images, read.count, read.width, read.height, read.stride, read.layout.channels,
                      read.layout.halves);
  };
  check(c_struct<welkin_target>(), target, 2);
}

}  // namespace welkin::test
