/* Programs that were compiled against an older or a newer header than the library. */
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "support.h"

/* A structure as a later version might declare it. */
typedef struct newer_options {
  welkin_projection_options known;
  int32_t another, and_another;
} newer_options;

typedef struct newer_environment {
  welkin_environment known;
  double another;
} newer_environment;

typedef struct newer_info {
  welkin_chain_info known;
  uint64_t another;
} newer_info;

static void the_library_says_its_version(void) { CHECK(welkin_c_version() >= WELKIN_C_VERSION); }

static void shorter_ones_have_defaults(void) {
  welkin_environment cubemap = uniform_cubemap(4, 1.0F, 1.0F, 1.0F);
  welkin_projection light = {.struct_size = sizeof light};
  welkin_projection_options options;
  WELKIN_INIT(options);
  options.bands = 5;
  const welkin_pixel_policy policy = {.struct_size = sizeof policy, .clamp_maximum = -1.0F};
  options.pixels = &policy; /* would be refused, but lies behind the end */
  options.struct_size = offsetof(welkin_projection_options, pixels);
  CHECK_STATUS(WELKIN_OK, welkin_project(&cubemap, 1, &options, NULL, &light));
  CHECK(light.bands == 5);

  cubemap.struct_size = offsetof(welkin_environment, size); /* it lacks its size */
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_project(&cubemap, 1, NULL, NULL, &light));
  free(pixels_of(&cubemap));
}

static void longer_ones_must_be_zero(void) {
  welkin_environment cubemap = uniform_cubemap(4, 1.0F, 1.0F, 1.0F);
  welkin_projection light = {.struct_size = sizeof light};
  newer_options options;
  memset(&options, 0, sizeof options);
  options.known.struct_size = sizeof options;
  options.known.bands = 4;
  CHECK_STATUS(WELKIN_OK, welkin_project(&cubemap, 1, &options.known, NULL, &light));
  CHECK(light.bands == 4);
  options.and_another = 1;
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_project(&cubemap, 1, &options.known, NULL, &light));
  CHECK(strstr(welkin_last_error(), "does not have") != NULL);

  newer_environment mips[2];
  memset(mips, 0, sizeof mips);
  mips[0].known = cubemap;
  mips[1].known = uniform_cubemap(2, 2.0F, 2.0F, 2.0F);
  mips[0].known.struct_size = mips[1].known.struct_size = sizeof *mips;
  const welkin_projection_options reduced = {.struct_size = sizeof reduced, .target_size = 2};
  CHECK_STATUS(WELKIN_OK, welkin_project(&mips[0].known, 2, &reduced, NULL, &light));
  CHECK(close_to(light.total_radiance[0], 8.0 * 3.14159265358979, 1e-4)); /* the second level was found where it lies */
  mips[1].known.struct_size = sizeof(welkin_environment);
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_project(&mips[0].known, 2, &reduced, NULL, &light));
  free(pixels_of(&mips[0].known));
  free(pixels_of(&mips[1].known));
}

/* A post that is refused because its options are newer still releases what was handed over. */
static void newer_posts_are_released(void) {
  struct {
    welkin_post_options known;
    void* another;
  } post;
  counter up = {0};
  memset(&post, 0, sizeof post);
  post.known.struct_size = sizeof post;
  post.known.release = count_up;
  post.known.release_user = &up;
  post.another = &up;
  welkin_worker* worker = make_worker();
  gate open = {1, 0};
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_post_function(worker, wait_at_gate, &open, &post.known, NULL));
  CHECK(counted(&up) == 1);
  post.another = NULL;
  CHECK_STATUS(WELKIN_OK, welkin_post_function(worker, wait_at_gate, &open, &post.known, NULL));

  /* An older structure that ends before the callbacks. */
  post.known.struct_size = offsetof(welkin_post_options, release);
  CHECK_STATUS(WELKIN_OK, welkin_post_function(worker, wait_at_gate, &open, &post.known, NULL));
  welkin_worker_destroy(worker);
  CHECK(counted(&up) == 2);
}

static void results_fill_what_there_is(void) {
  welkin_environment cubemap = uniform_cubemap(4, 1.0F, 1.0F, 1.0F);
  welkin_projection whole = {.struct_size = sizeof whole};
  CHECK_STATUS(WELKIN_OK, welkin_project(&cubemap, 1, NULL, NULL, &whole));

  /* Memory for three bands, followed by a byte pattern. */
  const size_t three_bands = offsetof(welkin_projection, coefficients) + 27 * sizeof(double);
  welkin_projection small;
  memset(&small, 0x5a, sizeof small);
  small.struct_size = (uint32_t)three_bands;
  CHECK_STATUS(WELKIN_OK, welkin_project(&cubemap, 1, NULL, NULL, &small));
  CHECK(small.struct_size == three_bands);
  CHECK(memcmp((char*)&small + 4, (char*)&whole + 4, three_bands - 4) == 0);
  const unsigned char* behind = (const unsigned char*)&small;
  for (size_t i = three_bands; i < sizeof small; ++i) CHECK(behind[i] == 0x5a);
  const welkin_projection_options four = {.struct_size = sizeof four, .bands = 4};
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_project(&cubemap, 1, &four, NULL, &small));

  const welkin_prefilter_options one = {.struct_size = sizeof one, .size = 4, .mips = 1};
  welkin_chain* chain = NULL;
  CHECK_STATUS(WELKIN_OK, welkin_prefilter(&cubemap, &one, NULL, &chain));
  newer_info info;
  memset(&info, 0x5a, sizeof info);
  info.known.struct_size = sizeof info;
  CHECK_STATUS(WELKIN_OK, welkin_chain_get_info(chain, &info.known));
  CHECK(info.known.struct_size == sizeof info && info.known.size == 4 && info.another == 0);
  welkin_chain_destroy(chain);
  free(pixels_of(&cubemap));
}

static void sizes_that_are_none(void) {
  welkin_environment cubemap = uniform_cubemap(4, 1.0F, 1.0F, 1.0F);
  welkin_projection light = {.struct_size = sizeof light};
  const uint32_t sizes[] = {0, 1, 4, 7, sizeof cubemap - 4, sizeof cubemap + 1, 1 << 20, UINT32_MAX};
  for (size_t i = 0; i < sizeof sizes / sizeof *sizes; ++i) {
    cubemap.struct_size = sizes[i];
    CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_project(&cubemap, 1, NULL, NULL, &light));
    CHECK(strstr(welkin_last_error(), "struct_size") != NULL);
  }
  cubemap.struct_size = sizeof cubemap;
  light.struct_size = 0;
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_project(&cubemap, 1, NULL, NULL, &light));
  free(pixels_of(&cubemap));
}

void versions(void) {
  the_library_says_its_version();
  shorter_ones_have_defaults();
  longer_ones_must_be_zero();
  newer_posts_are_released();
  results_fill_what_there_is();
  sizes_that_are_none();
}
