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
 * It is a thin layer over the C++ interface; results are the same bits.
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
 * Handles. What a call makes and hands out through a pointer to a pointer is the caller's, and each kind has a function
 * that destroys it; null is taken there and does nothing. Functions that ask a handle take null for an error
 * (WELKIN_INVALID_ARGUMENT, or 0 where no status is returned). Handles to results are immutable: any number of threads
 * may ask one at once. What a handle was made from may be destroyed before it: both share what they need.
 *
 * Threads. All functions may be called from any thread. Functions that compute spread over the oneTBB arena that the
 * calling thread is in, a worker's over the worker's threads.
 *
 * Strings are UTF-8, end in a zero and are copied.
 *
 * Numbers. A direction is three doubles x, y, z; a colour is r, g, b; a 3 x 3 matrix is nine doubles, column after
 * column. A direction or normal that a call takes may have any length: it is normalised, unless its length is 1. One
 * that is zero or not finite is WELKIN_INVALID_ARGUMENT. Returned directions have length 1. docs/guides/c.md leads
 * through the whole with examples.
 */
/* NOLINTBEGIN(modernize-*): this is C */
#ifndef WELKIN_WELKIN_H
#define WELKIN_WELKIN_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#ifndef WELKIN_API
#if defined(__GNUC__) && !defined(_WIN32)
#define WELKIN_API __attribute__((visibility("default")))
#else
#define WELKIN_API
#endif
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* The version of this interface. It rises when something is added or taken away. Fields and functions were taken away
 * in version 4, so programs that were compiled with an older header must be compiled again. A program runs with every
 * later library whose `welkin_c_version()` is not below its own WELKIN_C_VERSION, and with older ones, from version 4
 * on, as long as it leaves what is new alone. */
#define WELKIN_C_VERSION 4

/* The library's own WELKIN_C_VERSION, which may differ from the one that the program was compiled with. */
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
  WELKIN_QUEUE_FULL = 9,       /* a worker at its limits refused this job */
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

/* ---- Working memory ----
 * Calls take their large buffers and chains from blocks that earlier ones left, so that a warm call clears no pages
 * once results are freed. These functions change no result. */

/* Sets how many bytes of blocks that no call uses the process keeps, 128 MiB by default, and frees the oldest blocks
 * beyond that. 0 keeps none. */
WELKIN_API void welkin_keep_working_memory(uint64_t bytes);

/* Frees all blocks that no call uses. Calls that run keep theirs and leave them for later calls. */
WELKIN_API void welkin_release_working_memory(void);

/* ---- Environments ---- */

/* How one texel lies in memory: interleaved channels, no padding. Alpha is never read, and 1 where it is written. F16
 * is IEEE 754 binary16; U8 maps 0..255 to 0..1; SRGB8 does so and then applies the sRGB transfer function. Environments
 * are read in the first eight; results are written as floats and halves, see `welkin_cubemap_target`. */
typedef int32_t welkin_format;
enum {
  WELKIN_FORMAT_RGB_F32 = 0,
  WELKIN_FORMAT_RGBA_F32 = 1,
  WELKIN_FORMAT_RGB_F16 = 2,
  WELKIN_FORMAT_RGBA_F16 = 3,
  WELKIN_FORMAT_RGB_U8 = 4,
  WELKIN_FORMAT_RGBA_U8 = 5,
  WELKIN_FORMAT_RGB_SRGB8 = 6,
  WELKIN_FORMAT_RGBA_SRGB8 = 7,
  WELKIN_FORMAT_RG_F32 = 8, /* written only: the first two channels */
  WELKIN_FORMAT_RG_F16 = 9  /* likewise */
};

/* The caller's pixels, read in place: six square faces, +X -X +Y -Y +Z -Z, row 0 on top. Columns and rows run along
 * -z -y, +z -y, +x +z, +x -z, +x -y and -x -y. */
typedef struct welkin_cubemap {
  uint32_t struct_size;
  welkin_format format;     /* of all six faces */
  int64_t row_stride_bytes; /* from a row to the next; 0: rows are packed; negative: bottom-up */
  const void* faces[6];     /* first texel of each; float formats aligned to their channel */
  int64_t size;             /* texels along an edge, 1 to 16384 */
} welkin_cubemap;

/* The caller's pixels, read in place: a full sphere as latitude over longitude, the centre along +z, +x a quarter in
 * from the left, y up. */
typedef struct welkin_lat_long {
  uint32_t struct_size;
  welkin_format format;     /* of the pixels */
  int64_t row_stride_bytes; /* from a row to the next; 0: rows are packed; negative: bottom-up */
  const void* pixels;       /* first texel of the top row */
  int32_t width;            /* texels, 1 to 65536 */
  int32_t height;           /* texels, 1 to 32768 */
} welkin_lat_long;

/* How a picture file holds a sphere, with faces of N x N texels. */
typedef int32_t welkin_layout;
enum {
  WELKIN_LAYOUT_AUTOMATIC = 0, /* told from the file's header, its shape or its name */
  WELKIN_LAYOUT_LAT_LONG = 1,
  WELKIN_LAYOUT_VERTICAL_STRIP = 2,   /* N x 6N: +X -X +Y -Y +Z -Z from top to bottom */
  WELKIN_LAYOUT_HORIZONTAL_STRIP = 3, /* 6N x N: the same from left to right */
  WELKIN_LAYOUT_HORIZONTAL_CROSS = 4, /* 4N x 3N: -X +Z +X -Z in the middle row, +Y above +Z, -Y below it */
  WELKIN_LAYOUT_VERTICAL_CROSS = 5,   /* 3N x 4N: +Y; -X +Z +X; -Y; and -Z below that, turned by half a turn */
  WELKIN_LAYOUT_SIX_FILES = 6         /* one picture per face, told apart by the ends of their names */
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

/* How a file is read. A part, layer, level or element that the file does not have is refused (unsupported file), even
 * if its format has no such thing; part "0", level 0 and element 0 are in every file. */
typedef struct welkin_read_options {
  uint32_t struct_size;
  welkin_layout layout; /* how the picture holds the sphere */
  const char* part;     /* of a multi-part OpenEXR file: its name, or its number from 0; null: the first with colour */
  const char* layer;    /* of an OpenEXR file with layers; null: the channels without one, else the only one */
  welkin_transfer transfer;    /* what the numbers of a PNG mean */
  welkin_primaries primaries;  /* the colours that pixels are taken in */
  uint64_t memory_limit_bytes; /* the most that pixels may take; 0: 8 GiB */
  int64_t level;               /* of a file with a mip chain; 0 is the full size */
  int64_t element;             /* of an array of cubemaps or pictures (KTX2, KTX, DDS), from 0 */
} welkin_read_options;

/* ---- Projection to spherical harmonics ---- */

/* The largest number of bands that any call takes. */
#define WELKIN_MAXIMUM_BANDS 16

/* What a texel stands for while it is integrated. */
typedef int32_t welkin_quadrature;
enum {
  WELKIN_QUADRATURE_EXACT = 0,   /* its area: no error at any size */
  WELKIN_QUADRATURE_MIDPOINT = 1 /* its centre, as Babylon.js does */
};

/* What becomes of a NaN or an infinity. */
typedef int32_t welkin_non_finite_policy;
enum {
  WELKIN_NON_FINITE_REPLACE = 0, /* NaN and -infinity by 0, +infinity by the clamp's maximum or else 65504 */
  WELKIN_NON_FINITE_REJECT = 1   /* the call returns WELKIN_REJECTED_PIXEL */
};

/* What becomes of a finite value below zero. */
typedef int32_t welkin_negative_policy;
enum {
  WELKIN_NEGATIVE_KEEP = 0,
  WELKIN_NEGATIVE_REPLACE = 1, /* by 0 */
  WELKIN_NEGATIVE_REJECT = 2   /* the call returns WELKIN_REJECTED_PIXEL */
};

/* How an environment is projected. */
typedef struct welkin_projection_options {
  uint32_t struct_size;
  int32_t bands;                 /* 1 to WELKIN_MAXIMUM_BANDS; 0: 3 */
  welkin_quadrature quadrature;  /* how texels are integrated */
  int32_t target_size;           /* edge of the cubemap face to which the environment is reduced first; 0: it is not */
  float clamp_maximum;           /* upper bound on radiance, above 0; 0: none */
  int32_t clamp_preserve_colour; /* 1: r, g and b are scaled together; 0: each is clamped to [0, maximum] */
  int32_t gamma;                 /* 1: the pixels are gamma encoded, as Babylon.js's gammaSpace; 0: linear */
  welkin_non_finite_policy nan;  /* what becomes of a NaN */
  welkin_non_finite_policy infinity; /* what becomes of an infinity */
  welkin_negative_policy negative;   /* what becomes of a finite value below zero */
} welkin_projection_options;

/* The light of an environment. 6 KiB that the caller provides: nothing to free, and no second buffer whose length could
 * be wrong. A `struct_size` that ends inside `coefficients` is fine too: it must have room for the bands that are asked
 * for. */
typedef struct welkin_projection {
  uint32_t struct_size;
  int32_t bands;                         /* how many of them `coefficients` holds */
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

/* Projects `probe_count` cubemaps of any sizes and formats, all of one `struct_size`: 3 bands^2 doubles of each are
 * written to `coefficients`, one probe after the other, with the bits of `welkin_project_cubemap`. Nothing is taken
 * from the heap for a small probe. `totals` (may be null) gets the sums over all probes, the largest error estimate,
 * no bands and no coefficients. Errors name the number of the probe. */
WELKIN_API welkin_status welkin_project_many(const welkin_cubemap* probes, int64_t probe_count,
                                             const welkin_projection_options* options, const welkin_control* control,
                                             double* coefficients, welkin_projection* totals);

/* The same as `welkin_project_cubemap`, of a lat-long. */
WELKIN_API welkin_status welkin_project_lat_long(const welkin_lat_long* lat_long,
                                                 const welkin_projection_options* options,
                                                 const welkin_control* control, welkin_projection* projection);

/* The same of a file; a lat-long is projected while it is decoded. Also WELKIN_FILE_ACCESS, WELKIN_CORRUPT_FILE,
 * WELKIN_UNSUPPORTED_FILE, WELKIN_LIMIT_EXCEEDED. */
WELKIN_API welkin_status welkin_project_file(const char* path, const welkin_read_options* read_options,
                                             const welkin_projection_options* options, const welkin_control* control,
                                             welkin_projection* projection);

/* ---- Harmonics ----
 * `coefficients` holds 3 bands^2 doubles, as in `welkin_projection`. WELKIN_INVALID_ARGUMENT for null pointers and for
 * bands out of range. */

/* Radiance to irradiance: band l times pi, 2 pi/3, pi/4, 0, -pi/24, ... `irradiance`, 3 bands^2 doubles, may be
 * `radiance`. */
WELKIN_API welkin_status welkin_irradiance_from_radiance(int32_t bands, const double* radiance, double* irradiance);

/* Their value for a `direction` (x, y, z): `value` gets r, g, b. */
WELKIN_API welkin_status welkin_evaluate(int32_t bands, const double* coefficients, const double* direction,
                                         double* value);

/* The light after it was turned: what came from direction d comes from the turned d. `quaternion` is x, y, z, w of any
 * length but 0. `turned`, 3 bands^2 doubles, may be `coefficients`. */
WELKIN_API welkin_status welkin_turn_by_quaternion(int32_t bands, const double* coefficients, const double* quaternion,
                                                   double* turned);

/* The same for an orthogonal matrix, mirrors included. WELKIN_INVALID_ARGUMENT if it is off orthogonal by more than
 * 1e-6. */
WELKIN_API welkin_status welkin_turn_by_matrix(int32_t bands, const double* coefficients, const double* matrix,
                                               double* turned);

/* Factor of band l against ringing, with w = pi l / width. */
typedef int32_t welkin_window;
enum {
  WELKIN_WINDOW_NONE = 0,         /* 1 */
  WELKIN_WINDOW_HANNING = 1,      /* (1 + cos w) / 2, 0 from l = width on */
  WELKIN_WINDOW_LANCZOS = 2,      /* sin(w) / w, 0 from l = width on */
  WELKIN_WINDOW_MIN_LAPLACIAN = 3 /* 1 / (1 + c l^2 (l + 1)^2), smallest c that leaves no irradiance negative */
};

/* What a window did. */
typedef struct welkin_window_report {
  uint32_t struct_size;
  int32_t bands;                        /* how many of `factors` there are */
  double parameter;                     /* Hanning, Lanczos: the width in bands; min Laplacian: lambda */
  double minimum_before[3];             /* r, g, b: the minimum of irradiance over all normals */
  double minimum_after[3];              /* the same of the windowed irradiance */
  double factors[WELKIN_MAXIMUM_BANDS]; /* by band; zeros behind */
} welkin_window_report;

/* Multiplies each band of radiance by the window's factor. `width` is in bands, of Hanning and Lanczos only; 0: the
 * number of bands. `windowed`, 3 bands^2 doubles, may be `radiance`; `report` may be null. */
WELKIN_API welkin_status welkin_apply_window(int32_t bands, const double* radiance, welkin_window window, double width,
                                             double* windowed, welkin_window_report* report);

/* The minimum over the sphere, by channel: `value` gets r, g, b; `directions` (nine doubles, may be null) gets the
 * unit direction of each channel's. */
WELKIN_API welkin_status welkin_minimum(int32_t bands, const double* coefficients, double* value, double* directions);

/* The exposure that takes the mean radiance to middle grey: 0.18 over its luminance (Rec. 709), or 1 if the mean is not
 * above 0. Multiply radiance by it before a tone curve. */
WELKIN_API welkin_status welkin_exposure_of(int32_t bands, const double* radiance, double* exposure);

/* The one directional light that comes closest to an environment: `direction` (unit, towards it), `irradiance` (on a
 * surface that faces it), and 1 in `found`. 0 in `found`, and zeros, if the light comes from no direction. */
WELKIN_API welkin_status welkin_dominant_light(int32_t bands, const double* radiance, double* direction,
                                               double* irradiance, int32_t* found);

/* A sun as a directional light. */
typedef struct welkin_sun {
  uint32_t struct_size;
  double direction[3];           /* unit, towards its centre */
  double irradiance[3];          /* on a surface that faces it */
  double radiance[3];            /* its mean: irradiance / solid angle */
  double solid_angle;            /* steradians */
  double angular_radius_degrees; /* of a disc with that solid angle */
} welkin_sun;

/* The radiance coefficients of a sun's light, to be added to those of its sky: a disc of its solid angle that holds its
 * irradiance; with solid angle 0 a light from one direction. */
WELKIN_API welkin_status welkin_sun_harmonics(const welkin_sun* sun, int32_t bands, double* coefficients);

/* ---- Engines ---- */

/* The engines and formats whose conventions are known. */
typedef int32_t welkin_engine;
enum {
  WELKIN_ENGINE_WELKIN = 0,
  WELKIN_ENGINE_OPENEXR = 1,
  WELKIN_ENGINE_BABYLON = 2,
  WELKIN_ENGINE_THREE = 3,
  WELKIN_ENGINE_FILAMENT = 4,
  WELKIN_ENGINE_GLTF = 5,
  WELKIN_ENGINE_UNITY = 6,
  WELKIN_ENGINE_UNREAL = 7,
  WELKIN_ENGINE_BLENDER = 8,
  WELKIN_ENGINE_GODOT = 9,
  WELKIN_ENGINE_BEVY = 10,
  WELKIN_ENGINE_USD = 11
};

/* How an engine's axes lie to Welkin's. The strings are constants. */
typedef struct welkin_convention {
  uint32_t struct_size;
  welkin_engine engine;  /* whose it is */
  int32_t right_handed;  /* 1 or 0 */
  int32_t has_faces;     /* 1 if the engine has cubemaps of its own: `faces_from_engine` is one */
  const char* name;      /* "babylon", ... */
  const char* title;     /* "Babylon.js", ... */
  const char* axes;      /* in words */
  const char* lat_long;  /* in words */
  double from_welkin[9]; /* takes a direction in Welkin's axes to the engine's; a mirror for left-handed engines */
  double faces_from_engine[9]; /* takes a direction in the engine's axes to the frames of `welkin_cubemap`'s faces */
} welkin_convention;

/* How things lie in an engine. */
WELKIN_API welkin_status welkin_get_convention(welkin_engine engine, welkin_convention* convention);

/* Light in an engine's own form; docs/reference/engines.md has the formulas. */
typedef struct welkin_engine_light {
  uint32_t struct_size;
  welkin_engine engine; /* whose form it is */
  int32_t term_count;   /* 9 */
  int32_t vector_count; /* 7 for Unity and Unreal, else 0 */
  /* r, g, b of each term. Babylon.js (SphericalPolynomial): x y z xx yy zz yz zx xy; else coefficient l (l + 1) + m. */
  double terms[9][3];
  /* As the engine's shader has them: SHAr SHAg SHAb SHBr SHBg SHBb SHC, and the same for Unreal. */
  double vectors[7][4];
} welkin_engine_light;

/* Radiance in Welkin's axes, turned to the engine's axes, in the engine's form. Bands above the third are left out.
 * WELKIN_INVALID_ARGUMENT for those that have no form of their own: OpenEXR, Blender, Bevy, OpenUSD. */
WELKIN_API welkin_status welkin_engine_light_from_radiance(int32_t bands, const double* radiance, welkin_engine engine,
                                                           welkin_engine_light* light);

/* The same without the turn: `radiance` is in the engine's axes already. */
WELKIN_API welkin_status welkin_engine_light_in_place(int32_t bands, const double* radiance, welkin_engine engine,
                                                      welkin_engine_light* light);

/* ---- Results in the caller's memory ---- */

/* Memory for one level of a cubemap, which may be an upload buffer: the library writes each texel once and reads none.
 * Formats: RG, RGB and RGBA, F32 and F16. Halves are rounded to nearest; what is beyond the largest half (65504)
 * becomes that, and NaN becomes 0. Calls that take a target also take `values_clamped`, null or where the number of
 * such values goes. A target is checked before anything is computed. */
typedef struct welkin_cubemap_target {
  uint32_t struct_size;
  welkin_format format;     /* of all six faces */
  int64_t row_stride_bytes; /* from a row to the next, at least a row; 0: rows are packed; negative: bottom-up */
  void* faces[6];           /* first texel of the top row of each, aligned to its channels */
  int64_t size;             /* texels along an edge: exactly those of what is written */
} welkin_cubemap_target;

/* The same for a two-dimensional picture. */
typedef struct welkin_image_target {
  uint32_t struct_size;
  welkin_format format;     /* of the pixels */
  int64_t row_stride_bytes; /* from a row to the next, at least a row; 0: rows are packed; negative: bottom-up */
  void* pixels;             /* first texel of the top row, aligned to its channels */
  int32_t width;            /* texels: exactly those of what is written */
  int32_t height;           /* likewise */
} welkin_image_target;

/* A cubemap of RGB floats with its levels, level l with max(1, size >> l) texels along an edge. */
typedef struct welkin_cubemap_chain welkin_cubemap_chain;

/* What a chain holds. */
typedef struct welkin_cubemap_chain_info {
  uint32_t struct_size;
  int32_t size;        /* texels along an edge of level 0 */
  int32_t levels;      /* how many there are */
  int32_t prefiltered; /* 1: each level has a roughness, see `welkin_cubemap_chain_get_mip` */
  uint64_t bytes;      /* memory of all levels */
} welkin_cubemap_chain_info;

/* Destroys a handle. The pixels go with the last one. */
WELKIN_API void welkin_cubemap_chain_destroy(welkin_cubemap_chain* chain);

/* Another handle to the same pixels, which stay for as long as one of them is held. */
WELKIN_API welkin_status welkin_cubemap_chain_share(const welkin_cubemap_chain* chain, welkin_cubemap_chain** another);

/* Sizes of a chain. */
WELKIN_API welkin_status welkin_cubemap_chain_get_info(const welkin_cubemap_chain* chain,
                                                       welkin_cubemap_chain_info* info);

/* The pixels of a level in place: RGB_F32, rows packed, good for as long as the chain is held. All calls that read or
 * write cubemaps take them. */
WELKIN_API welkin_status welkin_cubemap_chain_get_level(const welkin_cubemap_chain* chain, int32_t level,
                                                        welkin_cubemap* pixels);

/* Writes a level to the caller's memory, on the calling thread: below a nanosecond a value for floats, some more for
 * halves. */
WELKIN_API welkin_status welkin_cubemap_chain_copy(const welkin_cubemap_chain* chain, int32_t level,
                                                   const welkin_cubemap_target* target, uint64_t* values_clamped);

/* ---- Reflections ---- */

/* What becomes of pixel values before they count as radiance, as in `welkin_projection_options`. */
typedef struct welkin_pixel_policy {
  uint32_t struct_size;
  float clamp_maximum;               /* upper bound on radiance, above 0; 0: none */
  int32_t clamp_preserve_colour;     /* 1: r, g and b are scaled together; 0: each is clamped to [0, maximum] */
  int32_t gamma;                     /* 1: the pixels are gamma encoded, as Babylon.js's gammaSpace; 0: linear */
  welkin_non_finite_policy nan;      /* what becomes of a NaN */
  welkin_non_finite_policy infinity; /* what becomes of an infinity */
  welkin_negative_policy negative;   /* what becomes of a finite value below zero */
} welkin_pixel_policy;

/* How a mip is made. */
typedef int32_t welkin_prefilter_method;
enum {
  WELKIN_PREFILTER_AUTOMATIC = 0, /* for each mip the fastest within both bounds */
  WELKIN_PREFILTER_SPECTRAL = 1,  /* by harmonics, the brightest texels each by its own lobe */
  WELKIN_PREFILTER_REFERENCE = 2, /* the integral, texel by texel: slow */
  WELKIN_PREFILTER_COPY = 4,      /* of a mip that was made: roughness 0 */
  WELKIN_PREFILTER_NARROW = 5     /* of a mip that was made: texels near by as areas, the far part by harmonics */
};

/* Ways to spread roughness over a chain, with t = mip / (mips - 1). */
typedef int32_t welkin_roughness_schedule;
enum {
  WELKIN_ROUGHNESS_LINEAR = 0,   /* t */
  WELKIN_ROUGHNESS_FILAMENT = 1, /* 1 - sqrt(1 - t); three.js too */
  WELKIN_ROUGHNESS_BABYLON = 2,  /* 0 at mip 0, else the square root of 2^(mip / 0.8) / size, at most 1 */
  WELKIN_ROUGHNESS_UNITY = 3,    /* r with mip = 6 r (1.7 - 0.7 r), whatever the number of mips */
  WELKIN_ROUGHNESS_UNREAL = 4    /* 0 at mip 0, else 2^((mip - (mips - 1) + 2) / 1.2), at most 1 */
};

/* The perceptual roughness of each mip: `roughness` has room for `mips` doubles, 1 to 16. `size`: of mip 0. */
WELKIN_API welkin_status welkin_roughness_of_mips(welkin_roughness_schedule schedule, int32_t mips, int32_t size,
                                                  double* roughness);

/* The roughness of lobes for a shader that reads mips by the schedule's formula, bilinearly in a mip and linearly
 * between two: `roughness` has room for `mips` doubles. For `lobe_roughness` of welkin_prefilter_options. */
WELKIN_API welkin_status welkin_fitted_roughness_of_mips(welkin_roughness_schedule schedule, int32_t mips, int32_t size,
                                                         double* roughness);

/* The default number of mips for a schedule. LINEAR and FILAMENT: down to 4 texels, but five where `size` has five;
 * UNITY: at most seven; BABYLON and UNREAL: down to 1 texel. */
WELKIN_API welkin_status welkin_mips_of_chain(welkin_roughness_schedule schedule, int32_t size, int32_t* mips);

/* Lobes of a chain whose mips have a roughness r each; docs/maths/reflections.md has their formulas. */
typedef int32_t welkin_lobe_family;
enum {
  WELKIN_LOBE_FAMILY_GGX = 0,
  WELKIN_LOBE_FAMILY_CHARLIE = 1, /* sheen; r below 0.05 is raised to it */
  WELKIN_LOBE_FAMILY_LAMBERT = 2, /* irradiance over pi, at any r; one mip unless `mips` says more */
  WELKIN_LOBE_FAMILY_PHONG = 3,   /* of power max(1, 2 / r^4 - 2); r below 0.12 is raised to it */
  WELKIN_LOBE_FAMILY_BLINN = 4,   /* of power 2 / r^4 - 2; r below 0.12 is raised to it */
  WELKIN_LOBE_FAMILY_SPECTRA = 5  /* `spectra` has the numbers */
};

/* Presets of how exact reflections and irradiance are. */
typedef int32_t welkin_quality;
enum {
  WELKIN_QUALITY_NORMAL = 0,   /* rms_error 1e-3 */
  WELKIN_QUALITY_FAST = 1,     /* rms_error 1e-2 */
  WELKIN_QUALITY_REFERENCE = 2 /* the integrals themselves, in double; takes minutes */
};

/* Sizes, lobes and bounds of a chain. */
typedef struct welkin_prefilter_options {
  uint32_t struct_size;
  int32_t size;                      /* texels along an edge of mip 0, 1 to 8192; 0: 256, of skies 32 */
  int32_t mips;                      /* 0: `roughness_count`; without roughness `welkin_mips_of_chain` of FILAMENT
                                        (of CHARLIE, LINEAR), of LAMBERT and SPECTRA 1 */
  int32_t roughness_count;           /* numbers at `roughness`; 0: those of WELKIN_ROUGHNESS_FILAMENT */
  const double* roughness;           /* perceptual, 0 to 1, of each mip; copied */
  welkin_prefilter_method method;    /* of all mips */
  double rms_error;                  /* bound on a mip's relative root mean square error; 0: by `quality` */
  double maximum_error;              /* bound on the relative error at any texel; 0: ten times rms_error, at most 1 */
  const welkin_pixel_policy* pixels; /* null: the defaults. In a bake and of a sky it must be null */
  welkin_lobe_family lobe;           /* of all mips */
  int32_t spectrum_bands;            /* numbers of each mip's spectrum, 1 to 1536; only of SPECTRA, as `spectra` */
  const double* spectra;             /* mips times spectrum_bands: what degrees are multiplied by; copied */
  welkin_quality quality;            /* method and bounds; where `rms_error` is not 0, WELKIN_QUALITY_NORMAL */
  const double* lobe_roughness;      /* of each mip's lobe, `roughness_count` numbers; null: `roughness`; copied */
} welkin_prefilter_options;

/* How one mip was made, and how good it is. */
typedef struct welkin_mip {
  uint32_t struct_size;
  int32_t size;                   /* texels along an edge */
  double roughness;               /* perceptual, at which a shader finds the mip */
  welkin_prefilter_method method; /* never automatic */
  int32_t bands;                  /* spectral */
  int32_t bright_texels;          /* spectral: that were added one by one */
  double error_estimate;          /* predicted rms error over the mip's rms; NaN: nothing is known (stored) */
  double mean[3];                 /* of the texels, by solid angle: lamps narrower than they are change it */
  double milliseconds;            /* wall time */
  double lobe_roughness;          /* of the mip's lobe */
  double error_between;           /* predicted rms error of lookups between this mip and the next; NaN: not known */
} welkin_mip;

/* Of a prefiltered chain. */
WELKIN_API welkin_status welkin_cubemap_chain_get_mip(const welkin_cubemap_chain* chain, int32_t level,
                                                      welkin_mip* mip);

/* Prefilters for reflections (GGX, split sum): a mip for each roughness. Also WELKIN_REJECTED_PIXEL,
 * WELKIN_LIMIT_EXCEEDED (bounds that no method reaches), WELKIN_CANCELLED, WELKIN_OUT_OF_MEMORY. */
WELKIN_API welkin_status welkin_prefilter_cubemap(const welkin_cubemap* cubemap,
                                                  const welkin_prefilter_options* options,
                                                  const welkin_control* control, welkin_cubemap_chain** chain);

/* The same of a lat-long. */
WELKIN_API welkin_status welkin_prefilter_lat_long(const welkin_lat_long* lat_long,
                                                   const welkin_prefilter_options* options,
                                                   const welkin_control* control, welkin_cubemap_chain** chain);

/* The roughness of each mip of a sheen chain of glTF: `roughness` has room for `mips` doubles, 1 to 16. */
WELKIN_API welkin_status welkin_charlie_roughness_of_mips(int32_t mips, int32_t size, double* roughness);

/* Contents of the first two channels of a BRDF table, with E = f0 scale + bias the reflectance in even light.
 * SPLIT_SUM: scale and bias. MULTIPLE_SCATTERING: bias and scale + bias, so that E = (1 - f0) red + f0 green. */
typedef int32_t welkin_brdf_model;
enum { WELKIN_BRDF_SPLIT_SUM = 0, WELKIN_BRDF_MULTIPLE_SCATTERING = 1 };

/* Size and contents of a BRDF table. */
typedef struct welkin_brdf_options {
  uint32_t struct_size;
  int32_t width;           /* along N.V, 1 to 4096; 0: 64 */
  int32_t height;          /* along perceptual roughness, 1 to 4096; 0: 64 */
  welkin_brdf_model model; /* of the first two channels */
  int32_t without_sheen;   /* 1: the third channel is 0; 0: it is the albedo of sheen */
} welkin_brdf_options;

/* Writes the table; the target has the options' width and height, row 0 the lowest roughness. Tables that were used
 * last are kept: a second call copies. */
WELKIN_API welkin_status welkin_brdf_table(const welkin_brdf_options* options, const welkin_control* control,
                                           const welkin_image_target* target, uint64_t* values_clamped);

/* What of a texel counts; a negative weight counts as 0. */
typedef int32_t welkin_importance_weight;
enum { WELKIN_IMPORTANCE_LUMINANCE = 0, WELKIN_IMPORTANCE_MEAN = 1, WELKIN_IMPORTANCE_LARGEST = 2 };

/* How a table by which a path tracer picks directions is made. */
typedef struct welkin_importance_options {
  uint32_t struct_size;
  int32_t width;                     /* of the table, 1 to the source's; 0: the source's */
  int32_t height;                    /* the same */
  welkin_importance_weight weight;   /* what of a texel counts */
  int32_t mis_compensation;          /* 1: weights less their mean, at least 0, for estimators that combine the table
                                        with samples of the material by the balance heuristic; 0: all counts */
  const welkin_pixel_policy* pixels; /* null: the defaults */
} welkin_importance_options;

/* Writes a table: `function` has width x height floats, the integral of the weight over each texel; `row_cdf` height +
 * 1; `column_cdf` height x (width + 1). `integral`, the sum of `function`, may be null. Also WELKIN_REJECTED_PIXEL,
 * WELKIN_CANCELLED. */
WELKIN_API welkin_status welkin_importance_lat_long(const welkin_lat_long* lat_long,
                                                    const welkin_importance_options* options,
                                                    const welkin_control* control, float* function, float* row_cdf,
                                                    float* column_cdf, double* integral);

/* Writes irradiance at each texel's centre from the coefficients of irradiance, `welkin_irradiance_from_radiance`'s;
 * the target's size is 1 to 4096. */
WELKIN_API welkin_status welkin_irradiance_cubemap(int32_t bands, const double* irradiance,
                                                   const welkin_control* control, const welkin_cubemap_target* target,
                                                   uint64_t* values_clamped);

/* ---- Bake: all that a physically based renderer loads, in one call ---- */

/* Flags, added up. */
typedef uint32_t welkin_parts;
enum {
  WELKIN_PART_BACKGROUND = 1, /* a sharp cubemap with mips */
  WELKIN_PART_SPECULAR = 2,   /* reflections */
  WELKIN_PART_IRRADIANCE = 4, /* a cubemap */
  WELKIN_PART_HARMONICS = 8,  /* of radiance */
  WELKIN_PART_BRDF = 16,      /* the table */
  WELKIN_PART_OCTAHEDRAL = 32 /* the reflections as an octahedral map; only where `octahedral_size` asks for it */
};

/* How a level is made from the one above it. */
typedef int32_t welkin_mip_filter;
enum {
  WELKIN_MIP_FILTER_SOLID_ANGLE = 0, /* keeps the sphere's total radiance */
  WELKIN_MIP_FILTER_BOX = 1          /* as graphics APIs do */
};

/* How an irradiance cubemap is computed. */
typedef int32_t welkin_irradiance_method;
enum {
  WELKIN_IRRADIANCE_AUTOMATIC = 0, /* within `irradiance_rms_error` of the integral over the source's texels */
  WELKIN_IRRADIANCE_DIRECT = 1,    /* the integral itself: the reference, slow */
  WELKIN_IRRADIANCE_HARMONICS = 2  /* from `bands` of the harmonics, as shaders show that read so many */
};

/* Parts, sizes and bounds of a bake. */
typedef struct welkin_bake_options {
  uint32_t struct_size;
  welkin_parts leave_out;                     /* parts that are not made; 0: all are */
  int32_t background_size;                    /* 0: the specular cubemap's; without one the source's own */
  int32_t background_without_mips;            /* 1: level 0 alone */
  welkin_mip_filter mip_filter;               /* of the background */
  int32_t irradiance_size;                    /* 0: 64 */
  welkin_irradiance_method irradiance_method; /* of the irradiance cubemap */
  int32_t bands;                              /* of the harmonics; 0: 3 */
  const welkin_prefilter_options* specular;   /* of the reflections; null: the defaults */
  const welkin_brdf_options* brdf;            /* of the table; null: the defaults */
  const welkin_pixel_policy* pixels;          /* for all parts; null: the defaults */
  uint64_t memory_limit_bytes;                /* results and working memory together; 0: 8 GiB */
  double irradiance_rms_error;                /* bound of the automatic method, 1e-6 to 1; 0: by `quality` */
  int32_t octahedral_size;                    /* texels along an edge, borders included; 0: no map is made */
  int32_t octahedral_levels;                  /* 0: 1. Size and border must be multiples of 2^(levels - 1) */
  int32_t octahedral_border;                  /* texels on each side of level 0; 0: 2^(octahedral_levels - 1) */
  welkin_quality quality;                     /* of irradiance, and of reflections whose own quality is normal */
} welkin_bake_options;

/* Bakes reflections and harmonics of `probe_count` cubemaps of any sizes and formats, all of one `struct_size`, into
 * memory of the caller's. `targets`, also of one `struct_size`, RGBA_F16 or RGBA_F32: one for each mip of the first
 * probe's chain, then of the second's, and so on; `target_count` is the number of mips times `probe_count`.
 * `coefficients` gets 3 bands^2 doubles of each probe; with 0 bands it may be null. `totals` as `welkin_project_many`,
 * `values_clamped` (may be null too) of all targets. Errors name the number of the probe. Arguments are checked before
 * anything is written; after other errors any part of the targets may be written. */
WELKIN_API welkin_status welkin_bake_many(const welkin_cubemap* probes, int64_t probe_count,
                                          const welkin_prefilter_options* options, const welkin_control* control,
                                          const welkin_cubemap_target* targets, int64_t target_count, int32_t bands,
                                          double* coefficients, welkin_projection* totals, uint64_t* values_clamped);

/* What a bake made. */
typedef struct welkin_bake_result welkin_bake_result;

/* Which parts a bake made, and how large they are. */
typedef struct welkin_bake_info {
  uint32_t struct_size;
  welkin_parts parts;               /* that there are */
  int32_t bands;                    /* 0 without harmonics */
  int32_t brdf_width;               /* 0 without a table */
  int32_t brdf_height;              /* likewise */
  int32_t brdf_channels;            /* 3 with sheen, else 2 */
  uint64_t peak_bytes;              /* bound on results and working memory together */
  double irradiance_error_estimate; /* predicted rms error of the irradiance cubemap over its rms; NaN: not known */
  int32_t octahedral_size;          /* 0 without a map */
  int32_t octahedral_levels;        /* fewer than asked for where there are fewer mips */
  int32_t octahedral_border;        /* texels on each side of level 0 */
  uint64_t values_clamped;          /* channel values that the formats of `welkin_bake_targets` could not hold */
} welkin_bake_info;

/* Bakes. As `welkin_project_cubemap`, and WELKIN_LIMIT_EXCEEDED. */
WELKIN_API welkin_status welkin_bake_cubemap(const welkin_cubemap* cubemap, const welkin_bake_options* options,
                                             const welkin_control* control, welkin_bake_result** result);

/* The same of a lat-long. */
WELKIN_API welkin_status welkin_bake_lat_long(const welkin_lat_long* lat_long, const welkin_bake_options* options,
                                              const welkin_control* control, welkin_bake_result** result);

/* Destroys a result. Chains that were shared stay. */
WELKIN_API void welkin_bake_result_destroy(welkin_bake_result* result);

/* What is in a result. */
WELKIN_API welkin_status welkin_bake_result_get_info(const welkin_bake_result* result, welkin_bake_info* info);

/* The cubemap of one of the parts background, specular and irradiance, lent: good for as long as the result is held,
 * and `welkin_cubemap_chain_share` keeps it longer. Null if that part was not made, for null and for other parts. */
WELKIN_API const welkin_cubemap_chain* welkin_bake_result_chain(const welkin_bake_result* result, welkin_parts part);

/* The harmonics of radiance, and what was read, replaced and clamped. WELKIN_INVALID_ARGUMENT without harmonics. */
WELKIN_API welkin_status welkin_bake_result_get_projection(const welkin_bake_result* result,
                                                           welkin_projection* projection);

/* Writes a level of the octahedral map, which has octahedral_size >> level texels along an edge: RGB, and alpha 1.
 * WELKIN_INVALID_ARGUMENT without a map. */
WELKIN_API welkin_status welkin_bake_result_copy_octahedral(const welkin_bake_result* result, int32_t level,
                                                            const welkin_image_target* target,
                                                            uint64_t* values_clamped);

/* Writes the BRDF table, as `welkin_brdf_table`. WELKIN_INVALID_ARGUMENT without one. */
WELKIN_API welkin_status welkin_bake_result_copy_brdf(const welkin_bake_result* result,
                                                      const welkin_image_target* target, uint64_t* values_clamped);

/* ---- Sky ----
 * y is up; a sun's azimuth is counted from +z towards +x, its elevation from the horizon up. `sun` is a direction
 * towards it. docs/maths/sky.md says what is computed. */

/* An atmosphere: a planet's air, its ground and its sun. Not to be changed while another thread uses it. */
typedef struct welkin_atmosphere welkin_atmosphere;

/* Atmospheres to begin with. */
typedef int32_t welkin_planet;
enum {
  WELKIN_PLANET_EARTH = 0,          /* clear air as measured, at 680, 550 and 440 nm */
  WELKIN_PLANET_EARTH_HILLAIRE = 1, /* Hillaire 2020's */
  WELKIN_PLANET_MARS = 2,
  WELKIN_PLANET_BARE = 3,           /* of Earth's size, without air, light or colour, at 680, 550 and 440 nm */
  WELKIN_PLANET_EARTH_BRUNETON = 4, /* Bruneton 2017's, at 680, 550 and 440 nm: almost no aerosol */
  WELKIN_PLANET_EARTH_HAZY = 5,     /* clear air's aerosol, three times as much */
  WELKIN_PLANET_EARTH_DUSTY = 6,    /* desert dust */
  WELKIN_PLANET_EARTH_POLLUTED = 7  /* continental air near cities */
};

/* Makes an atmosphere, which can then be changed. */
WELKIN_API welkin_status welkin_atmosphere_create(welkin_planet planet, welkin_atmosphere** atmosphere);

/* Earth at wavelengths of the caller's choice, 360 to 830 nm: three, or up to 96 for WELKIN_SKY_COLOUR_LINEAR_SRGB. */
WELKIN_API welkin_status welkin_atmosphere_create_earth(const double* wavelengths_nm, int32_t count,
                                                        welkin_atmosphere** atmosphere);

/* Destroys an atmosphere. Tables and jobs that were made of it have copies. */
WELKIN_API void welkin_atmosphere_destroy(welkin_atmosphere* atmosphere);

/* Rising or falling, 3 to 96. What was set for each of the wavelengths before has to be set again. */
WELKIN_API welkin_status welkin_atmosphere_set_wavelengths(welkin_atmosphere* atmosphere, const double* wavelengths_nm,
                                                           int32_t count);

/* A kind of matter: its density over the altitude, and its coefficients where the density is 1. All is copied. */
typedef struct welkin_constituent {
  uint32_t struct_size;
  int32_t layer_count; /* 0: there is nothing of it */
  /* Five doubles a layer, from the ground up: thickness_m, exponential_term, exponential_scale_per_m,
   * linear_term_per_m, constant_term. Density at altitude h, relative to that of the coefficients: exponential_term
   * exp(exponential_scale_per_m h) + linear_term_per_m h + constant_term, clamped to [0, 1]. */
  const double* layers;
  const double* scattering_per_m; /* one for each wavelength; null: none */
  const double* absorption_per_m; /* likewise */
} welkin_constituent;

/* Which of the air's constituents is meant. */
typedef int32_t welkin_matter;
enum {
  WELKIN_MATTER_RAYLEIGH = 0,
  WELKIN_MATTER_AEROSOL = 1,
  WELKIN_MATTER_ABSORBER = 2 /* ozone and the like, up to four: 2 to 5 */
};

/* Replaces the aerosol by one of this vertical optical depth at 550 nm (0 to 100), Angstrom exponent (-4 to 8), single
 * scattering albedo (0 to 1) and asymmetry (mean cosine, -0.8 to 0.999), of scale height 1200 m. Extinction follows
 * (wavelength / 550 nm)^-exponent; small particles have exponents of 1 to 2, dust about 0.2. */
WELKIN_API welkin_status welkin_atmosphere_set_aerosol(welkin_atmosphere* atmosphere, double optical_depth,
                                                       double angstrom_exponent, double single_scattering_albedo,
                                                       double asymmetry);

/* Null removes it. Absorbers are counted without gaps: the first one that is not there yet can be added. */
WELKIN_API welkin_status welkin_atmosphere_set_matter(welkin_atmosphere* atmosphere, welkin_matter matter,
                                                      const welkin_constituent* constituent);

/* How the aerosol scatters by angle. */
typedef int32_t welkin_aerosol_phase;
enum { WELKIN_PHASE_CORNETTE_SHANKS = 0, WELKIN_PHASE_HENYEY_GREENSTEIN = 1 };

/* Sets how the aerosol scatters. `asymmetry` is g, -0.8 to 0.999. */
WELKIN_API welkin_status welkin_atmosphere_set_aerosol_phase(welkin_atmosphere* atmosphere, welkin_aerosol_phase phase,
                                                             double asymmetry);

/* The aerosol's g by wavelength, -0.8 to 0.999: one value for each. `count` 0: again the one that
 * `welkin_atmosphere_set_aerosol_phase` and `welkin_atmosphere_set_aerosol` set, which those calls come back to. */
WELKIN_API welkin_status welkin_atmosphere_set_aerosol_asymmetries(welkin_atmosphere* atmosphere,
                                                                   const double* asymmetries, int32_t count);

/* Airglow and stars, by day and night: luminance of the zenith as seen from the ground, 0 (none, the default) to 1
 * cd/m2. A dark place without a moon has 2e-4. */
WELKIN_API welkin_status welkin_atmosphere_set_night(welkin_atmosphere* atmosphere, double zenith_luminance);

/* Sets the radii of the ground, 1 to 1e9 m, and of the top of the air, above it and at most 11 times it. */
WELKIN_API welkin_status welkin_atmosphere_set_radii(welkin_atmosphere* atmosphere, double bottom_m, double top_m);

/* The ground's, 0 to 1: one value for all wavelengths (`count` 1), or one for each. */
WELKIN_API welkin_status welkin_atmosphere_set_ground_albedo(welkin_atmosphere* atmosphere, const double* albedo,
                                                             int32_t count);

/* Above the air, on a surface that faces the sun, W/m2/nm: one value for each wavelength. */
WELKIN_API welkin_status welkin_atmosphere_set_sun(welkin_atmosphere* atmosphere, const double* irradiance,
                                                   int32_t count, double angular_radius_degrees);

/* WELKIN_OK if it can be computed; else the message names the parameter, what was found and what would do. */
WELKIN_API welkin_status welkin_atmosphere_check(const welkin_atmosphere* atmosphere);

/* Unit direction towards a sun. */
WELKIN_API welkin_status welkin_sun_direction(double elevation_degrees, double azimuth_degrees, double* direction);

/* Dimensions of the table of scattered light. FULL: height, zeniths of view and sun, and the azimuth between them.
 * COMPACT: without the azimuth, with which only the phase functions then vary. */
typedef int32_t welkin_scattering_layout;
enum { WELKIN_SCATTERING_FULL = 0, WELKIN_SCATTERING_COMPACT = 1 };

/* What the three channels of a computed sky are. */
typedef int32_t welkin_sky_colour;
enum {
  WELKIN_SKY_COLOUR_SPECTRAL = 0,   /* W/m2/sr/nm at three wavelengths */
  WELKIN_SKY_COLOUR_LINEAR_SRGB = 1 /* cd/m2 */
};

/* Sizes of the tables, and how far scattering is followed. */
typedef struct welkin_sky_table_options {
  uint32_t struct_size;
  welkin_scattering_layout layout;      /* of the table of scattered light */
  int32_t heights;                      /* 2 to 128; 0: 32 */
  int32_t view_zeniths;                 /* even, 4 to 1024; 0: 64 */
  int32_t sun_zeniths;                  /* 4 to 256; 0: 64 */
  int32_t sun_angles;                   /* FULL only, 2 to 128; 0: 8 */
  int32_t transmittance_heights;        /* 2 to 1024; 0: 64 */
  int32_t transmittance_zeniths;        /* 2 to 2048; 0: 256 */
  int32_t irradiance_heights;           /* 2 to 1024; 0: 16 */
  int32_t irradiance_sun_zeniths;       /* 2 to 1024; 0: 64 */
  int32_t orders;                       /* of scattering, 1 to 64; 0: 4 */
  welkin_sky_colour colour;             /* what the three channels are */
  double minimum_sun_elevation_degrees; /* that the tables hold, -90 up to below 0; 0: -30 */
  double until_change;                  /* stop before `orders` when one added less than this share; 0: never */
  uint64_t memory_limit_bytes;          /* 0: 4 GiB */
  int32_t exact_orders;                 /* not 0: nothing of orders beyond `orders`; 0: they are estimated */
} welkin_sky_table_options;

/* All that a planet's sky can look like: precomputed scattering. */
typedef struct welkin_sky_tables welkin_sky_tables;

/* What was computed. */
typedef struct welkin_sky_tables_info {
  uint32_t struct_size;
  int32_t orders;     /* that were computed */
  double last_change; /* share that the last of them added */
  uint64_t bytes;     /* memory of all tables */
} welkin_sky_tables_info;

/* Computes them: some two seconds of processor time with the defaults. The atmosphere is copied. Also
 * WELKIN_LIMIT_EXCEEDED, WELKIN_CANCELLED. */
WELKIN_API welkin_status welkin_sky_tables_create(const welkin_atmosphere* atmosphere,
                                                  const welkin_sky_table_options* options,
                                                  const welkin_control* control, welkin_sky_tables** tables);

/* Destroys a handle. Views, curves and jobs that were made of the tables keep them. */
WELKIN_API void welkin_sky_tables_destroy(welkin_sky_tables* tables);

/* Sizes of the tables. */
WELKIN_API welkin_status welkin_sky_tables_get_info(const welkin_sky_tables* tables, welkin_sky_tables_info* info);

/* The sky as it is seen from one height. */
typedef struct welkin_sky_view welkin_sky_view;

/* What a view is prepared for. */
typedef struct welkin_sky_view_options {
  uint32_t struct_size;
  int32_t without_ground; /* 1: rays that end on the ground see only the air before it */
} welkin_sky_view_options;

/* Makes a view, in some 2 ms. `altitude_m`: the observer's above the ground, 0 to 1e9. */
WELKIN_API welkin_status welkin_sky_view_create(const welkin_sky_tables* tables, double altitude_m,
                                                const welkin_sky_view_options* options, welkin_sky_view** view);

/* Destroys a view. */
WELKIN_API void welkin_sky_view_destroy(welkin_sky_view* view);

/* Radiance that arrives from `count` directions, without the sun's disc: packed x y z and packed r g b, floats. */
WELKIN_API welkin_status welkin_sky_view_radiance(const welkin_sky_view* view, const float* directions, size_t count,
                                                  const double* sun, float* rgb);

/* The sun as a directional light at this height. */
WELKIN_API welkin_status welkin_sky_view_sun(const welkin_sky_view* view, const double* sun, welkin_sun* light);

/* Irradiance of the sky, without direct sun, on a horizontal surface that faces up: r, g, b. */
WELKIN_API welkin_status welkin_sky_view_irradiance(const welkin_sky_view* view, const double* sun, double* irradiance);

/* What pictures show. */
typedef struct welkin_sky_picture_options {
  uint32_t struct_size;
  int32_t sun_disc; /* 1: the sun's disc, as texels that it covers by area */
} welkin_sky_picture_options;

/* Writes a picture of the sky to the target, whose size counts. */
WELKIN_API welkin_status welkin_sky_view_cubemap(const welkin_sky_view* view, const double* sun,
                                                 const welkin_sky_picture_options* options,
                                                 const welkin_control* control, const welkin_cubemap_target* target,
                                                 uint64_t* values_clamped);

/* The same as a lat-long. Its width must be twice its height. */
WELKIN_API welkin_status welkin_sky_view_lat_long(const welkin_sky_view* view, const double* sun,
                                                  const welkin_sky_picture_options* options,
                                                  const welkin_control* control, const welkin_image_target* target,
                                                  uint64_t* values_clamped);

/* A picture of the sky, prefiltered for reflections; `picture` may be null. */
WELKIN_API welkin_status welkin_sky_view_specular(const welkin_sky_view* view, const double* sun,
                                                  const welkin_prefilter_options* options,
                                                  const welkin_sky_picture_options* picture,
                                                  const welkin_control* control, welkin_cubemap_chain** chain);

/* Directions at which a sky is sampled. GAUSS: Gauss nodes on either side of the horizon, even azimuths. GAUSS_SPLIT:
 * azimuths closer together about the sun, and the aerosol's forward lobe integrated in closed form. UNIFORM: even
 * angles. */
typedef int32_t welkin_sky_quadrature;
enum { WELKIN_SKY_QUADRATURE_GAUSS_SPLIT = 0, WELKIN_SKY_QUADRATURE_GAUSS = 1, WELKIN_SKY_QUADRATURE_UNIFORM = 2 };

/* How a sky is projected. */
typedef struct welkin_sky_harmonics_options {
  uint32_t struct_size;
  int32_t bands;                    /* 1 to WELKIN_MAXIMUM_BANDS; 0: 3 */
  welkin_sky_quadrature quadrature; /* where directions are taken */
  int32_t zeniths;                  /* 2 to 128; 0: 16, of a curve 32 */
  int32_t azimuths;                 /* 2 to 256; 0: 16, of a curve 32 */
  int32_t nodes;                    /* sun elevations of a curve, 8 to 4096; 0: 256. Not for a projector */
} welkin_sky_harmonics_options;

/* The harmonics of a view for any sun, by quadrature. */
typedef struct welkin_sky_projector welkin_sky_projector;

/* Prepares what does not depend on the sun. Also WELKIN_LIMIT_EXCEEDED (more than 1 GiB). */
WELKIN_API welkin_status welkin_sky_projector_create(const welkin_sky_view* view,
                                                     const welkin_sky_harmonics_options* options,
                                                     welkin_sky_projector** projector);

/* Destroys a projector. */
WELKIN_API void welkin_sky_projector_destroy(welkin_sky_projector* projector);

/* Radiance of sky and ground, without the sun's disc: `coefficients` gets 3 bands^2 doubles. Allocates nothing. */
WELKIN_API welkin_status welkin_sky_projector_project(const welkin_sky_projector* projector, const double* sun,
                                                      double* coefficients);

/* The harmonics of a view over the sun's elevation, computed once: a moved sun is an interpolation and a turn. */
typedef struct welkin_sky_curve welkin_sky_curve;

/* Makes a curve, in milliseconds. Also WELKIN_LIMIT_EXCEEDED, WELKIN_CANCELLED. */
WELKIN_API welkin_status welkin_sky_curve_create(const welkin_sky_view* view,
                                                 const welkin_sky_harmonics_options* options,
                                                 const welkin_control* control, welkin_sky_curve** curve);

/* Destroys a curve. */
WELKIN_API void welkin_sky_curve_destroy(welkin_sky_curve* curve);

/* As of a projector; under a microsecond for three bands. `sun_irradiance` (may be null) gets r, g, b of the direct sun
 * on a surface that faces it. Allocates nothing. */
WELKIN_API welkin_status welkin_sky_curve_at(const welkin_sky_curve* curve, const double* sun, double* coefficients,
                                             double* sun_irradiance);

/* ---- Worker ---- */

/* Runs jobs on threads of its own, or on the engine's (docs/guides/worker.md). */
typedef struct welkin_worker welkin_worker;

/* A posted job. Handles are counted: a post gives one reference, `welkin_job_release` gives it back. A handle is good
 * for as long as it is held, also when the worker is gone; a job runs to its end whether one is held or not. */
typedef struct welkin_job welkin_job;

/* How the system ranks a worker's threads against all others. */
typedef int32_t welkin_thread_priority;
enum {
  WELKIN_THREAD_PRIORITY_DEFAULT = 0, /* BELOW; it was IDLE in versions 1 and 2 */
  WELKIN_THREAD_PRIORITY_BELOW = 1,   /* a tenth of a normal thread's share */
  WELKIN_THREAD_PRIORITY_NORMAL = 2,
  WELKIN_THREAD_PRIORITY_IDLE = 3 /* runs only on processors that nothing else wants, if there are any */
};

/* A worker's threads and limits. */
typedef struct welkin_worker_options {
  uint32_t struct_size;
  int32_t threads; /* 1 to 1024; 0: one less than the process may use, at least 1. With `enqueue`: how many tasks the
                      engine runs at the same time; 0: as many as the process may use */
  welkin_thread_priority thread_priority; /* of the worker's own threads */
  const char* name;                       /* of the threads; null: "welkin" */

  /* Null, or lends the worker the engine's threads: has `task(argument)` called, soon and exactly once, by a thread of
   * the engine's choice. Called from any thread, several at once. At most `threads` tasks are with the engine at a
   * time. The worker then has no threads of its own. What `enqueue_user` points to must live until the worker is
   * terminated or destroyed; a task that is called later does nothing. One that is never called is lost memory, and
   * until the worker is terminated a job may wait for it. */
  void (*enqueue)(void* enqueue_user, void (*task)(void* argument), void* argument);
  void* enqueue_user; /* what `enqueue` gets as its first argument */

  /* Limits; a job that is posted beyond one ends with WELKIN_QUEUE_FULL. */
  uint64_t max_jobs;  /* in flight; 0: 4096 */
  uint64_t max_bytes; /* in flight, of their pixels; 0: 4 GiB */
} welkin_worker_options;

/* What is in a worker's hands. */
typedef struct welkin_worker_load {
  uint32_t struct_size;
  int32_t threads;                  /* how many jobs it runs at once */
  uint64_t waiting;                 /* computations that no thread has started */
  uint64_t running;                 /* computations */
  uint64_t undrained;               /* callbacks that the next drain would call */
  uint64_t jobs;                    /* in flight, as `max_jobs` counts them */
  uint64_t bytes;                   /* in flight, as `max_bytes` counts them */
  uint64_t oldest_wait_nanoseconds; /* for which the oldest that waits has waited; 0: none waits */
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

/* What the worker has in hand at this moment. */
WELKIN_API welkin_status welkin_worker_get_load(const welkin_worker* worker, welkin_worker_load* load);

/* ---- Posting ---- */

/* Which waiting job starts next: the higher one, and of equals the older one. */
typedef int32_t welkin_priority;
enum { WELKIN_PRIORITY_LOW = -1, WELKIN_PRIORITY_NORMAL = 0, WELKIN_PRIORITY_HIGH = 1 };

/* How a job is posted, and whom its end is told. */
typedef struct welkin_post_options {
  uint32_t struct_size;
  welkin_priority priority; /* among the jobs that wait */
  const char* key; /* latest wins: a job of the same key that waits or runs ends with WELKIN_REPLACED; null: no key */
  uint64_t bytes;  /* that the job counts against `max_bytes`; 0: those of its pixels */

  /* Null, or the pixels (for a function: what it uses) go over to the job: `release(release_user)` is called when this
   * job does not need them any more. Exactly once for each call of a post function, whatever becomes of it:
   * - if the post fails, before it returns;
   * - for a file, whose path is copied, and for a sky, whose atmosphere or tables are kept, before the post returns;
   * - if the job is given up before it runs, before the call that gave it up returns (a cancel, a post at the worker's
   *   limits, a termination); for a post with the same key before that returns, or at once when the thread of the
   * worker goes on that is about to start or to end a job just then;
   * - if it runs, when nothing reads the pixels any more: shortly before or after the job is ready, and before
   *   `welkin_worker_wait_until_idle`, `welkin_worker_terminate` and `welkin_worker_destroy` return, where they wait.
   * On whichever thread that is, so it must not wait for the worker or one of its jobs. There is one exception: if
   * `struct_size` itself is refused (0, not a multiple of 8, far beyond what this library knows), nothing behind it is
   * read, and nothing is called.
   * Null: the pixels stay the caller's, and must stay as they are until the job is ready. */
  void (*release)(void* release_user);
  void* release_user; /* what `release` gets */

  /* Null, or called inside `welkin_worker_drain` once the job is done, well or not. `job` is lent for the call;
   * `welkin_job_retain` keeps it. Called exactly once if the post succeeds and the worker is drained to the end, never
   * if the post fails or the worker is destroyed first; if another thread drains, perhaps before the post returns. It
   * may call any function of this interface. */
  void (*completed)(welkin_job* job, void* completed_user);
  void* completed_user; /* what `completed` gets as its second argument */
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

/* `welkin_prefilter_cubemap`, as a job: `welkin_job_get_chain`. */
WELKIN_API welkin_status welkin_post_prefilter_cubemap(welkin_worker* worker, const welkin_cubemap* cubemap,
                                                       const welkin_prefilter_options* options,
                                                       const welkin_post_options* post, welkin_job** job);

/* `welkin_prefilter_lat_long`, as a job: `welkin_job_get_chain`. */
WELKIN_API welkin_status welkin_post_prefilter_lat_long(welkin_worker* worker, const welkin_lat_long* lat_long,
                                                        const welkin_prefilter_options* options,
                                                        const welkin_post_options* post, welkin_job** job);

/* `welkin_bake_cubemap`, as a job: `welkin_job_get_bake`. */
WELKIN_API welkin_status welkin_post_bake_cubemap(welkin_worker* worker, const welkin_cubemap* cubemap,
                                                  const welkin_bake_options* options, const welkin_post_options* post,
                                                  welkin_job** job);

/* `welkin_bake_lat_long`, as a job: `welkin_job_get_bake`. */
WELKIN_API welkin_status welkin_post_bake_lat_long(welkin_worker* worker, const welkin_lat_long* lat_long,
                                                   const welkin_bake_options* options, const welkin_post_options* post,
                                                   welkin_job** job);

/* Memory of the caller's for the cubemaps of a bake: RGBA_F16 or RGBA_F32, the targets of a part all of one
 * `struct_size`. A part without targets stays in the result. */
typedef struct welkin_bake_targets {
  uint32_t struct_size;
  const welkin_cubemap_target* background; /* one per level */
  int64_t background_count;                /* targets; 0: none */
  const welkin_cubemap_target* specular;   /* one per mip */
  int64_t specular_count;                  /* targets; 0: none */
  const welkin_cubemap_target* irradiance; /* one; null: none */
} welkin_bake_targets;

/* Posts a bake whose cubemaps the worker's threads write to the caller's memory: `welkin_job_get_bake` for the rest.
 * `targets` is copied. The memory must stay until the job is ready; `release` is called when nothing reads the pixels
 * or writes to the targets any more. A job that succeeds has written every texel; one that never started, or whose
 * targets do not fit (WELKIN_INVALID_ARGUMENT, by the job), none; any other job that fails, any part of them. Running
 * jobs must not share targets: a replaced job writes until it is ready. */
WELKIN_API welkin_status welkin_post_bake_cubemap_to(welkin_worker* worker, const welkin_cubemap* cubemap,
                                                     const welkin_bake_options* options,
                                                     const welkin_bake_targets* targets,
                                                     const welkin_post_options* post, welkin_job** job);

/* Posts the same of a lat-long. */
WELKIN_API welkin_status welkin_post_bake_lat_long_to(welkin_worker* worker, const welkin_lat_long* lat_long,
                                                      const welkin_bake_options* options,
                                                      const welkin_bake_targets* targets,
                                                      const welkin_post_options* post, welkin_job** job);

/* `welkin_sky_tables_create`, as a job: `welkin_job_get_sky_tables`. */
WELKIN_API welkin_status welkin_post_sky_tables(welkin_worker* worker, const welkin_atmosphere* atmosphere,
                                                const welkin_sky_table_options* options,
                                                const welkin_post_options* post, welkin_job** job);

/* The curve of a height, as a job: `welkin_job_get_sky_curve`. */
WELKIN_API welkin_status welkin_post_sky_curve(welkin_worker* worker, const welkin_sky_tables* tables,
                                               double altitude_m, const welkin_sky_harmonics_options* options,
                                               const welkin_post_options* post, welkin_job** job);

/* The reflections of a sky at a height, without the sun's disc, as a job: `welkin_job_get_chain`. */
WELKIN_API welkin_status welkin_post_sky_specular(welkin_worker* worker, const welkin_sky_tables* tables,
                                                  double altitude_m, const double* sun,
                                                  const welkin_prefilter_options* options,
                                                  const welkin_post_options* post, welkin_job** job);

/* A function of the caller's own, called as `run(run_user, control)` on one of the worker's threads, once or, if the
 * job is given up first, not at all. What it returns becomes the job's status: any value but WELKIN_NOT_READY, numbers
 * of your own too (from 1000 on they will never mean anything else). If it returns what a call in it failed with, the
 * job has that call's message. It should look at `welkin_control_stop_requested` every millisecond or so.
 * It must return: if it calls `pthread_exit`, its thread goes on and the job ends with WELKIN_INTERNAL. */
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
 * worker's own threads and with WELKIN_NO_LIMIT it starts a job that still waits itself. A request must not wait for
 * itself, directly or through other jobs: that wait never ends. */
WELKIN_API welkin_status welkin_job_wait(const welkin_job* job, uint64_t timeout_nanoseconds);

/* Copies the result, any number of times; never waits. What `welkin_job_poll` returns, and WELKIN_INVALID_ARGUMENT if
 * the job makes something else or `projection` has no room for its bands. */
WELKIN_API welkin_status welkin_job_projection(const welkin_job* job, welkin_projection* projection);

/* The result of a prefilter as a handle, which the caller destroys. It can be asked for any number of times: all
 * handles share it. Never waits. What `welkin_job_poll` returns, and WELKIN_INVALID_ARGUMENT if the job makes something
 * else. */
WELKIN_API welkin_status welkin_job_get_chain(const welkin_job* job, welkin_cubemap_chain** chain);

/* The same of a bake. */
WELKIN_API welkin_status welkin_job_get_bake(const welkin_job* job, welkin_bake_result** result);

/* The same of a sky's tables. */
WELKIN_API welkin_status welkin_job_get_sky_tables(const welkin_job* job, welkin_sky_tables** tables);

/* The same of a sky's curve. */
WELKIN_API welkin_status welkin_job_get_sky_curve(const welkin_job* job, welkin_sky_curve** curve);

/* Gives the job up: it ends with WELKIN_CANCELLED, at once if it waits, else before its next tile (a function: when it
 * returns). `given_up` (may be null) gets 1 if this call did it, 0 if the job was done or given up before. */
WELKIN_API welkin_status welkin_job_cancel(welkin_job* job, int32_t* given_up);

/* The job's priority. */
WELKIN_API welkin_status welkin_job_get_priority(const welkin_job* job, welkin_priority* priority);

/* Moves a waiting job to the end of those of that priority. */
WELKIN_API welkin_status welkin_job_set_priority(welkin_job* job, welkin_priority priority);

/* Takes one more reference, to be given back. Null does nothing. */
WELKIN_API void welkin_job_retain(welkin_job* job);

/* Gives a reference back. The handle goes with the last one, the job runs to its end. Null does nothing. */
WELKIN_API void welkin_job_release(welkin_job* job);

/* ---- The dynamic sky of an engine's loop ---- */

/* Set the sun, get the light, every frame. It posts to a worker, which must outlive it: a new atmosphere makes tables,
 * a curve and reflections, a new altitude the last two, a new elevation of the sun reflections. Turning the sun about
 * the vertical posts nothing. For one thread at a time. */
typedef struct welkin_sky_light welkin_sky_light;

/* What a dynamic sky computes, and from which change on. */
typedef struct welkin_sky_light_options {
  uint32_t struct_size;
  welkin_priority priority;                  /* of what is posted */
  const welkin_sky_table_options* tables;    /* not read where tables are given */
  const welkin_sky_harmonics_options* curve; /* with the number of bands */
  const welkin_prefilter_options* specular;  /* of the reflections; null: the defaults */
  int32_t without_specular;                  /* 1: no reflections */
  double altitude_m;                         /* the observer's, above the ground */
  double sun_threshold_degrees;              /* the sun stays until it is to move by this; 0: 0.01; negative: none */
  double specular_threshold_degrees;         /* of elevation, between new reflections; 0: 0.5; negative: none */
  double altitude_threshold_m;               /* 0: 1; negative: none */
  double blend_seconds;                      /* from old light to new; 0: 0.5; negative: at once */
} welkin_sky_light_options;

/* A prefiltered sky, and how it is to be used now. */
typedef struct welkin_sky_reflections {
  const welkin_cubemap_chain* chain; /* lent until the next update; null: none yet */
  uint64_t id;    /* rises with each new chain: what has the same one need not be uploaded again; 0: none */
  double weight;  /* of its light */
  double turn[9]; /* what came from direction d comes from turn * d */
} welkin_sky_reflections;

/* The light of a frame. */
typedef struct welkin_sky_frame {
  uint32_t struct_size;
  int32_t ready;                         /* 0 until the first curve has come: all is black */
  int32_t settled;                       /* 1: nothing is being made or blended */
  int32_t bands;                         /* how many of them `coefficients` holds */
  double sun_direction[3];               /* unit, towards it */
  double sun_irradiance[3];              /* on a surface that faces it, intensity included */
  double sun_solid_angle;                /* steradians */
  welkin_sky_reflections reflections[2]; /* newer and older; both weights add up to the intensity */

  /* Radiance of sky and ground, intensity included, without the sun's disc: as in `welkin_projection`, and likewise
   * `struct_size` may end inside. */
  double coefficients[3 * WELKIN_MAXIMUM_BANDS * WELKIN_MAXIMUM_BANDS];
} welkin_sky_frame;

/* Counts of work that was done and that was spared. */
typedef struct welkin_sky_light_counters {
  uint32_t struct_size;
  uint64_t frames;          /* calls of `welkin_sky_light_update` */
  uint64_t lights;          /* of them those that computed coefficients */
  uint64_t moves_ignored;   /* of sun or altitude, below their thresholds */
  uint64_t turns;           /* moves of the azimuth alone */
  uint64_t elevations;      /* moves of the elevation */
  uint64_t intensities;     /* changes of the intensity */
  uint64_t specular_spared; /* moves of the elevation that asked for no reflections */
  uint64_t posts;           /* requests given to the worker */
  uint64_t tables_baked;    /* tables, curves and reflections that were made */
  uint64_t curves_baked;    /* curves that were made */
  uint64_t speculars_baked; /* chains of reflections that were made */
  uint64_t given_up;        /* bakes that were stopped because something newer overtook them */
  uint64_t failures;        /* bakes that ended with an error */
} welkin_sky_light_counters;

/* Asks the worker for the first tables; the sun stands in the zenith. */
WELKIN_API welkin_status welkin_sky_light_create(welkin_worker* worker, const welkin_atmosphere* atmosphere,
                                                 const welkin_sky_light_options* options, welkin_sky_light** light);

/* The same with tables that are there, whose options count. */
WELKIN_API welkin_status welkin_sky_light_create_with_tables(welkin_worker* worker, const welkin_sky_tables* tables,
                                                             const welkin_sky_light_options* options,
                                                             welkin_sky_light** light);

/* Stops what is being made; does not wait. */
WELKIN_API void welkin_sky_light_destroy(welkin_sky_light* light);

/* `sun`: three doubles towards it. This and the next three look, compare, and post a request only if
 * there is something to make. */
WELKIN_API welkin_status welkin_sky_light_set_sun(welkin_sky_light* light, const double* sun);

/* A factor of all light, 0 to 1e12. */
WELKIN_API welkin_status welkin_sky_light_set_intensity(welkin_sky_light* light, double intensity);

/* Moves the observer, in metres above the ground: curve and reflections are made anew. */
WELKIN_API welkin_status welkin_sky_light_set_altitude(welkin_sky_light* light, double altitude_m);

/* Another planet: tables, curve and reflections are made anew. The atmosphere is copied. */
WELKIN_API welkin_status welkin_sky_light_set_atmosphere(welkin_sky_light* light, const welkin_atmosphere* atmosphere);

/* Takes what has come, goes on with what is being blended, and writes the light. Never waits; allocates only when new
 * reflections have come. `seconds`: since the last update. */
WELKIN_API welkin_status welkin_sky_light_update(welkin_sky_light* light, double seconds, welkin_sky_frame* frame);

/* How much work was done so far. */
WELKIN_API welkin_status welkin_sky_light_get_counters(const welkin_sky_light* light,
                                                       welkin_sky_light_counters* counters);

/* WELKIN_OK, or what the last bake that failed ended with, whose message is in `welkin_last_error`; the light is then
 * what it was before, and the next change asks again. */
WELKIN_API welkin_status welkin_sky_light_get_status(const welkin_sky_light* light);

/* ---- Files ----
 * Like `welkin_project_file` these are not in welkin-core, the library without files. A file that is written is
 * complete or not there. Also WELKIN_FILE_ACCESS, WELKIN_CORRUPT_FILE, WELKIN_UNSUPPORTED_FILE, WELKIN_LIMIT_EXCEEDED.
 */

/* Reads and bakes a file. */
WELKIN_API welkin_status welkin_bake_file(const char* path, const welkin_read_options* read_options,
                                          const welkin_bake_options* options, const welkin_control* control,
                                          welkin_bake_result** result);

/* `welkin_bake_file`, as a job: `welkin_job_get_bake`. The path is copied. */
WELKIN_API welkin_status welkin_post_bake_file(welkin_worker* worker, const char* path,
                                               const welkin_read_options* read_options,
                                               const welkin_bake_options* options, const welkin_post_options* post,
                                               welkin_job** job);

/* How texels are stored. Values that a format cannot hold are clamped and counted; NaN becomes 0, but in RGBA32F. */
typedef int32_t welkin_texel_format;
enum {
  WELKIN_TEXEL_RGBA16F = 0, /* -65504 to 65504 */
  WELKIN_TEXEL_RGBA32F = 1,
  WELKIN_TEXEL_B10G11R11 = 2, /* 0 to 64512, 1 part in 32; not in OpenEXR */
  WELKIN_TEXEL_E5B9G9R9 = 3,  /* 0 to 65408, 1 part in 512 of the largest channel; not in OpenEXR */
  /* Blocks, for radiance. */
  WELKIN_TEXEL_BC6H_UFLOAT = 4,  /* KTX2, DDS */
  WELKIN_TEXEL_BC6H_SFLOAT = 5,  /* likewise, with negatives */
  WELKIN_TEXEL_ASTC_4X4_HDR = 6, /* KTX2; WELKIN_UNSUPPORTED_FILE in a build without astcenc */
  WELKIN_TEXEL_ASTC_6X6_HDR = 7  /* likewise */
};

/* How long is searched for a block's best numbers; docs/notes/textures.md has errors and times. */
typedef int32_t welkin_bc6h_effort;
enum {
  WELKIN_BC6H_DEFAULT = 0, /* normal */
  WELKIN_BC6H_FAST = 1,
  WELKIN_BC6H_NORMAL = 2,
  WELKIN_BC6H_SLOW = 3
};
/* The same of ASTC. */
typedef int32_t welkin_astc_effort;
enum {
  WELKIN_ASTC_DEFAULT = 0, /* medium */
  WELKIN_ASTC_FASTEST = 1,
  WELKIN_ASTC_FAST = 2,
  WELKIN_ASTC_MEDIUM = 3,
  WELKIN_ASTC_THOROUGH = 4
};

/* How KTX2's levels are packed. */
typedef int32_t welkin_supercompression;
enum { WELKIN_SUPERCOMPRESSION_NONE = 0, WELKIN_SUPERCOMPRESSION_ZLIB = 1, WELKIN_SUPERCOMPRESSION_ZSTD = 2 };

/* How texels are stored in a file. */
typedef struct welkin_texture_options {
  uint32_t struct_size;
  welkin_texel_format format;               /* of all texels */
  welkin_supercompression supercompression; /* KTX2 only */
  welkin_bc6h_effort bc6h_effort;           /* with the BC6H formats */
  welkin_astc_effort astc_effort;           /* with the ASTC formats */
} welkin_texture_options;

/* Writes a cubemap with its mips in the format that the extension names: .ktx2, .ktx, .dds or .exr. `mips` is as
 * of `welkin_project_cubemap`; `values_clamped` (may be null) gets how many values the format could not hold. */
WELKIN_API welkin_status welkin_write_texture(const char* path, const welkin_cubemap* mips, int32_t mip_count,
                                              const welkin_texture_options* options, const welkin_control* control,
                                              uint64_t* values_clamped);

/* The same of a whole chain. A prefiltered one's roughness goes into KTX2's and OpenEXR's metadata, where this library
 * finds it again. */
WELKIN_API welkin_status welkin_write_chain(const char* path, const welkin_cubemap_chain* chain,
                                            const welkin_texture_options* options, const welkin_control* control,
                                            uint64_t* values_clamped);

/* Writes a picture, a BRDF table for instance, as a texture of one level: .ktx2 or .dds. `rgb` is height x width x 3
 * floats, first row on top. */
WELKIN_API welkin_status welkin_write_flat_texture(const char* path, int32_t width, int32_t height, const float* rgb,
                                                   const welkin_texture_options* options, const welkin_control* control,
                                                   uint64_t* values_clamped);

/* Writes Babylon.js's .env: a chain prefiltered with WELKIN_ROUGHNESS_BABYLON down to 1 texel, whose size is a power of
 * two, and the polynomial of the light. Both are in Welkin's axes, and turned to Babylon.js's. */
WELKIN_API welkin_status welkin_write_babylon_environment(const char* path, const welkin_cubemap_chain* specular,
                                                          int32_t bands, const double* radiance,
                                                          const welkin_control* control, uint64_t* values_clamped);

/* Saves a sky's tables with all their parameters; loaded again they are the same bits. */
WELKIN_API welkin_status welkin_sky_tables_save(const welkin_sky_tables* tables, const char* path);

/* Loads tables that were saved. `memory_limit_bytes` 0: 4 GiB. */
WELKIN_API welkin_status welkin_sky_tables_load(const char* path, uint64_t memory_limit_bytes,
                                                welkin_sky_tables** tables);

#ifdef __cplusplus
}
#endif

#endif
/* NOLINTEND(modernize-*) */
