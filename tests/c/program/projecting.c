/* Light of environments whose light is known, while the caller waits. (tests/c compares all options' bits.) */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "support.h"

static const double pi = 3.14159265358979323846;

/* Rows of white from below upwards. */
static void lat_longs(void) {
  enum { width = 16, height = 8 };
  unsigned char pixels[height * width * 4];
  for (size_t i = 0; i < sizeof pixels; ++i) pixels[i] = 255;
  const welkin_environment lat_long = {.struct_size = sizeof lat_long,
                                       .format = WELKIN_FORMAT_RGBA_U8,
                                       .row_stride_bytes = -(width * 4),
                                       .faces = {pixels + (height - 1) * width * 4},
                                       .width = width,
                                       .height = height};
  welkin_projection light = {.struct_size = sizeof light};
  CHECK_STATUS(WELKIN_OK, welkin_project(&lat_long, 1, NULL, NULL, &light));
  CHECK(close_to(light.total_radiance[1], 4.0 * pi, 1e-5));
}

/* A PFM of radiance (1, 2, 3) everywhere, little-endian: this program's processor is. */
static void files(void) {
  char name[] = "/tmp/welkin-c-XXXXXX";
  const int descriptor = mkstemp(name);
  FILE* file = descriptor < 0 ? NULL : fdopen(descriptor, "wb");
  if (file == NULL) abort();
  const float rgb[3] = {1.0F, 2.0F, 3.0F};
  fprintf(file, "PF\n16 8\n-1.0\n");
  for (int i = 0; i < 16 * 8; ++i) fwrite(rgb, sizeof rgb, 1, file);
  fclose(file);

  welkin_projection light = {.struct_size = sizeof light};
  CHECK_STATUS(WELKIN_OK, welkin_project_file(name, NULL, NULL, NULL, &light));
  CHECK(light.bands == 3 && light.struct_size == sizeof light);
  for (int i = 0; i < 27; ++i) {
    CHECK(close_to(light.coefficients[i], i < 3 ? sqrt(4.0 * pi) * (i + 1) : 0.0, 1e-5));
  }
  const welkin_projection before = light;
  const welkin_read_options small = {.struct_size = sizeof small, .memory_limit_bytes = 16};
  CHECK_STATUS(WELKIN_LIMIT_EXCEEDED, welkin_project_file(name, &small, NULL, NULL, &light));
  remove(name);
  CHECK_STATUS(WELKIN_FILE_ACCESS, welkin_project_file(name, NULL, NULL, NULL, &light));
  CHECK(strstr(welkin_last_error(), name) != NULL);
  CHECK(memcmp(&light, &before, sizeof light) == 0); /* a call that fails writes nothing */
}

void projecting(void) {
  lat_longs();
  files();
}
