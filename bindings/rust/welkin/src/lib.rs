#![doc = include_str!("../README.md")]
//! Results are immutable and may be read from any number of threads. Errors hold the library's message.
#![warn(missing_docs)]
use std::ffi::CStr;
use std::mem::{size_of, zeroed};
use std::os::raw::c_void;
use std::ptr::{null, null_mut};
use std::time::Duration;
use welkin_sys as sys;

/// A call that failed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Error {
    /// A `WELKIN_...` status of `welkin_sys`.
    pub status: i32,
    /// The input, the fault and the remedy.
    pub message: String,
}

impl std::fmt::Display for Error {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.write_str(&self.message)
    }
}
impl std::error::Error for Error {}

/// Result of a call.
pub type Result<T> = std::result::Result<T, Error>;

fn check(status: i32) -> Result<()> {
    if status == sys::WELKIN_OK {
        return Ok(());
    }
    // SAFETY: the message is never null, and valid until the next error on this thread.
    let message = unsafe { CStr::from_ptr(sys::welkin_last_error()) };
    Err(Error { status, message: message.to_string_lossy().into_owned() })
}

fn refuse<T>(message: &str) -> Result<T> {
    Err(Error { status: sys::WELKIN_INVALID_ARGUMENT, message: message.into() })
}

/// Makes a structure of the C interface with all defaults. SAFETY: zero is a value of every field of these structures.
macro_rules! defaults {
    ($kind:ident) => {{
        let mut value: sys::$kind = unsafe { zeroed() };
        value.struct_size = size_of::<sys::$kind>() as u32;
        value
    }};
}

/// Owns a handle of the C interface, destroyed on drop. Results are immutable, and a worker takes calls from any thread.
macro_rules! handle {
    ($(#[$about:meta])* $name:ident, $kind:ident, $destroy:ident) => {
        $(#[$about])*
        #[derive(Debug)]
        pub struct $name(*mut sys::$kind);
        // SAFETY: welkin.h lets any thread call its functions, and results are immutable.
        unsafe impl Send for $name {}
        unsafe impl Sync for $name {}
        impl Drop for $name {
            fn drop(&mut self) {
                // SAFETY: this object owns the handle.
                unsafe { sys::$destroy(self.0) }
            }
        }
    };
}

/// Harmonics of radiance.
#[derive(Debug, Clone, PartialEq)]
pub struct Projection {
    /// Number of bands.
    pub bands: usize,
    /// Estimated relative error of the coefficients.
    pub error_estimate: f64,
    /// r, g and b of coefficient (l, m) at index l (l + 1) + m.
    pub coefficients: Vec<[f64; 3]>,
}

fn rgb(values: &[f64]) -> Vec<[f64; 3]> {
    values.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect()
}

impl Projection {
    fn new(from: &sys::welkin_projection) -> Self {
        let bands = from.bands as usize;
        let coefficients = rgb(&from.coefficients[..3 * bands * bands]);
        Projection { bands, error_estimate: from.error_estimate, coefficients }
    }
}

/// A cubemap of packed RGB floats: faces +X -X +Y -Y +Z -Z one after another, top row first.
#[derive(Debug, Clone)]
pub struct Cubemap {
    size: usize,
    pixels: Vec<f32>,
}

impl Cubemap {
    /// Takes `18 size^2` floats. Returns an error if there are more or fewer.
    pub fn new(size: usize, pixels: Vec<f32>) -> Result<Self> {
        if !(1..=16384).contains(&size) || pixels.len() != 18 * size * size {
            return refuse("a cubemap has 1 to 16384 texels per edge, and 18 size^2 floats");
        }
        Ok(Cubemap { size, pixels })
    }

    fn view(&self) -> sys::welkin_environment {
        let mut view = defaults!(welkin_environment);
        view.size = self.size as i64;
        for (k, face) in self.pixels.chunks_exact(3 * self.size * self.size).enumerate() {
            view.faces[k] = face.as_ptr() as *const c_void;
        }
        view
    }

    /// Projects the cubemap to 1 to 16 bands.
    pub fn project(&self, bands: i32) -> Result<Projection> {
        let mut options = defaults!(welkin_projection_options);
        options.bands = bands;
        let mut light = defaults!(welkin_projection);
        // SAFETY: all pointers are valid during the call.
        check(unsafe { sys::welkin_project(&self.view(), 1, &options, null(), &mut light) })?;
        Ok(Projection::new(&light))
    }

    /// Prefilters the cubemap for specular reflections (GGX), with `size` texels per edge of mip 0; 0: 256.
    pub fn prefilter(&self, size: i32) -> Result<Chain> {
        let mut options = defaults!(welkin_prefilter_options);
        options.size = size;
        let mut chain = Chain(null_mut());
        // SAFETY: all pointers are valid during the call.
        check(unsafe { sys::welkin_prefilter(&self.view(), &options, null(), &mut chain.0) })?;
        Ok(chain)
    }

    /// Bakes background, reflections of `size` texels per edge (0: 256), irradiance, harmonics and the BRDF table.
    pub fn bake(&self, size: i32) -> Result<Bake> {
        let mut specular = defaults!(welkin_prefilter_options);
        specular.size = size;
        let mut options = defaults!(welkin_bake_options);
        options.specular = &specular;
        let mut bake = Bake(null_mut());
        // SAFETY: all pointers are valid during the call.
        check(unsafe { sys::welkin_bake(&self.view(), &options, null(), &mut bake.0) })?;
        Ok(bake)
    }
}

handle!(
    /// A cubemap of RGB floats with its mips.
    Chain, welkin_chain, welkin_chain_destroy
);

impl Chain {
    fn info(&self) -> sys::welkin_chain_info {
        let mut info = defaults!(welkin_chain_info);
        // SAFETY: the handle is not null. The call fails for nothing else.
        unsafe { sys::welkin_chain_get_info(self.0, &mut info) };
        info
    }
    /// Returns the texels per edge of level 0.
    pub fn size(&self) -> usize {
        self.info().size as usize
    }
    /// Returns the number of levels.
    pub fn levels(&self) -> usize {
        self.info().levels as usize
    }
    /// Returns the packed RGB texels of a face in place.
    pub fn face(&self, level: usize, face: usize) -> Result<&[f32]> {
        if face > 5 || level >= self.levels() {
            return refuse("there is no such face or level");
        }
        let mut pixels = defaults!(welkin_environment);
        // SAFETY: the pixels are immutable and valid while the chain is held, which the borrow ensures.
        unsafe {
            check(sys::welkin_chain_get_level(self.0, level as i32, &mut pixels))?;
            let count = (3 * pixels.size * pixels.size) as usize;
            Ok(std::slice::from_raw_parts(pixels.faces[face] as *const f32, count))
        }
    }
}

handle!(
    /// Result of a bake.
    Bake, welkin_bake_result, welkin_bake_result_destroy
);

impl Bake {
    fn part(&self, part: sys::welkin_parts) -> Result<Chain> {
        let mut chain = Chain(null_mut());
        // SAFETY: the handle is valid; sharing refuses the null pointer of a part that was not made.
        check(unsafe { sys::welkin_chain_share(sys::welkin_bake_result_chain(self.0, part), &mut chain.0) })?;
        Ok(chain)
    }
    /// Returns the sharp cubemap with its mips.
    pub fn background(&self) -> Result<Chain> {
        self.part(sys::WELKIN_PART_BACKGROUND)
    }
    /// Returns the prefiltered reflections.
    pub fn specular(&self) -> Result<Chain> {
        self.part(sys::WELKIN_PART_SPECULAR)
    }
    /// Returns the irradiance cubemap.
    pub fn irradiance(&self) -> Result<Chain> {
        self.part(sys::WELKIN_PART_IRRADIANCE)
    }
    /// Returns harmonics of radiance.
    pub fn radiance(&self) -> Result<Projection> {
        let mut light = defaults!(welkin_projection);
        // SAFETY: both pointers are valid.
        check(unsafe { sys::welkin_bake_result_get_projection(self.0, &mut light) })?;
        Ok(Projection::new(&light))
    }
}

handle!(
    /// Precomputed scattering of a planet's atmosphere.
    SkyTables, welkin_sky_tables, welkin_sky_tables_destroy
);
handle!(
    /// Harmonics of the sky from one altitude, for any sun.
    SkyCurve, welkin_sky_curve, welkin_sky_curve_destroy
);

/// Sizes of sky tables; welkin.h describes the fields. `struct_size` is set by the call.
pub use sys::welkin_sky_table_options as SkyTableOptions;

impl SkyTables {
    /// Computes tables of a planet (`welkin_sys::WELKIN_PLANET_...`): 2 to 3 s of CPU time with the default options.
    pub fn new(planet: i32, options: &SkyTableOptions) -> Result<Self> {
        let mut atmosphere = defaults!(welkin_atmosphere);
        atmosphere.planet = planet;
        let options = SkyTableOptions { struct_size: size_of::<SkyTableOptions>() as u32, ..*options };
        let mut tables = SkyTables(null_mut());
        // SAFETY: all pointers are valid during the call.
        check(unsafe { sys::welkin_sky_tables_create(&atmosphere, &options, null(), &mut tables.0) })?;
        Ok(tables)
    }

    /// Computes three bands of harmonics from an altitude, at `nodes` elevations of the sun; 0: 256.
    pub fn curve(&self, altitude_m: f64, nodes: i32) -> Result<SkyCurve> {
        let mut options = defaults!(welkin_sky_harmonics_options);
        options.bands = 3;
        options.nodes = nodes;
        let (mut view, mut curve) = (null_mut(), SkyCurve(null_mut()));
        // SAFETY: all pointers are valid during the calls. A curve may outlive its view.
        unsafe {
            check(sys::welkin_sky_view_create(self.0, altitude_m, 0, &mut view))?;
            let made = check(sys::welkin_sky_curve_create(view, &options, null(), &mut curve.0));
            sys::welkin_sky_view_destroy(view);
            made?;
        }
        Ok(curve)
    }
}

impl SkyCurve {
    /// Returns radiance without the sun's disc, and direct sunlight on a surface facing the sun.
    pub fn at(&self, elevation_degrees: f64, azimuth_degrees: f64) -> Result<(Vec<[f64; 3]>, [f64; 3])> {
        let (mut sun, mut light, mut direct) = ([0.0; 3], [0.0; 27], [0.0; 3]);
        // SAFETY: the curve has three bands, which are 27 numbers.
        unsafe {
            check(sys::welkin_sun_direction(elevation_degrees, azimuth_degrees, sun.as_mut_ptr()))?;
            check(sys::welkin_sky_curve_at(self.0, sun.as_ptr(), light.as_mut_ptr(), direct.as_mut_ptr()))?;
        }
        Ok((rgb(&light), direct))
    }
}

handle!(
    /// Bakes on threads of its own. Dropping it cancels all jobs and waits until none runs.
    Worker, welkin_worker, welkin_worker_destroy
);
handle!(
    /// A posted bake. It completes whether the handle is held or not.
    Job, welkin_job, welkin_job_release
);

unsafe extern "C" fn release(pixels: *mut c_void) {
    drop(Box::from_raw(pixels as *mut Cubemap));
}

impl Worker {
    /// Creates a worker with 1 to 1024 threads; 0: one less than the process may use.
    pub fn new(threads: i32) -> Result<Self> {
        let mut options = defaults!(welkin_worker_options);
        options.threads = threads;
        let mut worker = Worker(null_mut());
        // SAFETY: both pointers are valid.
        check(unsafe { sys::welkin_worker_create(&options, &mut worker.0) })?;
        Ok(worker)
    }

    /// Posts `Cubemap::bake`. The job owns the pixels.
    pub fn bake(&self, cubemap: Cubemap, size: i32) -> Result<Job> {
        let mut specular = defaults!(welkin_prefilter_options);
        specular.size = size;
        let mut options = defaults!(welkin_bake_options);
        options.specular = &specular;
        let view = cubemap.view(); // of the heap: it stays valid as the cubemap moves to the box
        let mut post = defaults!(welkin_post_options);
        post.release = Some(release);
        post.release_user = Box::into_raw(Box::new(cubemap)) as *mut c_void;
        let mut job = Job(null_mut());
        // SAFETY: the call releases the pixels exactly once, even if it fails.
        check(unsafe { sys::welkin_post_bake(self.0, &view, &options, null(), &post, &mut job.0) })?;
        Ok(job)
    }
}

impl Job {
    fn result(&self, status: i32) -> Result<Option<Bake>> {
        if status == sys::WELKIN_NOT_READY {
            return Ok(None);
        }
        check(status)?;
        let mut bake = Bake(null_mut());
        // SAFETY: the job is ready, and makes a bake.
        check(unsafe { sys::welkin_job_get_bake(self.0, &mut bake.0) })?;
        Ok(Some(bake))
    }
    /// Returns the result if it is ready. Never waits.
    pub fn poll(&self) -> Result<Option<Bake>> {
        // SAFETY: the handle is valid, and the progress may be null.
        self.result(unsafe { sys::welkin_job_poll(self.0, null_mut()) })
    }
    /// Waits for the result, but at most `timeout`.
    pub fn wait_for(&self, timeout: Duration) -> Result<Option<Bake>> {
        let limit = timeout.as_nanos().min(u128::from(u64::MAX - 1)) as u64;
        // SAFETY: the handle is valid.
        self.result(unsafe { sys::welkin_job_wait(self.0, limit) })
    }
    /// Waits for the result.
    pub fn wait(&self) -> Result<Bake> {
        // SAFETY: the handle is valid. The largest number means no limit, so the job is ready.
        let status = unsafe { sys::welkin_job_wait(self.0, u64::MAX) };
        self.result(status).map(|bake| bake.expect("a wait without a limit ends when the job is ready"))
    }
    /// Cancels the job. Returns whether this call cancelled it.
    pub fn cancel(&self) -> Result<bool> {
        let mut cancelled = 0;
        // SAFETY: both pointers are valid.
        check(unsafe { sys::welkin_job_cancel(self.0, &mut cancelled) })?;
        Ok(cancelled == 1)
    }
}
