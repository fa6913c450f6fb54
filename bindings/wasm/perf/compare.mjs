// scripts/wasm perf: compares the package with Babylon.js's and three.js's JavaScript, on the same faces, in one run of
// Node.js. Prints medians; the package's times include the messages to the worker and back.
import os from 'node:os';
import path from 'node:path';
import { pathToFileURL } from 'node:url';

process.env.WELKIN_WASM_BUILD ??= path.resolve(import.meta.dirname, '../../../build/wasm');
const { companion, faces, median, welkin } = await import(pathToFileURL(path.join(import.meta.dirname, '../tests/support.mjs')));
const { CubeMapToSphericalPolynomialTools } =
  await companion('@babylonjs/core/Misc/HighDynamicRange/cubemapToSphericalPolynomial.js');
const THREE = await companion('three/build/three.module.js');
const { LightProbeGenerator } = await companion('three/examples/jsm/lights/LightProbeGenerator.js');

const sizes = process.argv.slice(2).map(Number);
if (sizes.length === 0) sizes.push(64, 256, 1024);

async function timed(runs, call) {
  const times = [];
  for (let run = 0; run <= runs; ++run) {
    const begun = performance.now();
    await call();
    if (run > 0) times.push(performance.now() - begun); // the first one warms up
  }
  return median(times);
}

console.log(`Node.js ${process.version}, ${os.cpus()[0].model}`);
console.log('Projection of six RGBA float faces to three bands, milliseconds');
console.log('size  Babylon.js  three.js  welkin-wasm  (copied to the worker)  Babylon.js / welkin-wasm');
for (const size of sizes) {
  const runs = size > 512 ? 3 : 9;
  const [right, left, up, down, front, back] = faces(size, 4);
  const cube = [right, left, up, down, front, back];
  const babylon = await timed(runs, () => CubeMapToSphericalPolynomialTools.ConvertCubeMapToSphericalPolynomial(
    { size, right, left, up, down, front, back, format: 5, type: 1, gammaSpace: false }));
  // The generator reads the faces of a render target back; here they are there already.
  const renderer = { coordinateSystem: THREE.WebGLCoordinateSystem, isWebGLRenderer: true,
    readRenderTargetPixelsAsync: async (_target, _x, _y, _width, _height, data, face) => data.set(cube[face]) };
  const target = { width: size, texture: { type: THREE.FloatType, colorSpace: THREE.LinearSRGBColorSpace } };
  const three = await timed(runs, () => LightProbeGenerator.fromCubeRenderTarget(renderer, target));
  const copied = await timed(runs, () => welkin.projectCubemap(cube));
  const shared = cube.map((face) => {
    const values = new Float32Array(new SharedArrayBuffer(face.byteLength));
    values.set(face);
    return values;
  });
  const direct = await timed(runs, () => welkin.projectCubemap(shared));
  console.log(`${String(size).padStart(4)}  ${babylon.toFixed(1).padStart(10)}  ${three.toFixed(1).padStart(8)}  ${
    direct.toFixed(2).padStart(11)}  ${copied.toFixed(2).padStart(22)}  ${(babylon / direct).toFixed(0).padStart(24)}`);
}

const size = 256;
const cube = faces(size, 3);
const milliseconds = await timed(3, () => welkin.prefilterCubemap(cube, { size }));
console.log(`Reflections of a cubemap of ${size}, five mips, within 0.1 % rms: ${milliseconds.toFixed(0)} ms`);
welkin.dispose();
