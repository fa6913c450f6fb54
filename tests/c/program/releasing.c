/* Everything that is handed over is released exactly once, whatever the outcome of the post. */
#include <stdlib.h>

#include "support.h"

static welkin_post_options releasing_to(counter* to) {
  const welkin_post_options post = {.struct_size = sizeof post, .release = count_up, .release_user = to};
  return post;
}

/* A job's release may come shortly after it is ready; a worker's end waits for it. */
static void of_jobs_that_end(void) {
  static counter released[5];
  welkin_worker* worker = make_worker();
  welkin_environment cubemap = uniform_cubemap(8, 1.0F, 1.0F, 1.0F);
  const welkin_environment lat_long = {
      .struct_size = sizeof lat_long, .faces = {pixels_of(&cubemap)}, .width = 8, .height = 4};
  welkin_environment faceless = cubemap;
  faceless.faces[0] = NULL;

  welkin_post_options post = releasing_to(&released[0]);
  CHECK_STATUS(WELKIN_OK, welkin_post_project(worker, &cubemap, 1, NULL, &post, NULL));
  post = releasing_to(&released[1]);
  CHECK_STATUS(WELKIN_OK, welkin_post_project(worker, &lat_long, 1, NULL, &post, NULL));
  post = releasing_to(&released[2]);
  CHECK_STATUS(WELKIN_OK, welkin_post_project_file(worker, "/no/such/file.exr", NULL, NULL, &post, NULL));
  CHECK(counted(&released[2]) == 1); /* its path is copied */
  post = releasing_to(&released[3]);
  CHECK_STATUS(WELKIN_OK, welkin_post_function(worker, do_nothing, NULL, &post, NULL));
  post = releasing_to(&released[4]);
  welkin_job* job = NULL;
  CHECK_STATUS(WELKIN_OK, welkin_post_project(worker, &faceless, 1, NULL, &post, &job));
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_job_wait(job, WELKIN_NO_LIMIT));
  welkin_job_release(job);
  welkin_worker_destroy(worker);
  for (int i = 0; i < 5; ++i) CHECK(counted(&released[i]) == 1);
  free(pixels_of(&cubemap));
}

/* Handles stay valid for as long as they are held. */
static void of_jobs_whose_worker_goes(void) {
  welkin_worker* worker = make_worker();
  gate closed = {0, 0};
  counter released = {0}, completed = {0};
  const welkin_post_options post = counting(&released, &completed);
  welkin_job *running = NULL, *waiting = NULL;
  CHECK_STATUS(WELKIN_OK, welkin_post_function(worker, wait_at_gate, &closed, &post, &running));
  wait_until_entered(&closed);
  CHECK_STATUS(WELKIN_OK, welkin_post_function(worker, wait_at_gate, &closed, &post, &waiting));
  welkin_worker_destroy(worker); /* the gate stays shut: the function sees the stop request */
  CHECK(counted(&released) == 2);
  CHECK(counted(&completed) == 0);
  int32_t given_up = -1;
  CHECK_STATUS(WELKIN_STOPPED, welkin_job_wait(running, WELKIN_NO_LIMIT));
  CHECK_STATUS(WELKIN_STOPPED, welkin_job_wait(waiting, 0));
  CHECK_STATUS(WELKIN_OK, welkin_job_cancel(running, &given_up));
  CHECK(given_up == 0);
  CHECK_STATUS(WELKIN_OK, welkin_job_set_priority(waiting, WELKIN_PRIORITY_HIGH));
  CHECK(welkin_job_id(waiting) > welkin_job_id(running));
  welkin_job_release(running);
  welkin_job_release(waiting);
}

static void of_posts_that_fail(void) {
  welkin_worker* worker = make_worker();
  welkin_environment cubemap = uniform_cubemap(8, 1.0F, 1.0F, 1.0F);
  counter up = {0};
  welkin_post_options post = releasing_to(&up);
  const welkin_projection_options bad_options = {.struct_size = sizeof bad_options, .midpoint = 7};
  welkin_job* job = (welkin_job*)&up;
  int expected = 0;
#define FAILS(call)                                 \
  do {                                              \
    CHECK_STATUS(WELKIN_INVALID_ARGUMENT, call);    \
    CHECK(counted(&up) == ++expected); /* by now */ \
  } while (0)
  FAILS(welkin_post_project(NULL, &cubemap, 1, NULL, &post, &job));
  CHECK(job == NULL);
  FAILS(welkin_post_project(worker, NULL, 1, NULL, &post, &job));
  FAILS(welkin_post_project(worker, &cubemap, 0, NULL, &post, &job));
  FAILS(welkin_post_project(worker, &cubemap, 1, &bad_options, &post, &job));
  FAILS(welkin_post_project(worker, NULL, 1, NULL, &post, &job));
  FAILS(welkin_post_project_file(worker, NULL, NULL, NULL, &post, &job));
  FAILS(welkin_post_function(worker, NULL, NULL, &post, &job));
  cubemap.format = 99;
  FAILS(welkin_post_project(worker, &cubemap, 1, NULL, &post, &job));
  post.priority = 2;
  FAILS(welkin_post_function(worker, do_nothing, NULL, &post, &job));
#undef FAILS

  /* An invalid size: nothing behind it is read. */
  post.struct_size = 7;
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_post_function(worker, do_nothing, NULL, &post, &job));
  CHECK(counted(&up) == expected);
  welkin_worker_destroy(worker);
  CHECK(counted(&up) == expected);
  free(pixels_of(&cubemap));
}

void releasing(void) {
  of_jobs_that_end();
  of_jobs_whose_worker_goes();
  of_posts_that_fail();
}
