// node peers.mjs CONFIGURATION.json
// {"modules": folder that holds node_modules, "cube": six faces of RGB floats, "size", "targets": [0, 64], "budget": seconds,
// "processor": whether to count CPU time}. Prints [{peer, method, target, radiance: [[r, g, b], ...], seconds}], the
// coefficients of radiance in the program's own convention. Unsupported methods and missing programs are left out.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";

const wanted = JSON.parse(readFileSync(process.argv[2], "utf8"));
const root = `${wanted.modules}/node_modules`;
const load = (file) => import(pathToFileURL(`${root}/${file}`).href);
const version = (name) => createRequire(import.meta.url)(`${root}/${name}/package.json`).version;
const bytes = readFileSync(wanted.cube);
const pixels = new Float32Array(bytes.buffer, bytes.byteOffset, bytes.length / 4);
const faceFloats = wanted.size * wanted.size * 3;
const found = [];

function now() {
  if (!wanted.processor) return performance.now() / 1000;
  const { user, system } = process.cpuUsage();
  return (user + system) / 1e6;
}
/** Returns the minimum time of several calls; the first warms up the compiler and counts only if it is alone. */
async function best(call) {
  const end = performance.now() + 1000 * wanted.budget;
  let least = Infinity;
  let first;
  do {
    const start = now();
    await call();
    const time = now() - start;
    if (first === undefined) first = time;
    else least = Math.min(least, time);
  } while (performance.now() < end);
  return Number.isFinite(least) ? least : first;
}

async function babylon() {
  const { CubeMapToSphericalPolynomialTools: Tools } =
    await load("@babylonjs/core/Misc/HighDynamicRange/cubemapToSphericalPolynomial.js");
  const { SphericalHarmonics } = await load("@babylonjs/core/Maths/sphericalPolynomial.js");
  const cube = { size: wanted.size, format: 4, type: 1, gammaSpace: false };
  ["right", "left", "up", "down", "front", "back"].forEach((key, i) => {
    cube[key] = pixels.subarray(i * faceFloats, (i + 1) * faceFloats);
  });
  Tools.MAX_HDRI_VALUE = Infinity;
  const orders = ["l00", "l1_1", "l10", "l11", "l2_2", "l2_1", "l20", "l21", "l22"];
  let radiance;
  const convert = SphericalHarmonics.prototype.convertIncidentRadianceToIrradiance;
  SphericalHarmonics.prototype.convertIncidentRadianceToIrradiance = function () {
    radiance = orders.map((order) => [this[order].x, this[order].y, this[order].z]);
    return convert.call(this);
  };
  for (const target of wanted.targets) {
    const seconds = await best(() => Tools.ConvertCubeMapToSphericalPolynomial(cube, target));
    // Babylon.js has the opposite sign for odd orders.
    const turned = radiance.map((rgb, i) => ([1, 3, 5, 7].includes(i) ? rgb.map((v) => -v) : rgb));
    found.push({ peer: `Babylon.js ${version("@babylonjs/core")}`, method: "CubeMapToSphericalPolynomialTools", target,
                 radiance: turned, seconds });
  }
}

async function three() {
  const { FloatType, NoColorSpace, WebGLCoordinateSystem, REVISION } = await load("three/build/three.module.js");
  const { LightProbeGenerator } = await load("three/examples/jsm/lights/LightProbeGenerator.js");
  const texels = wanted.size * wanted.size;
  const faces = [0, 1, 2, 3, 4, 5].map((i) => {
    const rgba = new Float32Array(4 * texels).fill(1);
    for (let p = 0; p < texels; ++p) for (let c = 0; c < 3; ++c) rgba[4 * p + c] = pixels[i * faceFloats + 3 * p + c];
    return rgba;
  });
  // Replaces a GPU that reads its texture back: the faces are in memory.
  const renderer = { isWebGLRenderer: false, coordinateSystem: WebGLCoordinateSystem,
                     readRenderTargetPixelsAsync: async (target, x, y, w, h, index, face) => faces[face] };
  const target = { width: wanted.size, texture: { type: FloatType, colorSpace: NoColorSpace } };
  let probe;
  const seconds = await best(async () => { probe = await LightProbeGenerator.fromCubeRenderTarget(renderer, target); });
  found.push({ peer: `three.js r${REVISION}`, method: "LightProbeGenerator", target: 0,
               radiance: probe.sh.coefficients.map((v) => [v.x, v.y, v.z]), seconds });
}

for (const peer of [babylon, three]) {
  try {
    await peer();
  } catch (trouble) {
    console.error(`${trouble.message}`);
  }
}
console.log(JSON.stringify(found));
