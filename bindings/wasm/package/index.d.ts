/** Image-based lighting in a Web Worker (in Node.js: a worker thread). Every call returns a promise at once. Unknown
 * options are refused. */

/** Welkin's error codes, and three of this package's own. */
export type ErrorCode =
  | 'invalid_argument' | 'rejected_pixel' | 'file_access' | 'corrupt_file' | 'unsupported_file' | 'limit_exceeded'
  | 'out_of_memory' | 'stopped' | 'unexpected';

/** Error of rejected calls. A call that its signal aborts is rejected with the signal's reason instead. */
export class WelkinError extends Error {
  readonly code: ErrorCode;
}

export type Triple = [number, number, number];

/** Layout of texels in memory; `srgb8` and `srgba8` are decoded from sRGB. */
export type PixelFormat = 'rgb32f' | 'rgba32f' | 'rgb16f' | 'rgba16f' | 'rgb8' | 'rgba8' | 'srgb8' | 'srgba8';

export type Pixels = Float32Array | Uint16Array | Uint8Array | Uint8ClampedArray | ArrayBuffer;

/** Options of every call. */
export interface CallOptions {
  /** Cancels the call, which is rejected with the signal's reason. A running job ends with its worker. */
  signal?: AbortSignal;
  /** Receives the fraction of the work that is done, 0 to 1, at most every 30 ms. */
  onProgress?: (share: number) => void;
  /** Transfers the input's buffers to the worker instead of copying them; they are detached. Default: false. */
  transfer?: boolean;
}

/** Treatment of pixel values before they are used as radiance. */
export interface PixelOptions {
  /** Maximum of each channel. Default: none. Babylon.js uses 4096. */
  clamp?: number;
  /** Clamps by scaling the three channels together. */
  preserveColour?: boolean;
  /** Decodes gamma-encoded values: clamps them to [0, 1] and raises them to the power of 2.2, as Babylon.js does. */
  gamma?: boolean;
  /** Negatives become 0. */
  replaceNegatives?: boolean;
  /** Rejects NaN and infinities instead of replacing them. */
  rejectNonFinite?: boolean;
}

/** Contents of typed arrays: floats, half floats (`Uint16Array`), or bytes, which are sRGB unless `linear` is set. */
export interface SourceOptions extends PixelOptions {
  format?: PixelFormat;
  linear?: boolean;
}

export interface ProjectionOptions extends CallOptions, SourceOptions {
  /** 1 to 16. Default: 3. */
  bands?: number;
  /** Texels as areas ('exact', the default), or as points, as in Babylon.js. */
  quadrature?: 'exact' | 'midpoint';
  /** Texels per edge of the faces to which the environment is reduced first. */
  targetSize?: number;
}

/** Babylon.js's `SphericalPolynomial`. */
export type Polynomial = Record<'x' | 'y' | 'z' | 'xx' | 'yy' | 'zz' | 'yz' | 'zx' | 'xy', Triple>;

export interface SphericalHarmonics {
  bands: number;
  /**
   * Coefficients of radiance, red, green and blue of each, (l, m) at l (l + 1) + m: real, orthonormal, without
   * Condon-Shortley phase. Axes are right-handed with y up; for a cubemap, those of its faces.
   */
  radiance: Float64Array;
  /** Polynomial of the first three bands, as computed by Babylon.js. */
  polynomial: Polynomial;
}

export interface Projection extends SphericalHarmonics {
  diagnostics: {
    texels: number;
    nansReplaced: number;
    infinitiesReplaced: number;
    negativesReplaced: number;
    texelsClamped: number;
    /** Estimated relative error of the coefficients. */
    errorEstimate: number;
    /** Integral of radiance over the sphere. */
    totalRadiance: Triple;
  };
}

/** Projects a cubemap: six faces +X -X +Y -Y +Z -Z, RGB or RGBA, top row first; or all six in one array. */
export function projectCubemap(faces: Pixels[] | Pixels, options?: ProjectionOptions): Promise<Projection>;

/** Part of a face: `offset` in bytes, and bytes that are transferred to the worker. */
export interface FaceSlice { face: number; offset: number; slice: ArrayBuffer }

/**
 * Projects six faces of `size` x `size` texels that arrive in slices, so that no task of the page copies them all. Every
 * byte must come once. If the generator throws, the promise is rejected with its error.
 */
export function projectSlices(slices: AsyncIterable<FaceSlice> | Iterable<FaceSlice>,
  options: ProjectionOptions & { size: number; format: PixelFormat }): Promise<Projection>;

/** Projects an equirectangular image. Its centre looks along +z; +x lies a quarter of the width from the left edge. */
export function projectEquirect(pixels: Pixels, options: ProjectionOptions & { width: number; height: number }):
  Promise<Projection>;

/** Mapping from mips to roughness. three.js uses 'filament'. */
export type RoughnessSchedule = 'linear' | 'filament' | 'babylon' | 'unity' | 'unreal';

/** Lobes of reflections, as functions of roughness. */
export type LobeFamily = 'ggx' | 'charlie' | 'lambert' | 'phong' | 'blinn';

export interface ChainOptions {
  /** Options for an engine: 'three' sets `mirrorX` and the schedule 'filament', 'babylon' `mirrorX` and 'babylon'. */
  for?: 'three' | 'babylon';
  /** Texels per edge of mip 0, 1 to 4096. Default: 256. */
  size?: number;
  mips?: number;
  /** Default: 'filament'. */
  schedule?: RoughnessSchedule;
  /** Lobe of all mips. 'charlie' (sheen) and 'lambert' have their own roughness. Default: 'ggx'. */
  lobe?: LobeFamily;
  /** Preset of `rmsError`: 'fast' 1e-2, 'normal' 1e-3; 'reference': the integral, slow. Default: 'normal'. */
  quality?: 'normal' | 'fast' | 'reference';
  /** Fits lobes to shaders that interpolate linearly between mips by the schedule's formula. Default: false. */
  fitLookups?: boolean;
  /** Bound on a mip's relative rms error. Default: by `quality`. */
  rmsError?: number;
  /** Bound on the relative error at any texel. Default: ten times `rmsError`, at most 1. */
  maximumError?: number;
  /** Returns floats instead of half floats. */
  floats?: boolean;
  /** Mirrors the faces in x, as three.js and Babylon.js expect for cube textures. */
  mirrorX?: boolean;
}

export interface CubeFaces {
  /** Texels per edge. */
  size: number;
  format: 'rgba16f' | 'rgba32f';
  mirrored: boolean;
  /** Six faces, RGBA with an alpha of 1, top row first. */
  faces: (Uint16Array | Float32Array)[];
}

export interface Mip {
  size: number;
  /** Perceptual. */
  roughness: number;
  /** Predicted relative rms error; null if unknown. */
  errorEstimate: number | null;
  /** Predicted relative rms error of lookups between this mip and the next; null if unknown. */
  errorBetween: number | null;
  faces: (Uint16Array | Float32Array)[];
}

export interface Chain {
  size: number;
  format: 'rgba16f' | 'rgba32f';
  mirrored: boolean;
  mips: Mip[];
}

/** Prefilters a cubemap for specular reflections, one roughness per mip. */
export function prefilterCubemap(faces: Pixels[] | Pixels, options?: CallOptions & SourceOptions & ChainOptions):
  Promise<Chain>;
export function prefilterEquirect(pixels: Pixels,
  options: CallOptions & SourceOptions & ChainOptions & { width: number; height: number }): Promise<Chain>;

export interface LightOptions extends ChainOptions {
  /** Bands of harmonics, 1 to 16. Default: 3. */
  bands?: number;
  /** Makes a specular chain. Default: true. */
  specular?: boolean;
  /** Makes a file in Babylon.js's format, prefiltered, with its polynomial. Loads the module of textures. */
  env?: boolean;
  /** Makes a KTX2 file of the chain, mirrored if `mirrorX` is set. Loads the module of textures. */
  ktx2?: boolean;
  /**
   * Format of the KTX2 file's texels: 'uastc-hdr' has one byte per texel, as three.js's KTX2Loader uploads it to phones
   * (ASTC) and desktops (BC6H). Default: as the chain, 'rgba16f' or 'rgba32f'.
   */
  ktx2Format?: 'rgba16f' | 'rgba32f' | 'b10g11r11' | 'e5b9g9r9' | 'uastc-hdr';
  /** Search effort of the encoder of 'uastc-hdr'. Default: 'normal'. */
  ktx2Effort?: 'fast' | 'normal' | 'slow';
  /** Supercompression of the KTX2 file. Default: 'none'. */
  supercompression?: 'none' | 'zlib' | 'zstd';
  /** Texels per edge of a sharp cubemap. Default: none. */
  background?: number;
}

/** A sun extracted from an image, or that of a computed sky. */
export interface Sun {
  /** Unit vector towards the sun. */
  direction: Triple;
  /** On a surface facing the sun. */
  irradiance: Triple;
  /** In degrees. */
  angularRadius: number;
}

export interface Light extends SphericalHarmonics {
  /** Short name of `radiance`: the same array. */
  sh: Float64Array;
  specular: Chain | null;
  env: Uint8Array | null;
  ktx2: Uint8Array | null;
  background: CubeFaces | null;
  sun: Sun | null;
}

export interface BakeOptions extends CallOptions, PixelOptions, LightOptions {
  /** Name of the file in messages. Its kind is detected from its bytes. */
  name?: string;
  layout?: 'automatic' | 'lat-long' | 'vertical-strip' | 'horizontal-strip' | 'horizontal-cross' | 'vertical-cross';
  /** Extracts the sun from an equirectangular image as a directional light. */
  extractSun?: boolean;
}

/** Bakes an environment from the bytes of a file, a Blob or a Response: Radiance .hdr, PFM, KTX2 and DDS. OpenEXR, PNG and
 * Babylon.js's .env (with PNG images) load the module of codecs, KTX2 with zlib or Zstandard that of textures. */
export function bakeEnvironment(file: ArrayBuffer | ArrayBufferView | Blob | Response, options?: BakeOptions):
  Promise<Light & { source: { width: number; height: number } }>;

export interface SkyOptions extends CallOptions, LightOptions {
  /** Degrees. Default: 30. */
  sunElevation?: number;
  /** Degrees from +z towards +x. Default: 0. */
  sunAzimuth?: number;
  /** Altitude of the observer above the ground in metres. Default: 0. */
  altitude?: number;
  aerosol?: 'clear' | 'hazy' | 'dusty' | 'polluted';
  /** Resolution of the sky's tables. Those of the last sky are cached, so a moving sun costs less. Default: 'coarse'. */
  tables?: 'coarse' | 'full';
  /** Texels per edge of the faces that are baked. Default: 128. */
  faceSize?: number;
  /** Includes the sun's disc in the image. Default: false; the sun is then the directional light `sun`. */
  sunDisc?: boolean;
}

/** Computes a sky and its light. */
export function sky(options?: SkyOptions): Promise<Light>;

export interface SkyLightOptions extends ChainOptions {
  /** Texels per edge of the reflections; 0 for none. Default: 32. */
  size?: number;
  altitude?: number;
  aerosol?: 'clear' | 'hazy' | 'dusty' | 'polluted';
  tables?: 'coarse' | 'full';
  /** Change of the sun's elevation in degrees after which reflections are computed again. Default: 0.5. */
  specularThreshold?: number;
  /** Time to blend from old reflections to new ones, in the caller's seconds. Default: 0.5. */
  blendSeconds?: number;
}

/** A chain of reflections with its part in a frame. */
export interface SkyReflections {
  specular: Chain;
  /** Degrees by which the chain is rotated about the vertical, from +z towards +x: the sun's azimuth. */
  azimuth: number;
  /** Factor of its light. */
  weight: number;
}

export interface SkyLightFrame {
  /** False until the first light has arrived: all light is black. */
  ready: boolean;
  /** True if nothing is being computed or blended. */
  settled: boolean;
  /** Three bands of radiance of sky and ground without the sun's disc. */
  radiance: Float64Array;
  sun: Sun;
  /** Newer and older reflections: none, one or two. */
  reflections: SkyReflections[];
}

/**
 * A sky whose sun moves. The worker computes the light by the sun's elevation once, and reflections after each
 * `specularThreshold`; `update` interpolates and rotates, and never waits.
 */
export class SkyLight {
  constructor(options?: SkyLightOptions);
  /** Degrees; azimuth from +z towards +x. */
  setSun(elevation: number, azimuth: number): void;
  /** Factor of all light. */
  setIntensity(intensity: number): void;
  /** Returns the light of a frame, `seconds` after the one before; the same object every time. */
  update(seconds: number): SkyLightFrame;
  readonly counters: { frames: number; speculars: number; failures: number };
  /** Error of the last job that failed, or null. */
  readonly error: WelkinError | null;
  dispose(): void;
}

export interface SunOptions extends CallOptions {
  /** Azimuth of north, degrees from +z towards +x. Default: 180: north is -z, east +x. */
  north?: number;
  /** Raises the sun by the refraction of air. Default: false. */
  refraction?: boolean;
  /** Of the air at the observer, hPa. Default: 1010. */
  pressure?: number;
  /** Of the air at the observer, degrees Celsius. Default: 10. */
  temperature?: number;
}

/** The centre of the sun's disc: degrees, astronomical units, and the unit vector towards it. */
export interface SunPosition {
  elevation: number;
  /** From +z towards +x, as `sunAzimuth` of `sky`. */
  azimuth: number;
  /** From north through east. */
  compass: number;
  /** Part of the elevation that is due to refraction. */
  refraction: number;
  distance: number;
  direction: Triple;
}

/** Computes the sun's position by date (a Date, milliseconds since 1970, or text with a time zone such as
 * '2026-06-21T20:30+02:00'; 1900 to 2099) and place (degrees, positive in the north and the east). */
export function sunPosition(date: Date | number | string, latitude: number, longitude: number, options?: SunOptions):
  Promise<SunPosition>;

/** Sets the folder of the worker and the modules (`path`, default that of this file), the maximum number of workers
 * (`workers`, default 1), and the number of threads of each worker that is created from now on (`threads`, default 1). Threads
 * need memory that can be shared: in Node.js always, on a page with the headers COOP and COEP; elsewhere one thread
 * computes, with the same bits. Throws a `WelkinError` ('invalid_argument') for a count that is no whole number of 1 or more. */
export function configure(options: { path?: string | null; workers?: number; threads?: number }): void;

/** Ends all workers and frees their memory; jobs are rejected. The next call creates new ones. */
export function dispose(): void;

/** Returns the factor of a band from radiance to irradiance: pi, 2 pi / 3, pi / 4, 0, ... */
export function cosineLobe(band: number): number;

/** Converts coefficients of radiance to those of irradiance. */
export function irradianceFromRadiance(radiance: Float64Array): Float64Array;
