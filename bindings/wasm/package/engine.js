// Runs inside the worker: loads a WebAssembly module, passes it options and pixels, and copies results out of it.
// It is independent of the kind of worker: worker.js and worker-node.js provide a way to load and a way to answer.
import { CHAIN_NUMBERS } from './options.js';
import { instanceWithThreads } from './threads.js';

/** The modules and what each does, those that are quickest to load first. */
export const MODULES = {
  project: ['project'],
  prefilter: ['project', 'prefilter'],
  sky: ['project', 'prefilter', 'sky'],
  environment: ['project', 'prefilter', 'bake'],
  codecs: ['project', 'prefilter', 'bake', 'codecs'],
  textures: ['textures'],
};
/** What the module with threads does. */
const THREADED = ['project', 'prefilter', 'sky', 'bake'];

/** `ErrorCode` of include/welkin/core.h, in its order; statuses begin at 1. */
const CODES = ['invalid_argument', 'rejected_pixel', 'file_access', 'corrupt_file', 'unsupported_file', 'limit_exceeded',
  'cancelled', 'replaced', 'queue_full', 'stopped'];
const OTHER_CODES = { 1000: 'out_of_memory', 1001: 'unexpected' };

/** `PixelFormat` of include/welkin/image.h, and bytes per texel. */
export const FORMATS = {
  rgb32f: [0, 12], rgba32f: [1, 16], rgb16f: [2, 6], rgba16f: [3, 8], rgb8: [4, 3], rgba8: [5, 4], srgb8: [6, 3],
  srgba8: [7, 4],
};
const LAYOUTS = ['automatic', 'lat-long', 'vertical-strip', 'horizontal-strip', 'horizontal-cross', 'vertical-cross'];
/** `TexelFormat` of include/welkin/image.h, `Supercompression` and `Bc6hEffort`. */
const TEXELS = { rgba16f: 0, rgba32f: 1, b10g11r11: 2, e5b9g9r9: 3, 'uastc-hdr': 8 };
const SUPERCOMPRESSIONS = ['none', 'zlib', 'zstd'];
const EFFORTS = ['fast', 'normal', 'slow'];
const AEROSOLS = ['clear', 'hazy', 'dusty', 'polluted'];
const TABLES = ['coarse', 'full'];

function failure(code, message) {
  return { welkin: true, code, message };
}

function numberOf(list, name, what) {
  const index = list.indexOf(name);
  if (index < 0) throw failure('invalid_argument', `${what} is "${name}"; it may be ${list.join(', ')}`);
  return index;
}

/** The system calls that a standalone module imports. There are no files and no arguments; all other calls fail. */
function systemFor(memory) {
  const kNotThere = 52; // ENOSYS, as WASI numbers it
  const zeros = (...places) => {
    for (const place of places) new DataView(memory()).setUint32(place, 0, true);
    return 0;
  };
  return {
    environ_sizes_get: zeros,
    args_sizes_get: zeros,
    environ_get: () => 0,
    args_get: () => 0,
    clock_time_get: (_clock, _precision, place) => {
      new DataView(memory()).setBigUint64(place, BigInt(Math.round(performance.now() * 1e6)), true);
      return 0;
    },
    fd_write: (_file, vectors, count, written) => {
      const view = new DataView(memory());
      let bytes = 0;
      for (let k = 0; k < count; ++k) bytes += view.getUint32(vectors + 8 * k + 4, true);
      view.setUint32(written, bytes, true);
      return 0;
    },
    proc_exit: () => {
      throw failure('unexpected', 'the module ended itself');
    },
    emscripten_notify_memory_growth: () => {},
    missing: () => kNotThere,
  };
}

/** The exports and memory of a module with one thread. */
function instanceOf(module, progress) {
  let exports;
  const system = systemFor(() => exports.memory.buffer);
  const imports = {};
  for (const { module: space, name } of WebAssembly.Module.imports(module)) {
    imports[space] ??= {};
    imports[space][name] = (space === 'welkin' ? { progress }[name] : system[name]) ?? system.missing;
  }
  exports = new WebAssembly.Instance(module, imports).exports;
  exports._initialize?.();
  return { exports, memory: exports.memory };
}

/** One instance of a module. */
class Instance {
  constructor({ exports, memory, stop }) {
    this.exports = exports;
    this.memory = memory;
    this.stop = stop ?? (() => {});
  }

  /** Copies parts, typed arrays or buffers, one behind the other: the only copy on the way in. */
  put(parts) {
    let bytes = 0;
    for (const part of parts) bytes += part.byteLength;
    const place = this.exports.welkin_allocate(bytes) >>> 0;
    if (place === 0) throw failure('out_of_memory', `there is no memory for ${bytes} bytes`);
    let at = place;
    for (const part of parts) {
      const source = ArrayBuffer.isView(part)
        ? new Uint8Array(part.buffer, part.byteOffset, part.byteLength) : new Uint8Array(part);
      new Uint8Array(this.memory.buffer).set(source, at);
      at += part.byteLength;
    }
    return place;
  }

  free(place) {
    this.exports.welkin_free(place);
  }

  /** Copies a result out: the only copy on the way back, and never shared. */
  take(index, Type) {
    const place = this.exports.welkin_result(index) >>> 0;
    const bytes = this.exports.welkin_result_bytes(index) >>> 0;
    return new Type(new Uint8Array(this.memory.buffer, place, bytes).slice().buffer);
  }

  /** Calls an entry with its options. Throws what it reports. */
  call(entry, options) {
    const place = this.put([Float64Array.from(options)]);
    let status;
    try {
      status = this.exports[entry](place);
    } finally {
      this.free(place);
    }
    if (status === 0) return;
    const memory = new Uint8Array(this.memory.buffer);
    const begin = this.exports.welkin_message() >>> 0;
    const code = OTHER_CODES[status] ?? CODES[status - 1] ?? 'unexpected';
    const text = code === 'out_of_memory' ? 'there is not enough memory'
      : new TextDecoder().decode(memory.slice(begin, memory.indexOf(0, begin)));
    throw failure(code, text);
  }
}

function policy({ clamp, preserveColour, gamma, replaceNegatives, rejectNonFinite }) {
  return [clamp ?? 0, preserveColour ? 1 : 0, gamma ? 1 : 0, replaceNegatives ? 1 : 0, rejectNonFinite ? 1 : 0];
}

function chain(request) {
  return Object.entries(CHAIN_NUMBERS).map(([name, kind]) => {
    if (kind.names) return numberOf(kind.names, request[name] ?? kind.otherwise, name);
    return kind === 'flag' ? Number(Boolean(request[name])) : request[name] ?? 0;
  });
}

function light(request) {
  if (request.ktx2Format !== undefined) numberOf(Object.keys(TEXELS), request.ktx2Format, 'ktx2Format');
  numberOf(SUPERCOMPRESSIONS, request.supercompression ?? 'none', 'supercompression');
  numberOf(EFFORTS, request.ktx2Effort ?? 'normal', 'ktx2Effort');
  return [...chain(request), request.bands ?? 3, request.env ? 1 : 0, request.ktx2 ? 1 : 0,
    request.specular === false ? 0 : 1, request.background ?? 0];
}

const POLYNOMIAL = ['x', 'y', 'z', 'xx', 'yy', 'zz', 'yz', 'zx', 'xy'];
function polynomialOf(numbers) {
  return Object.fromEntries(POLYNOMIAL.map((name, k) => [name, Array.from(numbers.subarray(3 * k, 3 * k + 3))]));
}

function sunOf(numbers) {
  return numbers.length === 0 ? null
    : { direction: [...numbers.subarray(0, 3)], irradiance: [...numbers.subarray(3, 6)], angularRadius: numbers[6] };
}

/** Turns faces into those of the image mirrored in x, in place: +X and -X change places, and rows run the other way. */
function mirror(faces, size) {
  for (const face of faces) {
    const words = new Uint32Array(face.buffer, face.byteOffset, face.byteLength / 4);
    const texel = words.length / (size * size);
    for (let row = 0; row < size; ++row) {
      for (let left = 0, right = size - 1; left < right; ++left, --right) {
        const a = texel * (row * size + left);
        const b = texel * (row * size + right);
        for (let k = 0; k < texel; ++k) [words[a + k], words[b + k]] = [words[b + k], words[a + k]];
      }
    }
  }
  [faces[0], faces[1]] = [faces[1], faces[0]];
}

/** The chain whose numbers and texels are results `first` and the one behind it. */
function chainOf(instance, first, { floats, mirrorX }) {
  const numbers = instance.take(first, Float64Array);
  if (numbers.length === 0) return null;
  const texels = instance.take(first + 1, ArrayBufferOf);
  const Type = floats ? Float32Array : Uint16Array;
  const mips = [];
  let at = 0;
  for (let mip = 0; mip < numbers[1]; ++mip) {
    const [edge, roughness, error, between] = numbers.subarray(2 + 4 * mip, 6 + 4 * mip);
    const faces = [];
    for (let face = 0; face < 6; ++face) {
      faces.push(new Type(texels, at, 4 * edge * edge));
      at += 4 * edge * edge * Type.BYTES_PER_ELEMENT;
    }
    if (mirrorX) mirror(faces, edge);
    mips.push({ size: edge, roughness, errorEstimate: error < 0 ? null : error,
      errorBetween: between < 0 ? null : between, faces });
  }
  return { size: numbers[0], format: floats ? 'rgba32f' : 'rgba16f', mirrored: Boolean(mirrorX), mips };
}

/** For `take`: the bytes as they are. */
function ArrayBufferOf(buffer) {
  return buffer;
}

function backgroundOf(instance, index, { floats, mirrorX }) {
  const texels = instance.take(index, ArrayBufferOf);
  if (texels.byteLength === 0) return null;
  const Type = floats ? Float32Array : Uint16Array;
  const values = texels.byteLength / 6 / Type.BYTES_PER_ELEMENT;
  const faces = Array.from({ length: 6 }, (_, face) => new Type(texels, face * values * Type.BYTES_PER_ELEMENT, values));
  const size = Math.sqrt(values / 4);
  if (mirrorX) mirror(faces, size);
  return { size, format: floats ? 'rgba32f' : 'rgba16f', mirrored: Boolean(mirrorX), faces };
}

/** Calls an entry of the module of textures with a chain: floats, texels per edge, mips, and options behind them. */
function packed(textures, entry, floats, size, mips, numbers, rest) {
  const chain = textures.put([floats]);
  const more = textures.put([Float64Array.from(numbers)]);
  try {
    textures.call(entry, [chain, size, mips, ...rest(more)]);
    return textures.take(0, Uint8Array);
  } finally {
    textures.free(more);
    textures.free(chain);
  }
}

function ktx2Of(instance, textures, request) {
  const numbers = instance.take(2, Float64Array);
  const format = request.ktx2Format ?? (request.floats ? 'rgba32f' : 'rgba16f');
  const roughness = Array.from({ length: numbers[1] }, (_, mip) => numbers[3 + 4 * mip]);
  return packed(textures, 'welkin_pack_texture', instance.take(5, ArrayBufferOf), numbers[0], numbers[1], roughness,
    (place) => [TEXELS[format], SUPERCOMPRESSIONS.indexOf(request.supercompression ?? 'none'),
      EFFORTS.indexOf(request.ktx2Effort ?? 'normal'), request.mirrorX ? 1 : 0, place]);
}

function envOf(instance, textures, request, radiance) {
  const size = request.size ?? 256;
  return packed(textures, 'welkin_pack_env', instance.take(4, ArrayBufferOf), size, Math.floor(Math.log2(size)) + 1,
    radiance, (place) => [request.bands ?? 3, place]);
}

function lightOf(instance, request, textures) {
  const radiance = instance.take(0, Float64Array);
  return {
    bands: request.bands ?? 3,
    radiance,
    sh: radiance,
    polynomial: polynomialOf(instance.take(1, Float64Array)),
    specular: request.specular === false ? null : chainOf(instance, 2, request),
    env: request.env ? envOf(instance, textures, request, radiance) : null,
    ktx2: request.ktx2 ? ktx2Of(instance, textures, request) : null,
    background: backgroundOf(instance, 6, request),
  };
}

/** The source's first options; checks that there are as many bytes as the format says. */
function source(instance, request) {
  const format = FORMATS[request.format];
  if (format === undefined) {
    throw failure('invalid_argument', `format is "${request.format}"; it may be ${Object.keys(FORMATS).join(', ')}`);
  }
  const { width, height } = request;
  if (!Number.isInteger(width) || width < 1 || (height !== 0 && (!Number.isInteger(height) || height < 1))) {
    throw failure('invalid_argument', `the image has ${width} x ${height || width} texels; both must be whole numbers`);
  }
  const texels = height === 0 ? 6 * width * width : width * height;
  const bytes = request.pixels.reduce((sum, part) => sum + part.byteLength, 0);
  if (bytes !== texels * format[1]) {
    throw failure('invalid_argument',
      `the pixels have ${bytes} bytes; ${texels} texels of ${request.format} have ${texels * format[1]}`);
  }
  return [instance.put(request.pixels), width, height, format[0], ...policy(request)];
}

/** Where the pixels of a file are and what they are: the file itself, or floats that another module unpacked. */
function fileFor(instance, textures, request, name) {
  if (!isPacked(request.bytes)) return [instance.put([request.bytes]), request.bytes.byteLength, 0, 0];
  const bytes = textures.put([request.bytes]);
  const its = textures.put([name]);
  let shape;
  try {
    textures.call('welkin_unpack_texture', [bytes, request.bytes.byteLength, its]);
    shape = textures.take(0, Float64Array);
  } finally {
    textures.free(bytes);
    textures.free(its);
  }
  const pixels = textures.take(1, ArrayBufferOf);
  textures.exports.welkin_release();
  return [instance.put([pixels]), pixels.byteLength, ...shape];
}

const OPERATIONS = {
  project(instance, request) {
    const options = source(instance, request);
    try {
      instance.call('welkin_project',
        [...options, request.bands ?? 3, request.quadrature === 'midpoint' ? 1 : 0, request.targetSize ?? 0]);
    } finally {
      instance.free(options[0]);
    }
    const d = instance.take(2, Float64Array);
    return {
      bands: request.bands ?? 3,
      radiance: instance.take(0, Float64Array),
      polynomial: polynomialOf(instance.take(1, Float64Array)),
      diagnostics: {
        texels: d[0], nansReplaced: d[1], infinitiesReplaced: d[2], negativesReplaced: d[3], texelsClamped: d[4],
        errorEstimate: d[5], totalRadiance: [d[6], d[7], d[8]],
      },
    };
  },

  prefilter(instance, request) {
    const options = source(instance, request);
    try {
      instance.call('welkin_prefilter', [...options, ...chain(request)]);
    } finally {
      instance.free(options[0]);
    }
    return chainOf(instance, 0, request);
  },

  bake(instance, request, textures) {
    const text = new TextEncoder().encode(`${request.name ?? 'environment'}\0`);
    const [bytes, length, width, height] = fileFor(instance, textures, request, text);
    const name = instance.put([text]);
    try {
      instance.call('welkin_bake', [bytes, length, name, numberOf(LAYOUTS, request.layout ?? 'automatic', 'layout'),
        width, height, request.extractSun ? 1 : 0, ...policy(request), ...light(request)]);
    } finally {
      instance.free(bytes);
      instance.free(name);
    }
    const shape = instance.take(8, Float64Array);
    return {
      ...lightOf(instance, request, textures),
      sun: sunOf(instance.take(7, Float64Array)),
      source: { width: shape[0], height: shape[1] },
    };
  },

  sky(instance, request, textures) {
    instance.call('welkin_sky', [request.sunElevation ?? 30, request.sunAzimuth ?? 0, request.altitude ?? 0,
      numberOf(AEROSOLS, request.aerosol ?? 'clear', 'aerosol'), numberOf(TABLES, request.tables ?? 'coarse', 'tables'),
      request.faceSize ?? 128, request.sunDisc ? 1 : 0, ...light(request)]);
    return { ...lightOf(instance, request, textures), sun: sunOf(instance.take(7, Float64Array)) };
  },

  /** Light by the sun's elevation, for `SkyLight`. */
  skyCurve(instance, request) {
    const elevations = instance.put([request.elevations]);
    try {
      instance.call('welkin_sky_curve', [request.altitude ?? 0, numberOf(AEROSOLS, request.aerosol ?? 'clear', 'aerosol'),
        numberOf(TABLES, request.tables ?? 'coarse', 'tables'), elevations, request.elevations.length]);
    } finally {
      instance.free(elevations);
    }
    return { radiance: instance.take(0, Float64Array), direct: instance.take(1, Float64Array),
      angularRadius: instance.take(2, Float64Array)[0] };
  },

  sunPosition(instance, request) {
    const { date, latitude, longitude } = request;
    const text = typeof date === 'string' ? instance.put([new TextEncoder().encode(`${date}\0`)]) : 0;
    try {
      instance.call('welkin_sun_by_date', [text, Number(date) / 1000, latitude, longitude, request.north ?? 180,
        request.refraction ? 1 : 0, request.pressure ?? 1010, request.temperature ?? 10]);
    } finally {
      if (text !== 0) instance.free(text);
    }
    const [elevation, azimuth, compass, refraction, distance, ...direction] = instance.take(0, Float64Array);
    return { elevation, azimuth, compass, refraction, distance, direction };
  },
};

/** How files begin whose texels others' libraries unpack: OpenEXR, PNG, .env. */
const CODED = [[0x76, 0x2f, 0x31, 0x01], [0x89, 0x50, 0x4e, 0x47], [0x86, 0x16, 0x87, 0x96]];
const KTX2 = [0xab, 0x4b, 0x54, 0x58];
const KTX2_FORMAT = 12;
const KTX2_SCHEME = 44; // where the supercompression is named: 0 is none
const ASTC = [1000066000, 1000066013]; // Vulkan's formats from ... to

const bytesOf = (file) => (ArrayBuffer.isView(file) ? new Uint8Array(file.buffer, file.byteOffset, file.byteLength) : new Uint8Array(file));
const beginsWith = (bytes, magic) => magic.every((byte, k) => bytes[k] === byte);

/** A KTX2 file that the module of textures unpacks. */
function isPacked(file) {
  const bytes = bytesOf(file);
  if (!beginsWith(bytes, KTX2) || bytes.length < 80) return false;
  const format = new DataView(bytes.buffer, bytes.byteOffset).getUint32(KTX2_FORMAT, true);
  return bytes[KTX2_SCHEME] !== 0 || (format >= ASTC[0] && format <= ASTC[1]);
}

/** What the module must be able to do that does it; undefined where none can. */
function needOf(operation, request) {
  if (operation === 'bake') return CODED.some((magic) => beginsWith(bytesOf(request.bytes), magic)) ? 'codecs' : 'bake';
  return { project: 'project', prefilter: 'prefilter', sky: 'sky', skyCurve: 'sky', sunPosition: 'sky' }[operation];
}

function needsTextures(operation, request) {
  return Boolean(request.env || request.ktx2 || (operation === 'bake' && isPacked(request.bytes)));
}

/** All that buffers of a result need to be handed over instead of copied. */
export function buffersOf(value, found = new Set()) {
  if (ArrayBuffer.isView(value)) found.add(value.buffer);
  else if (value instanceof ArrayBuffer) found.add(value);
  else if (value !== null && typeof value === 'object') for (const part of Object.values(value)) buffersOf(part, found);
  return found;
}

/** Runs requests, one at a time. `load(name)` resolves to a compiled module, `makeThread` is as `instanceWithThreads`
 * takes it; null where no memory can be shared. */
export class Engine {
  constructor(load, makeThread) {
    this.load = load;
    this.makeThread = makeThread;
    this.instances = {};
    this.report = () => {};
  }

  async add(name, make) {
    this.instances[name] = new Instance(await make(await this.load(name), (share) => this.report(share)));
    return this.instances[name];
  }

  /** The smallest module that can do what is needed, or a larger one that is there already; with threads if there shall
   * be some. */
  async instanceFor(need, threads) {
    if (threads > 1 && this.makeThread && THREADED.includes(need)) {
      return this.instances.threads ?? this.add('threads', (module, progress) =>
        instanceWithThreads(module, progress, threads, this.makeThread));
    }
    const names = Object.keys(MODULES).filter((name) => MODULES[name].includes(need));
    const there = names.find((name) => this.instances[name]);
    return there ? this.instances[there] : this.add(names[0], instanceOf);
  }

  async run(operation, request, report = () => {}, threads = 1) {
    const need = needOf(operation, request);
    if (need === undefined) throw failure('invalid_argument', `there is no operation "${operation}"`);
    const [instance, textures] = await Promise.all([this.instanceFor(need, threads),
      needsTextures(operation, request) ? this.instanceFor('textures') : undefined]);
    this.report = report;
    try {
      const result = OPERATIONS[operation](instance, request, textures);
      for (const one of [instance, textures]) one?.exports.welkin_release();
      return result;
    } catch (error) {
      if (error?.welkin) throw error;
      // A trap: what the instances hold cannot be relied on any more.
      for (const name of Object.keys(this.instances)) {
        if (![instance, textures].includes(this.instances[name])) continue;
        this.instances[name].stop();
        delete this.instances[name];
      }
      throw failure('unexpected', String(error?.message ?? error));
    }
  }
}

/** Six faces of bytes that arrive in slices on a port of their own: the page copies and posts a few MB per task. */
function arrived({ port, faceBytes }) {
  return new Promise((resolve, reject) => {
    const faces = Array.from({ length: 6 }, () => new Uint8Array(faceBytes));
    let left = 6 * faceBytes;
    const end = (settle, value) => { port.close(); settle(value); };
    port.onmessage = ({ data }) => {
      if (data === null) return end(reject, failure('cancelled', 'the faces did not arrive'));
      faces[data.face].set(new Uint8Array(data.slice), data.offset);
      left -= data.slice.byteLength;
      return left > 0 ? undefined : end(resolve, faces);
    };
  });
}

function read(blob) {
  return blob.arrayBuffer().catch((error) => {
    throw failure('file_access', `the file could not be read: ${error.message}`);
  });
}

/** Connects an engine to a port: `{ id, operation, request }` comes in, `{ id, progress }`, `{ id, result }` or
 * `{ id, error }` goes out. */
export function serve(engine, post) {
  const kReportEvery = 30; // ms
  return async ({ id, operation, request, threads }) => {
    let reported = -Infinity;
    try {
      if (request.port) request.pixels = await arrived(request);
      if (request.bytes instanceof Blob) request.bytes = await read(request.bytes);
      let share = 0;
      const result = await engine.run(operation, request, (progress) => {
        const now = performance.now();
        if (!request.progress || (progress < 1 && now - reported < kReportEvery)) return;
        reported = now;
        share = progress;
        post({ id, progress }, []);
      }, threads);
      if (request.progress && share < 1) post({ id, progress: 1 }, []); // the last share may be another thread's
      post({ id, result }, [...buffersOf(result)]);
    } catch (error) {
      post({ id, error: { code: error.code ?? 'unexpected', message: error.message ?? String(error) } }, []);
    }
  };
}
