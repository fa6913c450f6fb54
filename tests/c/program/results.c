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
  welkin_cubemap cubemap = uniform_cubemap(8, 1.0F, 2.0F, 3.0F);
  const welkin_prefilter_options specular = {.struct_size = sizeof specular, .size = 8};
  const welkin_bake_options options = {.struct_size = sizeof options, .irradiance_size = 4, .specular = &specular};
  welkin_bake_result* bake = NULL;
  CHECK_STATUS(WELKIN_OK, welkin_bake_cubemap(&cubemap, &options, NULL, &bake));
  free(pixels_of(&cubemap));
  welkin_bake_info info = {.struct_size = sizeof info};
  CHECK_STATUS(WELKIN_OK, welkin_bake_result_get_info(bake, &info));
  CHECK(info.parts == 31 && info.bands == 3 && info.brdf_width == 64 && info.brdf_height == 64);

  const welkin_cubemap_chain* reflections = welkin_bake_result_chain(bake, WELKIN_PART_SPECULAR);
  for (int32_t level = 0; level < 4; ++level) {
    float texels[6][8 * 8 * 4];
    welkin_cubemap_target target = {.struct_size = sizeof target, .format = WELKIN_FORMAT_RGBA_F32, .size = 8 >> level};
    for (int face = 0; face < 6; ++face) target.faces[face] = texels[face];
    uint64_t clamped = 99;
    CHECK_STATUS(WELKIN_OK, welkin_cubemap_chain_copy(reflections, level, &target, &clamped));
    CHECK(clamped == 0);
    CHECK(close_to(texels[5][0], 1.0, 1e-5) && close_to(texels[5][1], 2.0, 1e-5) && texels[5][3] == 1.0F);
  }
  welkin_cubemap irradiance = {.struct_size = sizeof irradiance};
  CHECK_STATUS(WELKIN_OK,
               welkin_cubemap_chain_get_level(welkin_bake_result_chain(bake, WELKIN_PART_IRRADIANCE), 0, &irradiance));
  CHECK(close_to(((const float*)irradiance.faces[2])[2], 3.0 * pi, 1e-4));
  CHECK(welkin_bake_result_chain(bake, WELKIN_PART_BRDF) == NULL);
  CHECK(welkin_bake_result_chain(bake, 0) == NULL);
  CHECK(welkin_bake_result_chain(bake, WELKIN_PART_BACKGROUND | WELKIN_PART_SPECULAR) == NULL);
  welkin_bake_result_destroy(bake);
}

static void bakes_that_are_refused(void) {
  welkin_cubemap cubemap = uniform_cubemap(4, 1.0F, 1.0F, 1.0F);
  const welkin_lat_long lat_long = {
      .struct_size = sizeof lat_long, .pixels = pixels_of(&cubemap), .width = 8, .height = 4};
  welkin_worker* worker = make_worker();
  welkin_bake_result* bake = NULL;
  welkin_job* job = NULL;
  REFUSED("cubemap", welkin_bake_cubemap(NULL, NULL, NULL, &bake));
  REFUSED("lat_long", welkin_bake_lat_long(NULL, NULL, NULL, &bake));
  REFUSED("result", welkin_bake_cubemap(&cubemap, NULL, NULL, NULL));
  REFUSED("result", welkin_bake_lat_long(&lat_long, NULL, NULL, NULL));
  REFUSED("path", welkin_bake_file(NULL, NULL, NULL, NULL, &bake));
  REFUSED("result", welkin_bake_file("a.exr", NULL, NULL, NULL, NULL));
  REFUSED("worker", welkin_post_bake_cubemap(NULL, &cubemap, NULL, NULL, &job));
  REFUSED("worker", welkin_post_bake_lat_long(NULL, &lat_long, NULL, NULL, &job));
  REFUSED("worker", welkin_post_bake_file(NULL, "a.exr", NULL, NULL, NULL, &job));
  REFUSED("cubemap", welkin_post_bake_cubemap(worker, NULL, NULL, NULL, &job));
  REFUSED("lat_long", welkin_post_bake_lat_long(worker, NULL, NULL, NULL, &job));
  REFUSED("worker", welkin_post_bake_cubemap_to(NULL, &cubemap, NULL, NULL, NULL, &job));
  REFUSED("targets", welkin_post_bake_cubemap_to(worker, &cubemap, NULL, NULL, NULL, &job));
  REFUSED("targets", welkin_post_bake_lat_long_to(worker, &lat_long, NULL, NULL, NULL, &job));
  REFUSED("path", welkin_post_bake_file(worker, NULL, NULL, NULL, NULL, &job));
  REFUSED("job", welkin_job_get_bake(NULL, &bake));
  REFUSED("result", welkin_bake_result_get_info(NULL, NULL));
  REFUSED("result", welkin_bake_result_get_projection(NULL, NULL));
  REFUSED("result", welkin_bake_result_copy_brdf(NULL, NULL, NULL));
  REFUSED("result", welkin_bake_result_copy_octahedral(NULL, 0, NULL, NULL));
  CHECK(welkin_bake_result_chain(NULL, WELKIN_PART_SPECULAR) == NULL);
  welkin_bake_result_destroy(NULL);

  welkin_bake_options options;
#define OPTION(field, number)                                              \
  do {                                                                     \
    WELKIN_INIT(options);                                                  \
    options.field = number;                                                \
    REFUSED(#field, welkin_bake_cubemap(&cubemap, &options, NULL, &bake)); \
    CHECK(bake == NULL);                                                   \
  } while (0)
  OPTION(leave_out, 32);
  OPTION(background_without_mips, 2);
  OPTION(mip_filter, 2);
  OPTION(irradiance_method, -1);
  OPTION(octahedral_levels, 2);
  OPTION(struct_size, 4);
  OPTION(struct_size, sizeof options + 4);
#undef OPTION
  WELKIN_INIT(options);
  options.bands = 17;
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_bake_cubemap(&cubemap, &options, NULL, &bake));
  WELKIN_INIT(options);
  options.irradiance_rms_error = -1;
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_bake_cubemap(&cubemap, &options, NULL, &bake));
  const welkin_pixel_policy policy = {.struct_size = sizeof policy};
  const welkin_prefilter_options specular = {.struct_size = sizeof specular, .pixels = &policy};
  WELKIN_INIT(options);
  options.specular = &specular; /* a bake has one policy for all parts */
  REFUSED("pixels", welkin_bake_cubemap(&cubemap, &options, NULL, &bake));

  /* Without harmonics and table there is nothing of them to be had. */
  options = (welkin_bake_options){
      .struct_size = sizeof options,
      .leave_out = WELKIN_PART_SPECULAR | WELKIN_PART_IRRADIANCE | WELKIN_PART_HARMONICS | WELKIN_PART_BRDF};
  CHECK_STATUS(WELKIN_OK, welkin_bake_cubemap(&cubemap, &options, NULL, &bake));
  welkin_projection light = {.struct_size = sizeof light};
  float numbers[3];
  welkin_image_target target = {.struct_size = sizeof target, .pixels = numbers, .width = 1, .height = 1};
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
  welkin_cubemap cubemap = uniform_cubemap(4, 1.0F, 1.0F, 1.0F);
  const welkin_lat_long lat_long = {
      .struct_size = sizeof lat_long, .pixels = pixels_of(&cubemap), .width = 8, .height = 4};
  welkin_worker* worker = make_worker();
  welkin_cubemap_chain* chain = NULL;
  REFUSED("cubemap", welkin_prefilter_cubemap(NULL, NULL, NULL, &chain));
  REFUSED("lat_long", welkin_prefilter_lat_long(NULL, NULL, NULL, &chain));
  REFUSED("chain", welkin_prefilter_cubemap(&cubemap, NULL, NULL, NULL));
  REFUSED("chain", welkin_prefilter_lat_long(&lat_long, NULL, NULL, NULL));
  REFUSED("worker", welkin_post_prefilter_cubemap(NULL, &cubemap, NULL, NULL, NULL));
  REFUSED("worker", welkin_post_prefilter_lat_long(NULL, &lat_long, NULL, NULL, NULL));
  REFUSED("cubemap", welkin_post_prefilter_cubemap(worker, NULL, NULL, NULL, NULL));
  REFUSED("lat_long", welkin_post_prefilter_lat_long(worker, NULL, NULL, NULL, NULL));
  REFUSED("job", welkin_job_get_chain(NULL, &chain));
  REFUSED("roughness", welkin_roughness_of_mips(WELKIN_ROUGHNESS_LINEAR, 4, 16, NULL));
  double roughness[17] = {0.0};
  REFUSED("schedule", welkin_roughness_of_mips(5, 4, 16, roughness));
  int32_t mips = 0;
  REFUSED("mips", welkin_mips_of_chain(WELKIN_ROUGHNESS_LINEAR, 16, NULL));
  REFUSED("schedule", welkin_mips_of_chain(5, 16, &mips));
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_roughness_of_mips(WELKIN_ROUGHNESS_LINEAR, 17, 16, roughness));

  welkin_prefilter_options options;
#define OPTION(field, number, word)                                            \
  do {                                                                         \
    WELKIN_INIT(options);                                                      \
    options.field = number;                                                    \
    REFUSED(word, welkin_prefilter_cubemap(&cubemap, &options, NULL, &chain)); \
    CHECK(chain == NULL);                                                      \
  } while (0)
  OPTION(roughness_count, -1, "roughness_count");
  OPTION(roughness_count, 17, "roughness_count");
  OPTION(roughness_count, 2, "roughness");
  OPTION(method, WELKIN_PREFILTER_COPY, "method");
  OPTION(size, -1, "size");
  OPTION(struct_size, 7, "struct_size");
#undef OPTION
  welkin_pixel_policy policy = {.struct_size = sizeof policy, .nan = 2};
  WELKIN_INIT(options);
  options.pixels = &policy;
  REFUSED("nan", welkin_prefilter_cubemap(&cubemap, &options, NULL, &chain));

  REFUSED("roughness", welkin_charlie_roughness_of_mips(4, 16, NULL));

  float numbers[8 * 4 + 5 + 9 * 4];
  REFUSED("lat_long", welkin_importance_lat_long(NULL, NULL, NULL, numbers, numbers, numbers, NULL));
  REFUSED("function", welkin_importance_lat_long(&lat_long, NULL, NULL, NULL, numbers, numbers, NULL));
  REFUSED("row_cdf", welkin_importance_lat_long(&lat_long, NULL, NULL, numbers, NULL, numbers, NULL));
  REFUSED("column_cdf", welkin_importance_lat_long(&lat_long, NULL, NULL, numbers, numbers, NULL, NULL));
  welkin_importance_options importance = {.struct_size = sizeof importance, .weight = 3};
  REFUSED("weight", welkin_importance_lat_long(&lat_long, &importance, NULL, numbers, numbers, numbers, NULL));

  WELKIN_INIT(options);
  options.size = 4;
  CHECK_STATUS(WELKIN_OK, welkin_prefilter_cubemap(&cubemap, &options, NULL, &chain));
  welkin_cubemap level = {.struct_size = sizeof level};
  welkin_mip mip = {.struct_size = sizeof mip};
  REFUSED("level", welkin_cubemap_chain_get_level(chain, 3, &level));
  REFUSED("level", welkin_cubemap_chain_get_level(chain, -1, &level));
  REFUSED("pixels", welkin_cubemap_chain_get_level(chain, 0, NULL));
  REFUSED("level", welkin_cubemap_chain_get_mip(chain, 3, &mip));
  REFUSED("mip", welkin_cubemap_chain_get_mip(chain, 0, NULL));
  REFUSED("info", welkin_cubemap_chain_get_info(chain, NULL));
  REFUSED("target", welkin_cubemap_chain_copy(chain, 0, NULL, NULL));
  REFUSED("another", welkin_cubemap_chain_share(chain, NULL));
  welkin_cubemap_chain_destroy(chain);
  REFUSED("chain", welkin_cubemap_chain_get_level(NULL, 0, &level));
  REFUSED("chain", welkin_cubemap_chain_get_mip(NULL, 0, &mip));
  REFUSED("chain", welkin_cubemap_chain_get_info(NULL, NULL));
  REFUSED("chain", welkin_cubemap_chain_copy(NULL, 0, NULL, NULL));
  chain = (welkin_cubemap_chain*)&cubemap;
  REFUSED("chain", welkin_cubemap_chain_share(NULL, &chain));
  CHECK(chain == NULL);
  welkin_cubemap_chain_destroy(NULL);
  welkin_worker_destroy(worker);
  free(pixels_of(&cubemap));
}

static void tables_that_are_refused(void) {
  float texels[6 * 3] = {0.0F};
  double numbers[27] = {0.0};
  welkin_image_target target = {.struct_size = sizeof target, .pixels = texels, .width = 2, .height = 2};
  welkin_cubemap_target faces = {.struct_size = sizeof faces, .size = 1};
  for (int face = 0; face < 6; ++face) faces.faces[face] = texels + 3 * face;
  welkin_brdf_options options = {.struct_size = sizeof options, .width = 2, .height = 2, .model = 2};
  REFUSED("model", welkin_brdf_table(&options, NULL, &target, NULL));
  options.model = WELKIN_BRDF_SPLIT_SUM;
  options.without_sheen = 3;
  REFUSED("without_sheen", welkin_brdf_table(&options, NULL, &target, NULL));
  options.without_sheen = 0;
  options.width = 5000;
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_brdf_table(&options, NULL, &target, NULL));
  options.width = 2;
  REFUSED("target", welkin_brdf_table(&options, NULL, NULL, NULL));
  target.pixels = NULL;
  REFUSED("null", welkin_brdf_table(&options, NULL, &target, NULL));
  REFUSED("irradiance", welkin_irradiance_cubemap(3, NULL, NULL, &faces, NULL));
  REFUSED("target", welkin_irradiance_cubemap(3, numbers, NULL, NULL, NULL));
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_irradiance_cubemap(0, numbers, NULL, &faces, NULL));
  CHECK_STATUS(WELKIN_OK, welkin_irradiance_cubemap(3, numbers, NULL, &faces, NULL));
}

/* ---- Harmonics and engines ---- */

static void harmonics_that_are_refused(void) {
  double light[27] = {1.0}, to[27], value[3];
  const double quaternion[4] = {0.0, 0.0, 0.0, 1.0}, none[9] = {0.0};
  int32_t found = 0;
  welkin_sun sun = {.struct_size = sizeof sun};
  REFUSED("coefficients", welkin_turn_by_quaternion(3, NULL, quaternion, to));
  REFUSED("quaternion", welkin_turn_by_quaternion(3, light, NULL, to));
  REFUSED("turned", welkin_turn_by_quaternion(3, light, quaternion, NULL));
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_turn_by_quaternion(3, light, none, to));
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_turn_by_quaternion(17, light, quaternion, to));
  REFUSED("coefficients", welkin_turn_by_matrix(3, NULL, none, to));
  REFUSED("matrix", welkin_turn_by_matrix(3, light, NULL, to));
  REFUSED("turned", welkin_turn_by_matrix(3, light, none, NULL));
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_turn_by_matrix(3, light, none, to));
  REFUSED("radiance", welkin_apply_window(3, NULL, WELKIN_WINDOW_HANNING, 0.0, to, NULL));
  REFUSED("windowed", welkin_apply_window(3, light, WELKIN_WINDOW_HANNING, 0.0, NULL, NULL));
  REFUSED("window", welkin_apply_window(3, light, 4, 0.0, to, NULL));
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_apply_window(3, light, WELKIN_WINDOW_HANNING, -1.0, to, NULL));
  welkin_window_report report = {.struct_size = 3};
  to[0] = 7.0;
  REFUSED("report", welkin_apply_window(3, light, WELKIN_WINDOW_HANNING, 0.0, to, &report));
  CHECK(to[0] == 7.0); /* a call that fails writes none of its results */
  REFUSED("coefficients", welkin_minimum(3, NULL, value, NULL));
  REFUSED("value", welkin_minimum(3, light, NULL, NULL));
  REFUSED("radiance", welkin_exposure_of(3, NULL, value));
  REFUSED("exposure", welkin_exposure_of(3, light, NULL));
  REFUSED("radiance", welkin_dominant_light(3, NULL, value, value, &found));
  REFUSED("direction", welkin_dominant_light(3, light, NULL, value, &found));
  REFUSED("irradiance", welkin_dominant_light(3, light, value, NULL, &found));
  REFUSED("found", welkin_dominant_light(3, light, value, value, NULL));
  REFUSED("sun", welkin_sun_harmonics(NULL, 3, to));
  REFUSED("coefficients", welkin_sun_harmonics(&sun, 3, NULL));
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_sun_harmonics(&sun, 3, to)); /* it has no direction */

  welkin_convention convention = {.struct_size = sizeof convention};
  REFUSED("engine", welkin_get_convention(12, &convention));
  REFUSED("convention", welkin_get_convention(WELKIN_ENGINE_UNITY, NULL));
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
  welkin_atmosphere* air = NULL;
  double numbers[4] = {500.0, 500.0, 500.0, 500.0};
  REFUSED("planet", welkin_atmosphere_create(8, &air));
  REFUSED("atmosphere", welkin_atmosphere_create(WELKIN_PLANET_EARTH, NULL));
  REFUSED("wavelengths_nm", welkin_atmosphere_create_earth(NULL, 3, &air));
  REFUSED("wavelengths_nm", welkin_atmosphere_create_earth(numbers, 97, &air));
  REFUSED("atmosphere", welkin_atmosphere_create_earth(numbers, 3, NULL));
  REFUSED("atmosphere", welkin_atmosphere_set_wavelengths(NULL, numbers, 3));
  REFUSED("atmosphere", welkin_atmosphere_set_matter(NULL, 0, NULL));
  REFUSED("atmosphere", welkin_atmosphere_set_aerosol_phase(NULL, 0, 0.5));
  REFUSED("atmosphere", welkin_atmosphere_set_aerosol_asymmetries(NULL, numbers, 3));
  REFUSED("atmosphere", welkin_atmosphere_set_night(NULL, 2e-4));
  REFUSED("atmosphere", welkin_atmosphere_set_radii(NULL, 1.0, 2.0));
  REFUSED("atmosphere", welkin_atmosphere_set_ground_albedo(NULL, numbers, 1));
  REFUSED("atmosphere", welkin_atmosphere_set_sun(NULL, numbers, 3, 0.2));
  REFUSED("atmosphere", welkin_atmosphere_check(NULL));
  CHECK_STATUS(WELKIN_OK, welkin_atmosphere_create(WELKIN_PLANET_EARTH, &air));
  welkin_constituent matter = {.struct_size = sizeof matter, .layer_count = 1};
  REFUSED("matter", welkin_atmosphere_set_matter(air, -1, NULL));
  REFUSED("layers", welkin_atmosphere_set_matter(air, WELKIN_MATTER_AEROSOL, &matter));
  matter.layer_count = 9;
  REFUSED("layer_count", welkin_atmosphere_set_matter(air, WELKIN_MATTER_AEROSOL, &matter));
  matter.struct_size = 3;
  REFUSED("struct_size", welkin_atmosphere_set_matter(air, WELKIN_MATTER_AEROSOL, &matter));
  REFUSED("wavelengths_nm", welkin_atmosphere_set_wavelengths(air, NULL, 3));
  REFUSED("phase", welkin_atmosphere_set_aerosol_phase(air, 2, 0.5));
  REFUSED("asymmetries", welkin_atmosphere_set_aerosol_asymmetries(air, NULL, 3));
  REFUSED("asymmetries", welkin_atmosphere_set_aerosol_asymmetries(air, numbers, -1));
  REFUSED("albedo", welkin_atmosphere_set_ground_albedo(air, NULL, 1));
  REFUSED("albedo", welkin_atmosphere_set_ground_albedo(air, numbers, -1));
  REFUSED("irradiance", welkin_atmosphere_set_sun(air, NULL, 3, 0.2));
  CHECK_STATUS(WELKIN_OK, welkin_atmosphere_check(air)); /* nothing of that has changed it */
  REFUSED("direction", welkin_sun_direction(10.0, 0.0, NULL));
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_sun_direction(91.0, 0.0, numbers));
  welkin_atmosphere_destroy(air);
  welkin_atmosphere_destroy(NULL);
}

static void skies_that_are_refused(void) {
  welkin_worker* worker = make_worker();
  welkin_atmosphere* air = NULL;
  CHECK_STATUS(WELKIN_OK, welkin_atmosphere_create(WELKIN_PLANET_EARTH, &air));
  welkin_sky_table_options options = small_tables();
  welkin_sky_tables* tables = NULL;
  welkin_sky_tables* others = NULL;
  REFUSED("atmosphere", welkin_sky_tables_create(NULL, &options, NULL, &tables));
  REFUSED("tables", welkin_sky_tables_create(air, &options, NULL, NULL));
  options.layout = 2;
  REFUSED("layout", welkin_sky_tables_create(air, &options, NULL, &tables));
  options = small_tables();
  options.colour = -1;
  REFUSED("colour", welkin_sky_tables_create(air, &options, NULL, &tables));
  options = small_tables();
  options.minimum_sun_elevation_degrees = 5.0;
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_sky_tables_create(air, &options, NULL, &tables));
  CHECK(tables == NULL);
  options = small_tables();
  REFUSED("worker", welkin_post_sky_tables(NULL, air, &options, NULL, NULL));
  REFUSED("atmosphere", welkin_post_sky_tables(worker, NULL, &options, NULL, NULL));
  REFUSED("job", welkin_job_get_sky_tables(NULL, &tables));
  CHECK_STATUS(WELKIN_OK, welkin_sky_tables_create(air, &options, NULL, &tables));
  REFUSED("tables", welkin_sky_tables_get_info(NULL, NULL));
  REFUSED("info", welkin_sky_tables_get_info(tables, NULL));
  REFUSED("tables", welkin_sky_tables_save(NULL, "a"));
  REFUSED("path", welkin_sky_tables_save(tables, NULL));
  REFUSED("path", welkin_sky_tables_load(NULL, 0, &others));
  REFUSED("tables", welkin_sky_tables_load("a", 0, NULL));

  welkin_sky_view* view = NULL;
  const double sun[3] = {0.0, 1.0, 0.0}, dark[3] = {0.0, 0.0, 0.0};
  double numbers[27];
  float floats[18] = {0.0F};
  REFUSED("tables", welkin_sky_view_create(NULL, 0.0, NULL, &view));
  REFUSED("view", welkin_sky_view_create(tables, 0.0, NULL, NULL));
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_sky_view_create(tables, -1.0, NULL, &view));
  CHECK_STATUS(WELKIN_OK, welkin_sky_view_create(tables, 0.0, NULL, &view));
  welkin_sun light = {.struct_size = sizeof light};
  REFUSED("view", welkin_sky_view_radiance(NULL, floats, 1, sun, floats));
  REFUSED("directions", welkin_sky_view_radiance(view, NULL, 1, sun, floats));
  REFUSED("sun", welkin_sky_view_radiance(view, floats, 1, NULL, floats));
  REFUSED("rgb", welkin_sky_view_radiance(view, floats, 1, sun, NULL));
  REFUSED("view", welkin_sky_view_sun(NULL, sun, &light));
  REFUSED("sun", welkin_sky_view_sun(view, NULL, &light));
  REFUSED("light", welkin_sky_view_sun(view, sun, NULL));
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_sky_view_sun(view, dark, &light));
  REFUSED("view", welkin_sky_view_irradiance(NULL, sun, numbers));
  REFUSED("sun", welkin_sky_view_irradiance(view, NULL, numbers));
  REFUSED("irradiance", welkin_sky_view_irradiance(view, sun, NULL));
  welkin_cubemap_target faces = {.struct_size = sizeof faces, .size = 1};
  for (int face = 0; face < 6; ++face) faces.faces[face] = floats + 3 * face;
  const welkin_image_target image = {.struct_size = sizeof image, .pixels = floats, .width = 2, .height = 1};
  const welkin_sky_picture_options wrong = {.struct_size = sizeof wrong, .sun_disc = 2};
  REFUSED("view", welkin_sky_view_cubemap(NULL, sun, NULL, NULL, &faces, NULL));
  REFUSED("sun", welkin_sky_view_cubemap(view, NULL, NULL, NULL, &faces, NULL));
  REFUSED("target", welkin_sky_view_cubemap(view, sun, NULL, NULL, NULL, NULL));
  REFUSED("sun_disc", welkin_sky_view_cubemap(view, sun, &wrong, NULL, &faces, NULL));
  REFUSED("view", welkin_sky_view_lat_long(NULL, sun, NULL, NULL, &image, NULL));
  REFUSED("sun", welkin_sky_view_lat_long(view, NULL, NULL, NULL, &image, NULL));
  REFUSED("target", welkin_sky_view_lat_long(view, sun, NULL, NULL, NULL, NULL));
  welkin_cubemap_chain* chain = NULL;
  REFUSED("view", welkin_sky_view_specular(NULL, sun, NULL, NULL, NULL, &chain));
  REFUSED("sun", welkin_sky_view_specular(view, NULL, NULL, NULL, NULL, &chain));
  REFUSED("chain", welkin_sky_view_specular(view, sun, NULL, NULL, NULL, NULL));
  REFUSED("worker", welkin_post_sky_specular(NULL, tables, 0.0, sun, NULL, NULL, NULL));
  REFUSED("tables", welkin_post_sky_specular(worker, NULL, 0.0, sun, NULL, NULL, NULL));
  REFUSED("sun", welkin_post_sky_specular(worker, tables, 0.0, NULL, NULL, NULL, NULL));

  welkin_sky_projector* projector = NULL;
  welkin_sky_curve* curve = NULL;
  const welkin_sky_harmonics_options rule = {.struct_size = sizeof rule, .quadrature = 3};
  REFUSED("view", welkin_sky_projector_create(NULL, NULL, &projector));
  REFUSED("projector", welkin_sky_projector_create(view, NULL, NULL));
  REFUSED("quadrature", welkin_sky_projector_create(view, &rule, &projector));
  REFUSED("projector", welkin_sky_projector_project(NULL, sun, numbers));
  CHECK_STATUS(WELKIN_OK, welkin_sky_projector_create(view, NULL, &projector));
  REFUSED("sun", welkin_sky_projector_project(projector, NULL, numbers));
  REFUSED("coefficients", welkin_sky_projector_project(projector, sun, NULL));
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_sky_projector_project(projector, dark, numbers));
  REFUSED("view", welkin_sky_curve_create(NULL, NULL, NULL, &curve));
  REFUSED("curve", welkin_sky_curve_create(view, NULL, NULL, NULL));
  REFUSED("quadrature", welkin_sky_curve_create(view, &rule, NULL, &curve));
  REFUSED("curve", welkin_sky_curve_at(NULL, sun, numbers, NULL));
  REFUSED("worker", welkin_post_sky_curve(NULL, tables, 0.0, NULL, NULL, NULL));
  REFUSED("tables", welkin_post_sky_curve(worker, NULL, 0.0, NULL, NULL, NULL));
  REFUSED("job", welkin_job_get_sky_curve(NULL, &curve));

  welkin_sky_light* sky = NULL;
  welkin_sky_light_options sky_options = {.struct_size = sizeof sky_options, .without_specular = 2};
  REFUSED("worker", welkin_sky_light_create(NULL, air, NULL, &sky));
  REFUSED("atmosphere", welkin_sky_light_create(worker, NULL, NULL, &sky));
  REFUSED("light", welkin_sky_light_create(worker, air, NULL, NULL));
  REFUSED("without_specular", welkin_sky_light_create(worker, air, &sky_options, &sky));
  sky_options.without_specular = 0;
  sky_options.priority = 5;
  REFUSED("priority", welkin_sky_light_create_with_tables(worker, tables, &sky_options, &sky));
  REFUSED("worker", welkin_sky_light_create_with_tables(NULL, tables, NULL, &sky));
  REFUSED("tables", welkin_sky_light_create_with_tables(worker, NULL, NULL, &sky));
  REFUSED("light", welkin_sky_light_set_sun(NULL, sun));
  REFUSED("light", welkin_sky_light_set_intensity(NULL, 1.0));
  REFUSED("light", welkin_sky_light_set_altitude(NULL, 1.0));
  REFUSED("light", welkin_sky_light_set_atmosphere(NULL, air));
  REFUSED("light", welkin_sky_light_update(NULL, 0.1, NULL));
  REFUSED("light", welkin_sky_light_get_counters(NULL, NULL));
  REFUSED("light", welkin_sky_light_get_status(NULL));
  CHECK_STATUS(WELKIN_OK, welkin_sky_light_create_with_tables(worker, tables, NULL, &sky));
  REFUSED("sun", welkin_sky_light_set_sun(sky, NULL));
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_sky_light_set_sun(sky, dark));
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_sky_light_set_intensity(sky, -1.0));
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_sky_light_set_altitude(sky, -1.0));
  REFUSED("atmosphere", welkin_sky_light_set_atmosphere(sky, NULL));
  REFUSED("frame", welkin_sky_light_update(sky, 0.1, NULL));
  REFUSED("counters", welkin_sky_light_get_counters(sky, NULL));

  welkin_sky_light_destroy(sky);
  welkin_sky_projector_destroy(projector);
  welkin_sky_view_destroy(view);
  welkin_sky_tables_destroy(tables);
  welkin_atmosphere_destroy(air);
  welkin_worker_destroy(worker);
  welkin_sky_light_destroy(NULL);
  welkin_sky_curve_destroy(NULL);
  welkin_sky_projector_destroy(NULL);
  welkin_sky_view_destroy(NULL);
  welkin_sky_tables_destroy(NULL);
}

/* ---- Files ---- */

static void files_that_are_refused(void) {
  welkin_cubemap cubemap = uniform_cubemap(2, 1.0F, 1.0F, 1.0F);
  const welkin_prefilter_options small = {.struct_size = sizeof small, .size = 2};
  welkin_cubemap_chain* chain = NULL;
  CHECK_STATUS(WELKIN_OK, welkin_prefilter_cubemap(&cubemap, &small, NULL, &chain));
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
  options.bc6h_effort = 4;
  REFUSED("bc6h_effort", welkin_write_texture("a.ktx2", &cubemap, 1, &options, NULL, NULL));
  options.bc6h_effort = WELKIN_BC6H_DEFAULT;
  options.astc_effort = 5;
  REFUSED("astc_effort", welkin_write_texture("a.ktx2", &cubemap, 1, &options, NULL, NULL));
  REFUSED("path", welkin_write_chain(NULL, chain, NULL, NULL, NULL));
  REFUSED("chain", welkin_write_chain("a.ktx2", NULL, NULL, NULL, NULL));
  REFUSED("path", welkin_write_flat_texture(NULL, 1, 1, rgb, NULL, NULL, NULL));
  REFUSED("rgb", welkin_write_flat_texture("a.ktx2", 1, 1, NULL, NULL, NULL, NULL));
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_write_flat_texture("a.ktx2", 0, 1, rgb, NULL, NULL, NULL));
  REFUSED("path", welkin_write_babylon_environment(NULL, chain, 3, light, NULL, NULL));
  REFUSED("specular", welkin_write_babylon_environment("a.env", NULL, 3, light, NULL, NULL));
  REFUSED("radiance", welkin_write_babylon_environment("a.env", chain, 3, NULL, NULL, NULL));
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_write_babylon_environment("a.env", chain, 0, light, NULL, NULL));
  welkin_cubemap_chain_destroy(chain);
  free(pixels_of(&cubemap));
}

/* ---- What older programs' shorter structures get ---- */

static void shorter_results_fill_what_there_is(void) {
  welkin_convention convention;
  memset(&convention, 0x5a, sizeof convention);
  convention.struct_size = 16; /* it ends before the names */
  CHECK_STATUS(WELKIN_OK, welkin_get_convention(WELKIN_ENGINE_BABYLON, &convention));
  CHECK(convention.engine == WELKIN_ENGINE_BABYLON && convention.right_handed == 0 && convention.has_faces == 1);
  const unsigned char* behind = (const unsigned char*)&convention;
  for (size_t i = 16; i < sizeof convention; ++i) CHECK(behind[i] == 0x5a);
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
