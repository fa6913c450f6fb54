/* A moving sky in C. The sun sets over a hundred frames. A worker computes the sky's tables, its curve and its
 * reflections while frames run. Each frame uses what is ready: the harmonics of the sky, the sun as a directional
 * light, and two chains of reflections with their weights.
 *
 *   sky_in_c [--quick]     # --quick: small tables, computed in a fraction of a second
 *
 * It prints the light of some frames, and exits with 1 if a number is wrong. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <threads.h>
#include <time.h>
#include <welkin/welkin.h>

enum { FRAMES = 240, PRINTED_EVERY = 40, ROW_ALIGNMENT = 256, REFLECTION_SIZE = 32 };

static const double highest_sun = 40.0, lowest_sun = -4.0; /* degrees */
static const double pi = 3.14159265358979323846;

/* Ends the program if a call failed. */
static void must(welkin_status status, const char* call) {
  if (status == WELKIN_OK) return;
  fprintf(stderr, "%s: %s: %s\n", call, welkin_status_name(status), welkin_last_error());
  exit(1);
}
#define MUST(call) must((call), #call)

static int failures = 0;
static void check(int holds, const char* what) {
  if (holds) return;
  fprintf(stderr, "not so: %s\n", what);
  ++failures;
}

static void pause_milliseconds(int milliseconds) {
  thrd_sleep(&(struct timespec){.tv_nsec = milliseconds * 1000000L}, NULL);
}

/* ---- Reflections on their way to the GPU: all levels as RGBA16F in one block, rows aligned as APIs want them. ---- */

typedef struct staging {
  uint64_t id; /* of the chain that it holds */
  unsigned char* bytes;
  size_t size;
  int32_t levels;
} staging;

static size_t row_pitch(int32_t size) { return ((size_t)size * 8 + ROW_ALIGNMENT - 1) / ROW_ALIGNMENT * ROW_ALIGNMENT; }

static void fill_staging(staging* to, uint64_t id, const welkin_chain* chain) {
  welkin_chain_info info = {.struct_size = sizeof info};
  MUST(welkin_chain_get_info(chain, &info));
  size_t size = 0;
  for (int32_t level = 0; level < info.levels; ++level) {
    const int32_t edge = info.size >> level > 1 ? info.size >> level : 1;
    size += 6 * (size_t)edge * row_pitch(edge);
  }
  if (to->size != size) {
    free(to->bytes);
    to->bytes = malloc(size);
    if (to->bytes == NULL) exit(1);
    to->size = size;
  }
  unsigned char* place = to->bytes;
  for (int32_t level = 0; level < info.levels; ++level) {
    const int32_t edge = info.size >> level > 1 ? info.size >> level : 1;
    welkin_target target = {.struct_size = sizeof target,
                            .format = WELKIN_FORMAT_RGBA_F16,
                            .row_stride_bytes = (int64_t)row_pitch(edge),
                            .size = edge};
    for (int face = 0; face < 6; ++face, place += (size_t)edge * row_pitch(edge)) target.faces[face] = place;
    MUST(welkin_chain_copy(chain, level, &target, NULL));
  }
  to->id = id;
  to->levels = info.levels;
}

/* Takes over what has come since the last frame: a chain that is there already is not copied again. */
static int take_reflections(staging textures[2], const welkin_sky_frame* frame) {
  int copies = 0;
  for (int i = 1; i >= 0; --i) { /* the older one first: it may be what was the newer one until now */
    const welkin_sky_reflections* wanted = &frame->reflections[i];
    if (wanted->id == 0 || wanted->id == textures[i].id) continue;
    if (wanted->id == textures[1 - i].id) {
      const staging other = textures[i];
      textures[i] = textures[1 - i];
      textures[1 - i] = other;
      continue;
    }
    fill_staging(&textures[i], wanted->id, wanted->chain);
    ++copies;
  }
  return copies;
}

/* ---- What a frame is shaded with ---- */

/* Irradiance on flat ground: of the sky, and of the sun. */
static double ground_irradiance(const welkin_sky_frame* frame, double rgb[3]) {
  static const double up[3] = {0.0, 1.0, 0.0};
  double irradiance[3 * WELKIN_MAXIMUM_BANDS * WELKIN_MAXIMUM_BANDS];
  MUST(welkin_irradiance_from_radiance(frame->bands, frame->coefficients, irradiance));
  MUST(welkin_evaluate(frame->bands, irradiance, up, rgb));
  const double cosine = frame->sun_direction[1] > 0.0 ? frame->sun_direction[1] : 0.0;
  for (int channel = 0; channel < 3; ++channel) rgb[channel] += cosine * frame->sun_irradiance[channel];
  return rgb[0] + rgb[1] + rgb[2];
}

static void print_frame(int number, double elevation, const double rgb[3], const welkin_sky_frame* frame) {
  welkin_engine_light form = {.struct_size = sizeof form};
  MUST(welkin_engine_light_from_radiance(frame->bands, frame->coefficients, WELKIN_ENGINE_THREE, 0, &form));
  printf(
      "frame %3d: sun at %6.2f degrees, ground %.4f %.4f %.4f, three.js coefficients[0] %.4f %.4f %.4f, "
      "reflections %llu\n",
      number, elevation, rgb[0], rgb[1], rgb[2], form.terms[0][0], form.terms[0][1], form.terms[0][2],
      (unsigned long long)frame->reflections[0].id);
}

static void turn_sun(welkin_sky_light* sky, double elevation, double azimuth) {
  double direction[3];
  MUST(welkin_sun_direction(elevation, azimuth, direction));
  MUST(welkin_sky_light_set_sun(sky, direction));
}

/* Frames until nothing is being made or blended. */
static void settle(welkin_sky_light* sky, welkin_sky_frame* frame) {
  const time_t begin = time(NULL);
  do {
    pause_milliseconds(2);
    MUST(welkin_sky_light_get_status(sky));
    MUST(welkin_sky_light_update(sky, 1.0 / 60.0, frame));
  } while (!frame->settled && difftime(time(NULL), begin) < 120.0);
  check(frame->ready && frame->settled, "the light settles");
}

static welkin_sky_light* make_sky(welkin_worker* worker, int quick) {
  const welkin_atmosphere earth = {.struct_size = sizeof earth, .planet = WELKIN_PLANET_EARTH};
  welkin_sky_table_options tables = {.struct_size = sizeof tables};
  if (quick) {
    tables.heights = 4;
    tables.view_zeniths = 32;
    tables.sun_zeniths = 32;
    tables.orders = 2;
  }
  const welkin_prefilter_options specular = {.struct_size = sizeof specular, .size = REFLECTION_SIZE};
  const welkin_sky_light_options options = {
      .struct_size = sizeof options, .tables = &tables, .specular = &specular, .blend_seconds = 0.25};
  welkin_sky_light* sky = NULL;
  MUST(welkin_sky_light_create(worker, &earth, NULL, &options, &sky));
  return sky;
}

/* The same sky in two forms has the same mean radiance, where no light is being blended. */
static void check_mean(const welkin_sky_frame* frame) {
  welkin_mip mip = {.struct_size = sizeof mip};
  MUST(welkin_chain_get_mip(frame->reflections[0].chain, 0, &mip));
  for (int channel = 0; channel < 3; ++channel) {
    const double of_harmonics = frame->coefficients[channel] / sqrt(4.0 * pi);
    const double difference = fabs(mip.mean[channel] * frame->reflections[0].weight - of_harmonics);
    check(difference < 0.02 * of_harmonics, "reflections and harmonics have the same mean radiance");
  }
}

int main(int count, char** arguments) {
  const int quick = count > 1 && strcmp(arguments[1], "--quick") == 0;
  welkin_worker_options options = {.struct_size = sizeof options, .threads = 1, .name = "sky"};
  welkin_worker* worker = NULL;
  MUST(welkin_worker_create(&options, &worker));
  welkin_sky_light* sky = make_sky(worker, quick);

  static welkin_sky_frame frame = {.struct_size = sizeof frame};
  static staging textures[2];
  turn_sun(sky, highest_sun, 145.0);
  settle(sky, &frame);
  check_mean(&frame);
  int copies = take_reflections(textures, &frame);
  check(copies == 1, "the first reflections have come");

  double before = INFINITY;
  for (int number = 0; number < FRAMES; ++number) {
    const double elevation = highest_sun + (lowest_sun - highest_sun) * number / (FRAMES - 1);
    turn_sun(sky, elevation, 145.0 + 0.1 * number);
    MUST(welkin_sky_light_update(sky, 1.0 / 60.0, &frame));
    copies += take_reflections(textures, &frame);
    double rgb[3];
    const double ground = ground_irradiance(&frame, rgb);
    check(ground > 0.0 && ground < before, "the ground gets darker while the sun sets");
    before = ground;
    if (number % PRINTED_EVERY == 0 || number == FRAMES - 1) print_frame(number, elevation, rgb, &frame);
    pause_milliseconds(1); /* the rest of a real frame */
  }

  settle(sky, &frame);
  copies += take_reflections(textures, &frame);
  check(textures[0].id == frame.reflections[0].id && copies >= 2, "reflections follow the sun");
  uint16_t texel[4];
  memcpy(texel, textures[0].bytes, sizeof texel);
  check(texel[2] != 0 && texel[3] == 0x3C00, "a texel of the reflections is blue, and its alpha is 1");

  printf("%llu chains of reflections, of which %d were copied\n", (unsigned long long)frame.reflections[0].id, copies);
  check((uint64_t)copies <= frame.reflections[0].id, "no chain is copied twice");

  welkin_sky_light_destroy(sky);
  welkin_worker_destroy(worker);
  for (int i = 0; i < 2; ++i) free(textures[i].bytes);
  return failures == 0 ? 0 : 1;
}
