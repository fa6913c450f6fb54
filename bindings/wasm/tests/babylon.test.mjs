// Promise: with the patch, a page that asks Babylon.js for the polynomial of a large cube has no long task, and gets the same
// polynomial. WELKIN_CUBE is the size of its faces; the figures of the page are those of 2048.
import assert from 'node:assert/strict';
import { mkdirSync, rmSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';

import { chromium, openBrowser } from './pages/browser.mjs';
import { serve } from './pages/serve.mjs';
import { build, companion, modules, packageFolder, radianceFile } from './support.mjs';

const work = path.join(build, 'babylon');
const size = Number(process.env.WELKIN_CUBE ?? 512);

const program = `
import { CubeMapToSphericalPolynomialTools, Engine, HDRCubeTexture, RawCubeTexture, Scene, SphericalPolynomial, Vector3 } from '@babylonjs/core';
import { installPolynomials } from '/package/babylon.js';

const BABYLON = { CubeMapToSphericalPolynomialTools, HDRCubeTexture, SphericalPolynomial, Vector3 };
const TERMS = ['x', 'y', 'z', 'xx', 'yy', 'zz', 'yz', 'zx', 'xy'];
const tasks = [];
new PerformanceObserver((list) => tasks.push(...list.getEntries().map(({ duration }) => duration))).observe({ type: 'longtask' });
const wait = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));

/** The polynomial that a call leads to, and the longest task of the page on the way; 0: none took 50 ms. */
async function measured(begin) {
  await wait(1000);
  tasks.length = 0;
  const begun = performance.now();
  const texture = await begin();
  while (!texture.sphericalPolynomial) await wait(5);
  const milliseconds = performance.now() - begun;
  await wait(200);
  return { longest: Math.max(0, ...tasks), milliseconds, terms: TERMS.map((term) => texture.sphericalPolynomial[term].asArray()) };
}

async function show(size) {
  const scene = new Scene(new Engine(document.querySelector('canvas'), false));
  // All faces are one array, rotated by their axes: the content does not matter.
  const face = Float32Array.from({ length: 4 * size * size }, (_, k) => ((k % 4) + 1) * (0.2 + (k % size) / size + (k > size * size ? 1 : 0)));
  // One texel is read back, so that the upload is not part of what follows.
  const raw = async () => {
    const texture = Object.assign(new RawCubeTexture(scene, Array(6).fill(face), size, 5, 1, false), { gammaSpace: false });
    await texture.readPixels(5, 0, undefined, false, false, 0, 0, 1, 1);
    return texture;
  };
  // The call begins when the file is there: what Babylon.js does to it is in both.
  const file = () => new Promise((resolve, reject) => {
    const texture = new HDRCubeTexture('/made/sky.hdr', scene, size, true, true, false, false, () => resolve(texture), reject);
  });
  const found = {};
  for (const [name, make] of Object.entries({ raw, file })) {
    const start = name === 'raw' ? async (texture) => () => texture : async () => make;
    const before = await measured(await start(name === 'raw' && await make()));
    scene.getEngine().clearInternalTexturesCache();
    const remove = installPolynomials(BABYLON);
    const after = await measured(await start(name === 'raw' && await make()));
    remove();
    scene.getEngine().clearInternalTexturesCache();
    const difference = Math.max(...before.terms.flatMap((term, k) => term.map((value, c) => Math.abs(value - after.terms[k][c]))));
    found[name] = { before, after, difference, scale: Math.max(...before.terms.flat()) };
  }
  return found;
}
window.shown = show(Number(new URLSearchParams(location.search).get('size'))).then((result) => ({ result }), (error) => ({ error: String(error.stack) }));
`;

test('Babylon.js gets its polynomials from the worker without a fork', { skip: chromium ? false : 'Chromium is not there' }, async () => {
  rmSync(work, { recursive: true, force: true });
  mkdirSync(work, { recursive: true });
  writeFileSync(path.join(work, 'sky.hdr'), radianceFile(1024, 512, (x, y) => (y < 256 ? [0.3, 0.5, 0.2 + y / 256] : [0.2, 0.15 + x / 2048, 0.1])));
  writeFileSync(path.join(work, 'page.source.js'), program);
  writeFileSync(path.join(work, 'page.html'), `<!doctype html><canvas width="64" height="64"></canvas>
    <script type="importmap">{"imports": {"#platform": "/package/platform-browser.js"}}</script><script type="module" src="/made/page.js"></script>`);
  const { default: esbuild } = await companion('esbuild/lib/main.js');
  await esbuild.build({ entryPoints: [path.join(work, 'page.source.js')], bundle: true, format: 'esm', logLevel: 'error', external: ['/package/*'],
    nodePaths: [path.join(modules, 'node_modules')], outfile: path.join(work, 'page.js') });
  const server = await serve({ package: packageFolder, made: work });
  const browser = await openBrowser();
  try {
    const page = await browser.newPage();
    page.on('console', (message) => { if (message.type() === 'error') console.log(message.text()); });
    await page.goto(`${server.address}/made/page.html?size=${size}`);
    const { result, error } = await page.evaluate(() => window.shown);
    assert.equal(error, undefined);
    for (const [name, { before, after, difference, scale }] of Object.entries(result)) {
      const text = ({ longest, milliseconds }) => `longest task ${Math.round(longest)} ms, polynomial after ${Math.round(milliseconds)} ms`;
      console.log(`${name}, faces of ${size}: Babylon.js alone: ${text(before)}; with the patch: ${text(after)}`);
      assert.ok(difference < 1e-3 * scale, JSON.stringify(result));
    }
    assert.notEqual(JSON.stringify(result.raw.before.terms), JSON.stringify(result.raw.after.terms), 'the worker was not asked');
  } finally {
    await browser.close();
    server.close();
  }
});
