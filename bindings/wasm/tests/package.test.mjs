// Promise: what npm would publish is the package and nothing else, and it is small.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdirSync, readFileSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { gzipSync } from 'node:zlib';

import { build, modules, packageFolder } from './support.mjs';

test('npm packs what the package needs, and nothing else', () => {
  const [{ files }] = JSON.parse(execFileSync('npm', ['pack', '--dry-run', '--json'],
    { cwd: packageFolder, encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore'] }));
  const names = files.map(({ path: name }) => name).sort();
  const wanted = ['LICENSE', 'README.md', 'babylon.d.ts', 'babylon.js', 'engine.js', 'index.d.ts', 'index.js', 'options.js',
    'package.json', 'platform-browser.js', 'platform-node.js', 'script/welkin.js', 'sky-light.js', 'spheres.png',
    'thread-node.js', 'thread.js', 'threads.js', 'three.d.ts', 'three.js', 'welkin-codecs.wasm', 'welkin-environment.wasm',
    'welkin-prefilter.wasm', 'welkin-project.wasm', 'welkin-sky.wasm', 'welkin-textures.wasm', 'welkin-threads.wasm',
    'worker-node.js', 'worker.js'];
  assert.deepEqual(names, wanted);
});

for (const [name, bound] of [['project', 72], ['prefilter', 250], ['sky', 370], ['environment', 335], ['codecs', 570],
  ['textures', 205], ['threads', 430]]) {
  test(`the module ${name} has at most ${bound} KB as it is sent`, () => {
    const bytes = gzipSync(readFileSync(path.join(packageFolder, `welkin-${name}.wasm`)), { level: 9 }).length;
    console.log(`welkin-${name}.wasm: ${(bytes / 1000).toFixed(1)} KB gzip`);
    assert.ok(bytes <= bound * 1000, `${bytes} bytes`);
  });
}

test('the types fit a program that uses them', () => {
  const folder = path.join(build, 'types');
  rmSync(folder, { recursive: true, force: true });
  mkdirSync(path.join(folder, 'node_modules'), { recursive: true });
  symlinkSync(packageFolder, path.join(folder, 'node_modules/welkin-wasm'));
  symlinkSync(path.join(modules, 'node_modules/@babylonjs'), path.join(folder, 'node_modules/@babylonjs'));
  writeFileSync(path.join(folder, 'program.ts'), `
    import { bakeEnvironment, projectCubemap, sky, SkyLight, WelkinError, type Light } from 'welkin-wasm';
    import { installPolynomials, setSphericalPolynomial } from 'welkin-wasm/babylon';
    import * as BABYLON from '@babylonjs/core';
    import type { BaseTexture } from '@babylonjs/core/Materials/Textures/baseTexture.js';
    const { radiance, polynomial } = await projectCubemap([new Float32Array(12)], { bands: 3, quadrature: 'midpoint' });
    const light: Light = await bakeEnvironment(new ArrayBuffer(8), { size: 64, onProgress: (share) => share.toFixed(2) });
    const edge: number | undefined = light.specular?.mips[0].size;
    const red: number = polynomial.xx[0] + radiance[0] + (edge ?? 0);
    await sky({ sunElevation: 20, aerosol: 'dusty' }).catch((error: WelkinError) => error.code === 'limit_exceeded');
    // @ts-expect-error: there is no such aerosol
    await sky({ aerosol: 'green' });
    await sky({ for: 'three', background: 64 });
    const moving = new SkyLight({ size: 16, specularThreshold: 1 });
    moving.setSun(20, 30);
    const turned: number | undefined = moving.update(1 / 60).reflections[0]?.azimuth;
    console.log(turned);
    await bakeEnvironment(new ArrayBuffer(8), { ktx2: true, ktx2Format: 'uastc-hdr', supercompression: 'zstd' });
    // @ts-expect-error: there is no such option
    await sky({ sise: 256 });
    const remove: () => void = installPolynomials(BABYLON, { quadrature: 'midpoint' });
    remove();
    export { red, setSphericalPolynomial, type BaseTexture };
  `);
  execFileSync(process.execPath, [path.join(modules, 'node_modules/typescript/bin/tsc'), '--noEmit', '--strict', '--target', 'es2022',
    '--module', 'esnext', '--moduleResolution', 'bundler', '--skipLibCheck', 'program.ts'], { cwd: folder, stdio: 'inherit' });
});
