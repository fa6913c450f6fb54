/* Shared by the parts of the program: checks, pixels, a gate at which jobs wait, counters for callbacks. */
#ifndef WELKIN_TESTS_C_SUPPORT_H
#define WELKIN_TESTS_C_SUPPORT_H

#include <welkin/welkin.h>

/* Prints the failed check and goes on; the program's exit code becomes 1. May be called on any thread. */
#define CHECK(condition) check((condition) ? 1 : 0, #condition, __FILE__, __LINE__)
#define CHECK_STATUS(expected, call) check_status((expected), (call), #call, __FILE__, __LINE__)
void check(int holds, const char* condition, const char* file, int line);
void check_status(welkin_status expected, welkin_status status, const char* call, const char* file, int line);
int failures(void);

int close_to(double value, double expected, double tolerance);

/* A cubemap of RGB floats, the same radiance everywhere. Its pixels are one block, which begins at faces[0]. */
welkin_environment uniform_cubemap(int size, float red, float green, float blue);
void* pixels_of(const welkin_environment* cubemap);

/* Counts calls of callbacks: `count_up(&counter)` is a `release`, `count_completed` a `completed`. */
typedef struct counter {
  int value; /* guarded by a mutex of the program's */
} counter;
void count_up(void* its_counter);
void count_completed(welkin_job* job, void* its_counter);
int counted(const counter* its_counter);
welkin_post_options counting(counter* released, counter* completed);

welkin_status do_nothing(void* user, const welkin_control* control);

/* A function to post: waits until the gate is opened or the job is cancelled. */
typedef struct gate {
  int open, entered;
} gate;
welkin_status wait_at_gate(void* its_gate, const welkin_control* control);
void open_gate(gate* its_gate);
void wait_until_entered(gate* its_gate);

/* One thread, and defaults otherwise. */
welkin_worker* make_worker(void);

void sleep_milliseconds(int milliseconds);

/* The parts. */
void posting(void);
void releasing(void);
void refusing(void);
void versions(void);
void exiting(void);
void memory(void);

#endif
