#include "support.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
static int failed = 0;

void check(int holds, const char* condition, const char* file, int line) {
  if (holds) return;
  pthread_mutex_lock(&mutex);
  ++failed;
  pthread_mutex_unlock(&mutex);
  fprintf(stderr, "%s:%d: %s\n", file, line, condition);
}

void check_status(welkin_status expected, welkin_status status, const char* call, const char* file, int line) {
  if (status == expected) return;
  fprintf(stderr, "%s instead of %s (%s)\n", welkin_status_name(status), welkin_status_name(expected),
          welkin_last_error());
  check(0, call, file, line);
}

int failures(void) {
  pthread_mutex_lock(&mutex);
  const int count = failed;
  pthread_mutex_unlock(&mutex);
  return count;
}

int close_to(double value, double expected, double tolerance) { return fabs(value - expected) <= tolerance; }

welkin_environment uniform_cubemap(int size, float red, float green, float blue) {
  const size_t face = (size_t)size * (size_t)size * 3;
  float* pixels = malloc(6 * face * sizeof *pixels);
  if (pixels == NULL) abort();
  for (size_t i = 0; i < 6 * face; i += 3) {
    pixels[i] = red;
    pixels[i + 1] = green;
    pixels[i + 2] = blue;
  }
  welkin_environment cubemap;
  WELKIN_INIT(cubemap);
  cubemap.size = size;
  cubemap.format = WELKIN_FORMAT_RGB_F32;
  for (size_t i = 0; i < 6; ++i) cubemap.faces[i] = pixels + i * face;
  return cubemap;
}

void* pixels_of(const welkin_environment* cubemap) { return (void*)(uintptr_t)cubemap->faces[0]; }

void count_up(void* its_counter) {
  pthread_mutex_lock(&mutex);
  ++((counter*)its_counter)->value;
  pthread_mutex_unlock(&mutex);
}

void count_completed(welkin_job* job, void* its_counter) {
  CHECK(welkin_job_id(job) != 0);
  CHECK(welkin_job_poll(job, NULL) != WELKIN_NOT_READY);
  count_up(its_counter);
}

int counted(const counter* its_counter) {
  pthread_mutex_lock(&mutex);
  const int value = its_counter->value;
  pthread_mutex_unlock(&mutex);
  return value;
}

welkin_post_options counting(counter* released, counter* completed) {
  const welkin_post_options post = {.struct_size = sizeof post,
                                    .release = count_up,
                                    .release_user = released,
                                    .completed = count_completed,
                                    .completed_user = completed};
  return post;
}

welkin_status do_nothing(void* user, const welkin_control* control) {
  (void)user;
  (void)control;
  return WELKIN_OK;
}

static int flag_of(const int* flag) {
  pthread_mutex_lock(&mutex);
  const int value = *flag;
  pthread_mutex_unlock(&mutex);
  return value;
}

static void set_flag(int* flag) {
  pthread_mutex_lock(&mutex);
  *flag = 1;
  pthread_mutex_unlock(&mutex);
}

welkin_status wait_at_gate(void* its_gate, const welkin_control* control) {
  gate* here = its_gate;
  set_flag(&here->entered);
  while (!flag_of(&here->open)) {
    if (welkin_control_stop_requested(control)) return WELKIN_CANCELLED;
    sleep_milliseconds(1);
  }
  return WELKIN_OK;
}

void open_gate(gate* its_gate) { set_flag(&its_gate->open); }

void wait_until_entered(gate* its_gate) {
  while (!flag_of(&its_gate->entered)) sleep_milliseconds(1);
}

welkin_worker* make_worker(void) {
  welkin_worker_options options;
  WELKIN_INIT(options);
  options.threads = 1;
  welkin_worker* worker = NULL;
  CHECK_STATUS(WELKIN_OK, welkin_worker_create(&options, &worker));
  if (worker == NULL) abort();
  return worker;
}

void sleep_milliseconds(int milliseconds) {
  const struct timespec time = {milliseconds / 1000, (long)(milliseconds % 1000) * 1000000L};
  nanosleep(&time, NULL);
}
