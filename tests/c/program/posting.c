/* Jobs: posted, polled, waited for, drained, steered; and functions of the caller's own. */
#include <stdlib.h>
#include <string.h>

#include "support.h"

typedef struct received {
  uint64_t id;
  int calls;
  welkin_job* kept;
  welkin_projection light;
} received;

static void receive(welkin_job* job, void* user) {
  received* to = user;
  to->id = welkin_job_id(job);
  ++to->calls;
  to->light.struct_size = sizeof to->light;
  CHECK_STATUS(WELKIN_OK, welkin_job_projection(job, &to->light));
  welkin_job_retain(job);
  to->kept = job;
}

static void completed_runs_in_drain_alone(void) {
  welkin_worker* worker = make_worker();
  welkin_environment cubemap = uniform_cubemap(8, 1.0F, 1.0F, 1.0F);
  static received first, second;
  uint64_t called = 99;
  CHECK_STATUS(WELKIN_OK, welkin_worker_drain(worker, 0, &called));
  CHECK(called == 0);

  welkin_post_options post = {.struct_size = sizeof post, .completed = receive, .completed_user = &first};
  welkin_job* job = NULL;
  CHECK_STATUS(WELKIN_OK, welkin_post_project(worker, &cubemap, 1, NULL, &post, &job));
  CHECK_STATUS(WELKIN_OK, welkin_job_wait(job, WELKIN_NO_LIMIT));
  post.completed_user = &second;
  CHECK_STATUS(WELKIN_OK, welkin_post_project(worker, &cubemap, 1, NULL, &post, NULL));
  CHECK_STATUS(WELKIN_OK, welkin_worker_wait_until_idle(worker));
  CHECK(first.calls == 0);

  CHECK_STATUS(WELKIN_OK, welkin_worker_drain(worker, 0, &called)); /* one at least, whatever the budget */
  CHECK(called == 1 && first.calls == 1 && second.calls == 0);
  CHECK_STATUS(WELKIN_OK, welkin_worker_drain(worker, WELKIN_NO_LIMIT, NULL));
  CHECK(first.calls == 1 && second.calls == 1);
  CHECK(first.id == welkin_job_id(job) && first.kept == job && second.id > first.id);
  CHECK(memcmp(&first.light, &second.light, sizeof first.light) == 0);

  welkin_job_release(job);
  welkin_job_release(first.kept);
  welkin_worker_destroy(worker);
  CHECK(welkin_job_poll(second.kept, NULL) == WELKIN_OK); /* held longer than its worker */
  welkin_job_release(second.kept);
  free(pixels_of(&cubemap));
}

static void waiting_has_a_limit_and_cancelling_works(void) {
  welkin_worker* worker = make_worker();
  gate closed = {0, 0};
  welkin_job *running = NULL, *waiting = NULL;
  CHECK_STATUS(WELKIN_OK, welkin_post_function(worker, wait_at_gate, &closed, NULL, &running));
  wait_until_entered(&closed);
  CHECK_STATUS(WELKIN_OK, welkin_post_function(worker, wait_at_gate, &closed, NULL, &waiting));
  double progress = -1.0;
  CHECK_STATUS(WELKIN_NOT_READY, welkin_job_poll(running, &progress));
  CHECK(progress == 0.0);
  CHECK_STATUS(WELKIN_NOT_READY, welkin_job_wait(running, 2000000));
  CHECK_STATUS(WELKIN_NOT_READY, welkin_job_wait(waiting, 0));
  welkin_projection light = {.struct_size = sizeof light};
  CHECK_STATUS(WELKIN_NOT_READY, welkin_job_projection(waiting, &light));

  int32_t given_up = -1;
  CHECK_STATUS(WELKIN_OK, welkin_job_cancel(waiting, &given_up));
  CHECK(given_up == 1);
  CHECK_STATUS(WELKIN_CANCELLED, welkin_job_poll(waiting, NULL)); /* at once: it waited */
  CHECK(welkin_last_error()[0] != '\0');
  CHECK_STATUS(WELKIN_OK, welkin_job_cancel(waiting, &given_up));
  CHECK(given_up == 0);
  CHECK_STATUS(WELKIN_OK, welkin_job_cancel(running, NULL));
  CHECK_STATUS(WELKIN_CANCELLED, welkin_job_wait(running, WELKIN_NO_LIMIT));
  welkin_job_release(waiting);
  welkin_job_release(running);
  welkin_worker_destroy(worker);
}

static void keys_and_priorities(void) {
  welkin_worker* worker = make_worker();
  gate closed = {0, 0};
  welkin_job *running = NULL, *old = NULL, *new = NULL;
  CHECK_STATUS(WELKIN_OK, welkin_post_function(worker, wait_at_gate, &closed, NULL, &running));
  wait_until_entered(&closed);
  char key[] = "probe 7";
  welkin_post_options post = {.struct_size = sizeof post, .priority = WELKIN_PRIORITY_LOW, .key = key};
  CHECK_STATUS(WELKIN_OK, welkin_post_function(worker, wait_at_gate, &closed, &post, &old));
  key[0] = 'P'; /* it was copied */
  post.key = "probe 7";
  CHECK_STATUS(WELKIN_OK, welkin_post_function(worker, wait_at_gate, &closed, &post, &new));
  CHECK_STATUS(WELKIN_REPLACED, welkin_job_poll(old, NULL));

  CHECK_STATUS(WELKIN_OK, welkin_job_set_priority(new, WELKIN_PRIORITY_HIGH));
  open_gate(&closed);
  CHECK_STATUS(WELKIN_OK, welkin_job_wait(new, WELKIN_NO_LIMIT));
  welkin_job_release(running);
  welkin_job_release(old);
  welkin_job_release(new);
  welkin_worker_destroy(worker);
}

static welkin_status return_number(void* number, const welkin_control* control) {
  CHECK_STATUS(WELKIN_OK, welkin_control_report_progress(control, 0.75));
  CHECK_STATUS(WELKIN_OK, welkin_control_report_progress(control, 0.25));
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_control_report_progress(control, 1.5));
  return *(const welkin_status*)number;
}

static welkin_status project_inside(void* cubemap, const welkin_control* control) {
  welkin_projection light = {.struct_size = sizeof light};
  return welkin_project(cubemap, 1, NULL, control, &light);
}

static void functions_say_how_they_ended(void) {
  welkin_worker* worker = make_worker();
  welkin_status returned = 1234;
  welkin_job* job = NULL;
  CHECK_STATUS(WELKIN_OK, welkin_post_function(worker, return_number, &returned, NULL, &job));
  double progress = 0.0;
  CHECK_STATUS(1234, welkin_job_wait(job, WELKIN_NO_LIMIT));
  CHECK(strstr(welkin_last_error(), "1234") != NULL);
  CHECK(welkin_job_poll(job, &progress) == 1234 && progress == 0.75);
  welkin_job_release(job);

  returned = WELKIN_NOT_READY;
  CHECK_STATUS(WELKIN_OK, welkin_post_function(worker, return_number, &returned, NULL, &job));
  CHECK_STATUS(WELKIN_INTERNAL, welkin_job_wait(job, WELKIN_NO_LIMIT));
  welkin_job_release(job);

  welkin_environment cubemap = uniform_cubemap(8, 1.0F, 1.0F, 1.0F);
  CHECK_STATUS(WELKIN_OK, welkin_post_function(worker, project_inside, &cubemap, NULL, &job));
  CHECK_STATUS(WELKIN_OK, welkin_job_wait(job, WELKIN_NO_LIMIT));
  welkin_projection light = {.struct_size = sizeof light};
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_job_projection(job, &light)); /* a function has none */
  welkin_job_release(job);

  const void* face = cubemap.faces[4];
  cubemap.faces[4] = NULL;
  CHECK_STATUS(WELKIN_OK, welkin_post_function(worker, project_inside, &cubemap, NULL, &job));
  CHECK_STATUS(WELKIN_INVALID_ARGUMENT, welkin_job_wait(job, WELKIN_NO_LIMIT));
  CHECK(strstr(welkin_last_error(), "face 4") != NULL); /* the message of the call inside */
  welkin_job_release(job);
  cubemap.faces[4] = face;
  welkin_worker_destroy(worker);
  free(pixels_of(&cubemap));
}

void posting(void) {
  completed_runs_in_drain_alone();
  waiting_has_a_limit_and_cancelling_works();
  keys_and_priorities();
  functions_say_how_they_ended();
}
