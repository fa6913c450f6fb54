/* Calls that run out of memory report it and release what was handed over: the first allocation of the calling thread
 * fails, then the second, and so on until the call succeeds. */
#include <errno.h>
#include <stdlib.h>

#include "support.h"

/* Sanitizers have their own heap, in which no allocation can be made to fail. */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(__GLIBC__)
void memory(void) {}
#else

/* The program's malloc takes the place of glibc's, for operator new too; glibc's own name leads to the real one. */
extern void* __libc_malloc(size_t size);
extern void* __libc_memalign(size_t alignment, size_t size);

static __thread int until_failure = -1; /* allocations of this thread; below 0: none fails */

static int fails(void) {
  if (until_failure < 0) return 0;
  return until_failure-- == 0;
}

void* malloc(size_t size) {
  if (!fails()) return __libc_malloc(size);
  errno = ENOMEM;
  return NULL;
}

void* aligned_alloc(size_t alignment, size_t size) {
  if (!fails()) return __libc_memalign(alignment, size);
  errno = ENOMEM;
  return NULL;
}

static welkin_worker* worker;
static welkin_environment cubemap;
static const welkin_atmosphere air = {.struct_size = sizeof air};
static gate closed;
static welkin_job* job;
static counter released;
static const welkin_post_options post = {.struct_size = sizeof post,
                                         .key = "a key that is too long to be kept without an allocation",
                                         .release = count_up,
                                         .release_user = &released,
                                         .completed = count_completed,
                                         .completed_user = &released};

static welkin_status post_cubemap(void) { return welkin_post_project(worker, &cubemap, 1, NULL, &post, &job); }
static welkin_status post_lat_long(void) {
  const welkin_environment lat_long = {
      .struct_size = sizeof lat_long, .faces = {cubemap.faces[0]}, .width = 8, .height = 4};
  return welkin_post_project(worker, &lat_long, 1, NULL, &post, &job);
}
static welkin_status post_file(void) {
  return welkin_post_project_file(worker, "/a/path/that/is/too/long/to/be/kept/without/an/allocation.exr", NULL, NULL,
                                  &post, &job);
}
static welkin_status post_prefilter(void) {
  static const double roughness[] = {0.0, 0.5, 1.0};
  static const welkin_prefilter_options options = {
      .struct_size = sizeof options, .size = 4, .roughness = roughness, .roughness_count = 3};
  return welkin_post_prefilter(worker, &cubemap, &options, &post, &job);
}
static welkin_status post_bake(void) { return welkin_post_bake(worker, &cubemap, NULL, NULL, &post, &job); }
static welkin_status post_sky_tables(void) { return welkin_post_sky_tables(worker, &air, NULL, &post, &job); }
static welkin_status post_function(void) { return welkin_post_function(worker, wait_at_gate, &closed, &post, &job); }

static void post_with_failures(welkin_status (*call)(void)) {
  welkin_status status = WELKIN_OUT_OF_MEMORY;
  int failed = -1;
  do {
    const int before = counted(&released);
    job = NULL;
    until_failure = ++failed;
    status = call();
    until_failure = -1;
    if (status == WELKIN_OUT_OF_MEMORY) {
      CHECK(counted(&released) == before + 1);
      CHECK(job == NULL);
      CHECK(welkin_last_error()[0] != '\0');
    }
  } while (status == WELKIN_OUT_OF_MEMORY && failed < 1000);
  CHECK_STATUS(WELKIN_OK, status);
  CHECK(failed > 3);
  CHECK_STATUS(WELKIN_OK, welkin_job_cancel(job, NULL));
  welkin_job_release(job);
}

/* A call that makes a handle either makes it or reports a lack of memory and makes none. */
static void make_chains_with_failures(void) {
  static const welkin_prefilter_options options = {.struct_size = sizeof options, .size = 4};
  welkin_chain *chain = NULL, *another = NULL;
  CHECK_STATUS(WELKIN_OK, welkin_prefilter(&cubemap, &options, NULL, &chain));
  welkin_status status = WELKIN_OUT_OF_MEMORY;
  int failed = 0;
  for (; status == WELKIN_OUT_OF_MEMORY && failed < 1000; ++failed) {
    until_failure = failed;
    status = welkin_chain_share(chain, &another);
    until_failure = -1;
    CHECK((status == WELKIN_OK) == (another != NULL));
  }
  CHECK_STATUS(WELKIN_OK, status);
  CHECK(failed > 1);
  welkin_chain_destroy(another);
  welkin_chain_destroy(chain);
}

void memory(void) {
  worker = make_worker();
  cubemap = uniform_cubemap(4, 1.0F, 1.0F, 1.0F);
  CHECK_STATUS(WELKIN_OK, welkin_post_function(worker, wait_at_gate, &closed, NULL, &job));
  wait_until_entered(&closed);
  welkin_job_release(job);
  post_with_failures(post_cubemap);
  post_with_failures(post_lat_long);
  post_with_failures(post_file);
  post_with_failures(post_function);
  post_with_failures(post_prefilter);
  post_with_failures(post_bake);
  post_with_failures(post_sky_tables);
  make_chains_with_failures();

  welkin_status status = WELKIN_OUT_OF_MEMORY;
  for (int failed = 0; status == WELKIN_OUT_OF_MEMORY && failed < 100000; ++failed) {
    welkin_projection light = {.struct_size = sizeof light};
    until_failure = failed;
    status = welkin_project(&cubemap, 1, NULL, NULL, &light);
    until_failure = -1;
  }
  CHECK_STATUS(WELKIN_OK, status);
  open_gate(&closed);
  welkin_worker_destroy(worker);
  free(pixels_of(&cubemap));
}
#endif
