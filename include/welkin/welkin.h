/* Welkin for engines in other languages: image-based lighting through C99.
 *
 *   welkin_environment cubemap = {.struct_size = sizeof cubemap, .size = 1024, .format = WELKIN_FORMAT_RGBA_F16,
 *                                 .faces = {px, nx, py, ny, pz, nz}};
 *   welkin_projection light = {.struct_size = sizeof light};
 *   if (welkin_project(&cubemap, 1, NULL, NULL, &light) != WELKIN_OK) puts(welkin_last_error());
 *
 * Results are the bits of the C++ calls: the same on any number of threads, instruction set and platform.
 *
 * Structures. Each begins with `struct_size`, its `sizeof` in the caller's program. In structures that are read, zero
 * in any other field means the default, and a null pointer to options means all defaults. A structure that is shorter
 * than the library's lacks its last fields, which count as zero. In one that is longer, what the library does not know
 * must be zero. Structures that are written are filled as far as `struct_size` says, unknown fields with zeros.
 *
 * Errors. Calls that can fail return a `welkin_status`. No exception leaves a call, and none may leave a callback. A
 * call that fails writes no result, and sets a handle that it would have made to null. Null pointers, and sizes and
 * enumeration values that are out of range, give WELKIN_INVALID_ARGUMENT. Calls that compute can also return
 * WELKIN_REJECTED_PIXEL, WELKIN_LIMIT_EXCEEDED, WELKIN_CANCELLED and WELKIN_OUT_OF_MEMORY.
 *
 * Handles belong to the caller. Each kind has a function that destroys it, for which null does nothing. Other functions
 * refuse a null handle. Handles to results are immutable, and any number of threads may read one. What a handle was
 * made from may be destroyed before it.
 *
 * Threads. All functions may be called from any thread. Functions that compute use the oneTBB arena of the calling
 * thread. `control` may be null; inside a function that a worker runs, pass the one that it was given.
 *
 * Numbers. Strings are UTF-8 and are copied. A direction is three doubles x, y, z, y up, of any length above 0;
 * returned ones have length 1. A colour is r, g, b. A 3 x 3 matrix is nine doubles, column after column. Harmonics are
 * real, orthonormal, without Condon-Shortley phase, Y(1, -1..1) ~ y, z, x: 3 bands^2 doubles, r, g, b of coefficient
 * (l, m) from 3 (l (l + 1) + m) on. docs/guides/c.md has examples.
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

/* The version of this interface. A program runs with a library whose `welkin_c_version()` is not below its own
 * WELKIN_C_VERSION, if both are 5 or more. Version 5 took functions and fields away. */
#define WELKIN_C_VERSION 5

/* Returns the library's own WELKIN_C_VERSION. */
WELKIN_API uint32_t welkin_c_version(void);

/* Makes `object`, a structure of this header, all defaults: WELKIN_INIT(options); */
#define WELKIN_INIT(object) \
  ((void)memset(&(object), 0, sizeof(object)), (void)((object).struct_size = (uint32_t)sizeof(object)))

/* ---- Handles ---- */

/* A cubemap of RGB floats with its levels, level l with max(1, size >> l) texels along an edge. */
typedef struct welkin_chain welkin_chain;
/* What a bake made. */
typedef struct welkin_bake_result welkin_bake_result;
/* All that a planet's sky can look like: precomputed scattering. */
typedef struct welkin_sky_tables welkin_sky_tables;
/* The sky as it is seen from one height. */
typedef struct welkin_sky_view welkin_sky_view;
/* The harmonics of a view over the sun's elevation, computed once: a moved sun is an interpolation and a turn. */
typedef struct welkin_sky_curve welkin_sky_curve;
/* The dynamic sky of an engine's loop: set the sun, get the light, every frame. For one thread at a time. */
typedef struct welkin_sky_light welkin_sky_light;
/* Runs jobs on threads of its own, or on the engine's (docs/guides/worker.md). */
typedef struct welkin_worker welkin_worker;
/* A posted job. Handles are counted: a post gives one reference, `welkin_job_release` gives it back. A handle is valid
 * for as long as it is held, also when the worker is gone; a job runs to its end whether one is held or not. */
typedef struct welkin_job welkin_job;
/* Given by a worker to a caller's function (`welkin_post_function`): steers the job, until that function returns. */
typedef struct welkin_control welkin_control;

/* Destroy a handle, without waiting. What handles share goes with the last of them. */
WELKIN_API void welkin_chain_destroy(welkin_chain* chain);
WELKIN_API void welkin_bake_result_destroy(welkin_bake_result* result); /* of a bake */
WELKIN_API void welkin_sky_tables_destroy(welkin_sky_tables* tables);   /* of tables */
WELKIN_API void welkin_sky_view_destroy(welkin_sky_view* view);         /* of a view */
WELKIN_API void welkin_sky_curve_destroy(welkin_sky_curve* curve);      /* of a curve */
WELKIN_API void welkin_sky_light_destroy(welkin_sky_light* light);      /* of a dynamic sky */

/* ---- Status ---- */

/* Later versions may know more values: take what you do not know for an error. */
typedef int32_t welkin_status;
enum {
  WELKIN_OK = 0,
  WELKIN_INVALID_ARGUMENT = 1, /* that no call could accept (a null face, 17 bands) */
  WELKIN_REJECTED_PIXEL = 2,   /* a texel that the options reject; the message names face, row and column */
  WELKIN_FILE_ACCESS = 3,      /* a file that cannot be opened, read or written */
  WELKIN_CORRUPT_FILE = 4,     /* a file that breaks its own format, or ends too early */
  WELKIN_UNSUPPORTED_FILE = 5, /* a sound file of a kind that Welkin does not read, or whose layout is unclear */
  WELKIN_LIMIT_EXCEEDED = 6,   /* would need more memory than the stated limit, or a bound that no method reaches */
  WELKIN_CANCELLED = 7,        /* the caller asked for it */
  WELKIN_REPLACED = 8,         /* a newer request with the same key took this job's place */
  WELKIN_QUEUE_FULL = 9,       /* a worker at its limits refused this job */
  WELKIN_STOPPED = 10,         /* the worker was terminated before this job was done */
  WELKIN_OUT_OF_MEMORY = 100,
  WELKIN_NOT_READY = 101, /* the job is not done yet; no error, and no message */
  WELKIN_INTERNAL = 102   /* anything else: no thread could be made, an exception left a callback, ... */
};

/* Returns "ok", "invalid_argument", ...; "unknown" for other values. Never null. */
WELKIN_API const char* welkin_status_name(welkin_status status);

/* Returns the message of the latest error on this thread: where, what was found, what to do. Empty if there was none,
 * never null. Valid until the next error on this thread. */
WELKIN_API const char* welkin_last_error(void);

/* Sets how many bytes of unused blocks the process keeps for later calls (128 MiB by default), and frees the rest. */
WELKIN_API void welkin_keep_working_memory(uint64_t bytes);

/* Frees all blocks that no call uses. */
WELKIN_API void welkin_release_working_memory(void);

/* ---- Environments ---- */

/* How a texel lies in memory: interleaved channels without padding. Alpha is never read, and 1 where it is written.
 * F16 is IEEE 754 binary16. U8 maps 0..255 to 0..1; SRGB8 then applies the sRGB transfer function. RG is
 * written only: the first two channels. */
typedef int32_t welkin_format; /* clang-format off */
enum { WELKIN_FORMAT_RGB_F32 = 0, WELKIN_FORMAT_RGBA_F32 = 1, WELKIN_FORMAT_RGB_F16 = 2, WELKIN_FORMAT_RGBA_F16 = 3,
       WELKIN_FORMAT_RGB_U8 = 4, WELKIN_FORMAT_RGBA_U8 = 5, WELKIN_FORMAT_RGB_SRGB8 = 6, WELKIN_FORMAT_RGBA_SRGB8 = 7,
       WELKIN_FORMAT_RG_F32 = 8, WELKIN_FORMAT_RG_F16 = 9 }; /* clang-format on */

/* The caller's pixels, read in place: a cubemap or a lat-long.
 * Cubemap: six square faces +X -X +Y -Y +Z -Z, row 0 on top. Their columns and rows run along -z -y, +z -y, +x +z,
 * +x -z, +x -y and -x -y.
 * Lat-long: a sphere as latitude over longitude, +z in the centre, +x a quarter in from the left, y up. */
typedef struct welkin_environment {
  uint32_t struct_size;
  welkin_format format;     /* of all pixels */
  int64_t row_stride_bytes; /* from a row to the next; 0: rows are packed; negative: bottom-up */
  const void* faces[6];     /* first texel of each face, aligned to its channels; of a lat-long faces[0] alone */
  int64_t size;             /* texels along an edge of a cubemap, 1 to 16384; 0: it is a lat-long */
  int32_t width;            /* of a lat-long, 1 to 65536 texels; else 0 */
  int32_t height;           /* of a lat-long, 1 to 32768 texels; else 0 */
} welkin_environment;

/* How a picture file holds a sphere, with faces of N x N texels. */
typedef int32_t welkin_layout;
enum {
  WELKIN_LAYOUT_AUTOMATIC = 0, /* by the file's header, its shape or its name */
  WELKIN_LAYOUT_LAT_LONG = 1,
  WELKIN_LAYOUT_VERTICAL_STRIP = 2,   /* N x 6N: +X -X +Y -Y +Z -Z from top to bottom */
  WELKIN_LAYOUT_HORIZONTAL_STRIP = 3, /* 6N x N: the same from left to right */
  WELKIN_LAYOUT_HORIZONTAL_CROSS = 4, /* 4N x 3N: -X +Z +X -Z in the middle row, +Y above +Z, -Y below it */
  WELKIN_LAYOUT_VERTICAL_CROSS = 5,   /* 3N x 4N: +Y; -X +Z +X; -Y; and -Z below that, turned by half a turn */
  WELKIN_LAYOUT_SIX_FILES = 6         /* one picture per face, told apart by the ends of their names */
};

/* What the numbers in a PNG mean. AUTOMATIC: sRGB, but linear where the file says that its gamma is 1. */
typedef int32_t welkin_transfer;
enum { WELKIN_TRANSFER_AUTOMATIC = 0, WELKIN_TRANSFER_SRGB = 1, WELKIN_TRANSFER_LINEAR = 2 };

/* How a file is read. A part, layer, level or element that the file does not have gives WELKIN_UNSUPPORTED_FILE. */
typedef struct welkin_read_options {
  uint32_t struct_size;
  welkin_layout layout; /* how the picture holds the sphere */
  const char* part;     /* of a multi-part OpenEXR file: its name, or its number from 0; null: the first with colour */
  const char* layer;    /* of an OpenEXR file with layers; null: the channels without one, else the only one */
  welkin_transfer transfer;    /* what the numbers of a PNG mean */
  int32_t primaries_as_stored; /* 1: the file's numbers; 0: Rec. 709, converted where the file states others */
  uint64_t memory_limit_bytes; /* the most that pixels may take; 0: 8 GiB */
  int64_t level;               /* of a file with a mip chain; 0 is the full size */
  int64_t element;             /* of an array of cubemaps or pictures (KTX2, KTX, DDS), from 0 */
} welkin_read_options;

/* ---- Projection to spherical harmonics ---- */

/* The largest number of bands. */
#define WELKIN_MAXIMUM_BANDS 16

/* Of finite values below zero. REPLACE: by 0. REJECT: WELKIN_REJECTED_PIXEL. */
typedef int32_t welkin_negative_policy;
enum { WELKIN_NEGATIVE_KEEP = 0, WELKIN_NEGATIVE_REPLACE = 1, WELKIN_NEGATIVE_REJECT = 2 };

/* What becomes of pixel values before they count as radiance. */
typedef struct welkin_pixel_policy {
  uint32_t struct_size;
  float clamp_maximum;             /* upper bound on radiance, above 0; 0: none */
  int32_t clamp_preserve_colour;   /* 1: r, g and b are scaled together; 0: each is clamped to [0, maximum] */
  int32_t gamma;                   /* 1: channels are clamped to [0, 1] and raised to 2.2 (Babylon.js's gammaSpace) */
  int32_t reject_nan;              /* 1: a NaN gives WELKIN_REJECTED_PIXEL; 0: it counts as 0 */
  int32_t reject_infinity;         /* 1: likewise; 0: +infinity counts as clamp_maximum or 65504, -infinity as 0 */
  welkin_negative_policy negative; /* of finite values below zero */
} welkin_pixel_policy;

/* How an environment is projected. */
typedef struct welkin_projection_options {
  uint32_t struct_size;
  int32_t bands;       /* 1 to WELKIN_MAXIMUM_BANDS; 0: 3 */
  int32_t midpoint;    /* 1: a texel counts at its centre, as in Babylon.js; 0: as its area, without error */
  int32_t target_size; /* edge of the cube face to which the picture is reduced first; 0: it is not */
  const welkin_pixel_policy* pixels; /* null: the defaults */
} welkin_projection_options;

/* The light of an environment, in memory of the caller's. A `struct_size` that ends inside `coefficients` is accepted
 * if it has room for the bands. */
typedef struct welkin_projection {
  uint32_t struct_size;
  int32_t bands;                         /* of `coefficients` */
  uint64_t texels;                       /* read and projected */
  uint64_t nans_replaced;                /* channel values */
  uint64_t infinities_replaced;          /* channel values */
  uint64_t negatives_replaced;           /* channel values */
  uint64_t texels_clamped;               /* texels that the clamp changed */
  double total_radiance_before_clamp[3]; /* integral of radiance over the sphere, before the clamp */
  double total_radiance[3];              /* the same as it was projected */
  double error_estimate;                 /* estimated relative error of the coefficients */
  double coefficients[3 * WELKIN_MAXIMUM_BANDS * WELKIN_MAXIMUM_BANDS]; /* of radiance; zeros behind */
} welkin_projection;

/* Projects an environment. `mips` is the full size, followed by `mip_count - 1` levels of a cubemap (15 at most in
 * all), each half the one before, all of one format and one `struct_size`. Only `target_size` uses the levels. */
WELKIN_API welkin_status welkin_project(const welkin_environment* mips, int32_t mip_count,
                                        const welkin_projection_options* options, const welkin_control* control,
                                        welkin_projection* projection);

/* Projects `probe_count` cubemaps of any sizes and formats, all of one `struct_size`. `coefficients` gets 3 bands^2
 * doubles per probe. `totals` (may be null) gets sums over all probes, the largest error estimate, and no bands. Errors
 * name the number of the probe. Small probes allocate nothing. */
WELKIN_API welkin_status welkin_project_many(const welkin_environment* probes, int64_t probe_count,
                                             const welkin_projection_options* options, const welkin_control* control,
                                             double* coefficients, welkin_projection* totals);

/* Projects a file. A lat-long is projected while it is decoded. */
WELKIN_API welkin_status welkin_project_file(const char* path, const welkin_read_options* read_options,
                                             const welkin_projection_options* options, const welkin_control* control,
                                             welkin_projection* projection);

/* ---- Harmonics: 3 bands^2 doubles each. A result may overwrite its argument. ---- */

/* Multiplies band l of radiance by pi, 2 pi/3, pi/4, 0, -pi/24, ...: irradiance. */
WELKIN_API welkin_status welkin_irradiance_from_radiance(int32_t bands, const double* radiance, double* irradiance);

/* Evaluates coefficients at a direction: `value` gets r, g, b. */
WELKIN_API welkin_status welkin_evaluate(int32_t bands, const double* coefficients, const double* direction,
                                         double* value);

/* Turns light by an orthogonal matrix, mirrors included: what came from direction d comes from matrix * d.
 * WELKIN_INVALID_ARGUMENT if it is off orthogonal by more than 1e-6. */
WELKIN_API welkin_status welkin_turn(int32_t bands, const double* coefficients, const double* matrix, double* turned);

/* Windows against ringing. With w = pi l / width, band l is multiplied by (1 + cos w) / 2 (HANNING) or sin(w) / w
 * (LANCZOS), 0 from l = width on, or by 1 / (1 + c l^2 (l + 1)^2) with the smallest c that leaves no irradiance
 * negative. */
typedef int32_t welkin_window;
enum { WELKIN_WINDOW_NONE = 0, WELKIN_WINDOW_HANNING = 1, WELKIN_WINDOW_LANCZOS = 2, WELKIN_WINDOW_MIN_LAPLACIAN = 3 };

/* Multiplies each band of radiance by the window's factor. `width` is in bands, of Hanning and Lanczos only; 0: the
 * number of bands. */
WELKIN_API welkin_status welkin_apply_window(int32_t bands, const double* radiance, welkin_window window, double width,
                                             double* windowed);

/* Computes the factor that takes the mean radiance to middle grey, luminance 0.18; 1 if the mean is not above 0. */
WELKIN_API welkin_status welkin_exposure_of(int32_t bands, const double* radiance, double* exposure);

/* Finds the directional light that comes closest to an environment: `direction` towards it, `irradiance` on a surface
 * that faces it, and 1 in `found`; zeros if the light comes from no direction. */
WELKIN_API welkin_status welkin_dominant_light(int32_t bands, const double* radiance, double* direction,
                                               double* irradiance, int32_t* found);

/* Computes the radiance of a sun as harmonics, to be added to those of its sky: a disc of `solid_angle` steradians that
 * holds the irradiance; with 0 a light from one direction. */
WELKIN_API welkin_status welkin_sun_harmonics(const double* direction, const double* irradiance, double solid_angle,
                                              int32_t bands, double* coefficients);

/* ---- Engines ---- */

/* The engines and formats whose conventions are known. */
typedef int32_t welkin_engine; /* clang-format off */
enum { WELKIN_ENGINE_WELKIN = 0, WELKIN_ENGINE_OPENEXR = 1, WELKIN_ENGINE_BABYLON = 2, WELKIN_ENGINE_THREE = 3,
       WELKIN_ENGINE_FILAMENT = 4, WELKIN_ENGINE_GLTF = 5, WELKIN_ENGINE_UNITY = 6, WELKIN_ENGINE_UNREAL = 7,
       WELKIN_ENGINE_BLENDER = 8, WELKIN_ENGINE_GODOT = 9, WELKIN_ENGINE_BEVY = 10, WELKIN_ENGINE_USD = 11 };
/* clang-format on */

/* Gets an engine's axes as matrices: one takes a direction in Welkin's axes to the engine's (a mirror for left-handed
 * engines), the other a direction in the engine's axes to the frames of a `welkin_environment`'s faces; zeros for
 * engines without cubemaps of their own. docs/reference/engines.md has all conventions in words. */
WELKIN_API welkin_status welkin_get_axes(welkin_engine engine, double* from_welkin, double* faces_from_engine);

/* Light in an engine's own form; docs/reference/engines.md has the formulas. */
typedef struct welkin_engine_light {
  uint32_t struct_size;
  welkin_engine engine; /* whose form it is */
  int32_t term_count;   /* 9 */
  int32_t vector_count; /* 7 for Unity and Unreal, else 0 */
  double terms[9][3];   /* Babylon.js (SphericalPolynomial): x y z xx yy zz yz zx xy; else coefficient l (l + 1) + m */
  double vectors[7][4]; /* as shaders read them: SHAr SHAg SHAb SHBr SHBg SHBb SHC */
} welkin_engine_light;

/* Converts radiance to an engine's form. It is turned from Welkin's axes to the engine's, unless `in_place` is 1. Bands
 * above the third are left out. WELKIN_INVALID_ARGUMENT for OpenEXR, Blender, Bevy and OpenUSD, which have no form. */
WELKIN_API welkin_status welkin_engine_light_from_radiance(int32_t bands, const double* radiance, welkin_engine engine,
                                                           int32_t in_place, welkin_engine_light* light);

/* ---- Results in the caller's memory ---- */

/* Memory for a picture: for one level of a cubemap, or for a flat picture. It may be an upload buffer, since each texel
 * is written once and none is read. Formats: RG, RGB and RGBA, F32 and F16; bakes write RGBA alone. Halves are rounded
 * to nearest; what is beyond the largest half (65504) becomes that, and NaN 0. Calls that take a target also take
 * `values_clamped` (may be null), which gets the number of such values. Targets are checked before any work is done. */
typedef struct welkin_target {
  uint32_t struct_size;
  welkin_format format;     /* of all texels */
  int64_t row_stride_bytes; /* from a row to the next, at least a row; 0: rows are packed; negative: bottom-up */
  void* faces[6];           /* first texel of the top row of each, aligned to its channels; flat: faces[0] alone */
  int64_t size;             /* texels along an edge of a cubemap; 0: a flat picture */
  int32_t width;            /* texels of a flat picture; else 0 */
  int32_t height;           /* texels of a flat picture; else 0 */
} welkin_target;

/* What a chain holds. */
typedef struct welkin_chain_info {
  uint32_t struct_size;
  int32_t size;        /* texels along an edge of level 0 */
  int32_t levels;      /* how many there are */
  int32_t prefiltered; /* 1: each level has a roughness, see `welkin_chain_get_mip` */
} welkin_chain_info;

/* Makes another handle to the same pixels. */
WELKIN_API welkin_status welkin_chain_share(const welkin_chain* chain, welkin_chain** another);

/* Gets the sizes of a chain. */
WELKIN_API welkin_status welkin_chain_get_info(const welkin_chain* chain, welkin_chain_info* info);

/* Gets the pixels of a level in place: packed RGB_F32, valid for as long as the chain is held. */
WELKIN_API welkin_status welkin_chain_get_level(const welkin_chain* chain, int32_t level, welkin_environment* pixels);

/* Writes a level to the caller's memory, on the calling thread. */
WELKIN_API welkin_status welkin_chain_copy(const welkin_chain* chain, int32_t level, const welkin_target* target,
                                           uint64_t* values_clamped);

/* ---- Reflections ---- */

/* How a mip is made: for each the fastest within both bounds; by harmonics, the brightest texels each by its own lobe;
 * or by the integral, texel by texel (slow). Mips may also come out as copies (roughness 0) or NARROW: nearby texels as
 * areas, the far part by harmonics. */
typedef int32_t welkin_prefilter_method; /* clang-format off */
enum { WELKIN_PREFILTER_AUTOMATIC = 0, WELKIN_PREFILTER_SPECTRAL = 1, WELKIN_PREFILTER_REFERENCE = 2,
       WELKIN_PREFILTER_COPY = 4, WELKIN_PREFILTER_NARROW = 5 }; /* clang-format on */

/* Ways to spread roughness over a chain, with t = mip / (mips - 1), and the number of mips down to so many texels. */
typedef int32_t welkin_roughness_schedule;
enum {
  WELKIN_ROUGHNESS_DEFAULT = 0,  /* FILAMENT; of CHARLIE as the sample renderer of glTF has it */
  WELKIN_ROUGHNESS_LINEAR = 1,   /* t; down to 4 texels, but five mips where `size` has five */
  WELKIN_ROUGHNESS_FILAMENT = 2, /* 1 - sqrt(1 - t); three.js too; mips as LINEAR */
  WELKIN_ROUGHNESS_BABYLON = 3,  /* 0 at mip 0, else the square root of 2^(mip / 0.8) / size, at most 1; to 1 texel */
  WELKIN_ROUGHNESS_UNITY = 4,    /* r with mip = 6 r (1.7 - 0.7 r), whatever the number of mips; at most seven */
  WELKIN_ROUGHNESS_UNREAL = 5    /* 0 at mip 0, else 2^((mip - (mips - 1) + 2) / 1.2), at most 1; to 1 texel */
};

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

/* How exact reflections and irradiance are: rms_error 1e-3, 1e-2, or the integrals in double (minutes). */
typedef int32_t welkin_quality;
enum { WELKIN_QUALITY_NORMAL = 0, WELKIN_QUALITY_FAST = 1, WELKIN_QUALITY_REFERENCE = 2 };

/* Sizes, lobes and bounds of a chain. Arrays are copied. */
typedef struct welkin_prefilter_options {
  uint32_t struct_size;
  int32_t size;                       /* texels along an edge of mip 0, 1 to 8192; 0: 256, of skies 32 */
  int32_t mips;                       /* 0: `roughness_count`, else the schedule's; of LAMBERT and SPECTRA 1 */
  int32_t roughness_count;            /* numbers at `roughness`; 0: the schedule's */
  const double* roughness;            /* perceptual, 0 to 1, of each mip */
  welkin_prefilter_method method;     /* of all mips */
  double rms_error;                   /* bound on a mip's relative root mean square error; 0: by `quality` */
  double maximum_error;               /* bound on the relative error at any texel; 0: ten times rms_error, at most 1 */
  const welkin_pixel_policy* pixels;  /* null: the defaults. Must be null in a bake and of a sky */
  welkin_lobe_family lobe;            /* of all mips */
  int32_t spectrum_bands;             /* SPECTRA only: numbers of each mip's spectrum, 1 to 1536 */
  const double* spectra;              /* SPECTRA only: mips times spectrum_bands factors of degree 0, 1, ... */
  welkin_quality quality;             /* method and bounds; not read where `rms_error` is not 0 */
  const double* lobe_roughness;       /* of each mip's lobe, `roughness_count` numbers; null: `roughness` */
  welkin_roughness_schedule schedule; /* where `roughness` is null */
  int32_t fitted;                     /* 1: lobes of the schedule are those that lookups between mips err least with */
} welkin_prefilter_options;

/* How one mip was made, and how good it is. */
typedef struct welkin_mip {
  uint32_t struct_size;
  int32_t size;                   /* texels along an edge */
  double roughness;               /* perceptual, at which a shader finds the mip */
  welkin_prefilter_method method; /* never automatic */
  int32_t bands;                  /* of SPECTRAL and NARROW */
  int32_t bright_texels;          /* that were added one by one */
  double error_estimate;          /* predicted rms error over the mip's rms; NaN: not known */
  double mean[3];                 /* of the texels, by solid angle */
  double lobe_roughness;          /* of the mip's lobe */
  double error_between;           /* predicted rms error of lookups between this mip and the next; NaN: not known */
} welkin_mip;

/* Describes a mip of a prefiltered chain. */
WELKIN_API welkin_status welkin_chain_get_mip(const welkin_chain* chain, int32_t level, welkin_mip* mip);

/* Prefilters an environment for reflections (GGX, split sum): a mip for each roughness. */
WELKIN_API welkin_status welkin_prefilter(const welkin_environment* environment,
                                          const welkin_prefilter_options* options, const welkin_control* control,
                                          welkin_chain** chain);

/* Size and contents of a BRDF table, with E = f0 scale + bias the reflectance in even light. */
typedef struct welkin_brdf_options {
  uint32_t struct_size;
  int32_t width;               /* along N.V, 1 to 4096; 0: 64 */
  int32_t height;              /* along perceptual roughness, 1 to 4096; 0: 64 */
  int32_t multiple_scattering; /* 1: bias and scale + bias, so that E = (1 - f0) red + f0 green; 0: scale and bias */
  int32_t without_sheen;       /* 1: the third channel is 0; 0: it is the albedo of sheen */
} welkin_brdf_options;

/* Writes the table to a flat target of the options' size, row 0 the lowest roughness. Recent tables are kept. */
WELKIN_API welkin_status welkin_brdf_table(const welkin_brdf_options* options, const welkin_control* control,
                                           const welkin_target* target, uint64_t* values_clamped);

/* Writes irradiance at each texel's centre from the coefficients of irradiance to a cubemap target of 1 to 4096. */
WELKIN_API welkin_status welkin_irradiance_cubemap(int32_t bands, const double* irradiance,
                                                   const welkin_control* control, const welkin_target* target,
                                                   uint64_t* values_clamped);

/* ---- Bake: all that a physically based renderer loads, in one call ---- */

/* Flags, added up: a sharp cubemap with mips, reflections, an irradiance cubemap, harmonics of radiance, the BRDF
 * table, and the reflections as an octahedral map, which is only made where `octahedral_size` asks for it. */
typedef uint32_t welkin_parts; /* clang-format off */
enum { WELKIN_PART_BACKGROUND = 1, WELKIN_PART_SPECULAR = 2, WELKIN_PART_IRRADIANCE = 4, WELKIN_PART_HARMONICS = 8,
       WELKIN_PART_BRDF = 16, WELKIN_PART_OCTAHEDRAL = 32 }; /* clang-format on */

/* How an irradiance cubemap is computed: within `irradiance_rms_error` of the integral over the source's texels, as
 * that integral (slow), or from `bands` of harmonics, as shaders show that read so many. */
typedef int32_t welkin_irradiance_method;
enum { WELKIN_IRRADIANCE_AUTOMATIC = 0, WELKIN_IRRADIANCE_DIRECT = 1, WELKIN_IRRADIANCE_HARMONICS = 2 };

/* Parts, sizes and bounds of a bake. */
typedef struct welkin_bake_options {
  uint32_t struct_size;
  welkin_parts leave_out;          /* parts that are not made; 0: all are */
  int32_t background_size;         /* 0: the specular cubemap's; without one the source's own */
  int32_t background_without_mips; /* 1: level 0 alone */
  int32_t background_box_filter;   /* 1: levels are plain means, as in graphics APIs; 0: means by solid angle */
  int32_t irradiance_size;         /* 0: 64 */
  welkin_irradiance_method irradiance_method; /* of the irradiance cubemap */
  int32_t bands;                              /* of the harmonics; 0: 3 */
  const welkin_prefilter_options* specular;   /* null: the defaults */
  const welkin_brdf_options* brdf;            /* null: the defaults */
  const welkin_pixel_policy* pixels;          /* for all parts; null: the defaults */
  uint64_t memory_limit_bytes;                /* results and working memory together; 0: 8 GiB */
  double irradiance_rms_error;                /* bound of the automatic method, 1e-6 to 1; 0: by `quality` */
  int32_t octahedral_size;                    /* texels along an edge, borders included; 0: no map is made */
  int32_t octahedral_levels;                  /* 0: 1. Size and border must be multiples of 2^(levels - 1) */
  int32_t octahedral_border;                  /* texels on each side of level 0; 0: 2^(octahedral_levels - 1) */
  welkin_quality quality;                     /* of irradiance, and of reflections whose own quality is normal */
} welkin_bake_options;

/* Which parts a bake made, and how large they are. */
typedef struct welkin_bake_info {
  uint32_t struct_size;
  welkin_parts parts;               /* that there are */
  int32_t bands;                    /* 0 without harmonics */
  uint64_t peak_bytes;              /* bound on results and working memory together */
  double irradiance_error_estimate; /* predicted rms error of the irradiance cubemap over its rms; NaN: not known */
  int32_t octahedral_size;          /* 0 without a map */
  int32_t octahedral_levels;        /* fewer than asked for where there are fewer mips */
  int32_t octahedral_border;        /* texels on each side of level 0 */
  uint64_t values_clamped;          /* channel values that the formats of `welkin_bake_targets` could not hold */
} welkin_bake_info;

/* Bakes an environment. */
WELKIN_API welkin_status welkin_bake(const welkin_environment* environment, const welkin_bake_options* options,
                                     const welkin_control* control, welkin_bake_result** result);

/* Reads and bakes a file. */
WELKIN_API welkin_status welkin_bake_file(const char* path, const welkin_read_options* read_options,
                                          const welkin_bake_options* options, const welkin_control* control,
                                          welkin_bake_result** result);

/* Bakes reflections and harmonics of many cubemaps into memory of the caller's; `probes`, `coefficients` (null with 0
 * bands) and `totals` as in `welkin_project_many`. `targets`: all mips of the first probe, then of the second, and so
 * on. After an error that came later than the check of the arguments any part of the targets may be written. */
WELKIN_API welkin_status welkin_bake_many(const welkin_environment* probes, int64_t probe_count,
                                          const welkin_prefilter_options* options, const welkin_control* control,
                                          const welkin_target* targets, int64_t target_count, int32_t bands,
                                          double* coefficients, welkin_projection* totals, uint64_t* values_clamped);

/* Describes a result. */
WELKIN_API welkin_status welkin_bake_result_get_info(const welkin_bake_result* result, welkin_bake_info* info);

/* Returns the cubemap of the part background, specular or irradiance, lent for as long as the result is held
 * (`welkin_chain_share` keeps it longer). Null if that part was not made, and for other parts. */
WELKIN_API const welkin_chain* welkin_bake_result_chain(const welkin_bake_result* result, welkin_parts part);

/* Gets the harmonics of radiance, and what was read, replaced and clamped. */
WELKIN_API welkin_status welkin_bake_result_get_projection(const welkin_bake_result* result,
                                                           welkin_projection* projection);

/* Writes a level of the octahedral map to a flat target of octahedral_size >> level texels. */
WELKIN_API welkin_status welkin_bake_result_copy_octahedral(const welkin_bake_result* result, int32_t level,
                                                            const welkin_target* target, uint64_t* values_clamped);

/* Writes the BRDF table to a flat target. */
WELKIN_API welkin_status welkin_bake_result_copy_brdf(const welkin_bake_result* result, const welkin_target* target,
                                                      uint64_t* values_clamped);

/* ---- Sky ----
 * y is up; a sun's azimuth is counted from +z towards +x, its elevation from the horizon up. `sun` is a direction
 * towards it. docs/guides/moving_sky.md says what is computed. */

/* Atmospheres to begin with. EARTH has clear air as measured, HAZY three times its aerosol, DUSTY desert dust, POLLUTED
 * the air near cities. HILLAIRE and BRUNETON are those of Hillaire 2020 and of Bruneton 2017, the latter almost without
 * aerosol. BARE has Earth's size, and neither air nor light nor colour. */
typedef int32_t welkin_planet; /* clang-format off */
enum { WELKIN_PLANET_EARTH = 0, WELKIN_PLANET_EARTH_HILLAIRE = 1, WELKIN_PLANET_MARS = 2, WELKIN_PLANET_BARE = 3,
       WELKIN_PLANET_EARTH_BRUNETON = 4, WELKIN_PLANET_EARTH_HAZY = 5, WELKIN_PLANET_EARTH_DUSTY = 6,
       WELKIN_PLANET_EARTH_POLLUTED = 7 }; /* clang-format on */

/* A kind of matter: its density over the altitude, and its coefficients where the density is 1. */
typedef struct welkin_constituent {
  uint32_t struct_size;
  int32_t layer_count; /* 0: there is nothing of it; 8 at most */
  /* Five doubles per layer, from the ground up: thickness_m, exponential_term, exponential_scale_per_m,
   * linear_term_per_m, constant_term. Density at altitude h, relative to that of the coefficients: exponential_term
   * exp(exponential_scale_per_m h) + linear_term_per_m h + constant_term, clamped to [0, 1]. */
  const double* layers;
  const double* scattering_per_m; /* one per wavelength; null: none */
  const double* absorption_per_m; /* one per wavelength; null: none */
} welkin_constituent;

/* How the aerosol scatters by angle. */
typedef int32_t welkin_aerosol_phase;
enum { WELKIN_PHASE_DEFAULT = 0, WELKIN_PHASE_CORNETTE_SHANKS = 1, WELKIN_PHASE_HENYEY_GREENSTEIN = 2 };

/* A planet's air, ground and sun: a planet, and what differs from it. Arrays have one value per wavelength. Zero and
 * null leave what the planet has. All is copied by the calls that read it. */
typedef struct welkin_atmosphere {
  uint32_t struct_size;
  welkin_planet planet;         /* to begin with */
  int32_t wavelength_count;     /* 3, or up to 96 with `linear_srgb`; 0: 680, 550 and 440 nm, or the planet's own */
  int32_t absorber_count;       /* of `absorbers`; -1: there are none */
  const double* wavelengths_nm; /* rising or falling. Of EARTH, HAZY, DUSTY and POLLUTED 360 to 830; of other planets
                                   all that has a value per wavelength must be given too */
  const welkin_constituent* rayleigh; /* molecules */
  const welkin_constituent* aerosol;  /* particles */
  const double* aerosol_optics; /* instead of `aerosol`, of scale height 1200 m: vertical optical depth at 550 nm (0 to
                                   100), Angstrom exponent (-4 to 8), single scattering albedo, asymmetry */
  welkin_aerosol_phase aerosol_phase;     /* of the particles */
  double aerosol_asymmetry;               /* g of its phase function, -0.8 to 0.999 */
  const double* aerosol_asymmetries;      /* g by wavelength */
  const welkin_constituent* absorbers[4]; /* ozone and the like */
  double bottom_radius_m;                 /* of the ground, 1 to 1e9 */
  double top_radius_m;                    /* of the air, above the ground's, at most 11 times it */
  const double* ground_albedo;            /* 0 to 1 */
  const double* sun_irradiance;           /* above the air, on a surface that faces the sun, W/m2/nm */
  double sun_angular_radius_degrees;      /* of the disc */
  double night_zenith_luminance;          /* airglow and stars, from the ground, up to 1 cd/m2; a dark place has 2e-4 */
} welkin_atmosphere;

/* Computes the unit direction towards a sun. */
WELKIN_API welkin_status welkin_sun_direction(double elevation_degrees, double azimuth_degrees, double* direction);

/* Sizes of the tables, and how far scattering is followed. */
typedef struct welkin_sky_table_options {
  uint32_t struct_size;
  int32_t compact;      /* 1: without the azimuth between view and sun, with which only phase functions then vary */
  int32_t heights;      /* 2 to 128; 0: 32 */
  int32_t view_zeniths; /* even, 4 to 1024; 0: 64 */
  int32_t sun_zeniths;  /* 4 to 256; 0: 64 */
  int32_t sun_angles;   /* 2 to 128, not with `compact`; 0: 8 */
  int32_t transmittance_heights;        /* 2 to 1024; 0: 64 */
  int32_t transmittance_zeniths;        /* 2 to 2048; 0: 256 */
  int32_t irradiance_heights;           /* 2 to 1024; 0: 16 */
  int32_t irradiance_sun_zeniths;       /* 2 to 1024; 0: 64 */
  int32_t orders;                       /* of scattering, 1 to 64; 0: 4 */
  int32_t linear_srgb;                  /* 1: channels are cd/m2; 0: W/m2/sr/nm at three wavelengths */
  double minimum_sun_elevation_degrees; /* that the tables hold, -90 up to below 0; 0: -30 */
  double until_change;                  /* stop before `orders` when one added less than this share; 0: never */
  uint64_t memory_limit_bytes;          /* 0: 4 GiB */
  int32_t exact_orders;                 /* not 0: nothing of orders beyond `orders`; 0: they are estimated */
} welkin_sky_table_options;

/* Computes tables: about two seconds of processor time with the defaults. The message of WELKIN_INVALID_ARGUMENT names
 * the parameter of the atmosphere that cannot be computed, what was found and what to do. */
WELKIN_API welkin_status welkin_sky_tables_create(const welkin_atmosphere* atmosphere,
                                                  const welkin_sky_table_options* options,
                                                  const welkin_control* control, welkin_sky_tables** tables);

/* Saves tables with all their parameters; loaded again they are the same bits. */
WELKIN_API welkin_status welkin_sky_tables_save(const welkin_sky_tables* tables, const char* path);

/* Loads tables that were saved. `memory_limit_bytes` 0: 4 GiB. */
WELKIN_API welkin_status welkin_sky_tables_load(const char* path, uint64_t memory_limit_bytes,
                                                welkin_sky_tables** tables);

/* Makes a view, in some 2 ms. `altitude_m`: the observer's above the ground, 0 to 1e9. `without_ground` 1: rays that
 * end on the ground see only the air before it. */
WELKIN_API welkin_status welkin_sky_view_create(const welkin_sky_tables* tables, double altitude_m,
                                                int32_t without_ground, welkin_sky_view** view);

/* Computes radiance from `count` directions, without the sun's disc: packed x y z and packed r g b. */
WELKIN_API welkin_status welkin_sky_view_radiance(const welkin_sky_view* view, const float* directions, size_t count,
                                                  const double* sun, float* rgb);

/* Computes the sun as a directional light at this height: irradiance on a surface that faces it, and steradians. */
WELKIN_API welkin_status welkin_sky_view_sun(const welkin_sky_view* view, const double* sun, double* irradiance,
                                             double* solid_angle);

/* Writes a picture of the sky: a cubemap, or a lat-long if the target is flat, whose width must be twice its height.
 * `sun_disc` 1: with the sun's disc, as texels that it covers by area. */
WELKIN_API welkin_status welkin_sky_view_picture(const welkin_sky_view* view, const double* sun, int32_t sun_disc,
                                                 const welkin_control* control, const welkin_target* target,
                                                 uint64_t* values_clamped);

/* Prefilters a picture of the sky for reflections. */
WELKIN_API welkin_status welkin_sky_view_specular(const welkin_sky_view* view, const double* sun, int32_t sun_disc,
                                                  const welkin_prefilter_options* options,
                                                  const welkin_control* control, welkin_chain** chain);

/* How a sky is projected. */
typedef struct welkin_sky_harmonics_options {
  uint32_t struct_size;
  int32_t bands;    /* 1 to WELKIN_MAXIMUM_BANDS; 0: 3 */
  int32_t zeniths;  /* 2 to 128; 0: 32 */
  int32_t azimuths; /* 2 to 256; 0: 32 */
  int32_t nodes;    /* sun elevations of the curve, 8 to 4096; 0: 256 */
} welkin_sky_harmonics_options;

/* Makes a curve, in milliseconds. */
WELKIN_API welkin_status welkin_sky_curve_create(const welkin_sky_view* view,
                                                 const welkin_sky_harmonics_options* options,
                                                 const welkin_control* control, welkin_sky_curve** curve);

/* Computes radiance of sky and ground, without the sun's disc: `coefficients` gets 3 bands^2 doubles. `sun_irradiance`
 * (may be null) gets r, g, b of the direct sun on a surface that faces it. Allocates nothing; under a microsecond for
 * three bands. */
WELKIN_API welkin_status welkin_sky_curve_at(const welkin_sky_curve* curve, const double* sun, double* coefficients,
                                             double* sun_irradiance);

/* ---- Worker ---- */

/* How the system ranks a worker's threads. BELOW: a tenth of a normal thread's share, the default. IDLE: they run only
 * on processors that nothing else wants. */
typedef int32_t welkin_thread_priority; /* clang-format off */
enum { WELKIN_THREAD_PRIORITY_DEFAULT = 0, WELKIN_THREAD_PRIORITY_BELOW = 1,
       WELKIN_THREAD_PRIORITY_NORMAL = 2, WELKIN_THREAD_PRIORITY_IDLE = 3 }; /* clang-format on */

/* A worker's threads and limits. */
typedef struct welkin_worker_options {
  uint32_t struct_size;
  int32_t threads; /* 1 to 1024; 0: one less than the process may use, at least 1. With `enqueue`: how many tasks the
                      engine runs at the same time; 0: as many as the process may use */
  welkin_thread_priority thread_priority; /* of its own threads */
  const char* name;                       /* of the threads; null: "welkin" */

  /* Null, or lends the worker the engine's threads; it then has none of its own. `enqueue` has `task(argument)` called,
   * soon and exactly once, on a thread of the engine's choice. It is called from any thread, several at once, with at
   * most `threads` tasks outstanding. `enqueue_user` must live until the worker is terminated or destroyed; a task that
   * is called later does nothing. A task that is never called leaks, and a job may wait for it. */
  void (*enqueue)(void* enqueue_user, void (*task)(void* argument), void* argument);
  void* enqueue_user; /* what `enqueue` gets */

  /* A job that is posted beyond a limit ends with WELKIN_QUEUE_FULL. */
  uint64_t max_jobs;  /* in flight; 0: 4096 */
  uint64_t max_bytes; /* in flight, of their pixels; 0: 4 GiB */
} welkin_worker_options;

/* Makes a worker. WELKIN_INTERNAL if no thread could be made. */
WELKIN_API welkin_status welkin_worker_create(const welkin_worker_options* options, welkin_worker** worker);

/* Terminates and frees it. No other thread may use the worker any more; its jobs may be used. Completed callbacks that
 * were not drained are never called; to have them all, terminate, drain, then destroy. */
WELKIN_API void welkin_worker_destroy(welkin_worker* worker);

/* Cancels all jobs (they end with WELKIN_STOPPED), waits until none runs, and ends the threads. Later posts are stopped
 * too; callbacks can still be drained. On one of the worker's own threads it does not wait. */
WELKIN_API welkin_status welkin_worker_terminate(welkin_worker* worker);

/* Waits until nothing waits or runs; not for callbacks. On one of the worker's own threads it returns at once. */
WELKIN_API welkin_status welkin_worker_wait_until_idle(welkin_worker* worker);

/* No limit of time: longer than any. */
#define WELKIN_NO_LIMIT UINT64_MAX

/* Calls the `completed` callbacks of jobs that are done, on this thread, in the order in which they finished: at least
 * one if there is one, then until `budget_nanoseconds` are spent. `called` (may be null) gets their number. */
WELKIN_API welkin_status welkin_worker_drain(welkin_worker* worker, uint64_t budget_nanoseconds, uint64_t* called);

/* ---- Posting ----
 * Posts return at once. `post` and `job` may be null; else `*job` gets a handle to be given back with
 * `welkin_job_release`. Structures are copied. Null pointers, sizes and enumeration values are refused here, and
 * nothing is posted; all other errors, a worker's refusal too, arrive through the job. */

/* Which waiting job starts next: the higher one, and of equals the older one. */
typedef int32_t welkin_priority;
enum { WELKIN_PRIORITY_LOW = -1, WELKIN_PRIORITY_NORMAL = 0, WELKIN_PRIORITY_HIGH = 1 };

/* How a job is posted, and who hears of its end. */
typedef struct welkin_post_options {
  uint32_t struct_size;
  welkin_priority priority; /* among the jobs that wait */
  const char* key; /* latest wins: a job of the same key that waits or runs ends with WELKIN_REPLACED; null: no key */
  uint64_t bytes;  /* that the job counts against `max_bytes`; 0: those of its pixels */

  /* Null: the pixels (for a function: what it uses) must stay until the job is ready. Else they go over to the job, and
   * `release(release_user)` is called once nothing reads them any more. It is called exactly once for each call of a
   * post function, on any thread, and must not wait for the worker or its jobs:
   * - if the post fails, before it returns; for files and skies, before the post returns;
   * - if the job never runs, before the call returns that cancelled it, refused it or terminated the worker; for a
   *   replaced job, which a thread may be about to start or to end, possibly a moment later;
   * - if it runs, about when it is ready, and before `welkin_worker_wait_until_idle`, `welkin_worker_terminate` and
   *   `welkin_worker_destroy` return.
   * The one exception: if `struct_size` itself is refused, nothing is called. */
  void (*release)(void* release_user);
  void* release_user; /* what `release` gets */

  /* Null, or called inside `welkin_worker_drain` once the job is done, well or not: exactly once if the post succeeds
   * and the worker is drained to the end. `job` is lent for the call; `welkin_job_retain` keeps it. */
  void (*completed)(welkin_job* job, void* completed_user);
  void* completed_user; /* what `completed` gets */
} welkin_post_options;

/* Post the call of the same name, or the curve or the reflections (without the sun's disc) of a sky at a height. */
WELKIN_API welkin_status welkin_post_project(welkin_worker* worker, const welkin_environment* mips, int32_t mip_count,
                                             const welkin_projection_options* options, const welkin_post_options* post,
                                             welkin_job** job);
WELKIN_API welkin_status welkin_post_project_file(welkin_worker* worker, const char* path,
                                                  const welkin_read_options* read_options,
                                                  const welkin_projection_options* options,
                                                  const welkin_post_options* post, welkin_job** job); /* a projection */
WELKIN_API welkin_status welkin_post_prefilter(welkin_worker* worker, const welkin_environment* environment,
                                               const welkin_prefilter_options* options, const welkin_post_options* post,
                                               welkin_job** job); /* a chain */
WELKIN_API welkin_status welkin_post_bake_file(welkin_worker* worker, const char* path,
                                               const welkin_read_options* read_options,
                                               const welkin_bake_options* options, const welkin_post_options* post,
                                               welkin_job** job); /* a bake */
WELKIN_API welkin_status welkin_post_sky_tables(welkin_worker* worker, const welkin_atmosphere* atmosphere,
                                                const welkin_sky_table_options* options,
                                                const welkin_post_options* post, welkin_job** job); /* tables */
WELKIN_API welkin_status welkin_post_sky_curve(welkin_worker* worker, const welkin_sky_tables* tables,
                                               double altitude_m, const welkin_sky_harmonics_options* options,
                                               const welkin_post_options* post, welkin_job** job); /* a curve */
WELKIN_API welkin_status welkin_post_sky_specular(welkin_worker* worker, const welkin_sky_tables* tables,
                                                  double altitude_m, const double* sun,
                                                  const welkin_prefilter_options* options,
                                                  const welkin_post_options* post, welkin_job** job); /* a chain */

/* Memory of the caller's for the cubemaps of a bake: RGBA_F16 or RGBA_F32, the targets of a part all of one
 * `struct_size`. A part without targets stays in the result. */
typedef struct welkin_bake_targets {
  uint32_t struct_size;
  const welkin_target* background; /* one per level */
  int64_t background_count;        /* targets; 0: none */
  const welkin_target* specular;   /* one per mip */
  int64_t specular_count;          /* targets; 0: none */
  const welkin_target* irradiance; /* one; null: none */
} welkin_bake_targets;

/* Posts `welkin_bake`. `targets` may be null; else the worker's threads write the bake's cubemaps there, and that
 * memory must stay until the job is ready; `release` then also waits for the last write. A job that succeeds has
 * written every texel; one that never started, or whose targets do not fit, none; any other job that fails, any part of
 * them. Running jobs must not share targets: a replaced job writes until it is ready. */
WELKIN_API welkin_status welkin_post_bake(welkin_worker* worker, const welkin_environment* environment,
                                          const welkin_bake_options* options, const welkin_bake_targets* targets,
                                          const welkin_post_options* post, welkin_job** job);

/* Posts a function of the caller's: `run(run_user, control)` is called on one of the worker's threads, once, or not at
 * all if the job is cancelled first. What it returns becomes the job's status: any value but WELKIN_NOT_READY, from
 * 1000 on your own numbers. If it returns what a call in it failed with, the job has that call's message. It should
 * look at `welkin_control_stop_requested` about every millisecond. If it calls `pthread_exit`, its thread goes on and
 * the job ends with WELKIN_INTERNAL. */
WELKIN_API welkin_status welkin_post_function(welkin_worker* worker,
                                              welkin_status (*run)(void* run_user, const welkin_control* control),
                                              void* run_user, const welkin_post_options* post, welkin_job** job);

/* Returns 1 if the job was cancelled: return then, WELKIN_CANCELLED for instance. Else 0. */
WELKIN_API int32_t welkin_control_stop_requested(const welkin_control* control);

/* Reports the share of the work that is done, 0 to 1. Less than was reported before changes nothing. */
WELKIN_API welkin_status welkin_control_report_progress(const welkin_control* control, double done);

/* ---- Jobs ----
 * Functions that get a result never wait, and may be called any number of times; all handles share the result. They
 * return what `welkin_job_poll` does, and WELKIN_INVALID_ARGUMENT if the job makes something else. */

/* Returns a number that is unique in the process and rises in the order of posting; 0 for null. */
WELKIN_API uint64_t welkin_job_id(const welkin_job* job);

/* Returns WELKIN_NOT_READY while the job waits or runs, then WELKIN_OK or its error, whose message is in
 * `welkin_last_error`. `progress` (may be null) gets the share that is done, 0 to 1, never falling. Never waits. */
WELKIN_API welkin_status welkin_job_poll(const welkin_job* job, double* progress);

/* Waits until the job is ready, at most `timeout_nanoseconds`, then returns what `welkin_job_poll` does. On one of the
 * worker's own threads and with WELKIN_NO_LIMIT it starts a job that still waits itself. A request must not wait for
 * itself, directly or through other jobs: that wait never ends. */
WELKIN_API welkin_status welkin_job_wait(const welkin_job* job, uint64_t timeout_nanoseconds);

/* Get the result: a copy of a projection, and a handle to a chain, a bake, a sky's tables and a sky's curve. */
WELKIN_API welkin_status welkin_job_projection(const welkin_job* job, welkin_projection* projection);
WELKIN_API welkin_status welkin_job_get_chain(const welkin_job* job, welkin_chain** chain);            /* a chain */
WELKIN_API welkin_status welkin_job_get_bake(const welkin_job* job, welkin_bake_result** result);      /* a bake */
WELKIN_API welkin_status welkin_job_get_sky_tables(const welkin_job* job, welkin_sky_tables** tables); /* a sky */
WELKIN_API welkin_status welkin_job_get_sky_curve(const welkin_job* job, welkin_sky_curve** curve);    /* a curve */

/* Cancels the job: it ends with WELKIN_CANCELLED, at once if it waits, else before its next tile (a function: when it
 * returns). `given_up` (may be null) gets 1 if this call did it, 0 if the job was done or cancelled before. */
WELKIN_API welkin_status welkin_job_cancel(welkin_job* job, int32_t* given_up);

/* Moves a waiting job to the end of those of that priority. */
WELKIN_API welkin_status welkin_job_set_priority(welkin_job* job, welkin_priority priority);

/* Take one more reference, and give one back. The handle goes with the last one; the job runs to its end. */
WELKIN_API void welkin_job_retain(welkin_job* job);
WELKIN_API void welkin_job_release(welkin_job* job); /* one back */

/* ---- The dynamic sky of an engine's loop ----
 * It posts to a worker, which must outlive it: a new atmosphere makes tables, a curve and reflections, a new altitude
 * the last two, a new elevation of the sun reflections. Turning the sun about the vertical posts nothing. */

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
  const welkin_chain* chain; /* lent until the next update; null: none yet */
  uint64_t id;               /* rises with each new chain: what has the same one need not be uploaded again; 0: none */
  double weight;             /* of its light */
  double turn[9];            /* what came from direction d comes from turn * d */
} welkin_sky_reflections;

/* The light of a frame. Its `struct_size` may end inside `coefficients`. */
typedef struct welkin_sky_frame {
  uint32_t struct_size;
  int32_t ready;                         /* 0 until the first curve has come: all is black */
  int32_t settled;                       /* 1: nothing is being made or blended */
  int32_t bands;                         /* of `coefficients` */
  double sun_direction[3];               /* towards it */
  double sun_irradiance[3];              /* on a surface that faces it, intensity included */
  double sun_solid_angle;                /* steradians */
  welkin_sky_reflections reflections[2]; /* newer and older; both weights add up to the intensity */
  double coefficients[3 * WELKIN_MAXIMUM_BANDS * WELKIN_MAXIMUM_BANDS]; /* radiance of sky and ground, intensity
                                                                           included, without the sun's disc */
} welkin_sky_frame;

/* Makes a dynamic sky, with the sun in the zenith. Tables that are there already may be given; `atmosphere` is then not
 * read and may be null, and the tables' options count. Else `tables` is null, and the worker is asked for some. */
WELKIN_API welkin_status welkin_sky_light_create(welkin_worker* worker, const welkin_atmosphere* atmosphere,
                                                 const welkin_sky_tables* tables,
                                                 const welkin_sky_light_options* options, welkin_sky_light** light);

/* Change the sun's direction, a factor of all light (0 to 1e12), the observer's metres above the ground, or the
 * planet. They post a request only if there is something to make. */
WELKIN_API welkin_status welkin_sky_light_set_sun(welkin_sky_light* light, const double* sun);
WELKIN_API welkin_status welkin_sky_light_set_intensity(welkin_sky_light* light, double intensity); /* a factor */
WELKIN_API welkin_status welkin_sky_light_set_altitude(welkin_sky_light* light, double altitude_m); /* metres */
/* Changes the planet. */
WELKIN_API welkin_status welkin_sky_light_set_atmosphere(welkin_sky_light* light, const welkin_atmosphere* atmosphere);

/* Takes what has come, goes on with what is being blended, and writes the light. Never waits; allocates only when new
 * reflections have come. `seconds`: since the last update. */
WELKIN_API welkin_status welkin_sky_light_update(welkin_sky_light* light, double seconds, welkin_sky_frame* frame);

/* Returns WELKIN_OK, or what the last bake that failed ended with, whose message is in `welkin_last_error`. The light
 * is then what it was before, and the next change asks again. */
WELKIN_API welkin_status welkin_sky_light_get_status(const welkin_sky_light* light);

/* ---- Files ----
 * Functions about files (`..._file`, `..._save`, `..._load` and the following) are not in welkin-core. They also return
 * WELKIN_FILE_ACCESS, WELKIN_CORRUPT_FILE, WELKIN_UNSUPPORTED_FILE. A written file is complete or not there. */

/* How texels are stored. Values that a format cannot hold are clamped and counted; NaN becomes 0, but in RGBA32F.
 * B10G11R11 holds 1 part in 32 from 0 to 64512, E5B9G9R9 1 part in 512 of the largest channel from 0 to 65408. OpenEXR
 * has the first two alone, KTX2 and DDS have BC6H, KTX2 has ASTC (a build without astcenc: WELKIN_UNSUPPORTED_FILE). */
typedef int32_t welkin_texel_format; /* clang-format off */
enum { WELKIN_TEXEL_RGBA16F = 0, WELKIN_TEXEL_RGBA32F = 1, WELKIN_TEXEL_B10G11R11 = 2, WELKIN_TEXEL_E5B9G9R9 = 3,
       WELKIN_TEXEL_BC6H_UFLOAT = 4, WELKIN_TEXEL_BC6H_SFLOAT = 5,
       WELKIN_TEXEL_ASTC_4X4_HDR = 6, WELKIN_TEXEL_ASTC_6X6_HDR = 7 }; /* clang-format on */

/* How long the encoder of BC6H and ASTC searches; docs/reference/textures.md has errors and times. DEFAULT: NORMAL. */
typedef int32_t welkin_effort; /* clang-format off */
enum { WELKIN_EFFORT_DEFAULT = 0, WELKIN_EFFORT_FASTEST = 1, WELKIN_EFFORT_FAST = 2,
       WELKIN_EFFORT_NORMAL = 3, WELKIN_EFFORT_SLOW = 4 }; /* clang-format on */

/* How KTX2's levels are packed. */
typedef int32_t welkin_supercompression;
enum { WELKIN_SUPERCOMPRESSION_NONE = 0, WELKIN_SUPERCOMPRESSION_ZLIB = 1, WELKIN_SUPERCOMPRESSION_ZSTD = 2 };

/* How texels are stored in a file. */
typedef struct welkin_texture_options {
  uint32_t struct_size;
  welkin_texel_format format;               /* of all texels */
  welkin_supercompression supercompression; /* KTX2 only */
  welkin_effort effort;                     /* with the BC6H and ASTC formats */
} welkin_texture_options;

/* Writes a texture in the format that the extension names. `mips` is a cubemap with its levels, as in `welkin_project`:
 * .ktx2, .ktx, .dds or .exr; or one flat picture of packed RGB_F32 (`width` x `height`), a BRDF table for instance:
 * .ktx2 or .dds. `values_clamped` (may be null) gets how many values the format could not hold. */
WELKIN_API welkin_status welkin_write_texture(const char* path, const welkin_environment* mips, int32_t mip_count,
                                              const welkin_texture_options* options, const welkin_control* control,
                                              uint64_t* values_clamped);

/* Writes a whole chain. A prefiltered one's roughness goes into KTX2's and OpenEXR's metadata, where this library finds
 * it again. */
WELKIN_API welkin_status welkin_write_chain(const char* path, const welkin_chain* chain,
                                            const welkin_texture_options* options, const welkin_control* control,
                                            uint64_t* values_clamped);

/* Writes Babylon.js's .env: a chain prefiltered with WELKIN_ROUGHNESS_BABYLON down to 1 texel, whose size is a power of
 * two, and the polynomial of the light. Both are in Welkin's axes, and turned to Babylon.js's. */
WELKIN_API welkin_status welkin_write_babylon_environment(const char* path, const welkin_chain* specular, int32_t bands,
                                                          const double* radiance, const welkin_control* control,
                                                          uint64_t* values_clamped);

#ifdef __cplusplus
}
#endif

#endif
/* NOLINTEND(modernize-*) */
