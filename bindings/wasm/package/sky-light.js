// A computed sky whose sun moves: a page sets the sun and takes the light in every frame. Nothing here waits. The worker
// sends the sky's light by the sun's elevation once, which is interpolated and rotated here, and a chain of reflections
// after each half degree.

/** Elevations at which the worker gives light, degrees: `kNear` apart about the horizon, `kFar` elsewhere. */
const kNear = 1 / 32;
const kFar = 1 / 2;
const kEdge = 6;

export const ELEVATIONS = Float64Array.from([
  ...Array.from({ length: (90 - kEdge) / kFar }, (_, k) => -90 + k * kFar),
  ...Array.from({ length: (2 * kEdge) / kNear }, (_, k) => -kEdge + k * kNear),
  ...Array.from({ length: (90 - kEdge) / kFar + 1 }, (_, k) => kEdge + k * kFar)]);

/** The index of an elevation among them, with its fraction. */
function placeOf(elevation) {
  const below = (90 - kEdge) / kFar;
  if (elevation < -kEdge) return (elevation + 90) / kFar;
  const within = (2 * kEdge) / kNear;
  return elevation < kEdge ? below + (elevation + kEdge) / kNear : below + within + (elevation - kEdge) / kFar;
}

/** values[index][of] at an elevation, by the cubic through four neighbours (by the line where their steps differ). */
function interpolated(values, of, elevation, out) {
  const place = placeOf(elevation);
  const last = ELEVATIONS.length - 1;
  const first = Math.min(Math.floor(place), last - 1);
  const t = place - first;
  const step = ELEVATIONS[first + 1] - ELEVATIONS[first];
  const even = first > 0 && first + 2 <= last && ELEVATIONS[first] - ELEVATIONS[first - 1] === step &&
    ELEVATIONS[first + 2] - ELEVATIONS[first + 1] === step;
  const weights = even
    ? [-t * (t - 1) * (t - 2) / 6, (t + 1) * (t - 1) * (t - 2) / 2, -(t + 1) * t * (t - 2) / 2, (t + 1) * t * (t - 1) / 6]
    : [0, 1 - t, t, 0];
  for (let k = 0; k < of; ++k) {
    let sum = 0;
    for (let tap = 0; tap < 4; ++tap) {
      if (weights[tap] !== 0) sum += weights[tap] * values[of * (first - 1 + tap) + k];
    }
    out[k] = sum;
  }
  return out;
}

/** Rotates three bands about the vertical, +z towards +x, in place: light from direction d then comes from the turned d.
 * (l, m) at l (l + 1) + m; band 1 is y, z, x; band 2 is xy, yz, 3 z^2 - 1, xz, x^2 - y^2, of a symmetric matrix. */
function turnLight(light, radians) {
  const [c, s] = [Math.cos(radians), Math.sin(radians)];
  const kCross = Math.sqrt(15 / (4 * Math.PI)); // of xy, yz, xz; half of it of x^2 - y^2
  const kZonal = Math.sqrt(5 / (16 * Math.PI)); // of 3 z^2 - 1
  for (let channel = 0; channel < 3; ++channel) {
    const at = (k) => light[3 * k + channel];
    const [z, x] = [at(2), at(3)];
    const [xy, yz, zonal, xz, plane] = [4, 5, 6, 7, 8].map(at);
    // The form d -> d' M d of the band, without a trace.
    const zz = 2 * kZonal * zonal;
    const xx = -kZonal * zonal + (kCross / 2) * plane;
    const yy = -kZonal * zonal - (kCross / 2) * plane;
    const half = kCross / 2;
    // x' = c x + s z, z' = c z - s x
    const turned = {
      xx: c * c * xx + 2 * c * s * half * xz + s * s * zz,
      zz: c * c * zz - 2 * c * s * half * xz + s * s * xx,
      xz: (c * c - s * s) * half * xz + c * s * (zz - xx),
      xy: half * (c * xy + s * yz),
      yz: half * (c * yz - s * xy),
    };
    const put = (k, value) => { light[3 * k + channel] = value; };
    put(2, c * z - s * x);
    put(3, c * x + s * z);
    put(4, turned.xy / half);
    put(5, turned.yz / half);
    put(6, turned.zz / (2 * kZonal));
    put(7, turned.xz / half);
    put(8, (turned.xx - yy) / kCross);
  }
}

const radiansOf = (degrees) => (degrees * Math.PI) / 180;

/** The sky of a page's loop. `jobs` are the package's calls that it makes: `skyCurve(options)` and `sky(options)`. */
export class SkyLightLoop {
  #jobs;
  #options;
  #curve = null;
  #failure = null;
  #stopped = false;
  #busy = false;
  #elevation = 90;
  #azimuth = 0;
  #intensity = 1;
  #newer = null;
  #older = null;
  #part = 1;
  #counters = { frames: 0, speculars: 0, failures: 0 };
  #frame = {
    ready: false,
    settled: false,
    radiance: new Float64Array(27),
    sun: { direction: [0, 1, 0], irradiance: [0, 0, 0], angularRadius: 0 },
    reflections: [],
  };

  constructor(jobs, options) {
    this.#jobs = jobs;
    this.#options = { specularThreshold: 0.5, blendSeconds: 0.5, size: 32, ...options };
    this.#askForCurve();
  }

  /** Degrees; azimuth from +z towards +x. */
  setSun(elevation, azimuth) {
    if (!(elevation >= -90 && elevation <= 90) || !Number.isFinite(azimuth)) {
      throw this.#jobs.refusal(`the sun stands at ${elevation}, ${azimuth}; an elevation of -90 to 90 degrees and an azimuth are possible`);
    }
    this.#elevation = elevation;
    this.#azimuth = azimuth;
    if (this.#failure === null) return;
    this.#failure = null; // what failed is tried again
    if (this.#curve === null) this.#askForCurve();
  }

  /** The factor of all light. */
  setIntensity(intensity) {
    if (!(intensity >= 0 && intensity <= 1e12)) throw this.#jobs.refusal(`the intensity is ${intensity}; 0 to 1e12 are possible`);
    this.#intensity = intensity;
  }

  /** The light of this frame, `seconds` after the one before. The same object every time. */
  update(seconds) {
    ++this.#counters.frames;
    const frame = this.#frame;
    if (this.#part < 1) this.#part = Math.min(1, this.#part + seconds / this.#options.blendSeconds);
    if (this.#part === 1) this.#older = null;
    this.#askForReflections();
    if (this.#curve === null) return frame;
    frame.ready = true;
    interpolated(this.#curve.radiance, 27, this.#elevation, frame.radiance);
    interpolated(this.#curve.direct, 3, this.#elevation, frame.sun.irradiance);
    const azimuth = radiansOf(this.#azimuth);
    turnLight(frame.radiance, azimuth);
    for (let k = 0; k < 27; ++k) frame.radiance[k] *= this.#intensity;
    for (let c = 0; c < 3; ++c) frame.sun.irradiance[c] = Math.max(0, frame.sun.irradiance[c]) * this.#intensity;
    const [up, out] = [Math.sin(radiansOf(this.#elevation)), Math.cos(radiansOf(this.#elevation))];
    frame.sun.direction = [out * Math.sin(azimuth), up, out * Math.cos(azimuth)];
    frame.sun.angularRadius = this.#curve.angularRadius;
    frame.reflections = [[this.#newer, this.#part], [this.#older, 1 - this.#part]].filter(([one]) => one !== null)
      .map(([one, part]) => ({ specular: one.specular, azimuth: this.#azimuth, weight: part * this.#intensity }));
    frame.settled = !this.#busy && this.#part === 1;
    return frame;
  }

  /** Counts of work. */
  get counters() { return { ...this.#counters }; }
  /** The error of the last job that failed, until the sun is set again. */
  get error() { return this.#failure; }

  /** Takes no more results. */
  dispose() { this.#stopped = true; }

  #askForCurve() {
    this.#request(this.#jobs.skyCurve(), (curve) => { this.#curve = curve; });
  }

  #askForReflections() {
    if (this.#busy || this.#stopped || this.#failure !== null || this.#options.size === 0 || this.#part < 1) return;
    if (this.#newer !== null && Math.abs(this.#newer.elevation - this.#elevation) < this.#options.specularThreshold) return;
    const elevation = this.#elevation;
    this.#request(this.#jobs.sky(elevation, this.#options.size), ({ specular }) => {
      ++this.#counters.speculars;
      this.#older = this.#newer;
      this.#newer = { specular, elevation };
      this.#part = this.#older === null || this.#options.blendSeconds === 0 ? 1 : 0;
    });
  }

  #request(job, take) {
    this.#busy = true;
    job.then((result) => {
      if (!this.#stopped) take(result);
    }, (error) => {
      ++this.#counters.failures;
      this.#failure = error;
    }).finally(() => { this.#busy = false; });
  }
}
