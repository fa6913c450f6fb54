// The options of each call, and presets of engines.

const CALL = ['signal', 'onProgress', 'transfer'];
const PIXELS = ['clamp', 'preserveColour', 'gamma', 'replaceNegatives', 'rejectNonFinite'];
const SOURCE = [...PIXELS, 'format', 'linear'];
const EQUIRECT = ['width', 'height'];
const PROJECTION = ['bands', 'quadrature', 'targetSize'];

/** Options of a chain that go to the library, in the order of `ChainOption` in source/chains.h: 'number' (0 means
 * the default), 'flag', or the names of an enumeration, in its order, with the default. */
export const CHAIN_NUMBERS = {
  size: 'number',
  mips: 'number',
  schedule: { names: ['linear', 'filament', 'babylon', 'unity', 'unreal'], otherwise: 'filament' },
  rmsError: 'number',
  maximumError: 'number',
  floats: 'flag',
  lobe: { names: ['ggx', 'charlie', 'lambert', 'phong', 'blinn'], otherwise: 'ggx' },
  quality: { names: ['normal', 'fast', 'reference'], otherwise: 'normal' },
  fitLookups: 'flag',
};
const CHAIN = ['for', ...Object.keys(CHAIN_NUMBERS), 'mirrorX'];
const LIGHT = [...CHAIN, 'bands', 'specular', 'env', 'ktx2', 'ktx2Format', 'ktx2Effort', 'supercompression', 'background'];

const OPTIONS = {
  projectCubemap: [...CALL, ...SOURCE, ...PROJECTION],
  projectEquirect: [...CALL, ...SOURCE, ...PROJECTION, ...EQUIRECT],
  prefilterCubemap: [...CALL, ...SOURCE, ...CHAIN],
  prefilterEquirect: [...CALL, ...SOURCE, ...CHAIN, ...EQUIRECT],
  bakeEnvironment: [...CALL, ...PIXELS, ...LIGHT, 'name', 'layout', 'extractSun'],
  sky: [...CALL, ...LIGHT, 'sunElevation', 'sunAzimuth', 'altitude', 'aerosol', 'tables', 'faceSize', 'sunDisc'],
  SkyLight: [...CHAIN, 'altitude', 'aerosol', 'tables', 'specularThreshold', 'blendSeconds'],
  sunPosition: [...CALL, 'north', 'refraction', 'pressure', 'temperature'],
};

/** What an engine's shaders need of a chain. */
const PRESETS = {
  three: { mirrorX: true, schedule: 'filament' },
  babylon: { mirrorX: true, schedule: 'babylon' },
};

/** Levenshtein's distance. */
function distance(a, b) {
  let row = Array.from({ length: b.length + 1 }, (_, k) => k);
  for (let i = 1; i <= a.length; ++i) {
    const next = [i];
    for (let j = 1; j <= b.length; ++j) {
      next[j] = Math.min(row[j] + 1, next[j - 1] + 1, row[j - 1] + (a[i - 1] === b[j - 1] ? 0 : 1));
    }
    row = next;
  }
  return row[b.length];
}

/** The name that `name` was probably meant to be; undefined where none is near. */
function suggestion(name, names) {
  const lower = name.toLowerCase();
  const far = (other) => (lower.length > 2 && other.toLowerCase().startsWith(lower) ? 1 : distance(lower, other.toLowerCase()));
  const nearest = [...names].sort((a, b) => far(a) - far(b))[0];
  return far(nearest) <= 2 ? nearest : undefined;
}

function preset(call, { for: engine, ...options }, refuse) {
  if (engine === undefined) return options;
  if (!Object.hasOwn(PRESETS, engine)) {
    throw refuse(`${call}: for is "${engine}"; it may be ${Object.keys(PRESETS).join(', ')}`);
  }
  for (const [name, value] of Object.entries(PRESETS[engine])) {
    if (options[name] !== undefined && options[name] !== value) {
      throw refuse(`${call}: for "${engine}" sets ${name} to ${value}, and ${name} is ${options[name]}: leave one out`);
    }
  }
  return { ...options, ...PRESETS[engine] };
}

/** The options of `call`, with those that `for` stands for. Throws `refuse(message)` for an option that it has not. */
export function checkedOptions(call, options, refuse) {
  for (const name of Object.keys(options)) {
    if (OPTIONS[call].includes(name)) continue;
    const near = suggestion(name, OPTIONS[call]);
    throw refuse(near === undefined ? `${call} has no option ${name}; it has ${OPTIONS[call].join(', ')}`
      : `${call} has no option ${name}; did you mean ${near}?`);
  }
  return preset(call, options, refuse);
}
