/* Chains, bakes and skies as a program in C meets them: known light comes out, and what no call can accept is refused.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "support.h"

static const double pi = 3.14159265358979323846;

static void refused(welkin_status status, const char* word, int line) {
  check_status(WELKIN_INVALID_ARGUMENT, status, word, __FILE__, line);
  check(strstr(welkin_last_error(), word) != NULL, welkin_last_error(), __FILE__, line);
}
#define REFUSED(word, call) refused((call), (word), __LINE__)

/* ---- Bakes ---- */

static void uniform_light_stays_uniform(void) {
  welkin_environment cubemap = uniform_cubemap(8, 1.0F, 2.0F, 3.0F);
  const welkin_prefilter_options specular = {.struct_size = sizeof specular, .size = 8};
  const welkin_bake_options options = {.struct_size = sizeof options, .irradiance_size = 4, .specular = &specular};
  welkin_bake_result* bake = NULL;
  CHECK_STATUS(WELKIN_OK, welkin_bake(&cubemap, &options, NULL, &bake));
  free(pixels_of(&cubemap));
  welkin_bake_info info = {.struct_size = sizeof info};
  CHECK_STATUS(WELKIN_OK, welkin_bake_result_get_info(bake, &info));
  CHECK(info.parts == 31 && info.bands == 3);

  const welkin_chain* reflections = welkin_bake_result_chain(bake, WELKIN_PART_SPECULAR);
  for (int32_t level = 0; level < 4; ++level) {
    float texels[6][8 * 8 * 4];
    welkin_target target = {.struct_size = sizeof target, .format = WELKIN_FORMAT_RGBA_F32, .size = 8 >> level};
    for (int face = 0; face < 6; ++face) target.faces[face] = texels[face];
    uint64_t clamped = 99;
    CHECK_STATUS(WELKIN_OK, welkin_chain_copy(reflections, level, &target, &clamped));
    CHECK(clamped == 0);
    CHECK(close_to(texels[5][0], 1.0, 1e-5) && close_to(texels[5][1], 2.0, 1e-5) && texels[5][3] == 1.0F);
  }
  welkin_environment irradiance = {.struct_size = sizeof irradiance};
  CHECK_STATUS(WELKIN_OK,
               welkin_chain_get_level(welkin_bake_result_chain(bake, WELKIN_PART_IRRADIANCE), 0, &irradiance));
  CHECK(close_to(((const float*)irradiance.faces[2])[2], 3.0 * pi, 1e-4));
  CHECK(welkin_bake_result_chain(bake, WELKIN_PART_BRDF) == NULL);
  CHECK(welkin_bake_result_chain(bake, 0) == NULL);
  CHECK(welkin_bake_result_chain(bake, WELKIN_PART_BACKGROUND | WELKIN_PART_SPECULAR) == NULL);
  welkin_bake_result_destroy(bake);
}

static void bakes_that_are_refused(void) {
  welkin_environment cubemap = uniform_cubemap(4, 1.0F, 1.0F, 1.0F);
  welkin_worker* worker = make_worker();
  welkin_bake_result* bake = NULL;
  welkin_job* job = NULL;
  REFUSED("environment", welkin_bake(NULL, NULL, NULL, &bake));
  REFUSED("result", welkin_bake(&cubemap, NULL, NULL, NULL));
  REFUSED("path", welkin_bake_file(NULL, NULL, NULL, NULL, &bake));
  REFUSED("result", welkin_bake_file("a.exr", NULL, NULL, NULL, NULL));
  REFUSED("worker", welkin_post_bake(NULL, &cubemap, NULL, NULL, NULL, &job));
  REFUSED("worker", welkin_post_bake_file(NULL, "a.exr", NULL, NULL, NULL, &job));
  REFUSED("environment", welkin_post_bake(worker, NULL, NULL, NULL, NULL, &job));
  REFUSED("path", welkin_post_bake_file(worker, NULL, NULL, NULL, NULL, &job));
  REFUSED("job", welkin_job_get_bake(NULL, &bake));
  REFUSED("result", welkin_bake_result_get_info(NULL, NULL));
  REFUSED("result", welkin_bake_result_get_projection(NULL, NULL));
  REFUSED("result", welkin_bake_result_copy_brdf(NULL, NULL, NULL));
  REFUSED("result", welkin_bake_result_copy_octahedral(NULL, 0, NULL, NULL));
  CHECK(welkin_bake_result_chain(NULL, WELKIN_PART_SPECULAR) == NULL);
  welkin_bake_result_destroy(NULL);

  welkin_bake_options options;
#define OPTION(field, number)                                      \
  do {                                                             \
    WELKIN_INIT(options);                                          \
    options.field = number;                                        \
    REFUSED(#field, welkin_bake(&cubemap, &options, NULL, &bake)); \
    CHECK(bake == NULL);                                           \
  } while (0)
  OPTION(leave_out, 32);
  OPTION(background_without_mips, 2);
  OPTION(background_box_filter, 2);
  OPTION(irradiance_method, -1);
  OPTION(octahedral_levels, 2);
  OPTION(struct_size, 4);
  OPTION(struct_size, sizeof options + 4);
#undef OPTION
  WELKIN_INIT(options);
  options.bands = 17;
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_bake(&cubemap, &options, NULL, &bake));
  WELKIN_INIT(options);
  options.irradiance_rms_error = -1;
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_bake(&cubemap, &options, NULL, &bake));
  const welkin_pixel_policy policy = {.struct_size = sizeof policy};
  const welkin_prefilter_options specular = {.struct_size = sizeof specular, .pixels = &policy};
  WELKIN_INIT(options);
  options.specular = &specular; /* a bake has one policy for all parts */
  REFUSED("pixels", welkin_bake(&cubemap, &options, NULL, &bake));

  /* Without harmonics and table there is nothing of them to be had. */
  options = (welkin_bake_options){
      .struct_size = sizeof options,
      .leave_out = WELKIN_PART_SPECULAR | WELKIN_PART_IRRADIANCE | WELKIN_PART_HARMONICS | WELKIN_PART_BRDF};
  CHECK_STATUS(WELKIN_OK, welkin_bake(&cubemap, &options, NULL, &bake));
  welkin_projection light = {.struct_size = sizeof light};
  float numbers[3];
  welkin_target target = {.struct_size = sizeof target, .faces = {numbers}, .width = 1, .height = 1};
  REFUSED("harmonics", welkin_bake_result_get_projection(bake, &light));
  REFUSED("BRDF", welkin_bake_result_copy_brdf(bake, &target, NULL));
  REFUSED("octahedral", welkin_bake_result_copy_octahedral(bake, 0, &target, NULL));
  REFUSED("info", welkin_bake_result_get_info(bake, NULL));
  welkin_bake_result_destroy(bake);
  welkin_worker_destroy(worker);
  free(pixels_of(&cubemap));
}

/* ---- Chains, reflections and tables ---- */

static void chains_that_are_refused(void) {
  welkin_environment cubemap = uniform_cubemap(4, 1.0F, 1.0F, 1.0F);
  welkin_worker* worker = make_worker();
  welkin_chain* chain = NULL;
  REFUSED("environment", welkin_prefilter(NULL, NULL, NULL, &chain));
  REFUSED("chain", welkin_prefilter(&cubemap, NULL, NULL, NULL));
  REFUSED("worker", welkin_post_prefilter(NULL, &cubemap, NULL, NULL, NULL));
  REFUSED("environment", welkin_post_prefilter(worker, NULL, NULL, NULL, NULL));
  REFUSED("job", welkin_job_get_chain(NULL, &chain));

  welkin_prefilter_options options;
#define OPTION(field, number, word)                                    \
  do {                                                                 \
    WELKIN_INIT(options);                                              \
    options.field = number;                                            \
    REFUSED(word, welkin_prefilter(&cubemap, &options, NULL, &chain)); \
    CHECK(chain == NULL);                                              \
  } while (0)
  OPTION(roughness_count, -1, "roughness_count");
  OPTION(roughness_count, 17, "roughness_count");
  OPTION(roughness_count, 2, "roughness");
  OPTION(method, WELKIN_PREFILTER_COPY, "method");
  OPTION(schedule, 6, "schedule");
  OPTION(fitted, 2, "fitted");
  OPTION(size, -1, "size");
  OPTION(struct_size, 7, "struct_size");
#undef OPTION
  welkin_pixel_policy policy = {.struct_size = sizeof policy, .reject_nan = 2};
  WELKIN_INIT(options);
  options.pixels = &policy;
  REFUSED("reject_nan", welkin_prefilter(&cubemap, &options, NULL, &chain));

  WELKIN_INIT(options);
  options.size = 4;
  CHECK_STATUS(WELKIN_OK, welkin_prefilter(&cubemap, &options, NULL, &chain));
  welkin_environment level = {.struct_size = sizeof level};
  welkin_mip mip = {.struct_size = sizeof mip};
  REFUSED("level", welkin_chain_get_level(chain, 3, &level));
  REFUSED("level", welkin_chain_get_level(chain, -1, &level));
  REFUSED("pixels", welkin_chain_get_level(chain, 0, NULL));
  REFUSED("level", welkin_chain_get_mip(chain, 3, &mip));
  REFUSED("mip", welkin_chain_get_mip(chain, 0, NULL));
  REFUSED("info", welkin_chain_get_info(chain, NULL));
  REFUSED("target", welkin_chain_copy(chain, 0, NULL, NULL));
  REFUSED("another", welkin_chain_share(chain, NULL));
  welkin_chain_destroy(chain);
  REFUSED("chain", welkin_chain_get_level(NULL, 0, &level));
  REFUSED("chain", welkin_chain_get_mip(NULL, 0, &mip));
  REFUSED("chain", welkin_chain_get_info(NULL, NULL));
  REFUSED("chain", welkin_chain_copy(NULL, 0, NULL, NULL));
  chain = (welkin_chain*)&cubemap;
  REFUSED("chain", welkin_chain_share(NULL, &chain));
  CHECK(chain == NULL);
  welkin_chain_destroy(NULL);
  welkin_worker_destroy(worker);
  free(pixels_of(&cubemap));
}

static void tables_that_are_refused(void) {
  float texels[6 * 3] = {0.0F};
  double numbers[27] = {0.0};
  welkin_target target = {.struct_size = sizeof target, .faces = {texels}, .width = 2, .height = 2};
  welkin_target faces = {.struct_size = sizeof faces, .size = 1};
  for (int face = 0; face < 6; ++face) faces.faces[face] = texels + 3 * face;
  welkin_brdf_options options = {.struct_size = sizeof options, .width = 2, .height = 2, .multiple_scattering = 2};
  REFUSED("multiple_scattering", welkin_brdf_table(&options, NULL, &target, NULL));
  options.multiple_scattering = 0;
  options.without_sheen = 3;
  REFUSED("without_sheen", welkin_brdf_table(&options, NULL, &target, NULL));
  options.without_sheen = 0;
  options.width = 5000;
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_brdf_table(&options, NULL, &target, NULL));
  options.width = 2;
  REFUSED("target", welkin_brdf_table(&options, NULL, NULL, NULL));
  REFUSED("flat", welkin_brdf_table(&options, NULL, &faces, NULL));
  target.faces[0] = NULL;
  REFUSED("null", welkin_brdf_table(&options, NULL, &target, NULL));
  REFUSED("irradiance", welkin_irradiance_cubemap(3, NULL, NULL, &faces, NULL));
  REFUSED("target", welkin_irradiance_cubemap(3, numbers, NULL, NULL, NULL));
  target.faces[0] = texels;
  REFUSED("flat", welkin_irradiance_cubemap(3, numbers, NULL, &target, NULL));
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_irradiance_cubemap(0, numbers, NULL, &faces, NULL));
  CHECK_STATUS(WELKIN_OK, welkin_irradiance_cubemap(3, numbers, NULL, &faces, NULL));
}

/* ---- Harmonics and engines ---- */

static void harmonics_that_are_refused(void) {
  double light[27] = {1.0}, to[27], value[3];
  const double none[9] = {0.0};
  int32_t found = 0;
  REFUSED("coefficients", welkin_turn(3, NULL, none, to));
  REFUSED("matrix", welkin_turn(3, light, NULL, to));
  REFUSED("turned", welkin_turn(3, light, none, NULL));
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_turn(3, light, none, to));
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_turn(17, light, none, to));
  REFUSED("radiance", welkin_apply_window(3, NULL, WELKIN_WINDOW_HANNING, 0.0, to));
  REFUSED("windowed", welkin_apply_window(3, light, WELKIN_WINDOW_HANNING, 0.0, NULL));
  REFUSED("window", welkin_apply_window(3, light, 4, 0.0, to));
  to[0] = 7.0;
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_apply_window(3, light, WELKIN_WINDOW_HANNING, -1.0, to));
  CHECK(to[0] == 7.0); /* a call that fails writes none of its results */
  REFUSED("radiance", welkin_exposure_of(3, NULL, value));
  REFUSED("exposure", welkin_exposure_of(3, light, NULL));
  REFUSED("radiance", welkin_dominant_light(3, NULL, value, value, &found));
  REFUSED("direction", welkin_dominant_light(3, light, NULL, value, &found));
  REFUSED("irradiance", welkin_dominant_light(3, light, value, NULL, &found));
  REFUSED("found", welkin_dominant_light(3, light, value, value, NULL));
  REFUSED("direction", welkin_sun_harmonics(NULL, value, 0.0, 3, to));
  REFUSED("irradiance", welkin_sun_harmonics(none, NULL, 0.0, 3, to));
  REFUSED("coefficients", welkin_sun_harmonics(none, none, 0.0, 3, NULL));
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_sun_harmonics(none, none, 0.0, 3, to)); /* it has no direction */

  double axes[9];
  REFUSED("engine", welkin_get_axes(12, axes, axes));
  REFUSED("from_welkin", welkin_get_axes(WELKIN_ENGINE_UNITY, NULL, axes));
  REFUSED("faces_from_engine", welkin_get_axes(WELKIN_ENGINE_UNITY, axes, NULL));
}

/* ---- Skies ---- */

static welkin_sky_table_options small_tables(void) {
  const welkin_sky_table_options options = {.struct_size = sizeof options,
                                            .heights = 2,
                                            .view_zeniths = 16,
                                            .sun_zeniths = 8,
                                            .sun_angles = 2,
                                            .transmittance_heights = 8,
                                            .transmittance_zeniths = 16,
                                            .irradiance_heights = 2,
                                            .irradiance_sun_zeniths = 8,
                                            .orders = 1};
  return options;
}

static void atmospheres_that_are_refused(void) {
  double numbers[3] = {680.0, 550.0, 440.0};
  const welkin_sky_table_options options = small_tables();
  welkin_sky_tables* tables = NULL;
  welkin_constituent matter = {.struct_size = sizeof matter, .layer_count = 1};
  welkin_atmosphere air;
#define AIR(word, field, value)                                             \
  do {                                                                      \
    WELKIN_INIT(air);                                                       \
    air.field = value;                                                      \
    REFUSED(word, welkin_sky_tables_create(&air, &options, NULL, &tables)); \
    CHECK(tables == NULL);                                                  \
  } while (0)
  AIR("planet", planet, 8);
  AIR("wavelengths_nm", wavelength_count, 3);
  AIR("wavelength_count", wavelength_count, 97);
  AIR("wavelength_count", wavelength_count, -1);
  AIR("aerosol_phase", aerosol_phase, 3);
  AIR("absorber_count", absorber_count, 5);
  AIR("absorber_count", absorber_count, -2);
  AIR("absorbers", absorber_count, 1);
  AIR("layers", aerosol, &matter);
  matter.layer_count = 9;
  AIR("layer_count", rayleigh, &matter);
  matter.struct_size = 3;
  AIR("struct_size", rayleigh, &matter);
  AIR("radius", top_radius_m, 1.0);
  AIR("struct_size", struct_size, 3);
#undef AIR
  WELKIN_INIT(air);
  air.aerosol = &matter;
  air.aerosol_optics = numbers;
  REFUSED("aerosol_optics", welkin_sky_tables_create(&air, &options, NULL, &tables));
  REFUSED("direction", welkin_sun_direction(10.0, 0.0, NULL));
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_sun_direction(91.0, 0.0, numbers));
}

static void skies_that_are_refused(void) {
  welkin_worker* worker = make_worker();
  const welkin_atmosphere earth = {.struct_size = sizeof earth}, *const air = &earth;
  welkin_sky_table_options options = small_tables();
  welkin_sky_tables* tables = NULL;
  welkin_sky_tables* others = NULL;
  REFUSED("atmosphere", welkin_sky_tables_create(NULL, &options, NULL, &tables));
  REFUSED("tables", welkin_sky_tables_create(air, &options, NULL, NULL));
  options.compact = 2;
  REFUSED("compact", welkin_sky_tables_create(air, &options, NULL, &tables));
  options = small_tables();
  options.linear_srgb = -1;
  REFUSED("linear_srgb", welkin_sky_tables_create(air, &options, NULL, &tables));
  options = small_tables();
  options.minimum_sun_elevation_degrees = 5.0;
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_sky_tables_create(air, &options, NULL, &tables));
  CHECK(tables == NULL);
  options = small_tables();
  REFUSED("worker", welkin_post_sky_tables(NULL, air, &options, NULL, NULL));
  REFUSED("atmosphere", welkin_post_sky_tables(worker, NULL, &options, NULL, NULL));
  REFUSED("job", welkin_job_get_sky_tables(NULL, &tables));
  CHECK_STATUS(WELKIN_OK, welkin_sky_tables_create(air, &options, NULL, &tables));
  REFUSED("tables", welkin_sky_tables_save(NULL, "a"));
  REFUSED("path", welkin_sky_tables_save(tables, NULL));
  REFUSED("path", welkin_sky_tables_load(NULL, 0, &others));
  REFUSED("tables", welkin_sky_tables_load("a", 0, NULL));

  welkin_sky_view *view = NULL, *others_view = NULL;
  const double sun[3] = {0.0, 1.0, 0.0}, dark[3] = {0.0, 0.0, 0.0};
  double numbers[27];
  float floats[18] = {0.0F};
  REFUSED("tables", welkin_sky_view_create(NULL, 0.0, 0, &view));
  REFUSED("view", welkin_sky_view_create(tables, 0.0, 0, NULL));
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_sky_view_create(tables, -1.0, 0, &view));
  CHECK_STATUS(WELKIN_OK, welkin_sky_view_create(tables, 0.0, 0, &view));
  double steradians = 0.0;
  REFUSED("without_ground", welkin_sky_view_create(tables, 0.0, 2, &others_view));
  REFUSED("view", welkin_sky_view_radiance(NULL, floats, 1, sun, floats));
  REFUSED("directions", welkin_sky_view_radiance(view, NULL, 1, sun, floats));
  REFUSED("sun", welkin_sky_view_radiance(view, floats, 1, NULL, floats));
  REFUSED("rgb", welkin_sky_view_radiance(view, floats, 1, sun, NULL));
  REFUSED("view", welkin_sky_view_sun(NULL, sun, numbers, &steradians));
  REFUSED("sun", welkin_sky_view_sun(view, NULL, numbers, &steradians));
  REFUSED("irradiance", welkin_sky_view_sun(view, sun, NULL, &steradians));
  REFUSED("solid_angle", welkin_sky_view_sun(view, sun, numbers, NULL));
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_sky_view_sun(view, dark, numbers, &steradians));
  welkin_target faces = {.struct_size = sizeof faces, .size = 1};
  for (int face = 0; face < 6; ++face) faces.faces[face] = floats + 3 * face;
  REFUSED("view", welkin_sky_view_picture(NULL, sun, 0, NULL, &faces, NULL));
  REFUSED("sun", welkin_sky_view_picture(view, NULL, 0, NULL, &faces, NULL));
  REFUSED("target", welkin_sky_view_picture(view, sun, 0, NULL, NULL, NULL));
  REFUSED("sun_disc", welkin_sky_view_picture(view, sun, 2, NULL, &faces, NULL));
  welkin_chain* chain = NULL;
  REFUSED("view", welkin_sky_view_specular(NULL, sun, 0, NULL, NULL, &chain));
  REFUSED("sun", welkin_sky_view_specular(view, NULL, 0, NULL, NULL, &chain));
  REFUSED("chain", welkin_sky_view_specular(view, sun, 0, NULL, NULL, NULL));
  REFUSED("worker", welkin_post_sky_specular(NULL, tables, 0.0, sun, NULL, NULL, NULL));
  REFUSED("tables", welkin_post_sky_specular(worker, NULL, 0.0, sun, NULL, NULL, NULL));
  REFUSED("sun", welkin_post_sky_specular(worker, tables, 0.0, NULL, NULL, NULL, NULL));

  welkin_sky_curve* curve = NULL;
  REFUSED("view", welkin_sky_curve_create(NULL, NULL, NULL, &curve));
  REFUSED("curve", welkin_sky_curve_create(view, NULL, NULL, NULL));
  REFUSED("curve", welkin_sky_curve_at(NULL, sun, numbers, NULL));
  REFUSED("worker", welkin_post_sky_curve(NULL, tables, 0.0, NULL, NULL, NULL));
  REFUSED("tables", welkin_post_sky_curve(worker, NULL, 0.0, NULL, NULL, NULL));
  REFUSED("job", welkin_job_get_sky_curve(NULL, &curve));

  welkin_sky_light* sky = NULL;
  welkin_sky_light_options sky_options = {.struct_size = sizeof sky_options, .without_specular = 2};
  REFUSED("worker", welkin_sky_light_create(NULL, air, NULL, NULL, &sky));
  REFUSED("atmosphere", welkin_sky_light_create(worker, NULL, NULL, NULL, &sky));
  REFUSED("light", welkin_sky_light_create(worker, air, NULL, NULL, NULL));
  REFUSED("without_specular", welkin_sky_light_create(worker, air, NULL, &sky_options, &sky));
  sky_options.without_specular = 0;
  sky_options.priority = 5;
  REFUSED("priority", welkin_sky_light_create(worker, NULL, tables, &sky_options, &sky));
  REFUSED("light", welkin_sky_light_set_sun(NULL, sun));
  REFUSED("light", welkin_sky_light_set_intensity(NULL, 1.0));
  REFUSED("light", welkin_sky_light_set_altitude(NULL, 1.0));
  REFUSED("light", welkin_sky_light_set_atmosphere(NULL, air));
  REFUSED("light", welkin_sky_light_update(NULL, 0.1, NULL));
  REFUSED("light", welkin_sky_light_get_status(NULL));
  CHECK_STATUS(WELKIN_OK, welkin_sky_light_create(worker, NULL, tables, NULL, &sky));
  REFUSED("sun", welkin_sky_light_set_sun(sky, NULL));
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_sky_light_set_sun(sky, dark));
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_sky_light_set_intensity(sky, -1.0));
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_sky_light_set_altitude(sky, -1.0));
  REFUSED("atmosphere", welkin_sky_light_set_atmosphere(sky, NULL));
  REFUSED("frame", welkin_sky_light_update(sky, 0.1, NULL));

  welkin_sky_light_destroy(sky);
  welkin_sky_view_destroy(view);
  welkin_sky_tables_destroy(tables);
  welkin_worker_destroy(worker);
  welkin_sky_light_destroy(NULL);
  welkin_sky_curve_destroy(NULL);
  welkin_sky_view_destroy(NULL);
  welkin_sky_tables_destroy(NULL);
}

/* ---- Files ---- */

static void files_that_are_refused(void) {
  welkin_environment cubemap = uniform_cubemap(2, 1.0F, 1.0F, 1.0F);
  const welkin_prefilter_options small = {.struct_size = sizeof small, .size = 2};
  welkin_chain* chain = NULL;
  CHECK_STATUS(WELKIN_OK, welkin_prefilter(&cubemap, &small, NULL, &chain));
  double light[27] = {1.0};
  float rgb[3] = {1.0F, 1.0F, 1.0F};
  welkin_texture_options options = {.struct_size = sizeof options, .format = 8};
  REFUSED("path", welkin_write_texture(NULL, &cubemap, 1, NULL, NULL, NULL));
  REFUSED("mips", welkin_write_texture("a.ktx2", NULL, 1, NULL, NULL, NULL));
  REFUSED("format", welkin_write_texture("a.ktx2", &cubemap, 1, &options, NULL, NULL));
  options.format = WELKIN_TEXEL_RGBA16F;
  options.supercompression = 3;
  REFUSED("supercompression", welkin_write_texture("a.ktx2", &cubemap, 1, &options, NULL, NULL));
  options.supercompression = WELKIN_SUPERCOMPRESSION_NONE;
  options.effort = 5;
  REFUSED("effort", welkin_write_texture("a.ktx2", &cubemap, 1, &options, NULL, NULL));
  REFUSED("path", welkin_write_chain(NULL, chain, NULL, NULL, NULL));
  REFUSED("chain", welkin_write_chain("a.ktx2", NULL, NULL, NULL, NULL));
  welkin_environment flat = {.struct_size = sizeof flat, .width = 1, .height = 1};
  REFUSED("faces", welkin_write_texture("a.ktx2", &flat, 1, NULL, NULL, NULL));
  flat.faces[0] = rgb;
  flat.format = WELKIN_FORMAT_RGBA_F32;
  REFUSED("packed", welkin_write_texture("a.ktx2", &flat, 1, NULL, NULL, NULL));
  REFUSED("path", welkin_write_babylon_environment(NULL, chain, 3, light, NULL, NULL));
  REFUSED("specular", welkin_write_babylon_environment("a.env", NULL, 3, light, NULL, NULL));
  REFUSED("radiance", welkin_write_babylon_environment("a.env", chain, 3, NULL, NULL, NULL));
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_write_babylon_environment("a.env", chain, 0, light, NULL, NULL));
  welkin_chain_destroy(chain);
  free(pixels_of(&cubemap));
}

/* ---- What older programs' shorter structures get ---- */

static void shorter_results_fill_what_there_is(void) {
  welkin_environment cubemap = uniform_cubemap(4, 1.0F, 1.0F, 1.0F);
  const welkin_prefilter_options one = {.struct_size = sizeof one, .size = 4, .mips = 1};
  welkin_chain* chain = NULL;
  CHECK_STATUS(WELKIN_OK, welkin_prefilter(&cubemap, &one, NULL, &chain));
  welkin_mip mip;
  memset(&mip, 0x5a, sizeof mip);
  mip.struct_size = 16; /* it ends before the method */
  CHECK_STATUS(WELKIN_OK, welkin_chain_get_mip(chain, 0, &mip));
  CHECK(mip.size == 4 && mip.roughness == 0.0);
  const unsigned char* behind = (const unsigned char*)&mip;
  for (size_t i = 16; i < sizeof mip; ++i) CHECK(behind[i] == 0x5a);
  welkin_chain_destroy(chain);
  free(pixels_of(&cubemap));
}

void results(void) {
  uniform_light_stays_uniform();
  bakes_that_are_refused();
  chains_that_are_refused();
  tables_that_are_refused();
  harmonics_that_are_refused();
  atmospheres_that_are_refused();
  skies_that_are_refused();
  files_that_are_refused();
  shorter_results_fill_what_there_is();
}
