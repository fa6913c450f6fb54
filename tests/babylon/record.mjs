// Asks the real Babylon.js for the polynomials of the seeded test cubemaps.
//
//   node record.mjs --modules DIR > ../data/babylon.json      DIR holds node_modules (npm ci); or WELKIN_BABYLON=DIR
//   node record.mjs --modules DIR --check ../data/babylon.json   exit code 1 unless the same comes out again
//
// Nothing of Babylon.js is reimplemented: every number comes out of @babylonjs/core.
//
// Left out on purpose: an infinity with preserved colours or without a clamp. Babylon.js answers NaN or Infinity
// there for every coefficient, where Welkin puts the clamp's maximum, or else 65504, in the infinity's place.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { checksum, makeCubemap } from "./test_environments.mjs";

const flags = process.argv.slice(2);
const flag = (name) => (flags.includes(name) ? flags[flags.indexOf(name) + 1] : undefined);
const modules = flag("--modules") ?? process.env.WELKIN_BABYLON;
if (!modules) {
  console.error("usage: node record.mjs --modules DIR [--check FILE]   (DIR: where npm ci was run)");
  process.exit(2);
}
const core = `${resolve(modules)}/node_modules/@babylonjs/core`;
const load = (file) => import(pathToFileURL(`${core}/${file}`).href);
const { CubeMapToSphericalPolynomialTools: Tools } = await load("Misc/HighDynamicRange/cubemapToSphericalPolynomial.js");
const { SphericalHarmonics } = await load("Maths/sphericalPolynomial.js");
const { version } = createRequire(import.meta.url)(`${core}/package.json`);

const FACES = ["right", "left", "up", "down", "front", "back"];
const TERMS = ["x", "y", "z", "xx", "yy", "zz", "yz", "zx", "xy"];
const ORDERS = ["l00", "l1_1", "l10", "l11", "l2_2", "l2_1", "l20", "l21", "l22"];
const triples = (from, keys) => keys.map((key) => [from[key].x, from[key].y, from[key].z]);

/** Babylon.js's polynomial, and the radiance coefficients that it was made from (its signs: odd orders negated). */
function project(pixels, size, channels, { gamma = false, maximum = 4096, preserve = false, target = 0 }) {
  const face = size * size * channels;
  const cube = { size, format: channels === 4 ? 5 : 4, type: pixels instanceof Uint8Array ? 0 : 1, gammaSpace: gamma };
  FACES.forEach((key, i) => (cube[key] = pixels.subarray(i * face, (i + 1) * face)));
  Tools.MAX_HDRI_VALUE = Number(maximum);
  Tools.PRESERVE_CLAMPED_COLORS = preserve;
  const method = SphericalHarmonics.prototype.convertIncidentRadianceToIrradiance;
  let radiance;
  SphericalHarmonics.prototype.convertIncidentRadianceToIrradiance = function () {
    radiance = triples(this, ORDERS);
    return method.call(this);
  };
  const polynomial = triples(Tools.ConvertCubeMapToSphericalPolynomial(cube, target), TERMS);
  SphericalHarmonics.prototype.convertIncidentRadianceToIrradiance = method;
  return { polynomial, radiance };
}

// group: [content, bytes, options]
const NO_CLAMP = { maximum: "Infinity" };
const PRESERVE = { maximum: 100, preserve: true };
const FULL_SIZE = {
  random: [["random", false, {}]],
  smooth: [["smooth", false, {}]],
  plain: [["uniform", false, {}], ["blocks", false, {}]],
  high_range: [["high_range", false, {}], ["high_range", false, { maximum: 100 }], ["high_range", false, NO_CLAMP]],
  clamped: [["clamped", false, {}], ["clamped", false, { preserve: true }], ["clamped", false, { maximum: 100 }],
    ["clamped", false, PRESERVE], ["clamped", false, NO_CLAMP], ["sun_disc", false, {}], ["sun_disc", false, PRESERVE],
    ["one_texel_sun", false, {}], ["one_texel_sun", false, NO_CLAMP]],
  gamma: [["gamma_encoded", false, { gamma: true }], ["gamma_encoded", false, { gamma: true, maximum: 0.5 }],
    ["gamma_encoded", false, { gamma: true, maximum: 0.5, preserve: true }]],
  u8: [["random", true, {}], ["random", true, { gamma: true }]],
  nan_bearing: [["special_values", false, {}], ["special_values", false, { gamma: true }], ["nan_bearing", false, {}],
    ["nan_bearing", false, NO_CLAMP], ["nan_bearing", false, PRESERVE]],
};
const REDUCED = [["random", false, {}], ["high_range", false, {}], ["sun_disc", false, {}],
  ["sun_disc", false, { preserve: true }], ["clamped", false, PRESERVE], ["one_texel_sun", false, NO_CLAMP],
  ["gamma_encoded", false, { gamma: true }], ["random", true, {}], ["random", true, { gamma: true }],
  ["special_values", false, {}], ["nan_bearing", false, NO_CLAMP]];

const cases = [];
const cubemaps = new Map();  // Babylon.js leaves its input alone, and a kind is made once for all of its options.
function add(group, [content, bytes, options], size) {
  // Alternate between RGB and RGBA, so that each kind is tried as both.
  const channels = size % 2 === 0 ? 4 : 3;
  const seed = 1 + size;
  const key = [content, bytes, size].join();
  if (!cubemaps.has(key)) {
    const made = makeCubemap(content, size, channels, seed, bytes);
    cubemaps.set(key, { made, sum: checksum(made) });
  }
  const { made, sum } = cubemaps.get(key);
  const { polynomial, radiance } = project(made, size, channels, options);
  if (!polynomial.flat().every(Number.isFinite)) throw new Error(`${group} ${key}: Babylon.js gives no finite answer`);
  const record = { group, content, type: bytes ? "u8" : "f32", size, channels, seed, checksum: sum, options, polynomial };
  if (size === 7) record.radiance = radiance;
  cases.push(record);
}
for (const [group, kinds] of Object.entries(FULL_SIZE))
  for (const kind of kinds) for (const size of [1, 2, 3, 7, 16, 64, 257]) add(group, kind, size);
for (const [content, bytes, options] of REDUCED)
  for (const size of [64, 100, 256])
    for (const target of [8, 16, 32, 48, 64]) add("target_size", [content, bytes, { ...options, target }], size);

const text = `{"source": "@babylonjs/core ${version}", "terms": ${JSON.stringify(TERMS)}, "cases": [\n` +
  cases.map((record) => JSON.stringify(record)).join(",\n") + "\n]}\n";

/** Equal, or so near that only the last bits of this machine's pow and atan2 can differ; else what differs. */
function difference(recorded, now) {
  const shape = ({ polynomial, radiance, ...rest }) => JSON.stringify(rest);
  if (recorded.source !== now.source) return `${recorded.source} was recorded, this is ${now.source}`;
  if (recorded.cases.length !== now.cases.length) return `${recorded.cases.length} cases, now ${now.cases.length}`;
  for (const [i, then] of recorded.cases.entries()) {
    if (shape(then) !== shape(now.cases[i])) return `case ${i}: ${shape(then)} became ${shape(now.cases[i])}`;
    for (const key of ["polynomial", "radiance"]) {
      if (!then[key]) continue;
      const a = then[key].flat(), b = now.cases[i][key].flat();
      const scale = Math.max(...a.map(Math.abs));
      if (!a.every((value, k) => Math.abs(value - b[k]) <= 1e-12 * scale)) return `case ${i}: ${shape(then)}: ${key}`;
    }
  }
  return undefined;
}

const file = flag("--check");
if (!file) process.stdout.write(text);
else {
  const recorded = readFileSync(file, "utf8");
  const what = recorded === text ? undefined : difference(JSON.parse(recorded), JSON.parse(text));
  if (what) {
    console.error(`${file} is not what Babylon.js gives: ${what}`);
    process.exit(1);
  }
  console.log(`${cases.length} cases as recorded, ${recorded === text ? "byte for byte" : "to within 1e-12"}`);
}
