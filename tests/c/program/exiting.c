/* Functions that try to end the calling thread, which belongs to the library: it goes on. */
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "support.h"

static welkin_status exit_thread(void* user, const welkin_control* control) {
  (void)user;
  (void)control;
  pthread_exit(NULL);
}

static void exit_thread_completed(welkin_job* job, void* its_counter) {
  count_completed(job, its_counter);
  pthread_exit(NULL);
}

static void exit_thread_release(void* its_counter) {
  count_up(its_counter);
  pthread_exit(NULL);
}

/* Runs on the worker's only thread, which must survive for the jobs that follow. */
static void exiting_in_functions(void) {
  welkin_worker* worker = make_worker();
  for (int i = 0; i < 3; ++i) {
    welkin_job* job = NULL;
    CHECK_STATUS(WELKIN_OK, welkin_post_function(worker, exit_thread, NULL, NULL, &job));
    CHECK_STATUS(WELKIN_INTERNAL, welkin_job_wait(job, WELKIN_NO_LIMIT));
    CHECK(strstr(welkin_last_error(), "pthread_exit") != NULL);
    welkin_job_release(job);
  }
  welkin_worker_destroy(worker);
}

static void exiting_in_callbacks(void) {
  welkin_worker* worker = make_worker();
  welkin_environment cubemap = uniform_cubemap(8, 1.0F, 1.0F, 1.0F);
  counter released = {0}, completed = {0};
  const welkin_post_options post = {.struct_size = sizeof post,
                                    .release = exit_thread_release,
                                    .release_user = &released,
                                    .completed = exit_thread_completed,
                                    .completed_user = &completed};
  for (int i = 1; i <= 3; ++i) {
    welkin_job* job = NULL;
    CHECK_STATUS(WELKIN_OK, welkin_post_project(worker, &cubemap, 1, NULL, &post, &job));
    CHECK_STATUS(WELKIN_OK, welkin_job_wait(job, WELKIN_NO_LIMIT));
    CHECK_STATUS(WELKIN_OK, welkin_worker_wait_until_idle(worker));
    CHECK_STATUS(WELKIN_INTERNAL, welkin_worker_drain(worker, WELKIN_NO_LIMIT, NULL));
    CHECK(counted(&completed) == i);
    welkin_job_release(job);
  }
  welkin_worker_destroy(worker);
  CHECK(counted(&released) == 3);
  free(pixels_of(&cubemap));
}

void exiting(void) {
  exiting_in_functions();
  exiting_in_callbacks();
}
