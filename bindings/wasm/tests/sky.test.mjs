// Promise: a page's moving sky has the light of the worker's own skies, whatever the sun's elevation and azimuth, and asks
// for reflections no more often than it must.
import assert from 'node:assert/strict';
import { after, test } from 'node:test';

import { welkin } from './support.mjs';

after(() => welkin.dispose());

const wait = () => new Promise((resolve) => { setTimeout(resolve, 5); });

async function settled(sky, reflected = false) {
  let frame = sky.update(1);
  while (!(frame.ready && frame.settled && (!reflected || frame.reflections.length > 0))) {
    assert.equal(sky.error, null);
    await wait();
    frame = sky.update(1);
  }
  return frame;
}

test('the light of a frame is that of the sky by itself', async () => {
  const sky = new welkin.SkyLight({ size: 0 });
  assert.equal(sky.update(0).ready, false);
  await settled(sky);
  for (const [elevation, azimuth] of [[60.3, 0], [20.1, 145], [5.77, -30], [0.3, 90], [-3.21, 200]]) {
    sky.setSun(elevation, azimuth);
    const frame = sky.update(1 / 60);
    const direct = await welkin.sky({ sunElevation: elevation, sunAzimuth: azimuth, specular: false, faceSize: 256 });
    const whole = Math.hypot(...direct.radiance);
    const error = Math.hypot(...frame.radiance.map((value, k) => value - direct.radiance[k])) / whole;
    assert.ok(error < 6e-3, `${elevation}, ${azimuth}: ${error}`); // 256 texels see the aureole's core as points
    frame.sun.direction.forEach((value, k) => assert.ok(Math.abs(value - direct.sun.direction[k]) < 1e-9));
    const brightest = Math.max(...direct.sun.irradiance);
    frame.sun.irradiance.forEach((value, k) => assert.ok(Math.abs(value - direct.sun.irradiance[k]) < 2e-3 * brightest + 1e-6,
      `${elevation}: ${value} instead of ${direct.sun.irradiance[k]}`));
  }
  sky.dispose();
});

test('reflections follow the elevation, are blended, and turn with the azimuth', async () => {
  const sky = new welkin.SkyLight({ size: 16, blendSeconds: 1 });
  sky.setSun(30, 0);
  let frame = await settled(sky, true);
  assert.equal(frame.reflections.length, 1);
  const first = frame.reflections[0].specular;
  const alone = await welkin.sky({ sunElevation: 30, size: 16, faceSize: 32 });
  assert.deepEqual(first, alone.specular);
  sky.setSun(30.3, 80); // less than half a degree
  frame = sky.update(0.1);
  assert.equal(frame.reflections[0].specular, first);
  assert.equal(frame.reflections[0].azimuth, 80);
  sky.setSun(32, 80);
  while (frame.reflections.length < 2) {
    await wait();
    frame = sky.update(0.001);
  }
  assert.equal(frame.reflections[1].specular, first);
  frame = sky.update(0.25);
  assert.ok(Math.abs(frame.reflections[0].weight + frame.reflections[1].weight - 1) < 1e-9);
  assert.ok(frame.reflections[0].weight > 0.2 && frame.reflections[0].weight < 0.4);
  assert.equal(sky.counters.speculars, 2);
  sky.setIntensity(0);
  assert.ok(sky.update(0).radiance.every((value) => value === 0));
  assert.throws(() => sky.setSun(91, 0), { code: 'invalid_argument' });
  assert.throws(() => sky.setSun(0, NaN), { code: 'invalid_argument' });
  assert.throws(() => new welkin.SkyLight({ sise: 3 }), /did you mean size/);
  sky.dispose();
});
