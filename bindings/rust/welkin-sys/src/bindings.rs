
// Written by bindings/rust/generate. Do not edit.

pub const WELKIN_C_VERSION: u32 = 5;
pub const WELKIN_MAXIMUM_BANDS: u32 = 16;
extern "C" {
    #[doc = " Returns the library's own WELKIN_C_VERSION."]
    pub fn welkin_c_version() -> u32;
}
#[repr(C)]
#[derive(Debug, Copy, Clone)]
pub struct welkin_chain {
    _unused: [u8; 0],
}
#[repr(C)]
#[derive(Debug, Copy, Clone)]
pub struct welkin_bake_result {
    _unused: [u8; 0],
}
#[repr(C)]
#[derive(Debug, Copy, Clone)]
pub struct welkin_sky_tables {
    _unused: [u8; 0],
}
#[repr(C)]
#[derive(Debug, Copy, Clone)]
pub struct welkin_sky_view {
    _unused: [u8; 0],
}
#[repr(C)]
#[derive(Debug, Copy, Clone)]
pub struct welkin_sky_curve {
    _unused: [u8; 0],
}
#[repr(C)]
#[derive(Debug, Copy, Clone)]
pub struct welkin_sky_light {
    _unused: [u8; 0],
}
#[repr(C)]
#[derive(Debug, Copy, Clone)]
pub struct welkin_worker {
    _unused: [u8; 0],
}
#[repr(C)]
#[derive(Debug, Copy, Clone)]
pub struct welkin_job {
    _unused: [u8; 0],
}
#[repr(C)]
#[derive(Debug, Copy, Clone)]
pub struct welkin_probes {
    _unused: [u8; 0],
}
#[repr(C)]
#[derive(Debug, Copy, Clone)]
pub struct welkin_control {
    _unused: [u8; 0],
}
extern "C" {
    #[doc = " Destroys a handle without waiting. Data shared between handles is freed with the last of them."]
    pub fn welkin_chain_destroy(chain: *mut welkin_chain);
}
extern "C" {
    pub fn welkin_bake_result_destroy(result: *mut welkin_bake_result);
}
extern "C" {
    pub fn welkin_sky_tables_destroy(tables: *mut welkin_sky_tables);
}
extern "C" {
    pub fn welkin_sky_view_destroy(view: *mut welkin_sky_view);
}
extern "C" {
    pub fn welkin_sky_curve_destroy(curve: *mut welkin_sky_curve);
}
extern "C" {
    pub fn welkin_sky_light_destroy(light: *mut welkin_sky_light);
}
extern "C" {
    pub fn welkin_probes_destroy(probes: *mut welkin_probes);
}
#[doc = " Result of a call. Later versions may add values: treat unknown values as errors."]
pub type welkin_status = i32;
pub const WELKIN_OK: welkin_status = 0;
#[doc = " arguments that no call accepts, such as a null face or 17 bands"]
pub const WELKIN_INVALID_ARGUMENT: welkin_status = 1;
#[doc = " a texel that the options reject; the message names face, row and column"]
pub const WELKIN_REJECTED_PIXEL: welkin_status = 2;
#[doc = " a file that cannot be opened, read or written"]
pub const WELKIN_FILE_ACCESS: welkin_status = 3;
#[doc = " a file that violates its own format, or is truncated"]
pub const WELKIN_CORRUPT_FILE: welkin_status = 4;
#[doc = " a valid file of a kind that is not supported, or whose layout is ambiguous"]
pub const WELKIN_UNSUPPORTED_FILE: welkin_status = 5;
#[doc = " a memory limit is exceeded, or no method meets an error bound"]
pub const WELKIN_LIMIT_EXCEEDED: welkin_status = 6;
#[doc = " the caller cancelled"]
pub const WELKIN_CANCELLED: welkin_status = 7;
#[doc = " a newer job with the same key superseded this one"]
pub const WELKIN_REPLACED: welkin_status = 8;
#[doc = " the worker was at its limits and refused this job"]
pub const WELKIN_QUEUE_FULL: welkin_status = 9;
#[doc = " the worker was terminated before this job completed"]
pub const WELKIN_STOPPED: welkin_status = 10;
pub const WELKIN_OUT_OF_MEMORY: welkin_status = 100;
#[doc = " the job has not completed yet; not an error, no message"]
pub const WELKIN_NOT_READY: welkin_status = 101;
#[doc = " any other failure, such as a thread that cannot be created"]
pub const WELKIN_INTERNAL: welkin_status = 102;
extern "C" {
    #[doc = " Returns \"ok\", \"invalid_argument\", ...; \"unknown\" for other values. Never null."]
    pub fn welkin_status_name(status: welkin_status) -> *const ::std::os::raw::c_char;
}
extern "C" {
    #[doc = " Returns the message of the latest error on this thread: input, fault and remedy, until the next error. Never null."]
    pub fn welkin_last_error() -> *const ::std::os::raw::c_char;
}
extern "C" {
    #[doc = " Sets how many bytes of unused blocks the process keeps for later calls (default 128 MiB), and frees the rest."]
    pub fn welkin_keep_working_memory(bytes: u64);
}
extern "C" {
    #[doc = " Frees all blocks that no call uses."]
    pub fn welkin_release_working_memory();
}
#[doc = " The layout of a texel in memory: interleaved channels without padding. Alpha is ignored when read, and written as 1."]
#[doc = " F16 is IEEE 754 binary16. U8 maps 0..255 to 0..1; SRGB8 then applies sRGB's transfer function. RG is only written."]
pub type welkin_format = i32;
pub const WELKIN_FORMAT_RGB_F32: welkin_format = 0;
pub const WELKIN_FORMAT_RGBA_F32: welkin_format = 1;
pub const WELKIN_FORMAT_RGB_F16: welkin_format = 2;
pub const WELKIN_FORMAT_RGBA_F16: welkin_format = 3;
pub const WELKIN_FORMAT_RGB_U8: welkin_format = 4;
pub const WELKIN_FORMAT_RGBA_U8: welkin_format = 5;
pub const WELKIN_FORMAT_RGB_SRGB8: welkin_format = 6;
pub const WELKIN_FORMAT_RGBA_SRGB8: welkin_format = 7;
#[doc = " clang-format on"]
pub const WELKIN_FORMAT_RG_F32: welkin_format = 8;
#[doc = " clang-format on"]
pub const WELKIN_FORMAT_RG_F16: welkin_format = 9;
#[doc = " The caller's pixels, read in place: a cubemap or a lat-long. Cubemap: six square faces +X -X +Y -Y +Z -Z, top row"]
#[doc = " first. Their columns and rows run along -z -y, +z -y, +x +z, +x -z, +x -y and -x -y. Lat-long: an equirectangular"]
#[doc = " sphere, +z in the centre, +x a quarter of the width from the left edge, y up."]
#[repr(C)]
#[derive(Debug, Copy, Clone)]
pub struct welkin_environment {
    pub struct_size: u32,
    #[doc = " format of all texels"]
    pub format: welkin_format,
    #[doc = " distance between rows; 0: packed rows; negative: bottom-up"]
    pub row_stride_bytes: i64,
    #[doc = " first texel of each face, aligned to its channels; for a lat-long faces[0] only"]
    pub faces: [*const ::std::os::raw::c_void; 6usize],
    #[doc = " texels per edge of a cubemap, 1 to 16384; 0: a lat-long"]
    pub size: i64,
    #[doc = " texels of a lat-long, up to 65536 x 32768; else 0"]
    pub width: i32,
    #[doc = " texels of a lat-long, up to 65536 x 32768; else 0"]
    pub height: i32,
}
impl Default for welkin_environment {
    fn default() -> Self {
        let mut s = ::std::mem::MaybeUninit::<Self>::uninit();
        unsafe {
            ::std::ptr::write_bytes(s.as_mut_ptr(), 0, 1);
            s.assume_init()
        }
    }
}
#[doc = " The layout of a sphere in an image file, with faces of N x N texels."]
pub type welkin_layout = i32;
#[doc = " from the file's header, its shape or its name"]
pub const WELKIN_LAYOUT_AUTOMATIC: welkin_layout = 0;
pub const WELKIN_LAYOUT_LAT_LONG: welkin_layout = 1;
#[doc = " N x 6N: +X -X +Y -Y +Z -Z from top to bottom"]
pub const WELKIN_LAYOUT_VERTICAL_STRIP: welkin_layout = 2;
#[doc = " 6N x N: +X -X +Y -Y +Z -Z from left to right"]
pub const WELKIN_LAYOUT_HORIZONTAL_STRIP: welkin_layout = 3;
#[doc = " 4N x 3N: -X +Z +X -Z in the middle row, +Y above +Z, -Y below it"]
pub const WELKIN_LAYOUT_HORIZONTAL_CROSS: welkin_layout = 4;
#[doc = " 3N x 4N: +Y; -X +Z +X; -Y; and -Z below that, rotated by 180 degrees"]
pub const WELKIN_LAYOUT_VERTICAL_CROSS: welkin_layout = 5;
#[doc = " one image per face, identified by the ends of their names"]
pub const WELKIN_LAYOUT_SIX_FILES: welkin_layout = 6;
#[doc = " Encoding of values in a PNG. AUTOMATIC: sRGB, or linear where the file states a gamma of 1."]
pub type welkin_transfer = i32;
pub const WELKIN_TRANSFER_AUTOMATIC: welkin_transfer = 0;
pub const WELKIN_TRANSFER_SRGB: welkin_transfer = 1;
pub const WELKIN_TRANSFER_LINEAR: welkin_transfer = 2;
#[doc = " Options for reading a file. A part, layer, level or element that the file lacks returns WELKIN_UNSUPPORTED_FILE."]
#[repr(C)]
#[derive(Debug, Copy, Clone)]
pub struct welkin_read_options {
    pub struct_size: u32,
    #[doc = " layout of the sphere in the image"]
    pub layout: welkin_layout,
    #[doc = " part of an OpenEXR file: name, or index from 0; null: the first part with colour"]
    pub part: *const ::std::os::raw::c_char,
    #[doc = " layer of an OpenEXR file; null: the channels without a layer, else the only layer"]
    pub layer: *const ::std::os::raw::c_char,
    #[doc = " encoding of values in a PNG"]
    pub transfer: welkin_transfer,
    #[doc = " 1: values as stored; 0: converted to Rec. 709 where the file states other primaries"]
    pub primaries_as_stored: i32,
    #[doc = " limit for pixels; 0: 8 GiB"]
    pub memory_limit_bytes: u64,
    #[doc = " mip to read; 0 is the full size"]
    pub level: i64,
    #[doc = " index in an array of cubemaps or images (KTX2, KTX, DDS), from 0"]
    pub element: i64,
}
impl Default for welkin_read_options {
    fn default() -> Self {
        let mut s = ::std::mem::MaybeUninit::<Self>::uninit();
        unsafe {
            ::std::ptr::write_bytes(s.as_mut_ptr(), 0, 1);
            s.assume_init()
        }
    }
}
#[doc = " Treatment of finite values below zero. REPLACE: by 0. REJECT: WELKIN_REJECTED_PIXEL."]
pub type welkin_negative_policy = i32;
pub const WELKIN_NEGATIVE_KEEP: welkin_negative_policy = 0;
pub const WELKIN_NEGATIVE_REPLACE: welkin_negative_policy = 1;
pub const WELKIN_NEGATIVE_REJECT: welkin_negative_policy = 2;
#[doc = " Treatment of pixel values before they are used as radiance."]
#[repr(C)]
#[derive(Debug, Default, Copy, Clone)]
pub struct welkin_pixel_policy {
    pub struct_size: u32,
    #[doc = " maximum of radiance, above 0; 0: no clamp"]
    pub clamp_maximum: f32,
    #[doc = " 1: scales r, g and b by one factor; 0: clamps each to [0, maximum]"]
    pub clamp_preserve_colour: i32,
    #[doc = " 1: decodes channels, clamped to [0, 1], by the power 2.2 (as Babylon.js)"]
    pub gamma: i32,
    #[doc = " 1: a NaN returns WELKIN_REJECTED_PIXEL; 0: it is replaced by 0"]
    pub reject_nan: i32,
    #[doc = " 1: rejects infinities; 0: +infinity becomes clamp_maximum or 65504, -infinity 0"]
    pub reject_infinity: i32,
    #[doc = " treatment of finite values below zero"]
    pub negative: welkin_negative_policy,
}
#[doc = " Options of a projection."]
#[repr(C)]
#[derive(Debug, Copy, Clone)]
pub struct welkin_projection_options {
    pub struct_size: u32,
    #[doc = " 1 to WELKIN_MAXIMUM_BANDS; 0: 3"]
    pub bands: i32,
    #[doc = " 1: texels as points at their centres, as in Babylon.js; 0: texels as areas, exact"]
    pub midpoint: i32,
    #[doc = " texels per edge of the cubemap to which the source is reduced first; 0: not reduced"]
    pub target_size: i32,
    #[doc = " null: the defaults"]
    pub pixels: *const welkin_pixel_policy,
}
impl Default for welkin_projection_options {
    fn default() -> Self {
        let mut s = ::std::mem::MaybeUninit::<Self>::uninit();
        unsafe {
            ::std::ptr::write_bytes(s.as_mut_ptr(), 0, 1);
            s.assume_init()
        }
    }
}
#[doc = " Harmonics of an environment, in the caller's memory. `struct_size` may end inside `coefficients` if all bands fit."]
#[repr(C)]
#[derive(Debug, Copy, Clone)]
pub struct welkin_projection {
    pub struct_size: u32,
    #[doc = " bands in `coefficients`"]
    pub bands: i32,
    #[doc = " texels that were read"]
    pub texels: u64,
    #[doc = " channel values"]
    pub nans_replaced: u64,
    #[doc = " channel values"]
    pub infinities_replaced: u64,
    #[doc = " channel values"]
    pub negatives_replaced: u64,
    #[doc = " texels that the clamp changed"]
    pub texels_clamped: u64,
    #[doc = " integral of radiance over the sphere, before the clamp"]
    pub total_radiance_before_clamp: [f64; 3usize],
    #[doc = " integral of radiance over the sphere as projected"]
    pub total_radiance: [f64; 3usize],
    #[doc = " estimated relative error of the coefficients"]
    pub error_estimate: f64,
    #[doc = " radiance; unused ones are 0"]
    pub coefficients: [f64; 768usize],
}
impl Default for welkin_projection {
    fn default() -> Self {
        let mut s = ::std::mem::MaybeUninit::<Self>::uninit();
        unsafe {
            ::std::ptr::write_bytes(s.as_mut_ptr(), 0, 1);
            s.assume_init()
        }
    }
}
extern "C" {
    #[doc = " Projects an environment. `mips` is the full size, followed by `mip_count - 1` mips of a cubemap (15 at most in all),"]
    #[doc = " each half the size of the one before, all of one format and one `struct_size`. Only `target_size` uses the mips."]
    pub fn welkin_project(
        mips: *const welkin_environment,
        mip_count: i32,
        options: *const welkin_projection_options,
        control: *const welkin_control,
        projection: *mut welkin_projection,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Projects `probe_count` cubemaps, all of one `struct_size`. `coefficients` receives 3 bands^2 doubles per probe,"]
    #[doc = " `totals` (may be null) sums over all, the largest error estimate, and no bands. Errors name the probe's index."]
    pub fn welkin_project_many(
        probes: *const welkin_environment,
        probe_count: i64,
        options: *const welkin_projection_options,
        control: *const welkin_control,
        coefficients: *mut f64,
        totals: *mut welkin_projection,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Projects a file. A lat-long is projected while it is decoded."]
    pub fn welkin_project_file(
        path: *const ::std::os::raw::c_char,
        read_options: *const welkin_read_options,
        options: *const welkin_projection_options,
        control: *const welkin_control,
        projection: *mut welkin_projection,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Computes irradiance: multiplies band l of radiance by pi, 2 pi/3, pi/4, 0, -pi/24, ..."]
    pub fn welkin_irradiance_from_radiance(
        bands: i32,
        radiance: *const f64,
        irradiance: *mut f64,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Evaluates coefficients at a direction: `value` receives r, g, b."]
    pub fn welkin_evaluate(
        bands: i32,
        coefficients: *const f64,
        direction: *const f64,
        value: *mut f64,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Rotates or mirrors light by a matrix, orthogonal to 1e-6: light from direction d then comes from matrix * d."]
    pub fn welkin_rotate(
        bands: i32,
        coefficients: *const f64,
        matrix: *const f64,
        rotated: *mut f64,
    ) -> welkin_status;
}
#[doc = " Windows against ringing: the factor of band l. With w = pi l / width, HANNING is (1 + cos w) / 2 and LANCZOS sin(w) /"]
#[doc = " w, both 0 from l = width on. MIN_LAPLACIAN is 1 / (1 + c l^2 (l + 1)^2) c the least without negative irradiance."]
pub type welkin_window = i32;
pub const WELKIN_WINDOW_NONE: welkin_window = 0;
pub const WELKIN_WINDOW_HANNING: welkin_window = 1;
pub const WELKIN_WINDOW_LANCZOS: welkin_window = 2;
pub const WELKIN_WINDOW_MIN_LAPLACIAN: welkin_window = 3;
extern "C" {
    #[doc = " Multiplies each band of radiance by the window's factor. `width` is for HANNING and LANCZOS; 0: `bands`."]
    pub fn welkin_apply_window(
        bands: i32,
        radiance: *const f64,
        window: welkin_window,
        width: f64,
        windowed: *mut f64,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Computes the factor that scales the mean radiance to middle grey, luminance 0.18; 1 if the mean is not above 0."]
    pub fn welkin_exposure_of(
        bands: i32,
        radiance: *const f64,
        exposure: *mut f64,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Finds the directional light that best approximates an environment: `direction` towards it, `irradiance` on a surface"]
    #[doc = " facing it, and 1 in `found`; zeros if the light has no direction."]
    pub fn welkin_dominant_light(
        bands: i32,
        radiance: *const f64,
        direction: *mut f64,
        irradiance: *mut f64,
        found: *mut i32,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Computes the radiance of a sun as harmonics, to be added to those of its sky: a disc of `solid_angle` steradians with"]
    #[doc = " that irradiance, or a directional light if `solid_angle` is 0."]
    pub fn welkin_sun_harmonics(
        direction: *const f64,
        irradiance: *const f64,
        solid_angle: f64,
        bands: i32,
        coefficients: *mut f64,
    ) -> welkin_status;
}
#[doc = " Engines and formats with known conventions."]
pub type welkin_engine = i32;
pub const WELKIN_ENGINE_WELKIN: welkin_engine = 0;
pub const WELKIN_ENGINE_OPENEXR: welkin_engine = 1;
pub const WELKIN_ENGINE_BABYLON: welkin_engine = 2;
pub const WELKIN_ENGINE_THREE: welkin_engine = 3;
pub const WELKIN_ENGINE_FILAMENT: welkin_engine = 4;
pub const WELKIN_ENGINE_GLTF: welkin_engine = 5;
pub const WELKIN_ENGINE_UNITY: welkin_engine = 6;
pub const WELKIN_ENGINE_UNREAL: welkin_engine = 7;
pub const WELKIN_ENGINE_BLENDER: welkin_engine = 8;
pub const WELKIN_ENGINE_GODOT: welkin_engine = 9;
pub const WELKIN_ENGINE_BEVY: welkin_engine = 10;
pub const WELKIN_ENGINE_USD: welkin_engine = 11;
pub const WELKIN_ENGINE_PLAYCANVAS: welkin_engine = 12;
pub const WELKIN_ENGINE_QT: welkin_engine = 13;
extern "C" {
    #[doc = " Returns an engine's axes as matrices. `from_welkin` takes a direction in Welkin's axes to the engine's (a mirror for"]
    #[doc = " left-handed engines). `faces_from_engine` takes a direction in the engine's axes to the axes of cubemap faces; zeros"]
    #[doc = " for engines without cubemaps of their own. docs/reference/engines.md describes all conventions."]
    pub fn welkin_get_axes(
        engine: welkin_engine,
        from_welkin: *mut f64,
        faces_from_engine: *mut f64,
    ) -> welkin_status;
}
#[doc = " Light in an engine's own form; docs/reference/engines.md has the formulas."]
#[repr(C)]
#[derive(Debug, Default, Copy, Clone)]
pub struct welkin_engine_light {
    pub struct_size: u32,
    #[doc = " engine whose form it is"]
    pub engine: welkin_engine,
    #[doc = " 9"]
    pub term_count: i32,
    #[doc = " 7 for Unity and Unreal, else 0"]
    pub vector_count: i32,
    #[doc = " Babylon.js: SphericalPolynomial's x y z xx yy zz yz zx xy; others: index l (l + 1) + m"]
    pub terms: [[f64; 3usize]; 9usize],
    #[doc = " as shaders read them: SHAr SHAg SHAb SHBr SHBg SHBb SHC"]
    pub vectors: [[f64; 4usize]; 7usize],
}
extern "C" {
    #[doc = " Converts radiance to an engine's form, rotated to the engine's axes unless `in_place` is 1. Bands above the third are"]
    #[doc = " dropped. Returns WELKIN_INVALID_ARGUMENT for OpenEXR, Blender, Bevy and OpenUSD, which have no form."]
    pub fn welkin_engine_light_from_radiance(
        bands: i32,
        radiance: *const f64,
        engine: welkin_engine,
        in_place: i32,
        light: *mut welkin_engine_light,
    ) -> welkin_status;
}
#[doc = " Memory for one level of a cubemap, or for a flat image. It may be an upload buffer, since each texel is written once"]
#[doc = " and never read. Formats: RG, RGB and RGBA, F32 and F16; bakes write RGBA only. Half floats are rounded to nearest;"]
#[doc = " values above 65504 become 65504, and NaN becomes 0. Targets are checked before any work is done."]
#[repr(C)]
#[derive(Debug, Copy, Clone)]
pub struct welkin_target {
    pub struct_size: u32,
    #[doc = " format of all texels"]
    pub format: welkin_format,
    #[doc = " distance between rows, at least one row; 0: packed rows; negative: bottom-up"]
    pub row_stride_bytes: i64,
    #[doc = " first texel of each face's top row, aligned to its channels; flat image: faces[0] only"]
    pub faces: [*mut ::std::os::raw::c_void; 6usize],
    #[doc = " texels per edge of a cubemap; 0: a flat image"]
    pub size: i64,
    #[doc = " texels of a flat image; else 0"]
    pub width: i32,
    #[doc = " texels of a flat image; else 0"]
    pub height: i32,
}
impl Default for welkin_target {
    fn default() -> Self {
        let mut s = ::std::mem::MaybeUninit::<Self>::uninit();
        unsafe {
            ::std::ptr::write_bytes(s.as_mut_ptr(), 0, 1);
            s.assume_init()
        }
    }
}
#[doc = " Sizes of a chain."]
#[repr(C)]
#[derive(Debug, Default, Copy, Clone)]
pub struct welkin_chain_info {
    pub struct_size: u32,
    #[doc = " texels per edge of level 0"]
    pub size: i32,
    #[doc = " number of levels"]
    pub levels: i32,
    #[doc = " 1: each level has a roughness, see `welkin_chain_get_mip`"]
    pub prefiltered: i32,
}
extern "C" {
    #[doc = " Creates another handle to the same pixels."]
    pub fn welkin_chain_share(
        chain: *const welkin_chain,
        another: *mut *mut welkin_chain,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Returns the sizes of a chain."]
    pub fn welkin_chain_get_info(
        chain: *const welkin_chain,
        info: *mut welkin_chain_info,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Returns the pixels of a level in place: packed RGB_F32, valid while the chain is held."]
    pub fn welkin_chain_get_level(
        chain: *const welkin_chain,
        level: i32,
        pixels: *mut welkin_environment,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Writes a level to the caller's memory, on the calling thread."]
    pub fn welkin_chain_copy(
        chain: *const welkin_chain,
        level: i32,
        target: *const welkin_target,
        values_clamped: *mut u64,
    ) -> welkin_status;
}
#[doc = " How a mip is computed. AUTOMATIC: for each mip, the fastest method that meets both bounds. SPECTRAL: by harmonics,"]
#[doc = " with the brightest texels convolved one by one. REFERENCE: by the integral, texel by texel (slow). Results may also"]
#[doc = " be COPY (roughness 0) or NEAR_FAR (nearby texels as areas, the lobe's tail by harmonics)."]
pub type welkin_prefilter_method = i32;
pub const WELKIN_PREFILTER_AUTOMATIC: welkin_prefilter_method = 0;
pub const WELKIN_PREFILTER_SPECTRAL: welkin_prefilter_method = 1;
pub const WELKIN_PREFILTER_REFERENCE: welkin_prefilter_method = 2;
#[doc = " clang-format on"]
pub const WELKIN_PREFILTER_COPY: welkin_prefilter_method = 4;
#[doc = " clang-format on"]
pub const WELKIN_PREFILTER_NEAR_FAR: welkin_prefilter_method = 5;
#[doc = " Mappings from mips to roughness, with t = mip / (mips - 1), and the size of the last mip."]
pub type welkin_roughness_schedule = i32;
#[doc = " FILAMENT; for CHARLIE as in glTF's sample renderer"]
pub const WELKIN_ROUGHNESS_DEFAULT: welkin_roughness_schedule = 0;
#[doc = " t; down to 4 texels, but at least five mips where `size` has five"]
pub const WELKIN_ROUGHNESS_LINEAR: welkin_roughness_schedule = 1;
#[doc = " 1 - sqrt(1 - t), also three.js; mips as LINEAR"]
pub const WELKIN_ROUGHNESS_FILAMENT: welkin_roughness_schedule = 2;
#[doc = " 0 at mip 0, else sqrt(2^(mip / 0.8) / size), at most 1; down to 1 texel"]
pub const WELKIN_ROUGHNESS_BABYLON: welkin_roughness_schedule = 3;
#[doc = " r with mip = 6 r (1.7 - 0.7 r); by default at most seven mips"]
pub const WELKIN_ROUGHNESS_UNITY: welkin_roughness_schedule = 4;
#[doc = " 0 at mip 0, else 2^((mip - (mips - 1) + 2) / 1.2), at most 1; down to 1 texel"]
pub const WELKIN_ROUGHNESS_UNREAL: welkin_roughness_schedule = 5;
#[doc = " Lobes of a chain, by the roughness r of each mip; docs/maths/reflections.md has their formulas."]
pub type welkin_lobe_family = i32;
pub const WELKIN_LOBE_FAMILY_GGX: welkin_lobe_family = 0;
#[doc = " sheen; r is clamped to 0.05 or more"]
pub const WELKIN_LOBE_FAMILY_CHARLIE: welkin_lobe_family = 1;
#[doc = " irradiance over pi, at any r; one mip unless `mips` is set"]
pub const WELKIN_LOBE_FAMILY_LAMBERT: welkin_lobe_family = 2;
#[doc = " power max(1, 2 / r^4 - 2); r is clamped to 0.12 or more"]
pub const WELKIN_LOBE_FAMILY_PHONG: welkin_lobe_family = 3;
#[doc = " power 2 / r^4 - 2; r is clamped to 0.12 or more"]
pub const WELKIN_LOBE_FAMILY_BLINN: welkin_lobe_family = 4;
#[doc = " factors in `spectra`"]
pub const WELKIN_LOBE_FAMILY_SPECTRA: welkin_lobe_family = 5;
#[doc = " Accuracy of reflections and irradiance: rms_error 1e-3, 1e-2, or the integrals in double (minutes)."]
pub type welkin_quality = i32;
pub const WELKIN_QUALITY_NORMAL: welkin_quality = 0;
pub const WELKIN_QUALITY_FAST: welkin_quality = 1;
pub const WELKIN_QUALITY_REFERENCE: welkin_quality = 2;
#[doc = " Size, lobes and error bounds of a specular chain. Arrays are copied."]
#[repr(C)]
#[derive(Debug, Copy, Clone)]
pub struct welkin_prefilter_options {
    pub struct_size: u32,
    #[doc = " texels per edge of mip 0, 1 to 8192; 0: 256, for skies 32"]
    pub size: i32,
    #[doc = " 0: `roughness_count`, else the schedule's; for LAMBERT and SPECTRA 1"]
    pub mips: i32,
    #[doc = " length of `roughness`; 0: the schedule's"]
    pub roughness_count: i32,
    #[doc = " perceptual roughness of each mip, 0 to 1"]
    pub roughness: *const f64,
    #[doc = " method of all mips"]
    pub method: welkin_prefilter_method,
    #[doc = " bound on a mip's relative root mean square error; 0: by `quality`"]
    pub rms_error: f64,
    #[doc = " bound on the relative error at any texel; 0: ten times rms_error, at most 1"]
    pub maximum_error: f64,
    #[doc = " null: the defaults; must be null in a bake and for a sky"]
    pub pixels: *const welkin_pixel_policy,
    #[doc = " lobes of all mips"]
    pub lobe: welkin_lobe_family,
    #[doc = " SPECTRA only: numbers per mip, 1 to 1536"]
    pub spectrum_bands: i32,
    #[doc = " SPECTRA only: mips times spectrum_bands factors of degrees 0, 1, ..."]
    pub spectra: *const f64,
    #[doc = " method and bounds; ignored if `rms_error` is not 0"]
    pub quality: welkin_quality,
    #[doc = " roughness of each mip's lobe, `roughness_count` numbers; null: `roughness`"]
    pub lobe_roughness: *const f64,
    #[doc = " used if `roughness` is null"]
    pub schedule: welkin_roughness_schedule,
    #[doc = " 1: fits the schedule's lobes to lookups between mips"]
    pub fitted: i32,
}
impl Default for welkin_prefilter_options {
    fn default() -> Self {
        let mut s = ::std::mem::MaybeUninit::<Self>::uninit();
        unsafe {
            ::std::ptr::write_bytes(s.as_mut_ptr(), 0, 1);
            s.assume_init()
        }
    }
}
#[doc = " Roughness, method and estimated errors of one mip."]
#[repr(C)]
#[derive(Debug, Default, Copy, Clone)]
pub struct welkin_mip {
    pub struct_size: u32,
    #[doc = " texels per edge"]
    pub size: i32,
    #[doc = " perceptual roughness at which a shader looks the mip up"]
    pub roughness: f64,
    #[doc = " never AUTOMATIC"]
    pub method: welkin_prefilter_method,
    #[doc = " harmonic bands used (SPECTRAL, NEAR_FAR)"]
    pub bands: i32,
    #[doc = " texels convolved one by one"]
    pub bright_texels: i32,
    #[doc = " predicted rms error relative to the mip's rms; NaN: unknown"]
    pub error_estimate: f64,
    #[doc = " mean of the texels by solid angle"]
    pub mean: [f64; 3usize],
    #[doc = " perceptual roughness of the mip's lobe"]
    pub lobe_roughness: f64,
    #[doc = " predicted rms error of trilinear lookups up to the next mip; NaN: unknown"]
    pub error_between: f64,
}
extern "C" {
    #[doc = " Returns the record of a mip of a prefiltered chain."]
    pub fn welkin_chain_get_mip(
        chain: *const welkin_chain,
        level: i32,
        mip: *mut welkin_mip,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Prefilters an environment for specular reflections (GGX, split sum), one roughness per mip."]
    pub fn welkin_prefilter(
        environment: *const welkin_environment,
        options: *const welkin_prefilter_options,
        control: *const welkin_control,
        chain: *mut *mut welkin_chain,
    ) -> welkin_status;
}
#[doc = " Size and contents of a BRDF table: E = f0 scale + bias is the reflectance in a uniform environment."]
#[repr(C)]
#[derive(Debug, Default, Copy, Clone)]
pub struct welkin_brdf_options {
    pub struct_size: u32,
    #[doc = " along N.V and along perceptual roughness, 1 to 4096; 0: 64"]
    pub width: i32,
    #[doc = " along N.V and along perceptual roughness, 1 to 4096; 0: 64"]
    pub height: i32,
    #[doc = " 1: bias and scale + bias: E = (1 - f0) red + f0 green; 0: scale and bias"]
    pub multiple_scattering: i32,
    #[doc = " 1: the third channel is 0; 0: it is the albedo of sheen"]
    pub without_sheen: i32,
}
extern "C" {
    #[doc = " Writes the table to a flat target of the options' size; row 0 has the lowest roughness. Recent tables are cached."]
    pub fn welkin_brdf_table(
        options: *const welkin_brdf_options,
        control: *const welkin_control,
        target: *const welkin_target,
        values_clamped: *mut u64,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Evaluates irradiance coefficients at each texel's centre of a cubemap target of 1 to 4096 texels per edge."]
    pub fn welkin_irradiance_cubemap(
        bands: i32,
        irradiance: *const f64,
        control: *const welkin_control,
        target: *const welkin_target,
        values_clamped: *mut u64,
    ) -> welkin_status;
}
#[doc = " Parts of a bake, as flags: a sharp cubemap with mips, the specular cubemap, an irradiance cubemap, harmonics of"]
#[doc = " radiance, the BRDF table, and the specular cubemap as an octahedral map (only if `octahedral_size` is set)."]
pub type welkin_parts = u32;
pub const WELKIN_PART_BACKGROUND: welkin_parts = 1;
pub const WELKIN_PART_SPECULAR: welkin_parts = 2;
pub const WELKIN_PART_IRRADIANCE: welkin_parts = 4;
pub const WELKIN_PART_HARMONICS: welkin_parts = 8;
#[doc = " clang-format on"]
pub const WELKIN_PART_BRDF: welkin_parts = 16;
#[doc = " clang-format on"]
pub const WELKIN_PART_OCTAHEDRAL: welkin_parts = 32;
#[doc = " How an irradiance cubemap is computed. AUTOMATIC: within `irradiance_rms_error` of the integral over the source's"]
#[doc = " texels. DIRECT: as that integral (slow). HARMONICS: from `bands` of harmonics, as shaders do."]
pub type welkin_irradiance_method = i32;
pub const WELKIN_IRRADIANCE_AUTOMATIC: welkin_irradiance_method = 0;
pub const WELKIN_IRRADIANCE_DIRECT: welkin_irradiance_method = 1;
pub const WELKIN_IRRADIANCE_HARMONICS: welkin_irradiance_method = 2;
#[doc = " Parts, sizes and bounds of a bake."]
#[repr(C)]
#[derive(Debug, Copy, Clone)]
pub struct welkin_bake_options {
    pub struct_size: u32,
    #[doc = " parts not to make; 0: makes all"]
    pub leave_out: welkin_parts,
    #[doc = " 0: the specular cubemap's; without one the source's"]
    pub background_size: i32,
    #[doc = " 1: level 0 only"]
    pub background_without_mips: i32,
    #[doc = " 1: mips by plain means, as in graphics APIs; 0: means by solid angle"]
    pub background_box_filter: i32,
    #[doc = " 0: 64"]
    pub irradiance_size: i32,
    #[doc = " method of the irradiance cubemap"]
    pub irradiance_method: welkin_irradiance_method,
    #[doc = " bands of harmonics; 0: 3"]
    pub bands: i32,
    #[doc = " null: the defaults"]
    pub specular: *const welkin_prefilter_options,
    #[doc = " null: the defaults"]
    pub brdf: *const welkin_brdf_options,
    #[doc = " for all parts; null: the defaults"]
    pub pixels: *const welkin_pixel_policy,
    #[doc = " results and working memory together; 0: 8 GiB"]
    pub memory_limit_bytes: u64,
    #[doc = " bound of the automatic method, 1e-6 to 1; 0: by `quality`"]
    pub irradiance_rms_error: f64,
    #[doc = " texels per edge, including borders; 0: no map"]
    pub octahedral_size: i32,
    #[doc = " 0: 1. Size and border must be multiples of 2^(levels - 1)"]
    pub octahedral_levels: i32,
    #[doc = " texels on each side of level 0; 0: 2^(octahedral_levels - 1)"]
    pub octahedral_border: i32,
    #[doc = " for irradiance, and for reflections whose own quality is normal"]
    pub quality: welkin_quality,
}
impl Default for welkin_bake_options {
    fn default() -> Self {
        let mut s = ::std::mem::MaybeUninit::<Self>::uninit();
        unsafe {
            ::std::ptr::write_bytes(s.as_mut_ptr(), 0, 1);
            s.assume_init()
        }
    }
}
#[doc = " Parts of a result and their sizes."]
#[repr(C)]
#[derive(Debug, Default, Copy, Clone)]
pub struct welkin_bake_info {
    pub struct_size: u32,
    #[doc = " parts in the result"]
    pub parts: welkin_parts,
    #[doc = " 0 without harmonics"]
    pub bands: i32,
    #[doc = " bound on results and working memory together"]
    pub peak_bytes: u64,
    #[doc = " predicted rms error of irradiance relative to its rms; NaN: unknown"]
    pub irradiance_error_estimate: f64,
    #[doc = " 0 without a map; at most as many levels as mips"]
    pub octahedral_size: i32,
    #[doc = " 0 without a map; at most as many levels as mips"]
    pub octahedral_levels: i32,
    #[doc = " 0 without a map; at most as many levels as mips"]
    pub octahedral_border: i32,
    #[doc = " channel values that the formats of `welkin_bake_targets` could not hold"]
    pub values_clamped: u64,
}
extern "C" {
    #[doc = " Bakes an environment."]
    pub fn welkin_bake(
        environment: *const welkin_environment,
        options: *const welkin_bake_options,
        control: *const welkin_control,
        result: *mut *mut welkin_bake_result,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Reads and bakes a file."]
    pub fn welkin_bake_file(
        path: *const ::std::os::raw::c_char,
        read_options: *const welkin_read_options,
        options: *const welkin_bake_options,
        control: *const welkin_control,
        result: *mut *mut welkin_bake_result,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Bakes specular chains and harmonics of many cubemaps into the caller's memory. `probes`, `coefficients` (null with 0"]
    #[doc = " bands) and `totals` are as in `welkin_project_many`. `targets` has one element per mip, probe by probe. After errors"]
    #[doc = " other than WELKIN_INVALID_ARGUMENT, any targets may be written."]
    pub fn welkin_bake_many(
        probes: *const welkin_environment,
        probe_count: i64,
        options: *const welkin_prefilter_options,
        control: *const welkin_control,
        targets: *const welkin_target,
        target_count: i64,
        bands: i32,
        coefficients: *mut f64,
        totals: *mut welkin_projection,
        values_clamped: *mut u64,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Returns the parts and sizes of a result."]
    pub fn welkin_bake_result_get_info(
        result: *const welkin_bake_result,
        info: *mut welkin_bake_info,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Returns the background, specular or irradiance cubemap, valid while the result is held (`welkin_chain_share` keeps it"]
    #[doc = " longer). Null if that part was not made, and for other parts."]
    pub fn welkin_bake_result_chain(
        result: *const welkin_bake_result,
        part: welkin_parts,
    ) -> *const welkin_chain;
}
extern "C" {
    #[doc = " Returns harmonics of radiance, and counts of values read, replaced and clamped."]
    pub fn welkin_bake_result_get_projection(
        result: *const welkin_bake_result,
        projection: *mut welkin_projection,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Writes a level of the octahedral map to a flat target of octahedral_size >> level texels."]
    pub fn welkin_bake_result_copy_octahedral(
        result: *const welkin_bake_result,
        level: i32,
        target: *const welkin_target,
        values_clamped: *mut u64,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Writes the BRDF table to a flat target."]
    pub fn welkin_bake_result_copy_brdf(
        result: *const welkin_bake_result,
        target: *const welkin_target,
        values_clamped: *mut u64,
    ) -> welkin_status;
}
#[doc = " Positions of probes. Probe (i, j, k) along x, y and z has the index i + counts[0] (j + counts[1] k)."]
#[repr(C)]
#[derive(Debug, Default, Copy, Clone)]
pub struct welkin_probe_grid {
    pub struct_size: u32,
    #[doc = " 1 to 2048 each, at most 2^24 in total"]
    pub counts: [i32; 3usize],
    #[doc = " position of probe 0"]
    pub origin: [f64; 3usize],
    #[doc = " above 0"]
    pub spacing: [f64; 3usize],
}
#[doc = " Options of a bake of probes."]
#[repr(C)]
#[derive(Debug, Default, Copy, Clone)]
pub struct welkin_probe_options {
    pub struct_size: u32,
    #[doc = " 1 to 4; 0: 3"]
    pub bands: i32,
    #[doc = " texels per edge of the distance maps, 1 to 64; 0: 8; -1: none"]
    pub distance_size: i32,
    #[doc = " 0: 4; -1: none"]
    pub dilation_passes: i32,
    #[doc = " bands of environments for `welkin_probes_relight`; 0: none"]
    pub environment_bands: i32,
    #[doc = " 0: 0.1 and 0.75"]
    pub near_share: f64,
    #[doc = " 0: 0.1 and 0.75"]
    pub valid_share: f64,
}
extern "C" {
    #[doc = " Bakes a grid from one cubemap per probe. `depths` may be null."]
    pub fn welkin_probes_bake(
        grid: *const welkin_probe_grid,
        cubes: *const welkin_environment,
        depths: *const *const f32,
        depth_size: i32,
        options: *const welkin_probe_options,
        control: *const welkin_control,
        probes: *mut *mut welkin_probes,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Computes where probes should be captured instead, so that none lies in a wall: three doubles per probe in `offsets`,"]
    #[doc = " which holds those of the depths' captures before (zeros for none)."]
    pub fn welkin_probes_relocate(
        grid: *const welkin_probe_grid,
        depths: *const *const f32,
        depth_size: i32,
        offsets: *mut f64,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Sets the offsets at which probes were captured: three doubles per probe; null: none."]
    pub fn welkin_probes_set_offsets(
        probes: *mut welkin_probes,
        offsets: *const f64,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Changes probes to another environment: 3 bands^2 doubles of radiance each."]
    pub fn welkin_probes_relight(
        probes: *mut welkin_probes,
        bands: i32,
        from: *const f64,
        to: *const f64,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Computes irradiance at `count` positions with unit normals (x, y, z each); `irradiance` receives r, g, b of each."]
    pub fn welkin_probes_irradiance(
        probes: *const welkin_probes,
        positions: *const f64,
        normals: *const f64,
        count: usize,
        irradiance: *mut f64,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Returns the coefficients of radiance: `count` doubles, 3 bands^2 per probe, valid until the probes are changed."]
    pub fn welkin_probes_coefficients(
        probes: *const welkin_probes,
        coefficients: *mut *const f64,
        count: *mut usize,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Packs texture `index` of a layout: \"three\", \"unity-l2\", \"unity-l1\", \"plain\", \"bevy\" or \"rtxgi\". `size` receives"]
    #[doc = " texels along x, y and z; `halves` (may be null) four half floats per texel, if `half_count` suffices."]
    pub fn welkin_probes_pack(
        probes: *const welkin_probes,
        layout: *const ::std::os::raw::c_char,
        index: i32,
        size: *mut i32,
        halves: *mut u16,
        half_count: usize,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Writes probes as PATH.json and its files, with textures of layouts separated by commas (may be null)."]
    pub fn welkin_probes_write(
        probes: *const welkin_probes,
        path: *const ::std::os::raw::c_char,
        layouts: *const ::std::os::raw::c_char,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Reads probes that welkin_probes_write wrote."]
    pub fn welkin_probes_read(
        path: *const ::std::os::raw::c_char,
        probes: *mut *mut welkin_probes,
    ) -> welkin_status;
}
#[doc = " Atmospheres to start from. EARTH has clear air as measured, HAZY three times its aerosol, DUSTY desert dust, POLLUTED"]
#[doc = " the air near cities. HILLAIRE is Earth as in Hillaire 2020; BRUNETON is Earth as in Bruneton 2017, almost without"]
#[doc = " aerosol. BARE has Earth's size, but no air and no light."]
pub type welkin_planet = i32;
pub const WELKIN_PLANET_EARTH: welkin_planet = 0;
pub const WELKIN_PLANET_EARTH_HILLAIRE: welkin_planet = 1;
pub const WELKIN_PLANET_MARS: welkin_planet = 2;
pub const WELKIN_PLANET_BARE: welkin_planet = 3;
pub const WELKIN_PLANET_EARTH_BRUNETON: welkin_planet = 4;
pub const WELKIN_PLANET_EARTH_HAZY: welkin_planet = 5;
pub const WELKIN_PLANET_EARTH_DUSTY: welkin_planet = 6;
#[doc = " clang-format on"]
pub const WELKIN_PLANET_EARTH_POLLUTED: welkin_planet = 7;
#[doc = " A constituent of the air: its density over altitude, and its coefficients where the density is 1."]
#[repr(C)]
#[derive(Debug, Copy, Clone)]
pub struct welkin_constituent {
    pub struct_size: u32,
    #[doc = " at most 8; 0: the constituent is absent"]
    pub layer_count: i32,
    #[doc = " Five doubles per layer, from the ground up: its thickness, and a, b, c, d. All in metres: relative density at"]
    #[doc = " altitude h is a exp(b h) + c h + d, clamped to [0, 1]."]
    pub layers: *const f64,
    #[doc = " one per wavelength; null: none"]
    pub scattering_per_m: *const f64,
    #[doc = " one per wavelength; null: none"]
    pub absorption_per_m: *const f64,
}
impl Default for welkin_constituent {
    fn default() -> Self {
        let mut s = ::std::mem::MaybeUninit::<Self>::uninit();
        unsafe {
            ::std::ptr::write_bytes(s.as_mut_ptr(), 0, 1);
            s.assume_init()
        }
    }
}
#[doc = " Phase function of the aerosol."]
pub type welkin_aerosol_phase = i32;
pub const WELKIN_PHASE_DEFAULT: welkin_aerosol_phase = 0;
pub const WELKIN_PHASE_CORNETTE_SHANKS: welkin_aerosol_phase = 1;
pub const WELKIN_PHASE_HENYEY_GREENSTEIN: welkin_aerosol_phase = 2;
#[doc = " A planet's air, ground and sun. Zero or null keeps the value of `planet`. Arrays: one value per wavelength."]
#[repr(C)]
#[derive(Debug, Copy, Clone)]
pub struct welkin_atmosphere {
    pub struct_size: u32,
    #[doc = " planet to start from"]
    pub planet: welkin_planet,
    #[doc = " 3, or 3 to 96 with `linear_srgb`; 0: the planet's wavelengths (Earth: 680, 550, 440)"]
    pub wavelength_count: i32,
    #[doc = " number of `absorbers`; 0: the planet's absorbers; -1: none"]
    pub absorber_count: i32,
    #[doc = " in nm, increasing or decreasing. EARTH, HAZY, DUSTY and POLLUTED exist at any from 360 to 830 nm. For other"]
    #[doc = " planets, set all arrays too."]
    pub wavelengths_nm: *const f64,
    #[doc = " molecules"]
    pub rayleigh: *const welkin_constituent,
    #[doc = " particles"]
    pub aerosol: *const welkin_constituent,
    #[doc = " four numbers that replace `aerosol`: optical depth at 550 nm (0 to 100), Angstrom exponent (-4 to 8), single"]
    #[doc = " scattering albedo (0 to 1) and asymmetry (-0.8 to 0.999). The scale height is 1200 m."]
    pub aerosol_optics: *const f64,
    #[doc = " phase function of the particles"]
    pub aerosol_phase: welkin_aerosol_phase,
    #[doc = " g of its phase function, -0.8 to 0.999"]
    pub aerosol_asymmetry: f64,
    #[doc = " g per wavelength"]
    pub aerosol_asymmetries: *const f64,
    #[doc = " absorbers such as ozone"]
    pub absorbers: [*const welkin_constituent; 4usize],
    #[doc = " radius of the ground, 1 to 1e9"]
    pub bottom_radius_m: f64,
    #[doc = " radius of the top of the air, above the ground's, at most 11 times it"]
    pub top_radius_m: f64,
    #[doc = " 0 to 1"]
    pub ground_albedo: *const f64,
    #[doc = " above the air, on a surface facing the sun, W/m2/nm"]
    pub sun_irradiance: *const f64,
    #[doc = " radius of the disc"]
    pub sun_angular_radius_degrees: f64,
    #[doc = " airglow and stars seen from the ground, up to 1 cd/m2; a dark site has 2e-4"]
    pub night_zenith_luminance: f64,
}
impl Default for welkin_atmosphere {
    fn default() -> Self {
        let mut s = ::std::mem::MaybeUninit::<Self>::uninit();
        unsafe {
            ::std::ptr::write_bytes(s.as_mut_ptr(), 0, 1);
            s.assume_init()
        }
    }
}
extern "C" {
    #[doc = " Computes the unit direction towards a sun."]
    pub fn welkin_sun_direction(
        elevation_degrees: f64,
        azimuth_degrees: f64,
        direction: *mut f64,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Computes the sun's position, 1900 to 2099, at a date such as \"2026-06-21T20:30:15+02:00\" and a place (degrees,"]
    #[doc = " positive in the north and the east). North is -z and east +x. `refraction` 1 raises the sun by that of 1010 hPa and"]
    #[doc = " 10 degrees Celsius. `direction` (may be null) receives three numbers."]
    pub fn welkin_sun_position(
        date: *const ::std::os::raw::c_char,
        latitude: f64,
        longitude: f64,
        refraction: i32,
        elevation_degrees: *mut f64,
        azimuth_degrees: *mut f64,
        direction: *mut f64,
    ) -> welkin_status;
}
#[doc = " Sizes of the tables, and orders of scattering."]
#[repr(C)]
#[derive(Debug, Default, Copy, Clone)]
pub struct welkin_sky_table_options {
    pub struct_size: u32,
    #[doc = " 1: omits the azimuth between view and sun; only phase functions then depend on it"]
    pub compact: i32,
    #[doc = " 2 to 128; 0: 32"]
    pub heights: i32,
    #[doc = " even, 4 to 1024; 0: 64"]
    pub view_zeniths: i32,
    #[doc = " 4 to 256; 0: 64"]
    pub sun_zeniths: i32,
    #[doc = " 2 to 128, not with `compact`; 0: 8"]
    pub sun_angles: i32,
    #[doc = " 2 to 1024 and to 2048; 0: 64 and 256"]
    pub transmittance_heights: i32,
    #[doc = " 2 to 1024 and to 2048; 0: 64 and 256"]
    pub transmittance_zeniths: i32,
    #[doc = " 2 to 1024; 0: 16 and 64"]
    pub irradiance_heights: i32,
    #[doc = " 2 to 1024; 0: 16 and 64"]
    pub irradiance_sun_zeniths: i32,
    #[doc = " orders of scattering, 1 to 64; 0: 4"]
    pub orders: i32,
    #[doc = " 1: channels are cd/m2; 0: W/m2/sr/nm at three wavelengths"]
    pub linear_srgb: i32,
    #[doc = " lowest sun in the tables, -90 to below 0; 0: -30"]
    pub minimum_sun_elevation_degrees: f64,
    #[doc = " stops early after an order that adds less than this fraction; 0: never"]
    pub convergence_threshold: f64,
    #[doc = " 0: 4 GiB"]
    pub memory_limit_bytes: u64,
    #[doc = " not 0: omits orders beyond `orders`; 0: estimates them"]
    pub truncate_orders: i32,
}
extern "C" {
    #[doc = " Computes scattering tables: 2 to 3 s of CPU time with the defaults."]
    pub fn welkin_sky_tables_create(
        atmosphere: *const welkin_atmosphere,
        options: *const welkin_sky_table_options,
        control: *const welkin_control,
        tables: *mut *mut welkin_sky_tables,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Saves tables with all their parameters. Loading restores the same bits."]
    pub fn welkin_sky_tables_save(
        tables: *const welkin_sky_tables,
        path: *const ::std::os::raw::c_char,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Loads saved tables. `memory_limit_bytes` 0: 4 GiB."]
    pub fn welkin_sky_tables_load(
        path: *const ::std::os::raw::c_char,
        memory_limit_bytes: u64,
        tables: *mut *mut welkin_sky_tables,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Creates a view from 0 to 1e9 m, in 2 ms. `without_ground` 1: rays that hit the ground see only air in front of it."]
    pub fn welkin_sky_view_create(
        tables: *const welkin_sky_tables,
        altitude_m: f64,
        without_ground: i32,
        view: *mut *mut welkin_sky_view,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Computes radiance without the sun's disc from `count` directions (x, y, z each); `rgb` receives r, g, b of each."]
    pub fn welkin_sky_view_radiance(
        view: *const welkin_sky_view,
        directions: *const f32,
        count: usize,
        sun: *const f64,
        rgb: *mut f32,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Computes the sun as a directional light: irradiance on a surface facing it, and solid angle in steradians."]
    pub fn welkin_sky_view_sun(
        view: *const welkin_sky_view,
        sun: *const f64,
        irradiance: *mut f64,
        solid_angle: *mut f64,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Writes an image of the sky: a cubemap, or a lat-long if the target is flat, whose width must be twice its height."]
    #[doc = " `sun_disc` 1 includes the sun's disc, by the area of texels that it covers."]
    pub fn welkin_sky_view_image(
        view: *const welkin_sky_view,
        sun: *const f64,
        sun_disc: i32,
        control: *const welkin_control,
        target: *const welkin_target,
        values_clamped: *mut u64,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Prefilters an image of the sky for specular reflections."]
    pub fn welkin_sky_view_specular(
        view: *const welkin_sky_view,
        sun: *const f64,
        sun_disc: i32,
        options: *const welkin_prefilter_options,
        control: *const welkin_control,
        chain: *mut *mut welkin_chain,
    ) -> welkin_status;
}
#[doc = " Options of a sky projection."]
#[repr(C)]
#[derive(Debug, Default, Copy, Clone)]
pub struct welkin_sky_harmonics_options {
    pub struct_size: u32,
    #[doc = " 1 to WELKIN_MAXIMUM_BANDS; 0: 3"]
    pub bands: i32,
    #[doc = " 2 to 128 and to 256; 0: 32"]
    pub zeniths: i32,
    #[doc = " 2 to 128 and to 256; 0: 32"]
    pub azimuths: i32,
    #[doc = " sun elevations of the curve, 8 to 4096; 0: 256"]
    pub nodes: i32,
}
extern "C" {
    #[doc = " Creates a curve, in milliseconds."]
    pub fn welkin_sky_curve_create(
        view: *const welkin_sky_view,
        options: *const welkin_sky_harmonics_options,
        control: *const welkin_control,
        curve: *mut *mut welkin_sky_curve,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Computes radiance of sky and ground, without the sun's disc: `coefficients` receives 3 bands^2 doubles."]
    #[doc = " `sun_irradiance` (may be null) receives r, g, b of direct sunlight on a surface facing the sun. Takes 1 us."]
    pub fn welkin_sky_curve_at(
        curve: *const welkin_sky_curve,
        sun: *const f64,
        coefficients: *mut f64,
        sun_irradiance: *mut f64,
    ) -> welkin_status;
}
#[doc = " Priority of a worker's threads relative to all other threads. BELOW_NORMAL, the default: a tenth of a normal thread's"]
#[doc = " CPU time when both compete. IDLE: only on otherwise idle processors."]
pub type welkin_thread_priority = i32;
pub const WELKIN_THREAD_PRIORITY_DEFAULT: welkin_thread_priority = 0;
pub const WELKIN_THREAD_PRIORITY_BELOW_NORMAL: welkin_thread_priority = 1;
#[doc = " clang-format on"]
pub const WELKIN_THREAD_PRIORITY_NORMAL: welkin_thread_priority = 2;
#[doc = " clang-format on"]
pub const WELKIN_THREAD_PRIORITY_IDLE: welkin_thread_priority = 3;
#[doc = " A worker's threads and limits."]
#[repr(C)]
#[derive(Debug, Copy, Clone)]
pub struct welkin_worker_options {
    pub struct_size: u32,
    #[doc = " 1 to 1024; 0: one less than the process may use, at least 1 (with `enqueue`: all)"]
    pub threads: i32,
    #[doc = " priority of its own threads"]
    pub thread_priority: welkin_thread_priority,
    #[doc = " name of the threads; null: \"welkin\""]
    pub name: *const ::std::os::raw::c_char,
    #[doc = " Null: the worker creates its own threads. Otherwise jobs run on the engine's threads: this function, called from"]
    #[doc = " any number of threads at once, must arrange for `task(argument)` to be called exactly once, soon, on any thread. At"]
    #[doc = " most `threads` tasks are outstanding. A task that is never called leaks memory, and its job waits forever."]
    pub enqueue: ::std::option::Option<
        unsafe extern "C" fn(
            enqueue_user: *mut ::std::os::raw::c_void,
            task: ::std::option::Option<unsafe extern "C" fn(argument: *mut ::std::os::raw::c_void)>,
            argument: *mut ::std::os::raw::c_void,
        ),
    >,
    #[doc = " passed to `enqueue`, until the worker is terminated or destroyed; later tasks do nothing"]
    pub enqueue_user: *mut ::std::os::raw::c_void,
    #[doc = " jobs in flight, 0: 4096; a job posted at a limit completes with WELKIN_QUEUE_FULL"]
    pub max_jobs: u64,
    #[doc = " bytes of their pixels in flight; 0: 4 GiB"]
    pub max_bytes: u64,
}
impl Default for welkin_worker_options {
    fn default() -> Self {
        let mut s = ::std::mem::MaybeUninit::<Self>::uninit();
        unsafe {
            ::std::ptr::write_bytes(s.as_mut_ptr(), 0, 1);
            s.assume_init()
        }
    }
}
extern "C" {
    #[doc = " Creates a worker. Returns WELKIN_INTERNAL if no thread can be created."]
    pub fn welkin_worker_create(
        options: *const welkin_worker_options,
        worker: *mut *mut welkin_worker,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Terminates and destroys a worker. No other thread may use it any more; its jobs remain usable. Completed callbacks"]
    #[doc = " that were not drained are never called; to receive them all, terminate, drain, then destroy."]
    pub fn welkin_worker_destroy(worker: *mut welkin_worker);
}
extern "C" {
    #[doc = " Cancels all jobs, waits until none runs (but not on a thread of the worker), and ends the threads. These jobs and"]
    #[doc = " later posts complete with WELKIN_STOPPED; callbacks can still be drained."]
    pub fn welkin_worker_terminate(worker: *mut welkin_worker) -> welkin_status;
}
extern "C" {
    #[doc = " Waits until no job waits or runs; callbacks may remain. Returns at once on a thread of the worker."]
    pub fn welkin_worker_wait_until_idle(worker: *mut welkin_worker) -> welkin_status;
}
extern "C" {
    #[doc = " Calls the `completed` callbacks of completed jobs, on this thread, in the order of completion: at least one if there"]
    #[doc = " is any, then until `budget_nanoseconds` are spent. `called` (may be null) receives their number."]
    pub fn welkin_worker_drain(
        worker: *mut welkin_worker,
        budget_nanoseconds: u64,
        called: *mut u64,
    ) -> welkin_status;
}
#[doc = " Order of waiting jobs: higher priority first, then first come, first served."]
pub type welkin_priority = i32;
pub const WELKIN_PRIORITY_LOW: welkin_priority = -1;
pub const WELKIN_PRIORITY_NORMAL: welkin_priority = 0;
pub const WELKIN_PRIORITY_HIGH: welkin_priority = 1;
#[doc = " Priority, key, ownership and callback of a post."]
#[repr(C)]
#[derive(Debug, Copy, Clone)]
pub struct welkin_post_options {
    pub struct_size: u32,
    #[doc = " position among waiting jobs"]
    pub priority: welkin_priority,
    #[doc = " replaces older jobs with the same key, which complete with WELKIN_REPLACED; null: no key"]
    pub key: *const ::std::os::raw::c_char,
    #[doc = " bytes to count against `max_bytes`; 0: those of its pixels"]
    pub bytes: u64,
    #[doc = " Null: the pixels (or the function's data) must stay valid until the job is ready. Otherwise the job owns them, and"]
    #[doc = " calls `release(release_user)` once per call of a post function, on any thread: before a post returns that fails or"]
    #[doc = " is about a file or a sky; else about when the job becomes ready, and before `welkin_worker_wait_until_idle`,"]
    #[doc = " `..._terminate` and `..._destroy` return; for a job that never ran, before the call returns that cancelled or"]
    #[doc = " refused it or terminated the worker (for a replaced job perhaps a moment later). It must not wait for the worker or"]
    #[doc = " its jobs. It is not called if the post refuses `struct_size`."]
    pub release:
        ::std::option::Option<unsafe extern "C" fn(release_user: *mut ::std::os::raw::c_void)>,
    #[doc = " passed to `release`"]
    pub release_user: *mut ::std::os::raw::c_void,
    #[doc = " Null, or called inside `welkin_worker_drain` once the job has completed or failed: exactly once if the post"]
    #[doc = " succeeds and the worker is drained to the end. `job` is valid during the call; `welkin_job_retain` keeps it."]
    pub completed: ::std::option::Option<
        unsafe extern "C" fn(job: *mut welkin_job, completed_user: *mut ::std::os::raw::c_void),
    >,
    #[doc = " passed to `completed`"]
    pub completed_user: *mut ::std::os::raw::c_void,
}
impl Default for welkin_post_options {
    fn default() -> Self {
        let mut s = ::std::mem::MaybeUninit::<Self>::uninit();
        unsafe {
            ::std::ptr::write_bytes(s.as_mut_ptr(), 0, 1);
            s.assume_init()
        }
    }
}
extern "C" {
    #[doc = " Each posts the call of its name; the last two compute a curve, and reflections without the sun's disc."]
    pub fn welkin_post_project(
        worker: *mut welkin_worker,
        mips: *const welkin_environment,
        mip_count: i32,
        options: *const welkin_projection_options,
        post: *const welkin_post_options,
        job: *mut *mut welkin_job,
    ) -> welkin_status;
}
extern "C" {
    pub fn welkin_post_project_file(
        worker: *mut welkin_worker,
        path: *const ::std::os::raw::c_char,
        read_options: *const welkin_read_options,
        options: *const welkin_projection_options,
        post: *const welkin_post_options,
        job: *mut *mut welkin_job,
    ) -> welkin_status;
}
extern "C" {
    pub fn welkin_post_prefilter(
        worker: *mut welkin_worker,
        environment: *const welkin_environment,
        options: *const welkin_prefilter_options,
        post: *const welkin_post_options,
        job: *mut *mut welkin_job,
    ) -> welkin_status;
}
extern "C" {
    pub fn welkin_post_bake_file(
        worker: *mut welkin_worker,
        path: *const ::std::os::raw::c_char,
        read_options: *const welkin_read_options,
        options: *const welkin_bake_options,
        post: *const welkin_post_options,
        job: *mut *mut welkin_job,
    ) -> welkin_status;
}
extern "C" {
    pub fn welkin_post_sky_tables(
        worker: *mut welkin_worker,
        atmosphere: *const welkin_atmosphere,
        options: *const welkin_sky_table_options,
        post: *const welkin_post_options,
        job: *mut *mut welkin_job,
    ) -> welkin_status;
}
extern "C" {
    pub fn welkin_post_sky_curve(
        worker: *mut welkin_worker,
        tables: *const welkin_sky_tables,
        altitude_m: f64,
        options: *const welkin_sky_harmonics_options,
        post: *const welkin_post_options,
        job: *mut *mut welkin_job,
    ) -> welkin_status;
}
extern "C" {
    pub fn welkin_post_sky_specular(
        worker: *mut welkin_worker,
        tables: *const welkin_sky_tables,
        altitude_m: f64,
        sun: *const f64,
        options: *const welkin_prefilter_options,
        post: *const welkin_post_options,
        job: *mut *mut welkin_job,
    ) -> welkin_status;
}
#[doc = " Memory of the caller for the cubemaps of a bake: RGBA_F16 or RGBA_F32, the targets of one part all with one"]
#[doc = " `struct_size`. Parts without targets are in the result."]
#[repr(C)]
#[derive(Debug, Copy, Clone)]
pub struct welkin_bake_targets {
    pub struct_size: u32,
    #[doc = " one per level"]
    pub background: *const welkin_target,
    #[doc = " number of targets; 0: none"]
    pub background_count: i64,
    #[doc = " one per mip"]
    pub specular: *const welkin_target,
    #[doc = " number of targets; 0: none"]
    pub specular_count: i64,
    #[doc = " one; null: none"]
    pub irradiance: *const welkin_target,
}
impl Default for welkin_bake_targets {
    fn default() -> Self {
        let mut s = ::std::mem::MaybeUninit::<Self>::uninit();
        unsafe {
            ::std::ptr::write_bytes(s.as_mut_ptr(), 0, 1);
            s.assume_init()
        }
    }
}
extern "C" {
    #[doc = " Posts `welkin_bake`. If `targets` is not null, the worker's threads write the cubemaps there; that memory must stay"]
    #[doc = " valid, and be no other running job's, until the job is ready (even if replaced), and `release` waits for the last"]
    #[doc = " write. A job that fails may have written some texels, but none if it never started or its targets are refused."]
    pub fn welkin_post_bake(
        worker: *mut welkin_worker,
        environment: *const welkin_environment,
        options: *const welkin_bake_options,
        targets: *const welkin_bake_targets,
        post: *const welkin_post_options,
        job: *mut *mut welkin_job,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Posts a function: `run(run_user, control)` is called once on a thread of the worker, or not at all if the job is"]
    #[doc = " cancelled first. The status that it returns, any but WELKIN_NOT_READY, becomes the job's, with the message of a call"]
    #[doc = " of this library that failed inside it with that status. Codes of your own start at 1000. The function should check"]
    #[doc = " `welkin_control_stop_requested` once per millisecond. After `pthread_exit` the job completes with WELKIN_INTERNAL."]
    pub fn welkin_post_function(
        worker: *mut welkin_worker,
        run: ::std::option::Option<
            unsafe extern "C" fn(
                run_user: *mut ::std::os::raw::c_void,
                control: *const welkin_control,
            ) -> welkin_status,
        >,
        run_user: *mut ::std::os::raw::c_void,
        post: *const welkin_post_options,
        job: *mut *mut welkin_job,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Returns 1 if the job was cancelled: the function should then return, for instance WELKIN_CANCELLED. Else 0."]
    pub fn welkin_control_stop_requested(control: *const welkin_control) -> i32;
}
extern "C" {
    #[doc = " Reports the fraction of the work that is done, 0 to 1. Lower values than before are ignored."]
    pub fn welkin_control_report_progress(
        control: *const welkin_control,
        done: f64,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Returns a number that is unique in the process and increases in the order of posting; 0 for null."]
    pub fn welkin_job_id(job: *const welkin_job) -> u64;
}
extern "C" {
    #[doc = " Returns WELKIN_NOT_READY while the job waits or runs, then WELKIN_OK or its error. `progress` (or null): 0 to 1."]
    pub fn welkin_job_poll(job: *const welkin_job, progress: *mut f64) -> welkin_status;
}
extern "C" {
    #[doc = " Waits until the job is ready, but at most `timeout_nanoseconds`, and returns the status of `welkin_job_poll`. On a"]
    #[doc = " thread of the worker, a wait with WELKIN_NO_LIMIT runs the job itself if that has not started. A request that waits"]
    #[doc = " for its own job, directly or through other jobs, deadlocks."]
    pub fn welkin_job_wait(job: *const welkin_job, timeout_nanoseconds: u64) -> welkin_status;
}
extern "C" {
    #[doc = " Returns the result: a copy of a projection, or a handle to a chain, a bake, sky tables or a sky curve."]
    pub fn welkin_job_projection(
        job: *const welkin_job,
        projection: *mut welkin_projection,
    ) -> welkin_status;
}
extern "C" {
    pub fn welkin_job_get_chain(
        job: *const welkin_job,
        chain: *mut *mut welkin_chain,
    ) -> welkin_status;
}
extern "C" {
    pub fn welkin_job_get_bake(
        job: *const welkin_job,
        result: *mut *mut welkin_bake_result,
    ) -> welkin_status;
}
extern "C" {
    pub fn welkin_job_get_sky_tables(
        job: *const welkin_job,
        tables: *mut *mut welkin_sky_tables,
    ) -> welkin_status;
}
extern "C" {
    pub fn welkin_job_get_sky_curve(
        job: *const welkin_job,
        curve: *mut *mut welkin_sky_curve,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Cancels the job; it completes with WELKIN_CANCELLED: at once if it waits, else before its next tile (a function: when"]
    #[doc = " it returns). `cancelled` (may be null) receives 1 if this call cancelled it, else 0."]
    pub fn welkin_job_cancel(job: *mut welkin_job, cancelled: *mut i32) -> welkin_status;
}
extern "C" {
    #[doc = " Moves a waiting job to the end of the queue of that priority."]
    pub fn welkin_job_set_priority(
        job: *mut welkin_job,
        priority: welkin_priority,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Adds a reference. A job whose last reference is dropped still completes."]
    pub fn welkin_job_retain(job: *mut welkin_job);
}
extern "C" {
    pub fn welkin_job_release(job: *mut welkin_job);
}
#[doc = " Options of a dynamic sky, with thresholds for recomputing."]
#[repr(C)]
#[derive(Debug, Copy, Clone)]
pub struct welkin_sky_light_options {
    pub struct_size: u32,
    #[doc = " priority of posted jobs"]
    pub priority: welkin_priority,
    #[doc = " ignored if tables are given"]
    pub tables: *const welkin_sky_table_options,
    #[doc = " includes the number of bands"]
    pub curve: *const welkin_sky_harmonics_options,
    #[doc = " options of the chain; null: the defaults"]
    pub specular: *const welkin_prefilter_options,
    #[doc = " 1: no reflections"]
    pub without_specular: i32,
    #[doc = " altitude of the observer above the ground"]
    pub altitude_m: f64,
    #[doc = " smaller movements are ignored; 0: 0.01; negative: every change counts"]
    pub sun_threshold_degrees: f64,
    #[doc = " change of elevation between new reflections; 0: 0.5; negative: all"]
    pub specular_threshold_degrees: f64,
    #[doc = " smaller changes are ignored; 0: 1; negative: every change counts"]
    pub altitude_threshold_m: f64,
    #[doc = " time to blend from old to new light; 0: 0.5; negative: at once"]
    pub blend_seconds: f64,
}
impl Default for welkin_sky_light_options {
    fn default() -> Self {
        let mut s = ::std::mem::MaybeUninit::<Self>::uninit();
        unsafe {
            ::std::ptr::write_bytes(s.as_mut_ptr(), 0, 1);
            s.assume_init()
        }
    }
}
#[doc = " A prefiltered sky, with its weight and rotation for this frame."]
#[repr(C)]
#[derive(Debug, Copy, Clone)]
pub struct welkin_sky_reflections {
    #[doc = " valid until the next update; null: none yet"]
    pub chain: *const welkin_chain,
    #[doc = " increases with each new chain; upload only if it changed; 0: none"]
    pub id: u64,
    #[doc = " factor of its light"]
    pub weight: f64,
    #[doc = " rotation, column-major: the light of d now comes from rotation * d"]
    pub rotation: [f64; 9usize],
}
impl Default for welkin_sky_reflections {
    fn default() -> Self {
        let mut s = ::std::mem::MaybeUninit::<Self>::uninit();
        unsafe {
            ::std::ptr::write_bytes(s.as_mut_ptr(), 0, 1);
            s.assume_init()
        }
    }
}
#[doc = " The light of a frame. `struct_size` may end inside `coefficients`."]
#[repr(C)]
#[derive(Debug, Copy, Clone)]
pub struct welkin_sky_frame {
    pub struct_size: u32,
    #[doc = " 0 until the first curve is available: all light is black"]
    pub ready: i32,
    #[doc = " 1: nothing is being computed or blended"]
    pub settled: i32,
    #[doc = " bands in `coefficients`"]
    pub bands: i32,
    #[doc = " direction towards the sun"]
    pub sun_direction: [f64; 3usize],
    #[doc = " on a surface facing it, including intensity"]
    pub sun_irradiance: [f64; 3usize],
    #[doc = " steradians"]
    pub sun_solid_angle: f64,
    #[doc = " newer and older; the weights add up to the intensity"]
    pub reflections: [welkin_sky_reflections; 2usize],
    #[doc = " radiance without the sun's disc, including intensity"]
    pub coefficients: [f64; 768usize],
}
impl Default for welkin_sky_frame {
    fn default() -> Self {
        let mut s = ::std::mem::MaybeUninit::<Self>::uninit();
        unsafe {
            ::std::ptr::write_bytes(s.as_mut_ptr(), 0, 1);
            s.assume_init()
        }
    }
}
extern "C" {
    #[doc = " Creates a dynamic sky, with the sun at the zenith. If `tables` is given, `atmosphere` is ignored and may be null, and"]
    #[doc = " the tables' own options apply. If `tables` is null, the worker computes them."]
    pub fn welkin_sky_light_create(
        worker: *mut welkin_worker,
        atmosphere: *const welkin_atmosphere,
        tables: *const welkin_sky_tables,
        options: *const welkin_sky_light_options,
        light: *mut *mut welkin_sky_light,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Sets the sun's direction and the other parameters. Posts a request only if something must be computed."]
    pub fn welkin_sky_light_set_sun(light: *mut welkin_sky_light, sun: *const f64)
        -> welkin_status;
}
extern "C" {
    pub fn welkin_sky_light_set_intensity(
        light: *mut welkin_sky_light,
        intensity: f64,
    ) -> welkin_status;
}
extern "C" {
    pub fn welkin_sky_light_set_altitude(
        light: *mut welkin_sky_light,
        altitude_m: f64,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Sets the planet."]
    pub fn welkin_sky_light_set_atmosphere(
        light: *mut welkin_sky_light,
        atmosphere: *const welkin_atmosphere,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Collects finished results, advances blending, and writes the light of the frame. Never waits. Allocates only in a"]
    #[doc = " frame in which new reflections have arrived, for their handle. `seconds` is the time since the last update."]
    pub fn welkin_sky_light_update(
        light: *mut welkin_sky_light,
        seconds: f64,
        frame: *mut welkin_sky_frame,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Returns WELKIN_OK, or the error of the last bake that failed. The light stays; the next change tries again."]
    pub fn welkin_sky_light_get_status(light: *const welkin_sky_light) -> welkin_status;
}
#[doc = " Formats of written texels. Values out of range are clamped and counted; NaN becomes 0, except in RGBA32F. B10G11R11"]
#[doc = " has a precision of 1 part in 32 from 0 to 64512; E5B9G9R9 of 1 part in 512 of the largest channel from 0 to 65408."]
#[doc = " OpenEXR holds the first two only; BC6H needs KTX2, KTX or DDS; ASTC (with astcenc) and UASTC HDR need KTX2."]
pub type welkin_texel_format = i32;
pub const WELKIN_TEXEL_RGBA16F: welkin_texel_format = 0;
pub const WELKIN_TEXEL_RGBA32F: welkin_texel_format = 1;
pub const WELKIN_TEXEL_B10G11R11: welkin_texel_format = 2;
pub const WELKIN_TEXEL_E5B9G9R9: welkin_texel_format = 3;
pub const WELKIN_TEXEL_BC6H_UFLOAT: welkin_texel_format = 4;
pub const WELKIN_TEXEL_BC6H_SFLOAT: welkin_texel_format = 5;
#[doc = " clang-format on"]
pub const WELKIN_TEXEL_ASTC_4X4_HDR: welkin_texel_format = 6;
#[doc = " clang-format on"]
pub const WELKIN_TEXEL_ASTC_6X6_HDR: welkin_texel_format = 7;
#[doc = " clang-format on"]
pub const WELKIN_TEXEL_UASTC_HDR_4X4: welkin_texel_format = 8;
#[doc = " Search effort of encoders for blocks; docs/reference/textures.md has errors and times. DEFAULT: NORMAL."]
pub type welkin_effort = i32;
pub const WELKIN_EFFORT_DEFAULT: welkin_effort = 0;
pub const WELKIN_EFFORT_FASTEST: welkin_effort = 1;
pub const WELKIN_EFFORT_FAST: welkin_effort = 2;
#[doc = " clang-format on"]
pub const WELKIN_EFFORT_NORMAL: welkin_effort = 3;
#[doc = " clang-format on"]
pub const WELKIN_EFFORT_SLOW: welkin_effort = 4;
#[doc = " Compression of KTX2's levels."]
pub type welkin_supercompression = i32;
pub const WELKIN_SUPERCOMPRESSION_NONE: welkin_supercompression = 0;
pub const WELKIN_SUPERCOMPRESSION_ZLIB: welkin_supercompression = 1;
pub const WELKIN_SUPERCOMPRESSION_ZSTD: welkin_supercompression = 2;
#[doc = " Options for writing textures."]
#[repr(C)]
#[derive(Debug, Default, Copy, Clone)]
pub struct welkin_texture_options {
    pub struct_size: u32,
    #[doc = " format of all texels"]
    pub format: welkin_texel_format,
    #[doc = " KTX2 only"]
    pub supercompression: welkin_supercompression,
    #[doc = " for the BC6H and ASTC formats"]
    pub effort: welkin_effort,
}
extern "C" {
    #[doc = " Writes a texture in the format that the extension names. `mips` is a cubemap with its mips, as in `welkin_project`"]
    #[doc = " (.ktx2, .ktx, .dds or .exr), or a flat image of packed RGB_F32 of `width` x `height`, like BRDF tables (.ktx2, .dds)."]
    pub fn welkin_write_texture(
        path: *const ::std::os::raw::c_char,
        mips: *const welkin_environment,
        mip_count: i32,
        options: *const welkin_texture_options,
        control: *const welkin_control,
        values_clamped: *mut u64,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Writes a chain. KTX2 and OpenEXR keep its roughness as metadata, which this library reads."]
    pub fn welkin_write_chain(
        path: *const ::std::os::raw::c_char,
        chain: *const welkin_chain,
        options: *const welkin_texture_options,
        control: *const welkin_control,
        values_clamped: *mut u64,
    ) -> welkin_status;
}
extern "C" {
    #[doc = " Writes Babylon.js's .env: a chain prefiltered with WELKIN_ROUGHNESS_BABYLON down to 1 texel, whose size is a power of"]
    #[doc = " two, and the polynomial of the light. Both are given in Welkin's axes and are rotated to Babylon.js's."]
    pub fn welkin_write_babylon_environment(
        path: *const ::std::os::raw::c_char,
        specular: *const welkin_chain,
        bands: i32,
        radiance: *const f64,
        control: *const welkin_control,
        values_clamped: *mut u64,
    ) -> welkin_status;
}
