// What a page calls. Each call posts one job to a worker and resolves with its result; nothing is computed here.
import { configurePlatform, makeWorker } from '#platform';
import { checkedOptions } from './options.js';

/** What calls are rejected with; `code` is one of Welkin's: 'invalid_argument', 'corrupt_file', ... */
export class WelkinError extends Error {
  constructor(code, message) {
    super(message);
    this.name = 'WelkinError';
    this.code = code;
  }
}

let mostWorkers = 1;
let nextId = 1;
const waiting = [];
const workers = [];

/** Where the worker's files lie (`path`), and how many workers there may be (`workers`). */
export function configure({ path, workers: count } = {}) {
  configurePlatform({ path });
  if (count !== undefined) {
    if (!Number.isInteger(count) || count < 1) throw new WelkinError('invalid_argument', `workers is ${count}; at least 1`);
    mostWorkers = count;
  }
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
  const worker = { job: null, port: null };
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
      worker.port.post({ id: job.id, operation: job.operation, request: job.request }, job.transfer);
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
    job.transfer = transfer ? [...new Set(buffers.map(bufferOf))].filter((buffer) => buffer instanceof ArrayBuffer) : [];
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

/** Six faces, or all in one array: their size is told from how many values there are, as no number is three times a
 * square and four times another. */
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

/** What a worker is told of a caller's options: no functions and no signals. */
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

/** The bytes of a file: as they are, or those of a Blob or of a Response that succeeded. */
async function bytesOf(file) {
  if (file instanceof ArrayBuffer || ArrayBuffer.isView(file)) return file;
  if (typeof file?.arrayBuffer !== 'function') {
    throw refusal('the file must be an ArrayBuffer, a typed array of its bytes, a Blob or a Response');
  }
  if (file.ok === false) throw new WelkinError('file_access', `${file.url || 'the file'}: the server answered ${file.status}`);
  return file.arrayBuffer();
}

export const bakeEnvironment = checked('bakeEnvironment', async (file, options) => {
  const bytes = await bytesOf(file);
  const transfer = options.transfer || bytes !== file; // nobody else has the bytes of a Blob
  return run('bake', { ...plain(options), bytes }, { ...options, transfer }, [bytes]);
});

export const sky = async (options = {}) => {
  const known = checkedOptions('sky', options, refusal);
  return run('sky', plain(known), known, []);
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
