/* A worker in an arena that an engine in C lends: a queue, and two threads that empty it. */
#include <pthread.h>
#include <stdlib.h>

#include "support.h"

enum { most_tasks = 256, threads = 2, jobs = 20 };

typedef struct arena {
  pthread_mutex_t mutex;
  pthread_cond_t changed;
  struct {
    void (*task)(void*);
    void* argument;
  } tasks[most_tasks];
  int count, closed, taken;
} arena;

static void enqueue(void* user, void (*task)(void*), void* argument) {
  arena* to = user;
  pthread_mutex_lock(&to->mutex);
  if (to->count == most_tasks) abort();
  to->tasks[to->count].task = task;
  to->tasks[to->count].argument = argument;
  ++to->count;
  ++to->taken;
  pthread_cond_signal(&to->changed);
  pthread_mutex_unlock(&to->mutex);
}

static void* serve(void* user) {
  arena* from = user;
  pthread_mutex_lock(&from->mutex);
  while (from->count > 0 || !from->closed) {
    if (from->count == 0) {
      pthread_cond_wait(&from->changed, &from->mutex);
      continue;
    }
    --from->count;
    void (*task)(void*) = from->tasks[from->count].task;
    void* argument = from->tasks[from->count].argument;
    pthread_mutex_unlock(&from->mutex);
    task(argument);
    pthread_mutex_lock(&from->mutex);
  }
  pthread_mutex_unlock(&from->mutex);
  return NULL;
}

static void close_arena(arena* of, pthread_t* served) {
  pthread_mutex_lock(&of->mutex);
  of->closed = 1;
  pthread_cond_broadcast(&of->changed);
  pthread_mutex_unlock(&of->mutex);
  for (int i = 0; i < threads; ++i) pthread_join(served[i], NULL);
}

void lending(void) {
  static arena lent = {.mutex = PTHREAD_MUTEX_INITIALIZER, .changed = PTHREAD_COND_INITIALIZER};
  pthread_t served[threads];
  for (int i = 0; i < threads; ++i) CHECK(pthread_create(&served[i], NULL, serve, &lent) == 0);
  const welkin_worker_options options = {
      .struct_size = sizeof options, .threads = threads, .enqueue = enqueue, .enqueue_user = &lent};
  welkin_worker* worker = NULL;
  CHECK_STATUS(WELKIN_OK, welkin_worker_create(&options, &worker));

  welkin_environment cubemap = uniform_cubemap(32, 1.0F, 1.0F, 1.0F);
  counter released = {0}, completed = {0};
  const welkin_post_options post = counting(&released, &completed);
  welkin_job* last = NULL;
  for (int i = 0; i < jobs; ++i) {
    welkin_job_release(last);
    CHECK_STATUS(WELKIN_OK, welkin_post_project(worker, &cubemap, 1, NULL, &post, &last));
  }
  CHECK_STATUS(WELKIN_OK, welkin_job_wait(last, WELKIN_NO_LIMIT));
  CHECK_STATUS(WELKIN_OK, welkin_worker_wait_until_idle(worker));
  CHECK_STATUS(WELKIN_OK, welkin_worker_drain(worker, WELKIN_NO_LIMIT, NULL));
  CHECK(counted(&completed) == jobs);
  CHECK(lent.taken > 0);
  welkin_job_release(last);
  welkin_worker_destroy(worker);
  close_arena(&lent, served);
  CHECK(counted(&released) == jobs);
  free(pixels_of(&cubemap));
}
