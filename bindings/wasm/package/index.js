// The functions that a page calls. Each posts one job to a worker and resolves with its result; none computes here.
import { configurePlatform, makeWorker } from '#platform';
import { checkedOptions } from './options.js';
import { ELEVATIONS, SkyLightLoop } from './sky-light.js';

/** What calls are rejected with; `code` is one of Welkin's: 'invalid_argument', 'corrupt_file', ... */
export class WelkinError extends Error {
  constructor(code, message) {
    super(message);
    this.name = 'WelkinError';
    this.code = code;
  }
}

let mostWorkers = 1;
let threads = 1;
let nextId = 1;
const waiting = [];
const workers = [];

function countOf(name, count) {
  if (!Number.isInteger(count) || count < 1) throw new WelkinError('invalid_argument', `${name} is ${count}; at least 1`);
  return count;
}

/** Where the worker's files lie (`path`), how many workers there may be (`workers`), and how many threads each has where
 * memory can be shared (`threads`, of workers that are made from now on). */
export function configure({ path, workers: count, threads: each } = {}) {
  configurePlatform({ path });
  if (count !== undefined) mostWorkers = countOf('workers', count);
  if (each !== undefined) threads = countOf('threads', each);
}

/** Ends all workers and gives their memory back. Jobs that wait or run are rejected. The next call makes new ones. */
export function dispose() {
  const error = new WelkinError('stopped', 'the workers were disposed of');
  for (const job of waiting.splice(0)) job.reject(error);
  for (const worker of workers.splice(0)) {
    worker.port.stop();
    worker.job?.reject(error);
  }
}

function addWorker() {
  const worker = { job: null, port: null, threads };
  const fail = (error) => {
    remove(worker);
    worker.job?.reject(new WelkinError('unexpected', error.message));
    beginJobs();
  };
  worker.port = makeWorker((message) => receive(worker, message), fail);
  workers.push(worker);
  return worker;
}

function remove(worker) {
  const place = workers.indexOf(worker);
  if (place >= 0) workers.splice(place, 1);
  worker.port?.stop();
}

function beginJobs() {
  while (waiting.length > 0) {
    const worker = workers.find((one) => one.job === null) ?? (workers.length < mostWorkers ? addWorker() : null);
    if (worker === null) return;
    const job = waiting.shift();
    worker.job = job;
    try {
      worker.port.post({ id: job.id, operation: job.operation, request: job.request, threads: worker.threads }, job.transfer);
    } catch (error) { // what cannot be cloned or was handed over before
      worker.job = null;
      job.reject(new WelkinError('invalid_argument', error.message));
    }
    job.request = null;
  }
}

function receive(worker, message) {
  const job = worker.job;
  if (job === null || job.id !== message.id) return;
  if (message.progress !== undefined) {
    job.onProgress?.(message.progress);
    return;
  }
  worker.job = null;
  if (message.error) job.reject(new WelkinError(message.error.code, message.error.message));
  else job.resolve(message.result);
  beginJobs();
}

/** A job whose signal is given takes it at once: one that runs ends with its worker. */
function abort(job) {
  const place = waiting.indexOf(job);
  if (place >= 0) waiting.splice(place, 1);
  const worker = workers.find((one) => one.job === job);
  if (worker) remove(worker);
  job.reject(job.signal.reason);
  beginJobs();
}

function run(operation, request, { signal, onProgress, transfer }, buffers) {
  return new Promise((resolve, reject) => {
    if (signal?.aborted) {
      reject(signal.reason);
      return;
    }
    const job = { id: nextId++, operation, signal, onProgress };
    const onAbort = () => abort(job);
    const settled = (settle) => (value) => {
      signal?.removeEventListener('abort', onAbort);
      settle(value);
    };
    job.resolve = settled(resolve);
    job.reject = settled(reject);
    job.request = { ...request, progress: onProgress !== undefined };
    job.transfer = transfer ? [...new Set(buffers.map(bufferOf))].filter((part) => part instanceof ArrayBuffer || part instanceof MessagePort) : [];
    signal?.addEventListener('abort', onAbort);
    waiting.push(job);
    beginJobs();
  });
}

const bufferOf = (part) => (ArrayBuffer.isView(part) ? part.buffer : part);

/** By the kind of array: floats, halves, or bytes, which are sRGB unless `linear` says otherwise. */
function formatOf(part, channels, { format, linear }) {
  if (format !== undefined) return format;
  const rgb = channels === 4 ? 'rgba' : 'rgb';
  if (part instanceof Float32Array) return `${rgb}32f`;
  if (part instanceof Uint16Array) return `${rgb}16f`;
  if (part instanceof Uint8Array || part instanceof Uint8ClampedArray) {
    return linear ? `${rgb}8` : channels === 4 ? 'srgba8' : 'srgb8';
  }
  throw new WelkinError('invalid_argument',
    'pixels must be a Float32Array, a Uint16Array of halves or a Uint8Array, or `format` must say what they are');
}

const BYTES = { rgb32f: 12, rgba32f: 16, rgb16f: 6, rgba16f: 8, rgb8: 3, rgba8: 4, srgb8: 3, srgba8: 4 };

/** Six faces, or all in one array: the number of values determines their size and channels, as no number is three
 * times a square and four times another. */
function cubemapSource(faces, options) {
  const parts = Array.isArray(faces) ? faces : [faces];
  if (parts.length !== 1 && parts.length !== 6) {
    throw new WelkinError('invalid_argument', `there are ${parts.length} faces; there must be 6, +X -X +Y -Y +Z -Z`);
  }
  const bytes = parts.reduce((sum, part) => sum + part.byteLength, 0) / 6;
  for (const channels of [4, 3]) {
    const format = formatOf(parts[0], channels, options);
    const size = Math.sqrt(bytes / BYTES[format]);
    if (size > 0 && Number.isInteger(size)) return { pixels: parts, width: size, height: 0, format };
  }
  throw new WelkinError('invalid_argument', `${bytes} bytes a face are those of no square of RGB or RGBA texels`);
}

function equirectSource(pixels, { width, height, ...options }) {
  const values = pixels.byteLength / (pixels.BYTES_PER_ELEMENT ?? 1);
  const channels = Math.round(values / (width * height));
  return { pixels: [pixels], width, height, format: formatOf(pixels, channels, options) };
}

/** A caller's options as sent to a worker: without functions and signals. */
function plain({ signal, onProgress, transfer, ...options }) {
  return options;
}

const refusal = (message) => new WelkinError('invalid_argument', message);

/** A call whose options are checked by its name; an error in the arguments is a rejected promise too. */
const checked = (name, call) => async (input, options = {}) => call(input, checkedOptions(name, options, refusal));

const ofSource = (name, operation, sourceOf) => checked(name, (input, options) => {
  const source = sourceOf(input, options);
  return run(operation, { ...plain(options), ...source }, options, source.pixels);
});

export const projectCubemap = ofSource('projectCubemap', 'project', cubemapSource);
export const projectEquirect = ofSource('projectEquirect', 'project', equirectSource);
export const prefilterCubemap = ofSource('prefilterCubemap', 'prefilter', cubemapSource);
export const prefilterEquirect = ofSource('prefilterEquirect', 'prefilter', equirectSource);

/** Projects six faces of `size` texels that an (asynchronous) generator yields in slices: `{ face, offset, slice }`, an
 * offset in bytes and an ArrayBuffer, which is transferred. All bytes of all faces must come once. */
export const projectSlices = async (slices, { size, format, ...options }) => {
  const known = checkedOptions('projectCubemap', options, refusal);
  if (!(format in BYTES)) throw refusal(`format is ${format}; it must be one of ${Object.keys(BYTES).join(', ')}`);
  const { port1, port2 } = new MessageChannel();
  const request = { ...plain(known), pixels: [], width: size, height: 0, format, port: port2, faceBytes: size * size * BYTES[format] };
  const result = run('project', request, { ...known, transfer: true }, [port2]);
  try {
    for await (const part of slices) port1.postMessage(part, [part.slice]);
  } catch (error) {
    port1.postMessage(null);
    await result.catch(() => {});
    throw error;
  }
  return result.finally(() => port1.close());
};

/** What the worker reads a file from: its bytes, or a Blob, which is handed over unread. To read a Response of 8 MB by
 * `arrayBuffer()` keeps a page from drawing for 50 to 110 ms; `blob()` leaves the bytes where the browser has them. */
async function readable(file) {
  if (file instanceof ArrayBuffer || ArrayBuffer.isView(file) || file instanceof Blob) return file;
  if (typeof file?.blob !== 'function') {
    throw refusal('the file must be an ArrayBuffer, a typed array of its bytes, a Blob or a Response');
  }
  if (file.ok === false) throw new WelkinError('file_access', `${file.url || 'the file'}: the server answered ${file.status}`);
  return file.blob();
}

export const bakeEnvironment = checked('bakeEnvironment', async (file, options) => {
  const bytes = await readable(file);
  return run('bake', { ...plain(options), bytes }, options, [bytes]);
});

export const sky = async (options = {}) => {
  const known = checkedOptions('sky', options, refusal);
  return run('sky', plain(known), known, []);
};

/** The sky of a page's loop: set the sun, take the light of each frame. Chains are made for an azimuth of 0. */
export class SkyLight extends SkyLightLoop {
  constructor(options = {}) {
    const { size, specularThreshold, blendSeconds, ...rest } = checkedOptions('SkyLight', options, refusal);
    const { altitude, aerosol, tables } = rest;
    const given = Object.fromEntries(Object.entries({ size, specularThreshold, blendSeconds }).filter(([, value]) => value !== undefined));
    super({
      refusal,
      skyCurve: () => run('skyCurve', { altitude, aerosol, tables, elevations: ELEVATIONS }, {}, []),
      sky: (sunElevation, edge) => run('sky', { ...rest, sunElevation, size: edge, faceSize: Math.max(32, edge) }, {}, []),
    }, given);
  }
}

export const sunPosition = async (date, latitude, longitude, options = {}) => {
  const known = checkedOptions('sunPosition', options, refusal);
  return run('sunPosition', { ...plain(known), date: date instanceof Date ? date.getTime() : date, latitude, longitude },
    known, []);
};

// Coefficients, small enough to be computed here.

/** pi, 2 pi / 3, pi / 4, 0, -pi / 24, ...: what the cosine makes of each band. */
export function cosineLobe(band) {
  if (band === 1) return (2 * Math.PI) / 3;
  if (band % 2 === 1) return 0;
  let factor = Math.PI; // pi (-1)^(l/2 - 1) / ((l + 2) (l - 1)) l! / (2^l (l/2)!^2), from the band before
  for (let l = 2; l <= band; l += 2) factor *= l === 2 ? 1 / 4 : -(l - 3) / (l + 2);
  return factor;
}

/** Coefficients of radiance to those of irradiance: three numbers a coefficient. */
export function irradianceFromRadiance(radiance) {
  return radiance.map((value, k) => value * cosineLobe(Math.floor(Math.sqrt(Math.floor(k / 3)))));
}
