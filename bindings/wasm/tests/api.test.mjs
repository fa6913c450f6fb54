// Promise: what the package gives in Node.js is right, and what it refuses it refuses with a code and words.
import assert from 'node:assert/strict';
import { after, test } from 'node:test';

import { companion, faces, radianceFile, welkin } from './support.mjs';

after(() => welkin.dispose());

const near = (value, wanted, share = 1e-4) =>
  assert.ok(Math.abs(value - wanted) <= share * Math.abs(wanted), `${value} instead of ${wanted}`);
const even = (size, channels, value) => Array.from({ length: 6 }, () => new Float32Array(size * size * channels).fill(value));
const c00 = 2 * Math.sqrt(4 * Math.PI);

test('an even cubemap has the light of an even sphere, at every size, with and without alpha', async () => {
  for (const size of [1, 2, 3, 7, 64, 257]) {
    for (const channels of [3, 4]) {
      const light = await welkin.projectCubemap(even(size, channels, 2));
      near(light.radiance[0], c00, 1e-6);
      assert.equal(light.radiance.length, 27);
      assert.equal(light.diagnostics.texels, 6 * size * size);
      near(welkin.irradianceFromRadiance(light.radiance)[0], Math.PI * c00, 1e-6);
    }
  }
});

test('a projection is as Babylon.js computes it', async () => {
  const { CubeMapToSphericalPolynomialTools } =
    await companion('@babylonjs/core/Misc/HighDynamicRange/cubemapToSphericalPolynomial.js');
  for (const size of [2, 7, 64]) {
    const [right, left, up, down, front, back] = faces(size, 4);
    const theirs = CubeMapToSphericalPolynomialTools.ConvertCubeMapToSphericalPolynomial(
      { size, right, left, up, down, front, back, format: 5, type: 1, gammaSpace: false });
    const { polynomial } = await welkin.projectCubemap([right, left, up, down, front, back],
      { quadrature: 'midpoint', clamp: 4096 });
    for (const term of Object.keys(polynomial)) {
      ['x', 'y', 'z'].forEach((channel, c) => {
        assert.ok(Math.abs(polynomial[term][c] - theirs[term][channel]) < 2e-6, `${size}: ${term}.${channel}`);
      });
    }
  }
});

test('all pixel formats are read', async () => {
  const size = 7;
  const bytes = Array.from({ length: 6 }, () => new Uint8Array(4 * size * size).fill(255));
  near((await welkin.projectCubemap(bytes)).radiance[0], c00 / 2, 1e-6);
  near((await welkin.projectCubemap(bytes.map(() => new Uint8Array(3 * size * size).fill(128)), { linear: true }))
    .radiance[0], (c00 / 2) * (128 / 255), 1e-6);
  const halves = Array.from({ length: 6 }, () => new Uint16Array(4 * size * size).fill(0x4000)); // 2
  near((await welkin.projectCubemap(halves)).radiance[0], c00, 1e-6);
  near((await welkin.projectCubemap(even(size, 3, 2).map((face) => face.buffer), { format: 'rgb32f' })).radiance[0], c00, 1e-6);
});

test('an equirectangular picture looks where it should', async () => {
  const [width, height] = [64, 32];
  const pixels = new Float32Array(3 * width * height);
  const column = width / 4; // a quarter in from the left: +x
  pixels.fill(100, 3 * ((height / 2) * width + column), 3 * ((height / 2) * width + column) + 3);
  const { radiance } = await welkin.projectEquirect(pixels, { width, height });
  const [y, z, x] = [radiance[3], radiance[6], radiance[9]];
  assert.ok(x > 0 && Math.abs(y) < 0.1 * x && Math.abs(z) < 0.1 * x, `${x} ${y} ${z}`);
});

test('an even environment stays even in every mip', async () => {
  const chain = await welkin.prefilterCubemap(even(16, 3, 2), { size: 16, floats: true });
  assert.equal(chain.size, 16);
  for (const mip of chain.mips) {
    assert.equal(mip.faces.length, 6);
    for (const face of mip.faces) {
      assert.equal(face.length, 4 * mip.size * mip.size);
      face.forEach((value, k) => near(value, k % 4 === 3 ? 1 : 2, 1e-5));
    }
  }
  assert.ok(chain.mips[0].roughness === 0 && chain.mips.at(-1).roughness === 1);
});

test('mirrored faces are those of the mirrored picture', async () => {
  const given = faces(8, 4);
  const plain = await welkin.prefilterCubemap(given, { size: 8, mips: 1, floats: true });
  const mirrored = await welkin.prefilterCubemap(given, { size: 8, mips: 1, floats: true, mirrorX: true });
  for (let face = 0; face < 6; ++face) {
    const from = plain.mips[0].faces[face < 2 ? 1 - face : face];
    for (let row = 0; row < 8; ++row) {
      for (let column = 0; column < 8; ++column) {
        assert.equal(mirrored.mips[0].faces[face][4 * (8 * row + column)], from[4 * (8 * row + 7 - column)]);
      }
    }
  }
});

test('an engine by name sets what its shaders need', async () => {
  const given = faces(8, 4);
  for (const [engine, schedule] of [['three', 'filament'], ['babylon', 'babylon']]) {
    assert.deepEqual(await welkin.prefilterCubemap(given, { for: engine, size: 8 }),
      await welkin.prefilterCubemap(given, { mirrorX: true, schedule, size: 8 }));
  }
});

test('a Blob and a Response are files as their bytes are', async () => {
  const file = radianceFile(64, 32, (x) => [x, 2, 3]);
  const wanted = await welkin.bakeEnvironment(file, { specular: false });
  for (const one of [new Blob([file]), new Response(file)]) {
    assert.deepEqual(await welkin.bakeEnvironment(one, { specular: false }), wanted);
  }
});

test('a .hdr file is baked: harmonics, reflections, KTX2', async () => {
  const file = radianceFile(64, 32, () => [2, 2, 2]);
  const shares = [];
  const light = await welkin.bakeEnvironment(file, { size: 32, ktx2: true, background: 16, onProgress: (share) => shares.push(share) });
  near(light.radiance[0], c00, 1e-4);
  assert.deepEqual(light.source, { width: 64, height: 32 });
  assert.equal(light.specular.mips[0].faces[0][0], 0x4000);
  assert.equal(light.background.faces[5].length, 4 * 16 * 16);
  assert.deepEqual([...light.ktx2.subarray(0, 8)], [0xab, 0x4b, 0x54, 0x58, 0x20, 0x32, 0x30, 0xbb]);
  assert.equal(light.sun, null);
  assert.ok(shares.length > 0 && shares.every((share, k) => share >= (shares[k - 1] ?? 0)) && shares.at(-1) === 1,
    `progress: ${shares}`);
});

test('a sun is taken out of a picture', async () => {
  const file = radianceFile(256, 128, (x, y) => (x === 64 && y === 32 ? [9e4, 9e4, 9e4] : [0.2, 0.3, 0.5]));
  const light = await welkin.bakeEnvironment(file, { specular: false, extractSun: true });
  assert.ok(light.sun.irradiance[0] > 1 && light.sun.direction[1] > 0.5, JSON.stringify(light.sun));
  near(light.radiance[0], 0.2 * Math.sqrt(4 * Math.PI), 0.01);
});

test('a computed sky is bluer than its sun', async () => {
  const light = await welkin.sky({ sunElevation: 40, sunAzimuth: 90, size: 16, faceSize: 32 });
  assert.ok(light.radiance[2] > light.radiance[0]);
  assert.ok(light.sun.irradiance[0] > light.sun.irradiance[2] && light.sun.direction[0] > 0.5);
  assert.equal(light.specular.size, 16);
});

test('the sun stands where astropy has it', async () => {
  const sun = await welkin.sunPosition('2026-06-21T20:30+02:00', 52.5, 13.4);
  near(sun.elevation, 6.9232, 3e-4);
  near(sun.compass, 299.9915, 7e-6);
  near(sun.azimuth, 180 - sun.compass, 1e-9);
  assert.deepEqual(await welkin.sunPosition(new Date('2026-06-21T18:30:00Z'), 52.5, 13.4), sun);
  const raised = await welkin.sunPosition(Date.UTC(2026, 5, 21, 18, 30), 52.5, 13.4, { refraction: true, north: 0 });
  near(raised.elevation - raised.refraction, sun.elevation, 1e-9);
  near(raised.azimuth, -sun.compass + 360, 1e-9);
  await assert.rejects(welkin.sunPosition('2026-06-21T20:30', 52.5, 13.4), /no time zone/);
  await assert.rejects(welkin.sunPosition(new Date(NaN), 52.5, 13.4), /1900 to 2099/);
});

test('errors are rejections with a code and words', async () => {
  const rejects = async (call, code, words) => {
    await assert.rejects(call, (error) => {
      assert.ok(error instanceof welkin.WelkinError, error);
      assert.equal(error.code, code, error.message);
      assert.match(error.message, words);
      return true;
    });
  };
  await rejects(welkin.projectCubemap([]), 'invalid_argument', /6, \+X/);
  await rejects(welkin.projectCubemap(even(4, 3, 1).slice(0, 5)), 'invalid_argument', /5 faces/);
  await rejects(welkin.projectCubemap(even(4, 3, 1), { bands: 17 }), 'invalid_argument', /bands is 17/);
  await rejects(welkin.projectCubemap(even(4, 3, NaN), { rejectNonFinite: true }), 'rejected_pixel', /face/i);
  await rejects(welkin.projectEquirect(new Float32Array(5), { width: 2, height: 1 }), 'invalid_argument', /20 bytes/);
  await rejects(welkin.bakeEnvironment('sky.hdr'), 'invalid_argument', /ArrayBuffer/);
  await rejects(welkin.bakeEnvironment(new Uint8Array(100), { name: 'zeros.hdr' }), 'unsupported_file', /zeros\.hdr/);
  await rejects(welkin.bakeEnvironment(radianceFile(64, 32, () => [1, 1, 1]).subarray(0, 999)), 'corrupt_file', /environment/);
  await rejects(welkin.prefilterCubemap(even(4, 3, 1), { size: 9000 }), 'invalid_argument', /9000/);
  await rejects(welkin.prefilterCubemap(even(4, 3, 1), { schedule: 'steep' }), 'invalid_argument', /steep/);
  await rejects(welkin.prefilterCubemap(even(4, 3, 1), { lobe: 'velvet' }), 'invalid_argument', /velvet/);
  await rejects(welkin.prefilterCubemap(even(4, 3, 1), { sise: 256 }), 'invalid_argument', /no option sise; did you mean size\?/);
  await rejects(welkin.sky({ tables: 'high' }), 'invalid_argument', /tables is "high"; it may be coarse, full/);
  await rejects(welkin.sky({ sun: 20 }), 'invalid_argument', /did you mean sunElevation\?/);
  await rejects(welkin.projectCubemap(even(4, 3, 1), { size: 4 }), 'invalid_argument', /no option size; it has signal,.*targetSize/);
  await rejects(welkin.sky({ for: 'unity' }), 'invalid_argument', /three, babylon/);
  await rejects(welkin.sky({ for: 'three', mirrorX: false }), 'invalid_argument', /sets mirrorX to true/);
  await rejects(welkin.bakeEnvironment(new Response('', { status: 404 })), 'file_access', /404/);
  // and the worker goes on
  near((await welkin.projectCubemap(even(4, 3, 2))).radiance[0], c00, 1e-6);
});

test('a signal ends a call at once, the one that runs and the one that waits; others go on', async () => {
  const running = new AbortController();
  const waiting = new AbortController();
  const long = welkin.sky({ tables: 'full', faceSize: 16, size: 16, signal: running.signal });
  const queued = welkin.projectCubemap(even(4, 3, 1), { signal: waiting.signal });
  const last = welkin.projectCubemap(even(4, 3, 2));
  waiting.abort();
  await assert.rejects(queued, { name: 'AbortError' });
  await new Promise((resolve) => setTimeout(resolve, 100));
  const begun = performance.now();
  running.abort();
  await assert.rejects(long, { name: 'AbortError' });
  assert.ok(performance.now() - begun < 100);
  near((await last).radiance[0], c00, 1e-6);
  await assert.rejects(welkin.projectCubemap(even(4, 3, 1), { signal: AbortSignal.abort() }), { name: 'AbortError' });
});

test('buffers are handed over if that is asked for, and copied otherwise', async () => {
  const kept = even(8, 4, 1);
  await welkin.projectCubemap(kept);
  assert.equal(kept[0].length, 256);
  const given = even(8, 4, 1);
  await welkin.projectCubemap(given, { transfer: true });
  assert.equal(given[0].length, 0);
  const one = new Float32Array(6 * 256).fill(2);
  const views = Array.from({ length: 6 }, (_, face) => one.subarray(256 * face, 256 * face + 256));
  near((await welkin.projectCubemap(views, { transfer: true })).radiance[0], c00, 1e-6);
  assert.equal(one.length, 0);
});

test('several workers work side by side, and the same call gives the same bits', async () => {
  welkin.configure({ workers: 2 });
  const results = await Promise.all(Array.from({ length: 6 }, () => welkin.projectCubemap(faces(64, 3, 5), { bands: 9 })));
  for (const { radiance } of results) assert.deepEqual(radiance, results[0].radiance);
  welkin.configure({ workers: 1 });
});

test('disposing rejects what is left, and the next call works again', async () => {
  const long = welkin.sky({ tables: 'full', size: 16 });
  welkin.dispose();
  await assert.rejects(long, { code: 'stopped' });
  near((await welkin.projectCubemap(even(4, 3, 2))).radiance[0], c00, 1e-6);
});
