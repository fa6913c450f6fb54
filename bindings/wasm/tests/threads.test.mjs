// Promise: with threads on shared memory every call gives the bits of one thread, errors keep their code and words, and
// calls can be ended; a page that may not share memory computes on one.
import assert from 'node:assert/strict';
import { after, test } from 'node:test';

import { faces, radianceFile, welkin } from './support.mjs';

const file = radianceFile(512, 256, (x, y) => (x === 100 && y === 80 ? [4000, 3000, 2000] : [y / 256, 0.4, (x % 17) / 17]));
const cube = faces(257, 4);

function onThreads(threads) {
  welkin.dispose(); // threads are those of new workers
  welkin.configure({ threads });
}

after(() => onThreads(1));

const CALLS = {
  projectCubemap: () => welkin.projectCubemap(cube, { bands: 7 }),
  prefilterCubemap: () => welkin.prefilterCubemap(cube, { size: 64 }),
  bakeEnvironment: () => welkin.bakeEnvironment(file, { size: 128, extractSun: true, ktx2: true }),
  sky: () => welkin.sky({ sunElevation: 12, size: 32, faceSize: 64 }),
};

for (const [name, call] of Object.entries(CALLS)) {
  test(`${name} gives the same bits on one, two and five threads, twice`, async () => {
    onThreads(1);
    const alone = await call();
    for (const threads of [2, 5]) {
      onThreads(threads);
      assert.deepEqual(await call(), alone);
      assert.deepEqual(await call(), alone);
    }
  });
}

test('results are of memory that is not shared, and can be handed on', async () => {
  onThreads(3);
  const { mips } = await welkin.prefilterCubemap(cube, { size: 16 });
  assert.ok(mips[0].faces[0].buffer instanceof ArrayBuffer);
  structuredClone(mips[0].faces[0], { transfer: [mips[0].faces[0].buffer] });
});

test('what a thread refuses keeps its code and words, and the next call works', async () => {
  onThreads(1);
  const broken = cube.map((face) => face.slice());
  broken[5][4 * 257 * 200 + 2] = NaN;
  const refused = async () => {
    const error = await welkin.projectCubemap(broken, { rejectNonFinite: true }).then(assert.fail, (one) => one);
    return [error.code, error.message];
  };
  const alone = await refused();
  assert.equal(alone[0], 'rejected_pixel');
  onThreads(4);
  for (let k = 0; k < 20; ++k) assert.deepEqual(await refused(), alone);
  await assert.rejects(welkin.projectCubemap(cube, { bands: 99 }), { code: 'invalid_argument' });
  assert.ok((await CALLS.projectCubemap()).radiance[0] > 0);
});

test('progress ends at one, and a call on threads ends by its signal', async () => {
  onThreads(3);
  const shares = [];
  await welkin.prefilterCubemap(cube, { size: 128, onProgress: (share) => shares.push(share) });
  assert.equal(shares.at(-1), 1);
  assert.deepEqual(shares, shares.slice().sort((a, b) => a - b));
  const ended = new AbortController();
  const long = welkin.sky({ tables: 'full', faceSize: 16, size: 16, signal: ended.signal });
  setTimeout(() => ended.abort(), 300);
  await assert.rejects(long, { name: 'AbortError' });
  assert.ok((await CALLS.projectCubemap()).radiance[0] > 0);
});

test('the number of threads is checked', () => {
  for (const threads of [0, 1.5, '2']) assert.throws(() => welkin.configure({ threads }), { code: 'invalid_argument' });
});
