/* Welkin for engines in other languages: a small C interface whose structures and functions stay as they are.
 *
 *   welkin_cubemap cubemap = {.struct_size = sizeof cubemap, .size = 1024, .format = WELKIN_FORMAT_RGBA_F16,
 *                             .faces = {px, nx, py, ny, pz, nz}};
 *   welkin_projection light = {.struct_size = sizeof light};
 *   if (welkin_project_cubemap(&cubemap, 1, NULL, NULL, &light) != WELKIN_OK) puts(welkin_last_error());
 *
 * or off the main thread:
 *
 *   welkin_post_options post = {.struct_size = sizeof post, .release = free, .release_user = pixels,
 *                               .completed = use_light, .completed_user = probe};
 *   welkin_post_project_cubemap(worker, &cubemap, 1, NULL, &post, NULL);
 *   ...
 *   welkin_worker_drain(worker, 500000, NULL);          // once a frame, at most half a millisecond
 *
 *   void use_light(welkin_job* job, void* probe) {      // runs in there
 *     welkin_projection light = {.struct_size = sizeof light};
 *     if (welkin_job_projection(job, &light) == WELKIN_OK) ...
 *   }
 *
 * It is a thin layer over the C++ interface, whose headers say more of what each thing means; results are the same
 * bits.
 *
 * Structures. Each begins with `struct_size`, its `sizeof` in the caller's program, and in each of those that are read,
 * zero means the default: fill a structure with zeros, set `struct_size`, then what you want (WELKIN_INIT does the
 * first two). A pointer to options may be null: all defaults. That is also how versions go together. Newer structures
 * are longer. What an older program's shorter one lacks is taken as zero; of a newer program's longer one, what this
 * library does not know must be zero, else the call fails instead of passing over something that was asked for.
 * Structures that are written are written as far as `struct_size` says, what this library does not know with zeros.
 *
 * Errors. No exception comes out of a call, and none may come out of a callback. Calls that can fail return a
 * `welkin_status`; WELKIN_OK is 0. A call that fails writes none of its results, but sets a handle that it would have
 * made to null. Null pointers, sizes and enumeration values that are none give WELKIN_INVALID_ARGUMENT. A
 * pointer that is neither null nor good cannot be told from a good one.
 *
 * Threads. All functions may be called from any thread. Functions that compute spread over the oneTBB arena that the
 * calling thread is in, a worker's over the worker's threads.
 *
 * Strings are UTF-8, end in a zero and are copied.
 */
/* NOLINTBEGIN(modernize-*): this is C */
#ifndef WELKIN_WELKIN_H
#define WELKIN_WELKIN_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#ifndef WELKIN_API
#if defined(__GNUC__)
#define WELKIN_API __attribute__((visibility("default")))
#else
#define WELKIN_API
#endif
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* The version of this interface. It rises when something is added; nothing is taken away or changed. A program runs
 * with every library whose `welkin_c_version()` is not below its own WELKIN_C_VERSION, and with older ones as long as
 * it leaves what is new alone. */
#define WELKIN_C_VERSION 1
WELKIN_API uint32_t welkin_c_version(void);

/* Makes `object`, a structure of this header, all defaults: WELKIN_INIT(options); */
#define WELKIN_INIT(object) \
  ((void)memset(&(object), 0, sizeof(object)), (void)((object).struct_size = (uint32_t)sizeof(object)))

/* ---- Status ---- */

/* Of a call, or of a job. Later versions may know more values: take what you do not know for an error. */
typedef int32_t welkin_status;
enum {
  WELKIN_OK = 0,
  WELKIN_INVALID_ARGUMENT = 1, /* that no call could accept (a null face, 17 bands) */
  WELKIN_REJECTED_PIXEL = 2,   /* a texel that the options reject; the message names face, row and column */
  WELKIN_FILE_ACCESS = 3,      /* a file that cannot be opened or read */
  WELKIN_CORRUPT_FILE = 4,     /* a file that breaks its own format, or ends too early */
  WELKIN_UNSUPPORTED_FILE = 5, /* a sound file of a kind that Welkin does not read, or whose layout it cannot tell */
  WELKIN_LIMIT_EXCEEDED = 6,   /* would need more memory than the stated limit */
  WELKIN_CANCELLED = 7,        /* the caller asked for it */
  WELKIN_REPLACED = 8,         /* a newer request with the same key took this job's place */
  WELKIN_QUEUE_FULL = 9,       /* a worker at its limits refused this job, or dropped it for another */
  WELKIN_STOPPED = 10,         /* the worker was terminated before this job was done */
  WELKIN_OUT_OF_MEMORY = 100,
  WELKIN_NOT_READY = 101, /* the job is not done yet; no error, and no message */
  WELKIN_INTERNAL = 102   /* anything else: no thread could be made, an exception came out of a callback, ... */
};

/* "ok", "invalid_argument", ...; "unknown" for what is none. Never null. */
WELKIN_API const char* welkin_status_name(welkin_status status);

/* What went wrong in the latest call on this thread that returned an error: where, what was found, what would do
 * instead. Never null; empty if none did. Stays until the next call on this thread that returns an error. */
WELKIN_API const char* welkin_last_error(void);

/* ---- Environments ---- */

/* How one texel lies in memory: interleaved channels, no padding. Alpha is never used. F16 is IEEE 754 binary16; U8
 * maps 0..255 to 0..1; SRGB8 does so and then applies the sRGB transfer function. */
typedef int32_t welkin_format;
enum {
  WELKIN_FORMAT_RGB_F32 = 0,
  WELKIN_FORMAT_RGBA_F32 = 1,
  WELKIN_FORMAT_RGB_F16 = 2,
  WELKIN_FORMAT_RGBA_F16 = 3,
  WELKIN_FORMAT_RGB_U8 = 4,
  WELKIN_FORMAT_RGBA_U8 = 5,
  WELKIN_FORMAT_RGB_SRGB8 = 6,
  WELKIN_FORMAT_RGBA_SRGB8 = 7
};

/* The caller's pixels, read in place: six square faces, +X -X +Y -Y +Z -Z, row 0 on top; image_view.h has their axes.
 */
typedef struct welkin_cubemap {
  uint32_t struct_size;
  welkin_format format;
  int64_t row_stride_bytes; /* from a row to the next; 0: rows are packed; negative: bottom-up */
  const void* faces[6];     /* first texel of each; float formats aligned to their channel */
  int64_t size;             /* texels along an edge, 1 to 16384 */
} welkin_cubemap;

/* The caller's pixels, read in place: a full sphere as latitude over longitude, the centre along +z, +x a quarter in
 * from the left, y up. */
typedef struct welkin_lat_long {
  uint32_t struct_size;
  welkin_format format;
  int64_t row_stride_bytes;
  const void* pixels; /* first texel of the top row */
  int32_t width;      /* 1 to 65536 */
  int32_t height;     /* 1 to 32768 */
} welkin_lat_long;

/* How a picture file holds a sphere; environment_file.h has the faces' places. */
typedef int32_t welkin_layout;
enum {
  WELKIN_LAYOUT_AUTOMATIC = 0, /* told from the file's header, its shape or its name */
  WELKIN_LAYOUT_LAT_LONG = 1,
  WELKIN_LAYOUT_VERTICAL_STRIP = 2,
  WELKIN_LAYOUT_HORIZONTAL_STRIP = 3,
  WELKIN_LAYOUT_HORIZONTAL_CROSS = 4,
  WELKIN_LAYOUT_VERTICAL_CROSS = 5,
  WELKIN_LAYOUT_SIX_FILES = 6
};

/* What the numbers in a PNG mean. */
typedef int32_t welkin_transfer;
enum {
  WELKIN_TRANSFER_AUTOMATIC = 0, /* sRGB, but linear where the file says that its gamma is 1 */
  WELKIN_TRANSFER_SRGB = 1,
  WELKIN_TRANSFER_LINEAR = 2
};

/* The colours that pixels are taken in. */
typedef int32_t welkin_primaries;
enum {
  WELKIN_PRIMARIES_REC709 = 0,   /* converted to Rec. 709 where the file states others */
  WELKIN_PRIMARIES_AS_STORED = 1 /* the file's numbers as they are */
};

/* How a file is read: OpenEXR, Radiance .hdr, PFM, PNG. */
typedef struct welkin_read_options {
  uint32_t struct_size;
  welkin_layout layout;
  const char* part;  /* of a multi-part OpenEXR file: its name, or its number from 0; null: the first with colour */
  const char* layer; /* of an OpenEXR file with layers; null: the channels without one, else the only one */
  welkin_transfer transfer;
  welkin_primaries primaries;
  uint64_t memory_limit_bytes; /* the most that pixels may take; 0: 8 GiB */
  int64_t level;               /* of a file with a mip chain; 0 is the full size */
} welkin_read_options;

/* ---- Projection to spherical harmonics ---- */

#define WELKIN_MAXIMUM_BANDS 16

/* What a texel stands for while it is integrated. */
typedef int32_t welkin_quadrature;
enum {
  WELKIN_QUADRATURE_EXACT = 0,   /* its area: no error at any size */
  WELKIN_QUADRATURE_MIDPOINT = 1 /* its centre, as Babylon.js does */
};

/* What becomes of a NaN or an infinity, and of a value below zero. */
typedef int32_t welkin_non_finite_policy;
enum { WELKIN_NON_FINITE_REPLACE = 0, WELKIN_NON_FINITE_REJECT = 1 };
typedef int32_t welkin_negative_policy;
enum { WELKIN_NEGATIVE_KEEP = 0, WELKIN_NEGATIVE_REPLACE = 1, WELKIN_NEGATIVE_REJECT = 2 };

/* projection.h says more of each. */
typedef struct welkin_projection_options {
  uint32_t struct_size;
  int32_t bands; /* 1 to WELKIN_MAXIMUM_BANDS; 0: 3 */
  welkin_quadrature quadrature;
  int32_t target_size;           /* edge of the cubemap face to which the environment is reduced first; 0: it is not */
  float clamp_maximum;           /* upper bound on radiance, above 0; 0: none */
  int32_t clamp_preserve_colour; /* 1: r, g and b are scaled together; 0: each is clamped to [0, maximum] */
  int32_t gamma;                 /* 1: the pixels are gamma encoded, as Babylon.js's gammaSpace; 0: linear */
  welkin_non_finite_policy nan;
  welkin_non_finite_policy infinity;
  welkin_negative_policy negative;
} welkin_projection_options;

/* The light of an environment. 6 KiB that the caller provides: nothing to free, and no second buffer whose length could
 * be wrong. A `struct_size` that ends inside `coefficients` is fine too: it must have room for the bands that are asked
 * for. */
typedef struct welkin_projection {
  uint32_t struct_size;
  int32_t bands;
  uint64_t texels;                       /* read and projected */
  uint64_t nans_replaced;                /* channel values */
  uint64_t infinities_replaced;          /* channel values */
  uint64_t negatives_replaced;           /* channel values */
  uint64_t texels_clamped;               /* texels that the clamp changed */
  double total_radiance_before_clamp[3]; /* r, g, b: integral of radiance over the sphere, before the clamp */
  double total_radiance[3];              /* the same as it was projected */
  double error_estimate;                 /* estimated relative error of the coefficients */

  /* Of radiance: r, g, b of coefficient (l, m) from 3 (l (l + 1) + m) on; bands^2 triples, zeros behind. Real,
   * orthonormal, without Condon-Shortley phase; Y(1, -1..1) ~ y, z, x. */
  double coefficients[3 * WELKIN_MAXIMUM_BANDS * WELKIN_MAXIMUM_BANDS];
} welkin_projection;

/* Given by a worker to a caller's own function (`welkin_post_function`): how the job that it is run for is steered.
 * Good until that function returns, on any thread. */
typedef struct welkin_control welkin_control;

/* Projects a cubemap and writes `*projection`. `mips` is the full size, followed by `mip_count - 1` levels (15 at most
 * in all), each half the one before, all of one format and one `struct_size`; only `target_size` makes use of them.
 * `control` may be null; inside a function that a worker runs, the one that it was given.
 * WELKIN_INVALID_ARGUMENT, WELKIN_REJECTED_PIXEL, WELKIN_CANCELLED, WELKIN_OUT_OF_MEMORY. */
WELKIN_API welkin_status welkin_project_cubemap(const welkin_cubemap* mips, int32_t mip_count,
                                                const welkin_projection_options* options, const welkin_control* control,
                                                welkin_projection* projection);

/* The same of a lat-long. */
WELKIN_API welkin_status welkin_project_lat_long(const welkin_lat_long* lat_long,
                                                 const welkin_projection_options* options,
                                                 const welkin_control* control, welkin_projection* projection);

/* The same of a file; a lat-long is projected while it is decoded. Also WELKIN_FILE_ACCESS, WELKIN_CORRUPT_FILE,
 * WELKIN_UNSUPPORTED_FILE, WELKIN_LIMIT_EXCEEDED. */
WELKIN_API welkin_status welkin_project_file(const char* path, const welkin_read_options* read_options,
                                             const welkin_projection_options* options, const welkin_control* control,
                                             welkin_projection* projection);

/* ---- What is made of coefficients ----
 * `coefficients` holds 3 bands^2 doubles, as in `welkin_projection`. WELKIN_INVALID_ARGUMENT for null pointers and for
 * bands out of range. */

/* Radiance to irradiance: band l times pi, 2 pi/3, pi/4, 0, -pi/24, ... `irradiance`, 3 bands^2 doubles, may be
 * `radiance`. */
WELKIN_API welkin_status welkin_irradiance_from_radiance(int32_t bands, const double* radiance, double* irradiance);

/* Their value for a unit `direction` (x, y, z): `value` gets r, g, b. */
WELKIN_API welkin_status welkin_evaluate(int32_t bands, const double* coefficients, const double* direction,
                                         double* value);

typedef int32_t welkin_engine;
enum {
  WELKIN_ENGINE_BABYLON = 2,
  WELKIN_ENGINE_THREE = 3,
  WELKIN_ENGINE_FILAMENT = 4,
  WELKIN_ENGINE_GLTF = 5,
  WELKIN_ENGINE_UNITY = 6,
  WELKIN_ENGINE_UNREAL = 7,
  WELKIN_ENGINE_GODOT = 9
};

/* Light in an engine's own form; docs/engines.md has the formulas. */
typedef struct welkin_engine_light {
  uint32_t struct_size;
  welkin_engine engine;
  int32_t term_count;   /* 9 */
  int32_t vector_count; /* 7 for Unity and Unreal, else 0 */
  /* r, g, b of each term. Babylon.js (SphericalPolynomial): x y z xx yy zz yz zx xy; else coefficient l (l + 1) + m. */
  double terms[9][3];
  /* As the engine's shader has them: SHAr SHAg SHAb SHBr SHBg SHBb SHC, and the same for Unreal. */
  double vectors[7][4];
} welkin_engine_light;

/* Radiance in Welkin's axes, turned to the engine's axes, in the engine's form. Bands above the third are left out. */
WELKIN_API welkin_status welkin_engine_light_from_radiance(int32_t bands, const double* radiance, welkin_engine engine,
                                                           welkin_engine_light* light);

/* The same without the turn: `radiance` is in the engine's axes already. */
WELKIN_API welkin_status welkin_engine_light_in_place(int32_t bands, const double* radiance, welkin_engine engine,
                                                      welkin_engine_light* light);

/* ---- Worker ---- */

/* Runs jobs on threads of its own, or in a lent arena; worker.h and docs/threading.md say more. */
typedef struct welkin_worker welkin_worker;

/* A posted job. Handles are counted: a post gives one reference, `welkin_job_release` gives it back. A handle is good
 * for as long as it is held, also when the worker is gone; a job runs to its end whether one is held or not. */
typedef struct welkin_job welkin_job;

/* How the system ranks a worker's threads against all others. */
typedef int32_t welkin_thread_priority;
enum {
  WELKIN_THREAD_PRIORITY_IDLE = 0,  /* runs only on processors that nothing else wants */
  WELKIN_THREAD_PRIORITY_BELOW = 1, /* a tenth of a normal thread's share */
  WELKIN_THREAD_PRIORITY_NORMAL = 2
};

/* What a post does when the worker is at its limits. */
typedef int32_t welkin_when_full;
enum {
  WELKIN_WHEN_FULL_WAIT = 0,       /* waits until there is room */
  WELKIN_WHEN_FULL_REFUSE = 1,     /* the new job gets WELKIN_QUEUE_FULL */
  WELKIN_WHEN_FULL_DROP_OLDEST = 2 /* the oldest waiting job of the lowest priority gets that */
};

typedef struct welkin_worker_options {
  uint32_t struct_size;
  int32_t threads; /* 1 to 1024; 0: one less than the process may use, at least 1 */
  welkin_thread_priority thread_priority;
  welkin_when_full when_full;
  const char* name; /* of the threads; null: "welkin" */

  /* Null, or lends the worker an arena: has `task(argument)` called, soon and exactly once, by a thread of the engine's
   * choice. Called from any thread. The worker then has no threads of its own (but one that watches). The arena must
   * outlive the worker; a task that is called after the worker is gone does nothing. One that is never called is lost
   * memory, and until the worker is terminated a job may wait for it. */
  void (*enqueue)(void* enqueue_user, void (*task)(void* argument), void* argument);
  void* enqueue_user;

  uint64_t most_jobs;  /* in flight; 0: 4096 */
  uint64_t most_bytes; /* in flight, of their pixels; 0: 4 GiB */
} welkin_worker_options;

/* What is in a worker's hands. */
typedef struct welkin_worker_load {
  uint32_t struct_size;
  int32_t threads;    /* it has; 0 with a lent arena */
  uint64_t waiting;   /* computations that no thread has started */
  uint64_t running;   /* computations */
  uint64_t undrained; /* callbacks that the next drain would call */
  uint64_t jobs;      /* in flight, as `most_jobs` counts them */
  uint64_t bytes;     /* in flight, as `most_bytes` counts them */
} welkin_worker_load;

/* Makes a worker; `options` may be null. WELKIN_INVALID_ARGUMENT, WELKIN_OUT_OF_MEMORY, WELKIN_INTERNAL if no thread
 * could be made. */
WELKIN_API welkin_status welkin_worker_create(const welkin_worker_options* options, welkin_worker** worker);

/* Terminates and frees it; null does nothing. No other thread may use the worker any more, its jobs may be used.
 * Completed callbacks that were not drained are never called; to have them all, terminate, drain, then destroy. */
WELKIN_API void welkin_worker_destroy(welkin_worker* worker);

/* Gives up all jobs (they end with WELKIN_STOPPED), waits until none runs, and ends the threads. Later posts are
 * stopped too; callbacks can still be drained. On one of the worker's own threads it does not wait. */
WELKIN_API welkin_status welkin_worker_terminate(welkin_worker* worker);

/* Waits until nothing waits or runs; not for callbacks. On one of the worker's own threads it returns at once. */
WELKIN_API welkin_status welkin_worker_wait_until_idle(welkin_worker* worker);

/* No limit of time: longer than any. */
#define WELKIN_NO_LIMIT UINT64_MAX

/* Calls the `completed` callbacks of jobs that are done, on this thread, in the order in which they finished: at least
 * one if there is one, then until `budget_nanoseconds` are spent. `called` (may be null) gets their number. */
WELKIN_API welkin_status welkin_worker_drain(welkin_worker* worker, uint64_t budget_nanoseconds, uint64_t* called);

WELKIN_API welkin_status welkin_worker_get_load(const welkin_worker* worker, welkin_worker_load* load);

/* ---- Posting ---- */

/* Which waiting job starts next: the higher one, and of equals the older one. */
typedef int32_t welkin_priority;
enum { WELKIN_PRIORITY_LOW = -1, WELKIN_PRIORITY_NORMAL = 0, WELKIN_PRIORITY_HIGH = 1 };

typedef struct welkin_post_options {
  uint32_t struct_size;
  welkin_priority priority;
  const char* key; /* latest wins: a job of the same key that waits or runs ends with WELKIN_REPLACED; null: no key */
  uint64_t bytes;  /* that the job counts against `most_bytes`; 0: those of its pixels */

  /* Null, or the pixels (for a function: what it uses) go over to the job: `release(release_user)` is called when this
   * job does not need them any more. Exactly once for each call of a post function, whatever becomes of it:
   * - if the post fails, before it returns;
   * - for a file, whose path is copied, before the post returns;
   * - if the job is given up before it runs, before the call that gave it up returns (a cancel, a post with the same
   *   key, a post at the worker's limits, a termination);
   * - if it runs, when nothing reads the pixels any more: shortly before or after the job is ready, and before
   *   `welkin_worker_wait_until_idle`, `welkin_worker_terminate` and `welkin_worker_destroy` return, where they wait.
   * On whichever thread that is, so it must not wait for the worker or one of its jobs. There is one exception: if
   * `struct_size` itself is refused (0, not a multiple of 8, far beyond what this library knows), nothing behind it is
   * read, and nothing is called.
   * Null: the pixels stay the caller's, and must stay as they are until the job is ready. Equal posts of such pixels
   * share one run. */
  void (*release)(void* release_user);
  void* release_user;

  /* Null, or called inside `welkin_worker_drain` once the job is done, well or not. `job` is lent for the call;
   * `welkin_job_retain` keeps it. Called exactly once if the post succeeds and the worker is drained to the end, never
   * if the post fails or the worker is destroyed first; if another thread drains, perhaps before the post returns. It
   * may call any function of this interface. */
  void (*completed)(welkin_job* job, void* completed_user);
  void* completed_user;
} welkin_post_options;

/* These return at once, unless the worker is at its limits and waits. `post` and `job` may be null; else `*job` gets a
 * handle to be given back with `welkin_job_release`. Structures are copied.
 * Null pointers, sizes and enumeration values are refused here; all else that is wrong arrives through the job, a
 * worker's refusal too. WELKIN_INVALID_ARGUMENT, WELKIN_OUT_OF_MEMORY; nothing is posted
 * then. */

/* `welkin_project_cubemap`, as a job. */
WELKIN_API welkin_status welkin_post_project_cubemap(welkin_worker* worker, const welkin_cubemap* mips,
                                                     int32_t mip_count, const welkin_projection_options* options,
                                                     const welkin_post_options* post, welkin_job** job);

/* `welkin_project_lat_long`, as a job. */
WELKIN_API welkin_status welkin_post_project_lat_long(welkin_worker* worker, const welkin_lat_long* lat_long,
                                                      const welkin_projection_options* options,
                                                      const welkin_post_options* post, welkin_job** job);

/* `welkin_project_file`, as a job. */
WELKIN_API welkin_status welkin_post_project_file(welkin_worker* worker, const char* path,
                                                  const welkin_read_options* read_options,
                                                  const welkin_projection_options* options,
                                                  const welkin_post_options* post, welkin_job** job);

/* A function of the caller's own, called as `run(run_user, control)` on one of the worker's threads, once or, if the
 * job is given up first, not at all. What it returns becomes the job's status: any value but WELKIN_NOT_READY, numbers
 * of your own too (from 1000 on they will never mean anything else). If it returns what a call in it failed with, the
 * job has that call's message. It should look at `welkin_control_stop_requested` every millisecond or so. */
WELKIN_API welkin_status welkin_post_function(welkin_worker* worker,
                                              welkin_status (*run)(void* run_user, const welkin_control* control),
                                              void* run_user, const welkin_post_options* post, welkin_job** job);

/* 1 if the job was given up: return then, WELKIN_CANCELLED for instance. Else 0. */
WELKIN_API int32_t welkin_control_stop_requested(const welkin_control* control);

/* Says what share of the work is done, 0 to 1. Less than was said before changes nothing. */
WELKIN_API welkin_status welkin_control_report_progress(const welkin_control* control, double done);

/* ---- Jobs ---- */

/* Unique in the process, rising in the order of posting; 0 for null. */
WELKIN_API uint64_t welkin_job_id(const welkin_job* job);

/* How the job stands; never waits. WELKIN_NOT_READY while it waits or runs, then WELKIN_OK, or its error, whose message
 * is in `welkin_last_error`. `progress` (may be null) always gets the share that is done, 0 to 1, never falling. */
WELKIN_API welkin_status welkin_job_poll(const welkin_job* job, double* progress);

/* Waits until the job is ready, at most `timeout_nanoseconds`, then returns what `welkin_job_poll` does. On one of the
 * worker's own threads and with WELKIN_NO_LIMIT it starts a job that still waits itself. */
WELKIN_API welkin_status welkin_job_wait(const welkin_job* job, uint64_t timeout_nanoseconds);

/* Copies the result, any number of times; never waits. What `welkin_job_poll` returns, and WELKIN_INVALID_ARGUMENT if
 * the job was a function's or `projection` has no room for its bands. */
WELKIN_API welkin_status welkin_job_projection(const welkin_job* job, welkin_projection* projection);

/* Gives the job up: it ends with WELKIN_CANCELLED, at once if it waits, else before its next tile (a function: when it
 * returns). `given_up` (may be null) gets 1 if this call did it, 0 if the job was done or given up before. */
WELKIN_API welkin_status welkin_job_cancel(welkin_job* job, int32_t* given_up);

WELKIN_API welkin_status welkin_job_get_priority(const welkin_job* job, welkin_priority* priority);

/* Moves a waiting job to the end of those of that priority. */
WELKIN_API welkin_status welkin_job_set_priority(welkin_job* job, welkin_priority priority);

/* One more reference to be given back; and giving one back. Null does nothing. */
WELKIN_API void welkin_job_retain(welkin_job* job);
WELKIN_API void welkin_job_release(welkin_job* job);

#ifdef __cplusplus
}
#endif

#endif
/* NOLINTEND(modernize-*) */
