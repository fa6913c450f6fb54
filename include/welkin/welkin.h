/* Welkin for engines in other languages: image-based lighting through C99.
 *
 *   welkin_environment cubemap = {.struct_size = sizeof cubemap, .size = 1024, .format = WELKIN_FORMAT_RGBA_F16,
 *                                 .faces = {px, nx, py, ny, pz, nz}};
 *   welkin_projection light = {.struct_size = sizeof light};
 *   if (welkin_project(&cubemap, 1, NULL, NULL, &light) != WELKIN_OK) puts(welkin_last_error());
 *
 * Results are bit-identical to those of C++, on any number of threads, instruction set and platform.
 *
 * Structures. Each begins with `struct_size`, its `sizeof` in the caller's program. In structures that are read, zero
 * in any other field selects the default, and a null pointer to options selects all defaults. Fields that a shorter
 * structure lacks count as zero; fields of a longer one that the library does not know must be zero. Structures that
 * are written are filled up to `struct_size`, unknown fields with zeros. `values_clamped` (may be null) receives the
 * number of values that the format of a target or a file could not hold.
 *
 * Errors. Calls that can fail return a `welkin_status`. No exception leaves a call, and none may leave a callback. A
 * call that fails writes no result unless its comment says so, and sets the handle that it would have created to null.
 * Required pointers that are null, and values out of range, make it return WELKIN_INVALID_ARGUMENT. Calls that compute
 * can also return WELKIN_REJECTED_PIXEL, WELKIN_LIMIT_EXCEEDED, WELKIN_CANCELLED and WELKIN_OUT_OF_MEMORY.
 *
 * Handles belong to the caller. Each kind has a function that destroys it and accepts null. Other functions refuse a
 * null handle. Handles of results are immutable and may be read from any number of threads. A handle may outlive the
 * object that it was created from, but a worker must outlive its `welkin_sky_light`.
 *
 * Threads. All functions may be called from any thread. Functions that compute use the oneTBB arena of the calling
 * thread. `control` may be null; inside a function that a worker runs, pass the one that it received.
 *
 * Numbers. Strings are UTF-8 and are copied. A direction is three doubles x, y, z, y up, of any length above 0;
 * returned ones have length 1. A colour is r, g, b. A 3 x 3 matrix is nine doubles, column by column. Harmonics are
 * real, orthonormal, without Condon-Shortley phase, Y(1, -1..1) ~ y, z, x: 3 bands^2 doubles, with r, g, b of
 * coefficient (l, m) from 3 (l (l + 1) + m) on. docs/guides/c.md has examples. */
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
/* A call that can fail. */
#define WELKIN_CALL WELKIN_API welkin_status

#ifdef __cplusplus
extern "C" {
#endif

/* Version of this interface. A program runs with a library whose `welkin_c_version()` is at least its own
 * WELKIN_C_VERSION, if both are at least 5. Version 5 removed functions and fields. */
#define WELKIN_C_VERSION 5

/* Returns the library's own WELKIN_C_VERSION. */
WELKIN_API uint32_t welkin_c_version(void);

/* Sets all fields of `object`, a structure of this header, to their defaults: WELKIN_INIT(options); */
#define WELKIN_INIT(object) \
  ((void)memset(&(object), 0, sizeof(object)), (void)((object).struct_size = (uint32_t)sizeof(object)))

/* ---- Handles ---- */

/* A cubemap of RGB floats with its mips; level l has max(1, size >> l) texels per edge. */
typedef struct welkin_chain welkin_chain;
/* Result of a bake. */
typedef struct welkin_bake_result welkin_bake_result;
/* Precomputed scattering of a planet's atmosphere. */
typedef struct welkin_sky_tables welkin_sky_tables;
/* The sky seen from one altitude. */
typedef struct welkin_sky_view welkin_sky_view;
/* Harmonics of a view over the sun's elevation: for any sun, an interpolation and a rotation. */
typedef struct welkin_sky_curve welkin_sky_curve;
/* The dynamic sky of an engine's loop: set the sun, get the light, every frame. For one thread at a time. */
typedef struct welkin_sky_light welkin_sky_light;
/* Runs jobs on threads of its own, or on the engine's (docs/guides/worker.md). */
typedef struct welkin_worker welkin_worker;
/* A posted job, reference-counted: a post returns one reference. It may outlive its worker. */
typedef struct welkin_job welkin_job;
/* A baked grid of light probes. */
typedef struct welkin_probes welkin_probes;
/* Passed by a worker to a caller's function (`welkin_post_function`), valid until that function returns. */
typedef struct welkin_control welkin_control;

/* Destroys a handle without waiting. Data shared between handles is freed with the last of them. */
WELKIN_API void welkin_chain_destroy(welkin_chain* chain);
WELKIN_API void welkin_bake_result_destroy(welkin_bake_result* result); /* destroys the result of a bake */
WELKIN_API void welkin_sky_tables_destroy(welkin_sky_tables* tables);   /* destroys sky tables */
WELKIN_API void welkin_sky_view_destroy(welkin_sky_view* view);         /* destroys a sky view */
WELKIN_API void welkin_sky_curve_destroy(welkin_sky_curve* curve);      /* destroys a sky curve */
WELKIN_API void welkin_sky_light_destroy(welkin_sky_light* light);      /* destroys a dynamic sky */
WELKIN_API void welkin_probes_destroy(welkin_probes* probes);           /* destroys probes */

/* ---- Status ---- */

/* Result of a call. Later versions may add values: treat unknown values as errors. */
typedef int32_t welkin_status;
enum {
  WELKIN_OK = 0,
  WELKIN_INVALID_ARGUMENT = 1, /* arguments that no call accepts, such as a null face or 17 bands */
  WELKIN_REJECTED_PIXEL = 2,   /* a texel that the options reject; the message names face, row and column */
  WELKIN_FILE_ACCESS = 3,      /* a file that cannot be opened, read or written */
  WELKIN_CORRUPT_FILE = 4,     /* a file that violates its own format, or is truncated */
  WELKIN_UNSUPPORTED_FILE = 5, /* a valid file of a kind that is not supported, or whose layout is ambiguous */
  WELKIN_LIMIT_EXCEEDED = 6,   /* a memory limit is exceeded, or no method meets an error bound */
  WELKIN_CANCELLED = 7,        /* the caller cancelled */
  WELKIN_REPLACED = 8,         /* a newer job with the same key superseded this one */
  WELKIN_QUEUE_FULL = 9,       /* the worker was at its limits and refused this job */
  WELKIN_STOPPED = 10,         /* the worker was terminated before this job completed */
  WELKIN_OUT_OF_MEMORY = 100,
  WELKIN_NOT_READY = 101, /* the job has not completed yet; not an error, no message */
  WELKIN_INTERNAL = 102   /* any other failure, such as a thread that cannot be created */
};

/* Returns "ok", "invalid_argument", ...; "unknown" for other values. Never null. */
WELKIN_API const char* welkin_status_name(welkin_status status);
/* Returns the message of the latest error on this thread: input, fault and remedy, until the next error. Never null. */
WELKIN_API const char* welkin_last_error(void);

/* Sets how many bytes of unused blocks the process keeps for later calls (default 128 MiB), and frees the rest. */
WELKIN_API void welkin_keep_working_memory(uint64_t bytes);
/* Frees all blocks that no call uses. */
WELKIN_API void welkin_release_working_memory(void);

/* ---- Environments ---- */

/* The layout of a texel in memory: interleaved channels without padding. Alpha is ignored when read, and written as 1.
 * F16 is IEEE 754 binary16. U8 maps 0..255 to 0..1; SRGB8 then applies sRGB's transfer function. RG is only written. */
typedef int32_t welkin_format; /* clang-format off */
enum { WELKIN_FORMAT_RGB_F32 = 0, WELKIN_FORMAT_RGBA_F32 = 1, WELKIN_FORMAT_RGB_F16 = 2, WELKIN_FORMAT_RGBA_F16 = 3,
       WELKIN_FORMAT_RGB_U8 = 4, WELKIN_FORMAT_RGBA_U8 = 5, WELKIN_FORMAT_RGB_SRGB8 = 6, WELKIN_FORMAT_RGBA_SRGB8 = 7,
       WELKIN_FORMAT_RG_F32 = 8, WELKIN_FORMAT_RG_F16 = 9 }; /* clang-format on */

/* The caller's pixels, read in place: a cubemap or a lat-long. Cubemap: six square faces +X -X +Y -Y +Z -Z, top row
 * first. Their columns and rows run along -z -y, +z -y, +x +z, +x -z, +x -y and -x -y. Lat-long: an equirectangular
 * sphere, +z in the centre, +x a quarter of the width from the left edge, y up. */
typedef struct welkin_environment {
  uint32_t struct_size;
  welkin_format format;     /* format of all texels */
  int64_t row_stride_bytes; /* distance between rows; 0: packed rows; negative: bottom-up */
  const void* faces[6];     /* first texel of each face, aligned to its channels; for a lat-long faces[0] only */
  int64_t size;             /* texels per edge of a cubemap, 1 to 16384; 0: a lat-long */
  int32_t width, height;    /* texels of a lat-long, up to 65536 x 32768; else 0 */
} welkin_environment;

/* The layout of a sphere in an image file, with faces of N x N texels. */
typedef int32_t welkin_layout;
enum {
  WELKIN_LAYOUT_AUTOMATIC = 0, /* from the file's header, its shape or its name */
  WELKIN_LAYOUT_LAT_LONG = 1,
  WELKIN_LAYOUT_VERTICAL_STRIP = 2,   /* N x 6N: +X -X +Y -Y +Z -Z from top to bottom */
  WELKIN_LAYOUT_HORIZONTAL_STRIP = 3, /* 6N x N: +X -X +Y -Y +Z -Z from left to right */
  WELKIN_LAYOUT_HORIZONTAL_CROSS = 4, /* 4N x 3N: -X +Z +X -Z in the middle row, +Y above +Z, -Y below it */
  WELKIN_LAYOUT_VERTICAL_CROSS = 5,   /* 3N x 4N: +Y; -X +Z +X; -Y; and -Z below that, rotated by 180 degrees */
  WELKIN_LAYOUT_SIX_FILES = 6         /* one image per face, identified by the ends of their names */
};

/* Encoding of values in a PNG. AUTOMATIC: sRGB, or linear where the file states a gamma of 1. */
typedef int32_t welkin_transfer;
enum { WELKIN_TRANSFER_AUTOMATIC = 0, WELKIN_TRANSFER_SRGB = 1, WELKIN_TRANSFER_LINEAR = 2 };

/* Options for reading a file. A part, layer, level or element that the file lacks returns WELKIN_UNSUPPORTED_FILE. */
typedef struct welkin_read_options {
  uint32_t struct_size;
  welkin_layout layout;        /* layout of the sphere in the image */
  const char* part;            /* part of an OpenEXR file: name, or index from 0; null: the first part with colour */
  const char* layer;           /* layer of an OpenEXR file; null: the channels without a layer, else the only layer */
  welkin_transfer transfer;    /* encoding of values in a PNG */
  int32_t primaries_as_stored; /* 1: values as stored; 0: converted to Rec. 709 where the file states other primaries */
  uint64_t memory_limit_bytes; /* limit for pixels; 0: 8 GiB */
  int64_t level;               /* mip to read; 0 is the full size */
  int64_t element;             /* index in an array of cubemaps or images (KTX2, KTX, DDS), from 0 */
} welkin_read_options;

/* ---- Projection to spherical harmonics ---- */

/* The maximum number of bands. */
#define WELKIN_MAXIMUM_BANDS 16

/* Treatment of finite values below zero. REPLACE: by 0. REJECT: WELKIN_REJECTED_PIXEL. */
typedef int32_t welkin_negative_policy;
enum { WELKIN_NEGATIVE_KEEP = 0, WELKIN_NEGATIVE_REPLACE = 1, WELKIN_NEGATIVE_REJECT = 2 };

/* Treatment of pixel values before they are used as radiance. */
typedef struct welkin_pixel_policy {
  uint32_t struct_size;
  float clamp_maximum;             /* maximum of radiance, above 0; 0: no clamp */
  int32_t clamp_preserve_colour;   /* 1: scales r, g and b by one factor; 0: clamps each to [0, maximum] */
  int32_t gamma;                   /* 1: decodes channels, clamped to [0, 1], by the power 2.2 (as Babylon.js) */
  int32_t reject_nan;              /* 1: a NaN returns WELKIN_REJECTED_PIXEL; 0: it is replaced by 0 */
  int32_t reject_infinity;         /* 1: rejects infinities; 0: +infinity becomes clamp_maximum or 65504, -infinity 0 */
  welkin_negative_policy negative; /* treatment of finite values below zero */
} welkin_pixel_policy;

/* Options of a projection. */
typedef struct welkin_projection_options {
  uint32_t struct_size;
  int32_t bands;       /* 1 to WELKIN_MAXIMUM_BANDS; 0: 3 */
  int32_t midpoint;    /* 1: texels as points at their centres, as in Babylon.js; 0: texels as areas, exact */
  int32_t target_size; /* texels per edge of the cubemap to which the source is reduced first; 0: not reduced */
  const welkin_pixel_policy* pixels; /* null: the defaults */
} welkin_projection_options;

/* Harmonics of an environment, in the caller's memory. `struct_size` may end inside `coefficients` if all bands fit. */
typedef struct welkin_projection {
  uint32_t struct_size;
  int32_t bands;                                                   /* bands in `coefficients` */
  uint64_t texels;                                                 /* texels that were read */
  uint64_t nans_replaced, infinities_replaced, negatives_replaced; /* channel values */
  uint64_t texels_clamped;                                         /* texels that the clamp changed */
  double total_radiance_before_clamp[3]; /* integral of radiance over the sphere, before the clamp */
  double total_radiance[3];              /* integral of radiance over the sphere as projected */
  double error_estimate;                 /* estimated relative error of the coefficients */
  double coefficients[3 * WELKIN_MAXIMUM_BANDS * WELKIN_MAXIMUM_BANDS]; /* radiance; unused ones are 0 */
} welkin_projection;

/* Projects an environment. `mips` is the full size, followed by `mip_count - 1` mips of a cubemap (15 at most in all),
 * each half the size of the one before, all of one format and one `struct_size`. Only `target_size` uses the mips. */
WELKIN_CALL welkin_project(const welkin_environment* mips, int32_t mip_count, const welkin_projection_options* options,
                           const welkin_control* control, welkin_projection* projection);

/* Projects `probe_count` cubemaps, all of one `struct_size`. `coefficients` receives 3 bands^2 doubles per probe,
 * `totals` (may be null) sums over all, the largest error estimate, and no bands. Errors name the probe's index. */
WELKIN_CALL welkin_project_many(const welkin_environment* probes, int64_t probe_count,
                                const welkin_projection_options* options, const welkin_control* control,
                                double* coefficients, welkin_projection* totals);

/* Projects a file. A lat-long is projected while it is decoded. */
WELKIN_CALL welkin_project_file(const char* path, const welkin_read_options* read_options,
                                const welkin_projection_options* options, const welkin_control* control,
                                welkin_projection* projection);

/* ---- Harmonics: 3 bands^2 doubles each. A result may overwrite its argument. ---- */

/* Computes irradiance: multiplies band l of radiance by pi, 2 pi/3, pi/4, 0, -pi/24, ... */
WELKIN_CALL welkin_irradiance_from_radiance(int32_t bands, const double* radiance, double* irradiance);

/* Evaluates coefficients at a direction: `value` receives r, g, b. */
WELKIN_CALL welkin_evaluate(int32_t bands, const double* coefficients, const double* direction, double* value);

/* Rotates or mirrors light by a matrix, orthogonal to 1e-6: light from direction d then comes from matrix * d. */
WELKIN_CALL welkin_rotate(int32_t bands, const double* coefficients, const double* matrix, double* rotated);

/* Windows against ringing: the factor of band l. With w = pi l / width, HANNING is (1 + cos w) / 2 and LANCZOS sin(w) /
 * w, both 0 from l = width on. MIN_LAPLACIAN is 1 / (1 + c l^2 (l + 1)^2) c the least without negative irradiance. */
typedef int32_t welkin_window;
enum { WELKIN_WINDOW_NONE = 0, WELKIN_WINDOW_HANNING = 1, WELKIN_WINDOW_LANCZOS = 2, WELKIN_WINDOW_MIN_LAPLACIAN = 3 };

/* Multiplies each band of radiance by the window's factor. `width` is for HANNING and LANCZOS; 0: `bands`. */
WELKIN_CALL welkin_apply_window(int32_t bands, const double* radiance, welkin_window window, double width,
                                double* windowed);

/* Computes the factor that scales the mean radiance to middle grey, luminance 0.18; 1 if the mean is not above 0. */
WELKIN_CALL welkin_exposure_of(int32_t bands, const double* radiance, double* exposure);

/* Finds the directional light that best approximates an environment: `direction` towards it, `irradiance` on a surface
 * facing it, and 1 in `found`; zeros if the light has no direction. */
WELKIN_CALL welkin_dominant_light(int32_t bands, const double* radiance, double* direction, double* irradiance,
                                  int32_t* found);

/* Computes the radiance of a sun as harmonics, to be added to those of its sky: a disc of `solid_angle` steradians with
 * that irradiance, or a directional light if `solid_angle` is 0. */
WELKIN_CALL welkin_sun_harmonics(const double* direction, const double* irradiance, double solid_angle, int32_t bands,
                                 double* coefficients);

/* ---- Engines ---- */

/* Engines and formats with known conventions. */
typedef int32_t welkin_engine; /* clang-format off */
enum { WELKIN_ENGINE_WELKIN, WELKIN_ENGINE_OPENEXR, WELKIN_ENGINE_BABYLON, WELKIN_ENGINE_THREE, WELKIN_ENGINE_FILAMENT,
       WELKIN_ENGINE_GLTF, WELKIN_ENGINE_UNITY, WELKIN_ENGINE_UNREAL, WELKIN_ENGINE_BLENDER, WELKIN_ENGINE_GODOT,
       WELKIN_ENGINE_BEVY, WELKIN_ENGINE_USD, WELKIN_ENGINE_PLAYCANVAS, WELKIN_ENGINE_QT };
/* clang-format on */

/* Returns an engine's axes as matrices. `from_welkin` takes a direction in Welkin's axes to the engine's (a mirror for
 * left-handed engines). `faces_from_engine` takes a direction in the engine's axes to the axes of cubemap faces; zeros
 * for engines without cubemaps of their own. docs/reference/engines.md describes all conventions. */
WELKIN_CALL welkin_get_axes(welkin_engine engine, double* from_welkin, double* faces_from_engine);

/* Light in an engine's own form; docs/reference/engines.md has the formulas. */
typedef struct welkin_engine_light {
  uint32_t struct_size;
  welkin_engine engine; /* engine whose form it is */
  int32_t term_count;   /* 9 */
  int32_t vector_count; /* 7 for Unity and Unreal, else 0 */
  double terms[9][3];   /* Babylon.js: SphericalPolynomial's x y z xx yy zz yz zx xy; others: index l (l + 1) + m */
  double vectors[7][4]; /* as shaders read them: SHAr SHAg SHAb SHBr SHBg SHBb SHC */
} welkin_engine_light;

/* Converts radiance to an engine's form, rotated to the engine's axes unless `in_place` is 1. Bands above the third are
 * dropped. Returns WELKIN_INVALID_ARGUMENT for OpenEXR, Blender, Bevy and OpenUSD, which have no form. */
WELKIN_CALL welkin_engine_light_from_radiance(int32_t bands, const double* radiance, welkin_engine engine,
                                              int32_t in_place, welkin_engine_light* light);

/* ---- Results in the caller's memory ---- */

/* Memory for one level of a cubemap, or for a flat image. It may be an upload buffer, since each texel is written once
 * and never read. Formats: RG, RGB and RGBA, F32 and F16; bakes write RGBA only. Half floats are rounded to nearest;
 * values above 65504 become 65504, and NaN becomes 0. Targets are checked before any work is done. */
typedef struct welkin_target {
  uint32_t struct_size;
  welkin_format format;     /* format of all texels */
  int64_t row_stride_bytes; /* distance between rows, at least one row; 0: packed rows; negative: bottom-up */
  void* faces[6];           /* first texel of each face's top row, aligned to its channels; flat image: faces[0] only */
  int64_t size;             /* texels per edge of a cubemap; 0: a flat image */
  int32_t width, height;    /* texels of a flat image; else 0 */
} welkin_target;

/* Sizes of a chain. */
typedef struct welkin_chain_info {
  uint32_t struct_size;
  int32_t size;        /* texels per edge of level 0 */
  int32_t levels;      /* number of levels */
  int32_t prefiltered; /* 1: each level has a roughness, see `welkin_chain_get_mip` */
} welkin_chain_info;

/* Creates another handle to the same pixels. */
WELKIN_CALL welkin_chain_share(const welkin_chain* chain, welkin_chain** another);
/* Returns the sizes of a chain. */
WELKIN_CALL welkin_chain_get_info(const welkin_chain* chain, welkin_chain_info* info);
/* Returns the pixels of a level in place: packed RGB_F32, valid while the chain is held. */
WELKIN_CALL welkin_chain_get_level(const welkin_chain* chain, int32_t level, welkin_environment* pixels);
/* Writes a level to the caller's memory, on the calling thread. */
WELKIN_CALL welkin_chain_copy(const welkin_chain* chain, int32_t level, const welkin_target* target,
                              uint64_t* values_clamped);

/* ---- Reflections ---- */

/* How a mip is computed. AUTOMATIC: for each mip, the fastest method that meets both bounds. SPECTRAL: by harmonics,
 * with the brightest texels convolved one by one. REFERENCE: by the integral, texel by texel (slow). Results may also
 * be COPY (roughness 0) or NEAR_FAR (nearby texels as areas, the lobe's tail by harmonics). */
typedef int32_t welkin_prefilter_method; /* clang-format off */
enum { WELKIN_PREFILTER_AUTOMATIC = 0, WELKIN_PREFILTER_SPECTRAL = 1, WELKIN_PREFILTER_REFERENCE = 2,
       WELKIN_PREFILTER_COPY = 4, WELKIN_PREFILTER_NEAR_FAR = 5 }; /* clang-format on */

/* Mappings from mips to roughness, with t = mip / (mips - 1), and the size of the last mip. */
typedef int32_t welkin_roughness_schedule;
enum {
  WELKIN_ROUGHNESS_DEFAULT = 0,  /* FILAMENT; for CHARLIE as in glTF's sample renderer */
  WELKIN_ROUGHNESS_LINEAR = 1,   /* t; down to 4 texels, but at least five mips where `size` has five */
  WELKIN_ROUGHNESS_FILAMENT = 2, /* 1 - sqrt(1 - t), also three.js; mips as LINEAR */
  WELKIN_ROUGHNESS_BABYLON = 3,  /* 0 at mip 0, else sqrt(2^(mip / 0.8) / size), at most 1; down to 1 texel */
  WELKIN_ROUGHNESS_UNITY = 4,    /* r with mip = 6 r (1.7 - 0.7 r); by default at most seven mips */
  WELKIN_ROUGHNESS_UNREAL = 5    /* 0 at mip 0, else 2^((mip - (mips - 1) + 2) / 1.2), at most 1; down to 1 texel */
};

/* Lobes of a chain, by the roughness r of each mip; docs/maths/reflections.md has their formulas. */
typedef int32_t welkin_lobe_family;
enum {
  WELKIN_LOBE_FAMILY_GGX = 0,
  WELKIN_LOBE_FAMILY_CHARLIE = 1, /* sheen; r is clamped to 0.05 or more */
  WELKIN_LOBE_FAMILY_LAMBERT = 2, /* irradiance over pi, at any r; one mip unless `mips` is set */
  WELKIN_LOBE_FAMILY_PHONG = 3,   /* power max(1, 2 / r^4 - 2); r is clamped to 0.12 or more */
  WELKIN_LOBE_FAMILY_BLINN = 4,   /* power 2 / r^4 - 2; r is clamped to 0.12 or more */
  WELKIN_LOBE_FAMILY_SPECTRA = 5  /* factors in `spectra` */
};

/* Accuracy of reflections and irradiance: rms_error 1e-3, 1e-2, or the integrals in double (minutes). */
typedef int32_t welkin_quality;
enum { WELKIN_QUALITY_NORMAL = 0, WELKIN_QUALITY_FAST = 1, WELKIN_QUALITY_REFERENCE = 2 };

/* Size, lobes and error bounds of a specular chain. Arrays are copied. */
typedef struct welkin_prefilter_options {
  uint32_t struct_size;
  int32_t size;                       /* texels per edge of mip 0, 1 to 8192; 0: 256, for skies 32 */
  int32_t mips;                       /* 0: `roughness_count`, else the schedule's; for LAMBERT and SPECTRA 1 */
  int32_t roughness_count;            /* length of `roughness`; 0: the schedule's */
  const double* roughness;            /* perceptual roughness of each mip, 0 to 1 */
  welkin_prefilter_method method;     /* method of all mips */
  double rms_error;                   /* bound on a mip's relative root mean square error; 0: by `quality` */
  double maximum_error;               /* bound on the relative error at any texel; 0: ten times rms_error, at most 1 */
  const welkin_pixel_policy* pixels;  /* null: the defaults; must be null in a bake and for a sky */
  welkin_lobe_family lobe;            /* lobes of all mips */
  int32_t spectrum_bands;             /* SPECTRA only: numbers per mip, 1 to 1536 */
  const double* spectra;              /* SPECTRA only: mips times spectrum_bands factors of degrees 0, 1, ... */
  welkin_quality quality;             /* method and bounds; ignored if `rms_error` is not 0 */
  const double* lobe_roughness;       /* roughness of each mip's lobe, `roughness_count` numbers; null: `roughness` */
  welkin_roughness_schedule schedule; /* used if `roughness` is null */
  int32_t fitted;                     /* 1: fits the schedule's lobes to lookups between mips */
} welkin_prefilter_options;

/* Roughness, method and estimated errors of one mip. */
typedef struct welkin_mip {
  uint32_t struct_size;
  int32_t size;                   /* texels per edge */
  double roughness;               /* perceptual roughness at which a shader looks the mip up */
  welkin_prefilter_method method; /* never AUTOMATIC */
  int32_t bands;                  /* harmonic bands used (SPECTRAL, NEAR_FAR) */
  int32_t bright_texels;          /* texels convolved one by one */
  double error_estimate;          /* predicted rms error relative to the mip's rms; NaN: unknown */
  double mean[3];                 /* mean of the texels by solid angle */
  double lobe_roughness;          /* perceptual roughness of the mip's lobe */
  double error_between;           /* predicted rms error of trilinear lookups up to the next mip; NaN: unknown */
} welkin_mip;

/* Returns the record of a mip of a prefiltered chain. */
WELKIN_CALL welkin_chain_get_mip(const welkin_chain* chain, int32_t level, welkin_mip* mip);

/* Prefilters an environment for specular reflections (GGX, split sum), one roughness per mip. */
WELKIN_CALL welkin_prefilter(const welkin_environment* environment, const welkin_prefilter_options* options,
                             const welkin_control* control, welkin_chain** chain);

/* Size and contents of a BRDF table: E = f0 scale + bias is the reflectance in a uniform environment. */
typedef struct welkin_brdf_options {
  uint32_t struct_size;
  int32_t width, height;       /* along N.V and along perceptual roughness, 1 to 4096; 0: 64 */
  int32_t multiple_scattering; /* 1: bias and scale + bias: E = (1 - f0) red + f0 green; 0: scale and bias */
  int32_t without_sheen;       /* 1: the third channel is 0; 0: it is the albedo of sheen */
} welkin_brdf_options;

/* Writes the table to a flat target of the options' size; row 0 has the lowest roughness. Recent tables are cached. */
WELKIN_CALL welkin_brdf_table(const welkin_brdf_options* options, const welkin_control* control,
                              const welkin_target* target, uint64_t* values_clamped);

/* Evaluates irradiance coefficients at each texel's centre of a cubemap target of 1 to 4096 texels per edge. */
WELKIN_CALL welkin_irradiance_cubemap(int32_t bands, const double* irradiance, const welkin_control* control,
                                      const welkin_target* target, uint64_t* values_clamped);

/* ---- Bake: complete image-based lighting in one call ---- */

/* Parts of a bake, as flags: a sharp cubemap with mips, the specular cubemap, an irradiance cubemap, harmonics of
 * radiance, the BRDF table, and the specular cubemap as an octahedral map (only if `octahedral_size` is set). */
typedef uint32_t welkin_parts; /* clang-format off */
enum { WELKIN_PART_BACKGROUND = 1, WELKIN_PART_SPECULAR = 2, WELKIN_PART_IRRADIANCE = 4, WELKIN_PART_HARMONICS = 8,
       WELKIN_PART_BRDF = 16, WELKIN_PART_OCTAHEDRAL = 32 }; /* clang-format on */

/* How an irradiance cubemap is computed. AUTOMATIC: within `irradiance_rms_error` of the integral over the source's
 * texels. DIRECT: as that integral (slow). HARMONICS: from `bands` of harmonics, as shaders do. */
typedef int32_t welkin_irradiance_method;
enum { WELKIN_IRRADIANCE_AUTOMATIC = 0, WELKIN_IRRADIANCE_DIRECT = 1, WELKIN_IRRADIANCE_HARMONICS = 2 };

/* Parts, sizes and bounds of a bake. */
typedef struct welkin_bake_options {
  uint32_t struct_size;
  welkin_parts leave_out;                     /* parts not to make; 0: makes all */
  int32_t background_size;                    /* 0: the specular cubemap's; without one the source's */
  int32_t background_without_mips;            /* 1: level 0 only */
  int32_t background_box_filter;              /* 1: mips by plain means, as in graphics APIs; 0: means by solid angle */
  int32_t irradiance_size;                    /* 0: 64 */
  welkin_irradiance_method irradiance_method; /* method of the irradiance cubemap */
  int32_t bands;                              /* bands of harmonics; 0: 3 */
  const welkin_prefilter_options* specular;   /* null: the defaults */
  const welkin_brdf_options* brdf;            /* null: the defaults */
  const welkin_pixel_policy* pixels;          /* for all parts; null: the defaults */
  uint64_t memory_limit_bytes;                /* results and working memory together; 0: 8 GiB */
  double irradiance_rms_error;                /* bound of the automatic method, 1e-6 to 1; 0: by `quality` */
  int32_t octahedral_size;                    /* texels per edge, including borders; 0: no map */
  int32_t octahedral_levels;                  /* 0: 1. Size and border must be multiples of 2^(levels - 1) */
  int32_t octahedral_border;                  /* texels on each side of level 0; 0: 2^(octahedral_levels - 1) */
  welkin_quality quality;                     /* for irradiance, and for reflections whose own quality is normal */
} welkin_bake_options;

/* Parts of a result and their sizes. */
typedef struct welkin_bake_info {
  uint32_t struct_size;
  welkin_parts parts;               /* parts in the result */
  int32_t bands;                    /* 0 without harmonics */
  uint64_t peak_bytes;              /* bound on results and working memory together */
  double irradiance_error_estimate; /* predicted rms error of irradiance relative to its rms; NaN: unknown */
  int32_t octahedral_size, octahedral_levels, octahedral_border; /* 0 without a map; at most as many levels as mips */
  uint64_t values_clamped; /* channel values that the formats of `welkin_bake_targets` could not hold */
} welkin_bake_info;

/* Bakes an environment. */
WELKIN_CALL welkin_bake(const welkin_environment* environment, const welkin_bake_options* options,
                        const welkin_control* control, welkin_bake_result** result);
/* Reads and bakes a file. */
WELKIN_CALL welkin_bake_file(const char* path, const welkin_read_options* read_options,
                             const welkin_bake_options* options, const welkin_control* control,
                             welkin_bake_result** result);

/* Bakes specular chains and harmonics of many cubemaps into the caller's memory. `probes`, `coefficients` (null with 0
 * bands) and `totals` are as in `welkin_project_many`. `targets` has one element per mip, probe by probe. After errors
 * other than WELKIN_INVALID_ARGUMENT, any targets may be written. */
WELKIN_CALL welkin_bake_many(const welkin_environment* probes, int64_t probe_count,
                             const welkin_prefilter_options* options, const welkin_control* control,
                             const welkin_target* targets, int64_t target_count, int32_t bands, double* coefficients,
                             welkin_projection* totals, uint64_t* values_clamped);

/* Returns the parts and sizes of a result. */
WELKIN_CALL welkin_bake_result_get_info(const welkin_bake_result* result, welkin_bake_info* info);
/* Returns the background, specular or irradiance cubemap, valid while the result is held (`welkin_chain_share` keeps it
 * longer). Null if that part was not made, and for other parts. */
WELKIN_API const welkin_chain* welkin_bake_result_chain(const welkin_bake_result* result, welkin_parts part);

/* Returns harmonics of radiance, and counts of values read, replaced and clamped. */
WELKIN_CALL welkin_bake_result_get_projection(const welkin_bake_result* result, welkin_projection* projection);

/* Writes a level of the octahedral map to a flat target of octahedral_size >> level texels. */
WELKIN_CALL welkin_bake_result_copy_octahedral(const welkin_bake_result* result, int32_t level,
                                               const welkin_target* target, uint64_t* values_clamped);
/* Writes the BRDF table to a flat target. */
WELKIN_CALL welkin_bake_result_copy_brdf(const welkin_bake_result* result, const welkin_target* target,
                                         uint64_t* values_clamped);

/* ---- Probe grids (docs/guides/probe_grids.md) ----
 * Depths: per probe, the six faces of its distances one after the other, `depth_size` texels per edge, without padding;
 * negative: the back of a surface; infinity: the environment. */

/* Positions of probes. Probe (i, j, k) along x, y and z has the index i + counts[0] (j + counts[1] k). */
typedef struct welkin_probe_grid {
  uint32_t struct_size;
  int32_t counts[3]; /* 1 to 2048 each, at most 2^24 in total */
  double origin[3];  /* position of probe 0 */
  double spacing[3]; /* above 0 */
} welkin_probe_grid;

/* Options of a bake of probes. */
typedef struct welkin_probe_options {
  uint32_t struct_size;
  int32_t bands;                  /* 1 to 4; 0: 3 */
  int32_t distance_size;          /* texels per edge of the distance maps, 1 to 64; 0: 8; -1: none */
  int32_t dilation_passes;        /* 0: 4; -1: none */
  int32_t environment_bands;      /* bands of environments for `welkin_probes_relight`; 0: none */
  double near_share, valid_share; /* 0: 0.1 and 0.75 */
} welkin_probe_options;

/* Bakes a grid from one cubemap per probe. `depths` may be null. */
WELKIN_CALL welkin_probes_bake(const welkin_probe_grid* grid, const welkin_environment* cubes,
                               const float* const* depths, int32_t depth_size, const welkin_probe_options* options,
                               const welkin_control* control, welkin_probes** probes);

/* Computes where probes should be captured instead, so that none lies in a wall: three doubles per probe in `offsets`,
 * which holds those of the depths' captures before (zeros for none). */
WELKIN_CALL welkin_probes_relocate(const welkin_probe_grid* grid, const float* const* depths, int32_t depth_size,
                                   double* offsets);

/* Sets the offsets at which probes were captured: three doubles per probe; null: none. */
WELKIN_CALL welkin_probes_set_offsets(welkin_probes* probes, const double* offsets);

/* Changes probes to another environment: 3 bands^2 doubles of radiance each. */
WELKIN_CALL welkin_probes_relight(welkin_probes* probes, int32_t bands, const double* from, const double* to);

/* Computes irradiance at `count` positions with unit normals (x, y, z each); `irradiance` receives r, g, b of each. */
WELKIN_CALL welkin_probes_irradiance(const welkin_probes* probes, const double* positions, const double* normals,
                                     size_t count, double* irradiance);

/* Returns the coefficients of radiance: `count` doubles, 3 bands^2 per probe, valid until the probes are changed. */
WELKIN_CALL welkin_probes_coefficients(const welkin_probes* probes, const double** coefficients, size_t* count);

/* Packs texture `index` of a layout: "three", "unity-l2", "unity-l1", "plain", "bevy" or "rtxgi". `size` receives
 * texels along x, y and z; `halves` (may be null) four half floats per texel, if `half_count` suffices. */
WELKIN_CALL welkin_probes_pack(const welkin_probes* probes, const char* layout, int32_t index, int32_t* size,
                               uint16_t* halves, size_t half_count);

/* Writes probes as PATH.json and its files, with textures of layouts separated by commas (may be null). */
WELKIN_CALL welkin_probes_write(const welkin_probes* probes, const char* path, const char* layouts);
/* Reads probes that welkin_probes_write wrote. */
WELKIN_CALL welkin_probes_read(const char* path, welkin_probes** probes);

/* ---- Sky ----
 * y is up; a sun's azimuth is measured from +z towards +x, its elevation from the horizon upwards. `sun` is a direction
 * towards it. docs/guides/moving_sky.md describes what is computed. */

/* Atmospheres to start from. EARTH has clear air as measured, HAZY three times its aerosol, DUSTY desert dust, POLLUTED
 * the air near cities. HILLAIRE is Earth as in Hillaire 2020; BRUNETON is Earth as in Bruneton 2017, almost without
 * aerosol. BARE has Earth's size, but no air and no light. */
typedef int32_t welkin_planet; /* clang-format off */
enum { WELKIN_PLANET_EARTH = 0, WELKIN_PLANET_EARTH_HILLAIRE = 1, WELKIN_PLANET_MARS = 2, WELKIN_PLANET_BARE = 3,
       WELKIN_PLANET_EARTH_BRUNETON = 4, WELKIN_PLANET_EARTH_HAZY = 5, WELKIN_PLANET_EARTH_DUSTY = 6,
       WELKIN_PLANET_EARTH_POLLUTED = 7 }; /* clang-format on */

/* A constituent of the air: its density over altitude, and its coefficients where the density is 1. */
typedef struct welkin_constituent {
  uint32_t struct_size;
  int32_t layer_count; /* at most 8; 0: the constituent is absent */
  /* Five doubles per layer, from the ground up: its thickness, and a, b, c, d. All in metres: relative density at
   * altitude h is a exp(b h) + c h + d, clamped to [0, 1]. */
  const double* layers;
  const double* scattering_per_m; /* one per wavelength; null: none */
  const double* absorption_per_m; /* one per wavelength; null: none */
} welkin_constituent;

/* Phase function of the aerosol. */
typedef int32_t welkin_aerosol_phase;
enum { WELKIN_PHASE_DEFAULT = 0, WELKIN_PHASE_CORNETTE_SHANKS = 1, WELKIN_PHASE_HENYEY_GREENSTEIN = 2 };

/* A planet's air, ground and sun. Zero or null keeps the value of `planet`. Arrays: one value per wavelength. */
typedef struct welkin_atmosphere {
  uint32_t struct_size;
  welkin_planet planet;     /* planet to start from */
  int32_t wavelength_count; /* 3, or 3 to 96 with `linear_srgb`; 0: the planet's wavelengths (Earth: 680, 550, 440) */
  int32_t absorber_count;   /* number of `absorbers`; 0: the planet's absorbers; -1: none */
  /* in nm, increasing or decreasing. EARTH, HAZY, DUSTY and POLLUTED exist at any from 360 to 830 nm. For other
   * planets, set all arrays too. */
  const double* wavelengths_nm;
  const welkin_constituent* rayleigh; /* molecules */
  const welkin_constituent* aerosol;  /* particles */
  /* four numbers that replace `aerosol`: optical depth at 550 nm (0 to 100), Angstrom exponent (-4 to 8), single
   * scattering albedo (0 to 1) and asymmetry (-0.8 to 0.999). The scale height is 1200 m. */
  const double* aerosol_optics;
  welkin_aerosol_phase aerosol_phase;     /* phase function of the particles */
  double aerosol_asymmetry;               /* g of its phase function, -0.8 to 0.999 */
  const double* aerosol_asymmetries;      /* g per wavelength */
  const welkin_constituent* absorbers[4]; /* absorbers such as ozone */
  double bottom_radius_m;                 /* radius of the ground, 1 to 1e9 */
  double top_radius_m;                    /* radius of the top of the air, above the ground's, at most 11 times it */
  const double* ground_albedo;            /* 0 to 1 */
  const double* sun_irradiance;           /* above the air, on a surface facing the sun, W/m2/nm */
  double sun_angular_radius_degrees;      /* radius of the disc */
  double night_zenith_luminance; /* airglow and stars seen from the ground, up to 1 cd/m2; a dark site has 2e-4 */
} welkin_atmosphere;

/* Computes the unit direction towards a sun. */
WELKIN_CALL welkin_sun_direction(double elevation_degrees, double azimuth_degrees, double* direction);

/* Computes the sun's position, 1900 to 2099, at a date such as "2026-06-21T20:30:15+02:00" and a place (degrees,
 * positive in the north and the east). North is -z and east +x. `refraction` 1 raises the sun by that of 1010 hPa and
 * 10 degrees Celsius. `direction` (may be null) receives three numbers. */
WELKIN_CALL welkin_sun_position(const char* date, double latitude, double longitude, int32_t refraction,
                                double* elevation_degrees, double* azimuth_degrees, double* direction);

/* Sizes of the tables, and orders of scattering. */
typedef struct welkin_sky_table_options {
  uint32_t struct_size;
  int32_t compact;      /* 1: omits the azimuth between view and sun; only phase functions then depend on it */
  int32_t heights;      /* 2 to 128; 0: 32 */
  int32_t view_zeniths; /* even, 4 to 1024; 0: 64 */
  int32_t sun_zeniths;  /* 4 to 256; 0: 64 */
  int32_t sun_angles;   /* 2 to 128, not with `compact`; 0: 8 */
  int32_t transmittance_heights, transmittance_zeniths; /* 2 to 1024 and to 2048; 0: 64 and 256 */
  int32_t irradiance_heights, irradiance_sun_zeniths;   /* 2 to 1024; 0: 16 and 64 */
  int32_t orders;                                       /* orders of scattering, 1 to 64; 0: 4 */
  int32_t linear_srgb;                                  /* 1: channels are cd/m2; 0: W/m2/sr/nm at three wavelengths */
  double minimum_sun_elevation_degrees;                 /* lowest sun in the tables, -90 to below 0; 0: -30 */
  double convergence_threshold; /* stops early after an order that adds less than this fraction; 0: never */
  uint64_t memory_limit_bytes;  /* 0: 4 GiB */
  int32_t truncate_orders;      /* not 0: omits orders beyond `orders`; 0: estimates them */
} welkin_sky_table_options;

/* Computes scattering tables: 2 to 3 s of CPU time with the defaults. */
WELKIN_CALL welkin_sky_tables_create(const welkin_atmosphere* atmosphere, const welkin_sky_table_options* options,
                                     const welkin_control* control, welkin_sky_tables** tables);

/* Saves tables with all their parameters. Loading restores the same bits. */
WELKIN_CALL welkin_sky_tables_save(const welkin_sky_tables* tables, const char* path);
/* Loads saved tables. `memory_limit_bytes` 0: 4 GiB. */
WELKIN_CALL welkin_sky_tables_load(const char* path, uint64_t memory_limit_bytes, welkin_sky_tables** tables);

/* Creates a view from 0 to 1e9 m, in 2 ms. `without_ground` 1: rays that hit the ground see only air in front of it. */
WELKIN_CALL welkin_sky_view_create(const welkin_sky_tables* tables, double altitude_m, int32_t without_ground,
                                   welkin_sky_view** view);

/* Computes radiance without the sun's disc from `count` directions (x, y, z each); `rgb` receives r, g, b of each. */
WELKIN_CALL welkin_sky_view_radiance(const welkin_sky_view* view, const float* directions, size_t count,
                                     const double* sun, float* rgb);

/* Computes the sun as a directional light: irradiance on a surface facing it, and solid angle in steradians. */
WELKIN_CALL welkin_sky_view_sun(const welkin_sky_view* view, const double* sun, double* irradiance,
                                double* solid_angle);

/* Writes an image of the sky: a cubemap, or a lat-long if the target is flat, whose width must be twice its height.
 * `sun_disc` 1 includes the sun's disc, by the area of texels that it covers. */
WELKIN_CALL welkin_sky_view_image(const welkin_sky_view* view, const double* sun, int32_t sun_disc,
                                  const welkin_control* control, const welkin_target* target, uint64_t* values_clamped);

/* Prefilters an image of the sky for specular reflections. */
WELKIN_CALL welkin_sky_view_specular(const welkin_sky_view* view, const double* sun, int32_t sun_disc,
                                     const welkin_prefilter_options* options, const welkin_control* control,
                                     welkin_chain** chain);

/* Options of a sky projection. */
typedef struct welkin_sky_harmonics_options {
  uint32_t struct_size;
  int32_t bands;             /* 1 to WELKIN_MAXIMUM_BANDS; 0: 3 */
  int32_t zeniths, azimuths; /* 2 to 128 and to 256; 0: 32 */
  int32_t nodes;             /* sun elevations of the curve, 8 to 4096; 0: 256 */
} welkin_sky_harmonics_options;

/* Creates a curve, in milliseconds. */
WELKIN_CALL welkin_sky_curve_create(const welkin_sky_view* view, const welkin_sky_harmonics_options* options,
                                    const welkin_control* control, welkin_sky_curve** curve);

/* Computes radiance of sky and ground, without the sun's disc: `coefficients` receives 3 bands^2 doubles.
 * `sun_irradiance` (may be null) receives r, g, b of direct sunlight on a surface facing the sun. Takes 1 us. */
WELKIN_CALL welkin_sky_curve_at(const welkin_sky_curve* curve, const double* sun, double* coefficients,
                                double* sun_irradiance);

/* ---- Worker ---- */

/* Priority of a worker's threads relative to all other threads. BELOW_NORMAL, the default: a tenth of a normal thread's
 * CPU time when both compete. IDLE: only on otherwise idle processors. */
typedef int32_t welkin_thread_priority; /* clang-format off */
enum { WELKIN_THREAD_PRIORITY_DEFAULT = 0, WELKIN_THREAD_PRIORITY_BELOW_NORMAL = 1,
       WELKIN_THREAD_PRIORITY_NORMAL = 2, WELKIN_THREAD_PRIORITY_IDLE = 3 }; /* clang-format on */

/* A worker's threads and limits. */
typedef struct welkin_worker_options {
  uint32_t struct_size;
  int32_t threads; /* 1 to 1024; 0: one less than the process may use, at least 1 (with `enqueue`: all) */
  welkin_thread_priority thread_priority; /* priority of its own threads */
  const char* name;                       /* name of the threads; null: "welkin" */
  /* Null: the worker creates its own threads. Otherwise jobs run on the engine's threads: this function, called from
   * any number of threads at once, must arrange for `task(argument)` to be called exactly once, soon, on any thread. At
   * most `threads` tasks are outstanding. A task that is never called leaks memory, and its job waits forever. */
  void (*enqueue)(void* enqueue_user, void (*task)(void* argument), void* argument);
  void* enqueue_user; /* passed to `enqueue`, until the worker is terminated or destroyed; later tasks do nothing */
  uint64_t max_jobs;  /* jobs in flight, 0: 4096; a job posted at a limit completes with WELKIN_QUEUE_FULL */
  uint64_t max_bytes; /* bytes of their pixels in flight; 0: 4 GiB */
} welkin_worker_options;

/* Creates a worker. Returns WELKIN_INTERNAL if no thread can be created. */
WELKIN_CALL welkin_worker_create(const welkin_worker_options* options, welkin_worker** worker);

/* Terminates and destroys a worker. No other thread may use it any more; its jobs remain usable. Completed callbacks
 * that were not drained are never called; to receive them all, terminate, drain, then destroy. */
WELKIN_API void welkin_worker_destroy(welkin_worker* worker);

/* Cancels all jobs, waits until none runs (but not on a thread of the worker), and ends the threads. These jobs and
 * later posts complete with WELKIN_STOPPED; callbacks can still be drained. */
WELKIN_CALL welkin_worker_terminate(welkin_worker* worker);
/* Waits until no job waits or runs; callbacks may remain. Returns at once on a thread of the worker. */
WELKIN_CALL welkin_worker_wait_until_idle(welkin_worker* worker);
/* No time limit. */
#define WELKIN_NO_LIMIT UINT64_MAX
/* Calls the `completed` callbacks of completed jobs, on this thread, in the order of completion: at least one if there
 * is any, then until `budget_nanoseconds` are spent. `called` (may be null) receives their number. */
WELKIN_CALL welkin_worker_drain(welkin_worker* worker, uint64_t budget_nanoseconds, uint64_t* called);

/* ---- Posting ----
 * Posts return at once. `post` and `job` may be null; otherwise `*job` receives a handle, to be released with
 * `welkin_job_release`. Structures are copied. Null pointers, and sizes and enumeration values out of range, fail the
 * post; all other errors, including a worker's refusal, arrive through the job. */

/* Order of waiting jobs: higher priority first, then first come, first served. */
typedef int32_t welkin_priority;
enum { WELKIN_PRIORITY_LOW = -1, WELKIN_PRIORITY_NORMAL = 0, WELKIN_PRIORITY_HIGH = 1 };

/* Priority, key, ownership and callback of a post. */
typedef struct welkin_post_options {
  uint32_t struct_size;
  welkin_priority priority; /* position among waiting jobs */
  const char* key; /* replaces older jobs with the same key, which complete with WELKIN_REPLACED; null: no key */
  uint64_t bytes;  /* bytes to count against `max_bytes`; 0: those of its pixels */
  /* Null: the pixels (or the function's data) must stay valid until the job is ready. Otherwise the job owns them, and
   * calls `release(release_user)` once per call of a post function, on any thread: before a post returns that fails or
   * is about a file or a sky; else about when the job becomes ready, and before `welkin_worker_wait_until_idle`,
   * `..._terminate` and `..._destroy` return; for a job that never ran, before the call returns that cancelled or
   * refused it or terminated the worker (for a replaced job perhaps a moment later). It must not wait for the worker or
   * its jobs. It is not called if the post refuses `struct_size`. */
  void (*release)(void* release_user);
  void* release_user; /* passed to `release` */
  /* Null, or called inside `welkin_worker_drain` once the job has completed or failed: exactly once if the post
   * succeeds and the worker is drained to the end. `job` is valid during the call; `welkin_job_retain` keeps it. */
  void (*completed)(welkin_job* job, void* completed_user);
  void* completed_user; /* passed to `completed` */
} welkin_post_options;

/* Each posts the call of its name; the last two compute a curve, and reflections without the sun's disc. */
WELKIN_CALL welkin_post_project(welkin_worker* worker, const welkin_environment* mips, int32_t mip_count,
                                const welkin_projection_options* options, const welkin_post_options* post,
                                welkin_job** job);
WELKIN_CALL welkin_post_project_file(welkin_worker* worker, const char* path, const welkin_read_options* read_options,
                                     const welkin_projection_options* options, const welkin_post_options* post,
                                     welkin_job** job); /* a projection */
WELKIN_CALL welkin_post_prefilter(welkin_worker* worker, const welkin_environment* environment,
                                  const welkin_prefilter_options* options, const welkin_post_options* post,
                                  welkin_job** job); /* a chain */
WELKIN_CALL welkin_post_bake_file(welkin_worker* worker, const char* path, const welkin_read_options* read_options,
                                  const welkin_bake_options* options, const welkin_post_options* post,
                                  welkin_job** job); /* a bake */
WELKIN_CALL welkin_post_sky_tables(welkin_worker* worker, const welkin_atmosphere* atmosphere,
                                   const welkin_sky_table_options* options, const welkin_post_options* post,
                                   welkin_job** job); /* tables */
WELKIN_CALL welkin_post_sky_curve(welkin_worker* worker, const welkin_sky_tables* tables, double altitude_m,
                                  const welkin_sky_harmonics_options* options, const welkin_post_options* post,
                                  welkin_job** job); /* a curve */
WELKIN_CALL welkin_post_sky_specular(welkin_worker* worker, const welkin_sky_tables* tables, double altitude_m,
                                     const double* sun, const welkin_prefilter_options* options,
                                     const welkin_post_options* post, welkin_job** job); /* a chain */

/* Memory of the caller for the cubemaps of a bake: RGBA_F16 or RGBA_F32, the targets of one part all with one
 * `struct_size`. Parts without targets are in the result. */
typedef struct welkin_bake_targets {
  uint32_t struct_size;
  const welkin_target* background; /* one per level */
  int64_t background_count;        /* number of targets; 0: none */
  const welkin_target* specular;   /* one per mip */
  int64_t specular_count;          /* number of targets; 0: none */
  const welkin_target* irradiance; /* one; null: none */
} welkin_bake_targets;

/* Posts `welkin_bake`. If `targets` is not null, the worker's threads write the cubemaps there; that memory must stay
 * valid, and be no other running job's, until the job is ready (even if replaced), and `release` waits for the last
 * write. A job that fails may have written some texels, but none if it never started or its targets are refused. */
WELKIN_CALL welkin_post_bake(welkin_worker* worker, const welkin_environment* environment,
                             const welkin_bake_options* options, const welkin_bake_targets* targets,
                             const welkin_post_options* post, welkin_job** job);

/* Posts a function: `run(run_user, control)` is called once on a thread of the worker, or not at all if the job is
 * cancelled first. The status that it returns, any but WELKIN_NOT_READY, becomes the job's, with the message of a call
 * of this library that failed inside it with that status. Codes of your own start at 1000. The function should check
 * `welkin_control_stop_requested` once per millisecond. After `pthread_exit` the job completes with WELKIN_INTERNAL. */
WELKIN_CALL welkin_post_function(welkin_worker* worker,
                                 welkin_status (*run)(void* run_user, const welkin_control* control), void* run_user,
                                 const welkin_post_options* post, welkin_job** job);

/* Returns 1 if the job was cancelled: the function should then return, for instance WELKIN_CANCELLED. Else 0. */
WELKIN_API int32_t welkin_control_stop_requested(const welkin_control* control);
/* Reports the fraction of the work that is done, 0 to 1. Lower values than before are ignored. */
WELKIN_CALL welkin_control_report_progress(const welkin_control* control, double done);

/* ---- Jobs ----
 * Functions that return a result never wait, and may be called any number of times; all handles share the result. They
 * return the status of `welkin_job_poll`, or WELKIN_INVALID_ARGUMENT if the job makes something else. */

/* Returns a number that is unique in the process and increases in the order of posting; 0 for null. */
WELKIN_API uint64_t welkin_job_id(const welkin_job* job);
/* Returns WELKIN_NOT_READY while the job waits or runs, then WELKIN_OK or its error. `progress` (or null): 0 to 1. */
WELKIN_CALL welkin_job_poll(const welkin_job* job, double* progress);

/* Waits until the job is ready, but at most `timeout_nanoseconds`, and returns the status of `welkin_job_poll`. On a
 * thread of the worker, a wait with WELKIN_NO_LIMIT runs the job itself if that has not started. A request that waits
 * for its own job, directly or through other jobs, deadlocks. */
WELKIN_CALL welkin_job_wait(const welkin_job* job, uint64_t timeout_nanoseconds);

/* Returns the result: a copy of a projection, or a handle to a chain, a bake, sky tables or a sky curve. */
WELKIN_CALL welkin_job_projection(const welkin_job* job, welkin_projection* projection);
WELKIN_CALL welkin_job_get_chain(const welkin_job* job, welkin_chain** chain);            /* a chain */
WELKIN_CALL welkin_job_get_bake(const welkin_job* job, welkin_bake_result** result);      /* a bake */
WELKIN_CALL welkin_job_get_sky_tables(const welkin_job* job, welkin_sky_tables** tables); /* tables */
WELKIN_CALL welkin_job_get_sky_curve(const welkin_job* job, welkin_sky_curve** curve);    /* a curve */

/* Cancels the job; it completes with WELKIN_CANCELLED: at once if it waits, else before its next tile (a function: when
 * it returns). `cancelled` (may be null) receives 1 if this call cancelled it, else 0. */
WELKIN_CALL welkin_job_cancel(welkin_job* job, int32_t* cancelled);

/* Moves a waiting job to the end of the queue of that priority. */
WELKIN_CALL welkin_job_set_priority(welkin_job* job, welkin_priority priority);
/* Adds a reference. A job whose last reference is dropped still completes. */
WELKIN_API void welkin_job_retain(welkin_job* job);
WELKIN_API void welkin_job_release(welkin_job* job); /* drops a reference */

/* ---- The dynamic sky of an engine's loop ----
 * Posts to a worker, which must outlive it. New atmosphere: tables, a curve and reflections. New altitude: a curve and
 * reflections. New elevation of the sun: reflections. Rotating the sun about the vertical posts nothing. */

/* Options of a dynamic sky, with thresholds for recomputing. */
typedef struct welkin_sky_light_options {
  uint32_t struct_size;
  welkin_priority priority;                  /* priority of posted jobs */
  const welkin_sky_table_options* tables;    /* ignored if tables are given */
  const welkin_sky_harmonics_options* curve; /* includes the number of bands */
  const welkin_prefilter_options* specular;  /* options of the chain; null: the defaults */
  int32_t without_specular;                  /* 1: no reflections */
  double altitude_m;                         /* altitude of the observer above the ground */
  double sun_threshold_degrees;              /* smaller movements are ignored; 0: 0.01; negative: every change counts */
  double specular_threshold_degrees;         /* change of elevation between new reflections; 0: 0.5; negative: all */
  double altitude_threshold_m;               /* smaller changes are ignored; 0: 1; negative: every change counts */
  double blend_seconds;                      /* time to blend from old to new light; 0: 0.5; negative: at once */
} welkin_sky_light_options;

/* A prefiltered sky, with its weight and rotation for this frame. */
typedef struct welkin_sky_reflections {
  const welkin_chain* chain; /* valid until the next update; null: none yet */
  uint64_t id;               /* increases with each new chain; upload only if it changed; 0: none */
  double weight;             /* factor of its light */
  double rotation[9];        /* rotation, column-major: the light of d now comes from rotation * d */
} welkin_sky_reflections;

/* The light of a frame. `struct_size` may end inside `coefficients`. */
typedef struct welkin_sky_frame {
  uint32_t struct_size;
  int32_t ready;                         /* 0 until the first curve is available: all light is black */
  int32_t settled;                       /* 1: nothing is being computed or blended */
  int32_t bands;                         /* bands in `coefficients` */
  double sun_direction[3];               /* direction towards the sun */
  double sun_irradiance[3];              /* on a surface facing it, including intensity */
  double sun_solid_angle;                /* steradians */
  welkin_sky_reflections reflections[2]; /* newer and older; the weights add up to the intensity */
  /* radiance without the sun's disc, including intensity */
  double coefficients[3 * WELKIN_MAXIMUM_BANDS * WELKIN_MAXIMUM_BANDS];
} welkin_sky_frame;

/* Creates a dynamic sky, with the sun at the zenith. If `tables` is given, `atmosphere` is ignored and may be null, and
 * the tables' own options apply. If `tables` is null, the worker computes them. */
WELKIN_CALL welkin_sky_light_create(welkin_worker* worker, const welkin_atmosphere* atmosphere,
                                    const welkin_sky_tables* tables, const welkin_sky_light_options* options,
                                    welkin_sky_light** light);

/* Sets the sun's direction and the other parameters. Posts a request only if something must be computed. */
WELKIN_CALL welkin_sky_light_set_sun(welkin_sky_light* light, const double* sun);
WELKIN_CALL welkin_sky_light_set_intensity(welkin_sky_light* light, double intensity); /* 0 to 1e12 */
WELKIN_CALL welkin_sky_light_set_altitude(welkin_sky_light* light, double altitude_m); /* metres */
/* Sets the planet. */
WELKIN_CALL welkin_sky_light_set_atmosphere(welkin_sky_light* light, const welkin_atmosphere* atmosphere);

/* Collects finished results, advances blending, and writes the light of the frame. Never waits. Allocates only in a
 * frame in which new reflections have arrived, for their handle. `seconds` is the time since the last update. */
WELKIN_CALL welkin_sky_light_update(welkin_sky_light* light, double seconds, welkin_sky_frame* frame);

/* Returns WELKIN_OK, or the error of the last bake that failed. The light stays; the next change tries again. */
WELKIN_CALL welkin_sky_light_get_status(const welkin_sky_light* light);

/* ---- Files ----
 * Functions about files (`..._file`, `..._save`, `..._load` and those below) are not in welkin-core. They also return
 * WELKIN_FILE_ACCESS, WELKIN_CORRUPT_FILE and WELKIN_UNSUPPORTED_FILE. Files are written completely or not at all. */

/* Formats of written texels. Values out of range are clamped and counted; NaN becomes 0, except in RGBA32F. B10G11R11
 * has a precision of 1 part in 32 from 0 to 64512; E5B9G9R9 of 1 part in 512 of the largest channel from 0 to 65408.
 * OpenEXR holds the first two only; BC6H needs KTX2, KTX or DDS; ASTC (with astcenc) and UASTC HDR need KTX2. */
typedef int32_t welkin_texel_format; /* clang-format off */
enum { WELKIN_TEXEL_RGBA16F = 0, WELKIN_TEXEL_RGBA32F = 1, WELKIN_TEXEL_B10G11R11 = 2, WELKIN_TEXEL_E5B9G9R9 = 3,
       WELKIN_TEXEL_BC6H_UFLOAT = 4, WELKIN_TEXEL_BC6H_SFLOAT = 5,
       WELKIN_TEXEL_ASTC_4X4_HDR = 6, WELKIN_TEXEL_ASTC_6X6_HDR = 7, WELKIN_TEXEL_UASTC_HDR_4X4 = 8 }; /* clang-format on */

/* Search effort of encoders for blocks; docs/reference/textures.md has errors and times. DEFAULT: NORMAL. */
typedef int32_t welkin_effort; /* clang-format off */
enum { WELKIN_EFFORT_DEFAULT = 0, WELKIN_EFFORT_FASTEST = 1, WELKIN_EFFORT_FAST = 2,
       WELKIN_EFFORT_NORMAL = 3, WELKIN_EFFORT_SLOW = 4 }; /* clang-format on */

/* Compression of KTX2's levels. */
typedef int32_t welkin_supercompression;
enum { WELKIN_SUPERCOMPRESSION_NONE = 0, WELKIN_SUPERCOMPRESSION_ZLIB = 1, WELKIN_SUPERCOMPRESSION_ZSTD = 2 };

/* Options for writing textures. */
typedef struct welkin_texture_options {
  uint32_t struct_size;
  welkin_texel_format format;               /* format of all texels */
  welkin_supercompression supercompression; /* KTX2 only */
  welkin_effort effort;                     /* for the BC6H and ASTC formats */
} welkin_texture_options;

/* Writes a texture in the format that the extension names. `mips` is a cubemap with its mips, as in `welkin_project`
 * (.ktx2, .ktx, .dds or .exr), or a flat image of packed RGB_F32 of `width` x `height`, like BRDF tables (.ktx2, .dds).
 */
WELKIN_CALL welkin_write_texture(const char* path, const welkin_environment* mips, int32_t mip_count,
                                 const welkin_texture_options* options, const welkin_control* control,
                                 uint64_t* values_clamped);

/* Writes a chain. KTX2 and OpenEXR keep its roughness as metadata, which this library reads. */
WELKIN_CALL welkin_write_chain(const char* path, const welkin_chain* chain, const welkin_texture_options* options,
                               const welkin_control* control, uint64_t* values_clamped);

/* Writes Babylon.js's .env: a chain prefiltered with WELKIN_ROUGHNESS_BABYLON down to 1 texel, whose size is a power of
 * two, and the polynomial of the light. Both are given in Welkin's axes and are rotated to Babylon.js's. */
WELKIN_CALL welkin_write_babylon_environment(const char* path, const welkin_chain* specular, int32_t bands,
                                             const double* radiance, const welkin_control* control,
                                             uint64_t* values_clamped);

#ifdef __cplusplus
}
#endif

#endif
/* NOLINTEND(modernize-*) */
