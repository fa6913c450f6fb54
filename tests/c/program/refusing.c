/* Invalid arguments are refused with a message and do no harm. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "support.h"

static void refused(welkin_status status, const char* word, int line) {
  check_status(WELKIN_INVALID_ARGUMENT, status, word, __FILE__, line);
  check(strstr(welkin_last_error(), word) != NULL, welkin_last_error(), __FILE__, line);
}
#define REFUSED(word, call) refused((call), (word), __LINE__)

static void null_pointers(void) {
  welkin_environment cubemap = uniform_cubemap(2, 1.0F, 1.0F, 1.0F);
  welkin_projection light = {.struct_size = sizeof light};
  double numbers[27] = {0.0};
  REFUSED("mips", welkin_project(NULL, 1, NULL, NULL, &light));
  REFUSED("projection", welkin_project(&cubemap, 1, NULL, NULL, NULL));
  REFUSED("path", welkin_project_file(NULL, NULL, NULL, NULL, &light));
  REFUSED("radiance", welkin_irradiance_from_radiance(3, NULL, numbers));
  REFUSED("irradiance", welkin_irradiance_from_radiance(3, numbers, NULL));
  REFUSED("direction", welkin_evaluate(3, numbers, NULL, numbers));
  REFUSED("value", welkin_evaluate(3, numbers, numbers, NULL));
  REFUSED("light", welkin_engine_light_from_radiance(3, numbers, WELKIN_ENGINE_UNITY, 1, NULL));
  REFUSED("worker", welkin_worker_create(NULL, NULL));
  REFUSED("worker", welkin_worker_terminate(NULL));
  REFUSED("worker", welkin_worker_wait_until_idle(NULL));
  REFUSED("worker", welkin_worker_drain(NULL, 0, NULL));
  REFUSED("worker", welkin_post_function(NULL, do_nothing, NULL, NULL, NULL));
  REFUSED("job", welkin_job_poll(NULL, NULL));
  REFUSED("job", welkin_job_wait(NULL, 0));
  REFUSED("job", welkin_job_projection(NULL, &light));
  REFUSED("job", welkin_job_cancel(NULL, NULL));
  REFUSED("job", welkin_job_set_priority(NULL, 0));
  REFUSED("control", welkin_control_report_progress(NULL, 0.5));
  CHECK(welkin_job_id(NULL) == 0);
  CHECK(welkin_control_stop_requested(NULL) == 0);
  welkin_job_retain(NULL);
  welkin_job_release(NULL);
  welkin_worker_destroy(NULL);

  for (int face = 0; face < 6; ++face) {
    welkin_environment broken = cubemap;
    broken.faces[face] = NULL;
    REFUSED("face", welkin_project(&broken, 1, NULL, NULL, &light));
  }
  free(pixels_of(&cubemap));
}

static void values_out_of_range(void) {
  welkin_environment cubemap = uniform_cubemap(2, 1.0F, 1.0F, 1.0F);
  welkin_projection light = {.struct_size = sizeof light};
  welkin_projection_options options;
#define OPTION(field, number)                                             \
  do {                                                                    \
    WELKIN_INIT(options);                                                 \
    options.field = number;                                               \
    REFUSED(#field, welkin_project(&cubemap, 1, &options, NULL, &light)); \
  } while (0)
  OPTION(bands, -1);
  OPTION(bands, 17);
  OPTION(midpoint, 2);
  OPTION(target_size, -1);
#undef OPTION
  welkin_pixel_policy policy;
#define POLICY(field, number)                                             \
  do {                                                                    \
    WELKIN_INIT(policy);                                                  \
    policy.field = number;                                                \
    REFUSED(#field, welkin_project(&cubemap, 1, &options, NULL, &light)); \
  } while (0)
  WELKIN_INIT(options);
  options.pixels = &policy;
  POLICY(clamp_preserve_colour, 2);
  POLICY(gamma, -1);
  POLICY(reject_nan, 2);
  POLICY(reject_infinity, -1);
  POLICY(negative, 3);
#undef POLICY
  WELKIN_INIT(policy);
  policy.clamp_maximum = -1.0F;
  REFUSED("clamp", welkin_project(&cubemap, 1, &options, NULL, &light));
  policy.clamp_maximum = (float)NAN;
  REFUSED("clamp", welkin_project(&cubemap, 1, &options, NULL, &light));

  REFUSED("mip_count", welkin_project(&cubemap, -1, NULL, NULL, &light));
  REFUSED("mip_count", welkin_project(&cubemap, 1 << 30, NULL, NULL, &light));
#define VIEW(word, field, number)                                  \
  do {                                                             \
    welkin_environment broken = cubemap;                           \
    broken.field = number;                                         \
    REFUSED(word, welkin_project(&broken, 1, NULL, NULL, &light)); \
  } while (0)
  VIEW("width", size, 0); /* a lat-long without texels */
  VIEW("width", width, 4);
  VIEW("height", height, 4);
  VIEW("size", size, -1);
  VIEW("size", size, INT64_MAX);
  VIEW("size", size, (int64_t)1 << 32);
  VIEW("format", format, 8);
  VIEW("format", format, INT32_MIN);
  VIEW("row_stride_bytes", row_stride_bytes, 1);
  VIEW("row_stride_bytes", row_stride_bytes, INT64_MIN);
#undef VIEW

  welkin_read_options reading = {.struct_size = sizeof reading, .layout = 7};
  REFUSED("layout", welkin_project_file("x.exr", &reading, NULL, NULL, &light));
  WELKIN_INIT(reading);
  reading.level = INT64_MAX;
  REFUSED("level", welkin_project_file("x.exr", &reading, NULL, NULL, &light));

  double numbers[27] = {0.0};
  welkin_engine_light form = {.struct_size = sizeof form};
  REFUSED("bands", welkin_irradiance_from_radiance(0, numbers, numbers));
  REFUSED("bands", welkin_evaluate(17, numbers, numbers, numbers));
  REFUSED("engine", welkin_engine_light_from_radiance(3, numbers, 99, 0, &form));
  REFUSED("OpenEXR", welkin_engine_light_from_radiance(3, numbers, 1, 0, &form)); /* has no form of its own */
  free(pixels_of(&cubemap));
}

static void workers_out_of_range(void) {
  welkin_worker_options options;
  welkin_worker* worker = NULL;
#define OPTION(field, number)                                 \
  do {                                                        \
    WELKIN_INIT(options);                                     \
    options.field = number;                                   \
    worker = (welkin_worker*)&options;                        \
    REFUSED(#field, welkin_worker_create(&options, &worker)); \
    CHECK(worker == NULL);                                    \
  } while (0)
  OPTION(threads, -1);
  OPTION(threads, 1025);
  OPTION(thread_priority, 4);
#undef OPTION
  CHECK_STATUS(WELKIN_OK, welkin_worker_create(NULL, &worker));
  welkin_job* job = NULL;
  CHECK_STATUS(WELKIN_OK, welkin_post_function(worker, do_nothing, NULL, NULL, &job));
  CHECK_STATUS(WELKIN_OK, welkin_job_wait(job, WELKIN_NO_LIMIT));
  REFUSED("priority", welkin_job_set_priority(job, 5));
  welkin_job_release(job);
  welkin_worker_destroy(worker);
}

static void messages_stay(void) {
  double numbers[3] = {0.0};
  REFUSED("bands", welkin_irradiance_from_radiance(-5, numbers, numbers));
  CHECK_STATUS(WELKIN_OK, welkin_irradiance_from_radiance(1, numbers, numbers));
  CHECK(strstr(welkin_last_error(), "-5") != NULL);
  CHECK(strcmp(welkin_status_name(WELKIN_OK), "ok") == 0);
  CHECK(strcmp(welkin_status_name(WELKIN_QUEUE_FULL), "queue_full") == 0);
  CHECK(strcmp(welkin_status_name(-1), "unknown") == 0);
}

void refusing(void) {
  null_pointers();
  values_out_of_range();
  workers_out_of_range();
  messages_stay();
}
