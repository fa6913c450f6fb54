/* Workers that end with jobs in flight, with callbacks undrained, and with handles held. */
#include <stdlib.h>

#include "support.h"

enum { jobs_in_flight = 40 };

static void terminating_with_jobs_in_flight(void) {
  welkin_worker* worker = make_worker();
  welkin_environment cubemap = uniform_cubemap(256, 1.0F, 1.0F, 1.0F);
  counter released = {0}, completed = {0};
  const welkin_post_options post = counting(&released, &completed);
  welkin_job* jobs[jobs_in_flight];
  for (int i = 0; i < jobs_in_flight; ++i) {
    CHECK_STATUS(WELKIN_OK, welkin_post_project(worker, &cubemap, 1, NULL, &post, &jobs[i]));
  }
  CHECK_STATUS(WELKIN_OK, welkin_job_wait(jobs[0], WELKIN_NO_LIMIT));
  CHECK_STATUS(WELKIN_OK, welkin_worker_terminate(worker));
  int stopped = 0;
  for (int i = 0; i < jobs_in_flight; ++i) {
    const welkin_status status = welkin_job_poll(jobs[i], NULL);
    CHECK(status == WELKIN_OK || status == WELKIN_STOPPED);
    if (status == WELKIN_STOPPED) ++stopped;
    welkin_job_release(jobs[i]);
  }
  CHECK(stopped > 0);

  welkin_job* late = NULL;
  CHECK_STATUS(WELKIN_OK, welkin_post_project(worker, &cubemap, 1, NULL, &post, &late));
  CHECK_STATUS(WELKIN_STOPPED, welkin_job_poll(late, NULL));
  welkin_job_release(late);

  /* Terminate, drain, destroy: every callback was called. */
  uint64_t called = 0;
  CHECK(counted(&completed) == 0);
  CHECK_STATUS(WELKIN_OK, welkin_worker_drain(worker, WELKIN_NO_LIMIT, &called));
  CHECK(called == jobs_in_flight + 1 && counted(&completed) == jobs_in_flight + 1);
  welkin_worker_destroy(worker);
  CHECK(counted(&released) == jobs_in_flight + 1);
  free(pixels_of(&cubemap));
}

static void destroying_without_draining(void) {
  welkin_worker* worker = make_worker();
  gate closed = {0, 0};
  counter released = {0}, completed = {0};
  const welkin_post_options post = counting(&released, &completed);
  welkin_job *running = NULL, *waiting = NULL;
  CHECK_STATUS(WELKIN_OK, welkin_post_function(worker, wait_at_gate, &closed, &post, &running));
  wait_until_entered(&closed);
  CHECK_STATUS(WELKIN_OK, welkin_post_function(worker, wait_at_gate, &closed, &post, &waiting));
  welkin_worker_destroy(worker); /* the gate stays shut: the function sees that it is to stop */
  CHECK(counted(&released) == 2);
  CHECK(counted(&completed) == 0);

  /* Handles are good for as long as they are held. */
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

/* From inside: a callback that terminates, a function that does. */
static void terminate_from_callback(welkin_job* job, void* worker) {
  (void)job;
  CHECK_STATUS(WELKIN_OK, welkin_worker_terminate(worker));
}

static welkin_status terminate_from_function(void* worker, const welkin_control* control) {
  CHECK_STATUS(WELKIN_OK, welkin_worker_terminate(worker));
  CHECK(welkin_control_stop_requested(control) == 1);
  return WELKIN_CANCELLED;
}

static void terminating_from_inside(void) {
  welkin_worker* worker = make_worker();
  gate open = {1, 0};
  const welkin_post_options post = {
      .struct_size = sizeof post, .completed = terminate_from_callback, .completed_user = worker};
  CHECK_STATUS(WELKIN_OK, welkin_post_function(worker, wait_at_gate, &open, &post, NULL));
  CHECK_STATUS(WELKIN_OK, welkin_worker_wait_until_idle(worker));
  CHECK_STATUS(WELKIN_OK, welkin_worker_drain(worker, WELKIN_NO_LIMIT, NULL));
  welkin_worker_destroy(worker);

  worker = make_worker();
  welkin_job* job = NULL;
  CHECK_STATUS(WELKIN_OK, welkin_post_function(worker, terminate_from_function, worker, NULL, &job));
  CHECK_STATUS(WELKIN_STOPPED, welkin_job_wait(job, WELKIN_NO_LIMIT));
  welkin_job_release(job);
  welkin_worker_destroy(worker);
}

void ending(void) {
  terminating_with_jobs_in_flight();
  destroying_without_draining();
  terminating_from_inside();
}
