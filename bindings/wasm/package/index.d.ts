/** Environments to light, in a Web Worker (in Node.js: a worker thread). Every call returns at once. An option that a call
 * does not have is refused. */

/** Welkin's error codes, and three of this package's own. */
export type ErrorCode =
  | 'invalid_argument' | 'rejected_pixel' | 'file_access' | 'corrupt_file' | 'unsupported_file' | 'limit_exceeded'
  | 'out_of_memory' | 'stopped' | 'unexpected';

/** What calls are rejected with. A call whose signal is given is rejected with the signal's reason instead. */
export class WelkinError extends Error {
  readonly code: ErrorCode;
}

export type Triple = [number, number, number];

/** How texels lie in memory; `srgb8` and `srgba8` are decoded from sRGB. */
export type PixelFormat = 'rgb32f' | 'rgba32f' | 'rgb16f' | 'rgba16f' | 'rgb8' | 'rgba8' | 'srgb8' | 'srgba8';

export type Pixels = Float32Array | Uint16Array | Uint8Array | Uint8ClampedArray | ArrayBuffer;

/** Options of every call. */
export interface CallOptions {
  /** Ends the call: it is rejected with the signal's reason. A job that runs ends with its worker. */
  signal?: AbortSignal;
  /** The share of the work that is done, 0 to 1, at most every 30 ms. */
  onProgress?: (share: number) => void;
  /** Hands the input's buffers over to the worker instead of copying them: they are detached. Default: false. */
  transfer?: boolean;
}

/** What becomes of pixel values before they count as radiance. */
export interface PixelOptions {
  /** Above that each channel is cut. Default: nothing is. Babylon.js has 4096. */
  clamp?: number;
  /** A clamp scales the three channels together. */
  preserveColour?: boolean;
  /** The values are gamma encoded: clamped to [0, 1] and raised to 2.2, as Babylon.js does. */
  gamma?: boolean;
  /** Negatives become 0. */
  replaceNegatives?: boolean;
  /** NaN and infinities are an error and are not replaced. */
  rejectNonFinite?: boolean;
}

/** What typed arrays hold: floats, halves (`Uint16Array`), or bytes, which are sRGB unless `linear` is set. */
export interface SourceOptions extends PixelOptions {
  format?: PixelFormat;
  linear?: boolean;
}

export interface ProjectionOptions extends CallOptions, SourceOptions {
  /** 1 to 16. Default: 3. */
  bands?: number;
  /** Texels as areas (the default: exact), or as points, as Babylon.js has them. */
  quadrature?: 'exact' | 'midpoint';
  /** The environment is reduced to faces of so many texels first. */
  targetSize?: number;
}

/** Babylon.js's `SphericalPolynomial`. */
export type Polynomial = Record<'x' | 'y' | 'z' | 'xx' | 'yy' | 'zz' | 'yz' | 'zx' | 'xy', Triple>;

export interface SphericalHarmonics {
  bands: number;
  /**
   * Coefficients of radiance, red, green and blue of each, (l, m) at l (l + 1) + m: real, orthonormal, without
   * Condon-Shortley phase. Axes are right-handed with y up; those of a cubemap are its faces' own.
   */
  radiance: Float64Array;
  /** Of the first three bands, as Babylon.js's own tools have it. */
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

/** Projects a cubemap: six faces +X -X +Y -Y +Z -Z, RGB or RGBA, row 0 on top; or all six in one array. */
export function projectCubemap(faces: Pixels[] | Pixels, options?: ProjectionOptions): Promise<Projection>;

/** Projects an equirectangular picture. Its centre looks along +z, +x lies a quarter in from the left. */
export function projectEquirect(pixels: Pixels, options: ProjectionOptions & { width: number; height: number }):
  Promise<Projection>;

/** How roughness is spread over the mips. 'filament' is three.js's too. */
export type RoughnessSchedule = 'linear' | 'filament' | 'babylon' | 'unity' | 'unreal';

/** Lobes of reflections, as functions of roughness. */
export type LobeFamily = 'ggx' | 'charlie' | 'lambert' | 'phong' | 'blinn';

export interface ChainOptions {
  /** What an engine needs: 'three' sets `mirrorX` and the schedule 'filament', 'babylon' `mirrorX` and 'babylon'. */
  for?: 'three' | 'babylon';
  /** Texels along an edge of mip 0, 1 to 4096. Default: 256. */
  size?: number;
  mips?: number;
  /** Default: 'filament'. */
  schedule?: RoughnessSchedule;
  /** What the mips are blurred by. 'charlie' (sheen) and 'lambert' have roughness of their own. Default: 'ggx'. */
  lobe?: LobeFamily;
  /** Preset of `rmsError`: 'fast' 1e-2, 'normal' 1e-3; 'reference': the integral itself, slow. Default: 'normal'. */
  quality?: 'normal' | 'fast' | 'reference';
  /** Lobes fitted to shaders that interpolate linearly between mips by the schedule's formula. Default: false. */
  fitLookups?: boolean;
  /** Bound on a mip's relative rms error. Default: by `quality`. */
  rmsError?: number;
  /** Bound on the relative error at any texel. Default: ten times `rmsError`, at most 1. */
  maximumError?: number;
  /** Texels are floats instead of halves. */
  floats?: boolean;
  /** Faces of the picture mirrored in x: what three.js and Babylon.js take for cube textures. */
  mirrorX?: boolean;
}

export interface CubeFaces {
  /** Texels along an edge. */
  size: number;
  format: 'rgba16f' | 'rgba32f';
  mirrored: boolean;
  /** Six, RGBA with an alpha of 1, row 0 on top. */
  faces: (Uint16Array | Float32Array)[];
}

export interface Mip {
  size: number;
  /** Perceptual. */
  roughness: number;
  /** Predicted relative rms error; null where nothing is known. */
  errorEstimate: number | null;
  /** The same of lookups between this mip and the next. */
  errorBetween: number | null;
  faces: (Uint16Array | Float32Array)[];
}

export interface Chain {
  size: number;
  format: 'rgba16f' | 'rgba32f';
  mirrored: boolean;
  mips: Mip[];
}

/** Reflections by GGX, a mip for each roughness. */
export function prefilterCubemap(faces: Pixels[] | Pixels, options?: CallOptions & SourceOptions & ChainOptions):
  Promise<Chain>;
export function prefilterEquirect(pixels: Pixels,
  options: CallOptions & SourceOptions & ChainOptions & { width: number; height: number }): Promise<Chain>;

export interface LightOptions extends ChainOptions {
  /** Bands of harmonics, 1 to 16. Default: 3. */
  bands?: number;
  /** False: no chain. Default: true. */
  specular?: boolean;
  /** A file in Babylon.js's format: prefiltered, with its polynomial. Takes the module of codecs. */
  env?: boolean;
  /** The chain as a KTX2 file. */
  ktx2?: boolean;
  /** A sharp cubemap of so many texels along an edge. Default: none. */
  background?: number;
}

/** A sun that was taken out of a picture, or that of a computed sky. */
export interface Sun {
  /** Unit, towards the sun. */
  direction: Triple;
  /** On a surface that faces it. */
  irradiance: Triple;
  /** In degrees. */
  angularRadius: number;
}

export interface Light extends SphericalHarmonics {
  /** `radiance` by its short name: the same array. */
  sh: Float64Array;
  specular: Chain | null;
  env: Uint8Array | null;
  ktx2: Uint8Array | null;
  background: CubeFaces | null;
  sun: Sun | null;
}

export interface BakeOptions extends CallOptions, PixelOptions, LightOptions {
  /** What messages call the file. Its kind is told from its bytes. */
  name?: string;
  layout?: 'automatic' | 'lat-long' | 'vertical-strip' | 'horizontal-strip' | 'horizontal-cross' | 'vertical-cross';
  /** Takes the sun out of an equirectangular picture, for a directional light. */
  takeOutSun?: boolean;
}

/** Bakes an environment out of a file's bytes, or those of a Blob or a Response: Radiance .hdr, PFM, KTX2 and DDS; OpenEXR, PNG, Babylon.js's .env (with
 * PNG pictures) and KTX2 packed by zlib take the module of codecs. */
export function bakeEnvironment(file: ArrayBuffer | ArrayBufferView | Blob | Response, options?: BakeOptions):
  Promise<Light & { source: { width: number; height: number } }>;

export interface SkyOptions extends CallOptions, LightOptions {
  /** Degrees. Default: 30. */
  sunElevation?: number;
  /** Degrees from +z towards +x. Default: 0. */
  sunAzimuth?: number;
  /** The observer's height above the ground in metres. Default: 0. */
  altitude?: number;
  aerosol?: 'clear' | 'hazy' | 'dusty' | 'polluted';
  /** How fine the sky's tables are. Those of the last sky are kept, so moving the sun costs less. Default: 'coarse'. */
  tables?: 'coarse' | 'full';
  /** Texels along an edge of the faces that are baked. Default: 128. */
  faceSize?: number;
  /** The sun's disc is in the picture. Default: false: it is the directional light `sun`. */
  sunDisc?: boolean;
}

/** Computes a sky and its light. */
export function sky(options?: SkyOptions): Promise<Light>;

/** `path`: where the worker and the modules lie, if not beside this file. `workers`: how many there may be (1). */
export function configure(options: { path?: string | null; workers?: number }): void;

/** Ends all workers and gives their memory back; jobs are rejected. The next call makes new ones. */
export function dispose(): void;

/** pi, 2 pi / 3, pi / 4, 0, ...: the factor of each band from radiance to irradiance. */
export function cosineLobe(band: number): number;

/** Coefficients of radiance to those of irradiance. */
export function irradianceFromRadiance(radiance: Float64Array): Float64Array;
