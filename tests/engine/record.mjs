// Asks the real Babylon.js and three.js what they make of coefficients and of small images.
//
//   node record.mjs --modules DIR > ../data/engines.json          DIR holds node_modules (npm ci)
//   node record.mjs --modules DIR --check ../data/engines.json    exit code 1 unless the same comes out, to within 1e-9
//
// No code of theirs is transcribed here: every number comes out of @babylonjs/core or three. Even three.js's shader is run
// from its text; only the GPU's work (rasterizing, filtering a texture, reading pixels back) is emulated. The tests make
// the same images from the formula in `radiance`.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";

const flags = process.argv.slice(2);
const flag = (name) => (flags.includes(name) ? flags[flags.indexOf(name) + 1] : undefined);
if (!flag("--modules")) {
  console.error("usage: node record.mjs --modules DIR [--check FILE]   (DIR: where npm ci was run)");
  process.exit(2);
}
const modules = `${resolve(flag("--modules"))}/node_modules`;
const load = (file) => import(pathToFileURL(`${modules}/${file}`).href);
const version = (name) => createRequire(import.meta.url)(`${modules}/${name}/package.json`).version;

const { PanoramaToCubeMapTools } = await load("@babylonjs/core/Misc/HighDynamicRange/panoramaToCubemap.js");
const { CubeMapToSphericalPolynomialTools } =
  await load("@babylonjs/core/Misc/HighDynamicRange/cubemapToSphericalPolynomial.js");
const { SphericalHarmonics, SphericalPolynomial } = await load("@babylonjs/core/Maths/sphericalPolynomial.js");
const three = await load("three/build/three.module.js");
const { LightProbeGenerator } = await load("three/examples/jsm/lights/LightProbeGenerator.js");

const TERMS = ["x", "y", "z", "xx", "yy", "zz", "yz", "zx", "xy"];

/** Radiance that comes from a unit direction: smooth, and different in every direction. */
const radiance = (x, y, z) => [
  2 + x + 0.5 * y - 0.7 * z + 0.3 * x * z + 0.2 * x * y,
  2 - 0.4 * x + 0.8 * y + 0.6 * z - 0.5 * y * z,
  2 + 0.3 * x - 0.9 * y + 0.2 * z + 0.4 * (x * x - y * y),
];

/** A lat-long whose pixels are radiance in Welkin's axes: centre +z, +x a quarter in from the left, row 0 on top. */
function latLong(width, height) {
  const pixels = new Float32Array(width * height * 3);
  for (let j = 0; j < height; ++j)
    for (let i = 0; i < width; ++i) {
      const latitude = Math.PI / 2 - (Math.PI * (j + 0.5)) / height;
      const longitude = Math.PI - (2 * Math.PI * (i + 0.5)) / width;
      const [s, c] = [Math.sin(longitude) * Math.cos(latitude), Math.cos(longitude) * Math.cos(latitude)];
      pixels.set(radiance(s, Math.sin(latitude), c), (j * width + i) * 3);
    }
  return pixels;
}

/** The six faces of the same, in the frames of CubemapView. */
function faces(size) {
  const frames = [
    (u, v) => [1, -v, -u], (u, v) => [-1, -v, u], (u, v) => [u, 1, v],
    (u, v) => [u, -1, -v], (u, v) => [u, -v, 1], (u, v) => [-u, -v, -1],
  ];
  return frames.map((direction) => {
    const pixels = [];
    for (let j = 0; j < size; ++j)
      for (let i = 0; i < size; ++i) {
        const d = direction((2 * i + 1) / size - 1, (2 * j + 1) / size - 1);
        const length = Math.hypot(...d);
        pixels.push(...radiance(...d.map((c) => c / length)));
      }
    return pixels;
  });
}

/** The whole of Babylon.js's way from an .hdr panorama to the polynomial of its texture. */
function babylonOfPanorama(width, height, size) {
  const cube = PanoramaToCubeMapTools.ConvertPanoramaToCubemap(latLong(width, height), width, height, size, true);
  const polynomial = CubeMapToSphericalPolynomialTools.ConvertCubeMapToSphericalPolynomial(cube);
  return { width, height, size, terms: TERMS.map((term) => [polynomial[term].x, polynomial[term].y, polynomial[term].z]) };
}

/** Radiance coefficients in canonical order and signs that the engines are given: nothing about them is special. */
const coefficients = [...Array(9).keys()].map((i) => [i === 0 ? 5 : Math.sin(1 + i), Math.cos(2 * i), Math.sin(3 * i + 2)]);

function babylonOfCoefficients() {
  const harmonics = new SphericalHarmonics();
  const names = ["l00", "l1_1", "l10", "l11", "l2_2", "l2_1", "l20", "l21", "l22"];
  // Its signs: odd orders negated.
  names.forEach((name, i) => harmonics[name].copyFromFloats(...coefficients[i].map((c) => (i % 2 ? -c : c))));
  harmonics.convertIncidentRadianceToIrradiance();
  harmonics.convertIrradianceToLambertianRadiance();
  const polynomial = SphericalPolynomial.FromHarmonics(harmonics);
  const back = SphericalHarmonics.FromPolynomial(polynomial);
  back.preScaleForRendering();
  return {
    terms: TERMS.map((term) => [polynomial[term].x, polynomial[term].y, polynomial[term].z]),
    pre_scaled: names.map((name) => [back[name].x, back[name].y, back[name].z]),
  };
}

const normals = [...Array(40).keys()].map((i) => {
  const y = 1 - (2 * i + 1) / 40;
  const turn = i * Math.PI * (3 - Math.sqrt(5));
  return [Math.sqrt(1 - y * y) * Math.cos(turn), y, Math.sqrt(1 - y * y) * Math.sin(turn)];
});

function threeOfCoefficients() {
  const probe = new three.SphericalHarmonics3().set(coefficients.map((c) => new three.Vector3(...c)));
  const at = (normal, method) => probe[method](new three.Vector3(...normal), new three.Vector3()).toArray();
  return {
    radiance: normals.map((normal) => at(normal, "getAt")),
    irradiance: normals.map((normal) => at(normal, "getIrradianceAt")),
  };
}

/** A stand-in for the canvas that fromCubeTexture reads its images through: it hands out what it was given, times 255. */
function threeOfCubeTexture(size) {
  const context = { drawImage(image) { this.image = image; }, getImageData() { return this.image; } };
  globalThis.document = { createElement: () => ({ getContext: () => context }) };
  const image = faces(size).map((rgb) => {
    const data = new Float64Array(size * size * 4).fill(255);
    for (let p = 0; p < size * size; ++p) for (let c = 0; c < 3; ++c) data[p * 4 + c] = rgb[p * 3 + c] * 255;
    return { width: size, height: size, data };
  });
  const probe = LightProbeGenerator.fromCubeTexture({ image, colorSpace: three.NoColorSpace });
  delete globalThis.document;
  return { size, coefficients: probe.sh.coefficients.map((c) => c.toArray()) };
}

/** three.js's own GLSL function equirectUv as a JavaScript function of a Vector3. Fails where the text is not as known. */
function equirectUvOfThree() {
  const body = /vec2 equirectUv\( in vec3 dir \) \{([^}]*)\}/.exec(three.ShaderChunk.common)[1];
  const translated = body
    .replace(/\bfloat\b/g, "const").replace(/\batan\(/g, "Math.atan2(").replace(/\basin\(/g, "Math.asin(")
    .replace(/\bclamp\(/g, "three.MathUtils.clamp(").replace(/\bvec2\(/g, "new three.Vector2(")
    .replace(/\bRECIPROCAL_PI2\b/g, "(0.5 / Math.PI)").replace(/\bRECIPROCAL_PI\b/g, "(1 / Math.PI)");
  return new Function("three", "dir", translated).bind(null, three);
}

/** What a sampler with linear filtering finds at (u, v), v from the bottom: the image was uploaded with flipY. */
function sampleLatLong(pixels, width, height, u, v) {
  const [x, y] = [u * width - 0.5, (1 - v) * height - 0.5];
  const [x0, y0] = [Math.floor(x), Math.floor(y)];
  const at = (i, j, c) => pixels[(Math.min(Math.max(j, 0), height - 1) * width + ((i + width) % width)) * 3 + c];
  const mix = (a, b, t) => a + (b - a) * t;
  return [0, 1, 2].map((c) =>
    mix(mix(at(x0, y0, c), at(x0 + 1, y0, c), x - x0), mix(at(x0, y0 + 1, c), at(x0 + 1, y0 + 1, c), x - x0), y - y0));
}

/**
 * The whole of three.js's way from a lat-long image (scene.background, scene.environment) to a light probe:
 * WebGLCubeRenderTarget.fromEquirectangularTexture, its CubeCamera with its six cameras, and
 * LightProbeGenerator.fromCubeRenderTarget. The renderer is a stand-in: for each pixel of a face it asks three's camera
 * which way the pixel looks, and runs equirectUv. Row 0 of what it hands back is the bottom row, as glReadPixels has it.
 */
async function threeOfPanorama(width, height, size) {
  const equirectUv = equirectUvOfThree();
  const pixels = latLong(width, height);
  const faceData = [];
  let face = 0;
  const renderer = {
    isWebGLRenderer: true,
    coordinateSystem: three.WebGLCoordinateSystem,
    xr: { enabled: false },
    state: { buffers: { depth: { getReversed: () => false } } },
    getRenderTarget: () => null,
    getActiveCubeFace: () => 0,
    getActiveMipmapLevel: () => 0,
    setRenderTarget: (target, index) => { face = index; },
    render(mesh, camera) {
      const data = new Float32Array(size * size * 4).fill(1);
      for (let j = 0; j < size; ++j)
        for (let i = 0; i < size; ++i) {
          const onScreen = new three.Vector3((2 * i + 1) / size - 1, (2 * j + 1) / size - 1, 0.5);
          const { x: u, y: v } = equirectUv(onScreen.unproject(camera).normalize());
          data.set(sampleLatLong(pixels, width, height, u, v), (j * size + i) * 4);
        }
      faceData[face] = data;
    },
    readRenderTargetPixelsAsync: async (target, x, y, w, h, buffer, index) => { buffer.set(faceData[index]); },
  };
  const texture = new three.DataTexture(null, width, height, three.RGBAFormat, three.FloatType);
  const target = new three.WebGLCubeRenderTarget(size).fromEquirectangularTexture(renderer, texture);
  const probe = await LightProbeGenerator.fromCubeRenderTarget(renderer, target);
  return { width, height, size, coefficients: probe.sh.coefficients.map((c) => c.toArray()) };
}

const record = {
  sources: [`@babylonjs/core ${version("@babylonjs/core")}`, `three ${version("three")}`],
  coefficients,
  normals,
  babylon: { of_coefficients: babylonOfCoefficients(), of_panorama: babylonOfPanorama(256, 128, 64) },
  three: {
    of_coefficients: threeOfCoefficients(),
    of_cube_texture: threeOfCubeTexture(64),
    of_panorama: await threeOfPanorama(256, 128, 64),
  },
};

/** Numbers of both, in order, and all that is not a number as text. */
function flat(value, numbers = []) {
  if (typeof value === "number") numbers.push(value);
  else if (Array.isArray(value) || (value && typeof value === "object")) Object.values(value).forEach((v) => flat(v, numbers));
  return numbers;
}
const words = (value) => JSON.stringify(value, (key, v) => (typeof v === "number" ? 0 : v));

const file = flag("--check");
if (!file) process.stdout.write(JSON.stringify(record, null, 1) + "\n");
else {
  const recorded = JSON.parse(readFileSync(file, "utf8"));
  const [then, now] = [flat(recorded), flat(record)];
  if (words(recorded) !== words(record) || !then.every((value, i) => Math.abs(value - now[i]) <= 1e-9)) {
    console.error(`${file} is not what Babylon.js and three.js give`);
    process.exit(1);
  }
  console.log(`${now.length} numbers as recorded, to within 1e-9`);
}
