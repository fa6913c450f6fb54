// Promise: files of others' codecs have the light that the native library finds in them, bit for bit, and the files that
// are made of it are the native library's, byte for byte. record_files.cpp wrote what they are compared with.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import path from 'node:path';
import { after, test } from 'node:test';

import { companion, openExrFile, pngFile, radianceFile, source, welkin } from './support.mjs';

after(() => welkin.dispose());

const recorded = JSON.parse(readFileSync(path.join(source, 'bindings/wasm/tests/data/files.json'), 'utf8'));
const bytesOf = (hexadecimal) => Uint8Array.from(Buffer.from(hexadecimal, 'hex'));

/** FNV-1a of 64 bits. */
function hash(bytes) {
  let value = 0xcbf29ce484222325n;
  for (const byte of bytes) value = BigInt.asUintN(64, (value ^ BigInt(byte)) * 0x100000001b3n);
  return value.toString(16).padStart(16, '0');
}

for (const { name, width, height, file, radiance } of recorded) {
  test(`${name}: the native library's bits`, async () => {
    const light = await welkin.bakeEnvironment(bytesOf(file), { name, specular: false });
    assert.deepEqual([...light.radiance], radiance);
    assert.deepEqual(light.sh, light.radiance);
    assert.deepEqual(light.source, { width, height });
  });
}

test('KTX2 and .env files of an OpenEXR file: the native library\'s bytes', async () => {
  const { file, ktx2, env } = recorded.find((one) => one.env);
  const light = await welkin.bakeEnvironment(bytesOf(file), { size: 16, schedule: 'babylon', ktx2: true, env: true });
  assert.equal(hash(light.ktx2), ktx2);
  assert.equal(hash(light.env), env);
  const again = await welkin.bakeEnvironment(light.env, { name: 'again.env', specular: false });
  again.radiance.forEach((value, k) => assert.ok(Math.abs(value - light.radiance[k]) < 0.02 * light.radiance[0]));
});

test('an OpenEXR file that ends too soon is refused, and so is one that says nonsense', async () => {
  const colourAt = (x, y) => [x / 64, y / 32, 1];
  const whole = openExrFile(64, 32, colourAt, true);
  assert.equal((await welkin.bakeEnvironment(whole, { specular: false })).source.width, 64);
  await assert.rejects(welkin.bakeEnvironment(whole.subarray(0, whole.length - 40), { name: 'short.exr' }),
    { code: 'corrupt_file', message: /short\.exr/ });
  const odd = whole.slice();
  odd.fill(0xff, 8, 40);
  await assert.rejects(welkin.bakeEnvironment(odd, { name: 'odd.exr' }), { code: 'corrupt_file', message: /odd\.exr/ });
});

test('PNG files are read as sRGB', async () => {
  const light = await welkin.bakeEnvironment(pngFile(64, 32, () => [255, 188, 0]), { specular: false });
  const whole = Math.sqrt(4 * Math.PI);
  assert.ok(Math.abs(light.radiance[0] - whole) < 1e-4 * whole, `${light.radiance[0]}`);
  assert.ok(Math.abs(light.radiance[1] - 0.503 * whole) < 1e-2 * whole, `${light.radiance[1]}`);
});

test('an .env file is one that Babylon.js reads', async () => {
  const { GetEnvInfo } = await companion('@babylonjs/core/Misc/environmentTextureTools.js');
  const { env, radiance } = await welkin.bakeEnvironment(radianceFile(64, 32, () => [1, 2, 3]), { size: 16, env: true });
  const info = GetEnvInfo(env);
  assert.equal(info.width, 16);
  assert.equal(info.specular.mipmaps.length, 6 * 5);
  assert.ok(Math.abs(info.irradiance.l00?.[0] ?? info.irradiance.xx[0]) > 0, JSON.stringify(info.irradiance));
  assert.ok(radiance[0] > 0);
  assert.equal((await welkin.sky({ size: 16, faceSize: 16, env: true })).env[0], 0x86);
});

test('a chain becomes UASTC HDR with Zstandard, which is read again', async () => {
  const file = radianceFile(64, 32, (x, y) => [1 + x / 32, 2, 1 + y / 16]);
  const options = { size: 64, for: 'three', specular: false, ktx2: true };
  const plain = await welkin.bakeEnvironment(file, { ...options, ktx2Format: 'uastc-hdr' });
  const packed = await welkin.bakeEnvironment(file, { ...options, ktx2Format: 'uastc-hdr', supercompression: 'zstd' });
  const halves = await welkin.bakeEnvironment(file, { ...options, supercompression: 'zlib' });
  assert.ok(packed.ktx2.length < plain.ktx2.length && plain.ktx2.length < halves.ktx2.length);
  const view = new DataView(packed.ktx2.buffer);
  assert.equal(view.getUint32(12, true), 1000066000);
  assert.equal(view.getUint32(44, true), 2);
  assert.equal(packed.ktx2[view.getUint32(48, true) + 12], 167);
  const wanted = await welkin.bakeEnvironment(halves.ktx2, { specular: false });
  for (const { ktx2 } of [plain, packed]) {
    const read = await welkin.bakeEnvironment(ktx2, { specular: false });
    assert.deepEqual(read.source, { width: 64, height: 384 });
    read.radiance.forEach((value, k) => assert.ok(Math.abs(value - wanted.radiance[k]) < 0.01 * wanted.radiance[0]));
  }
  await assert.rejects(welkin.bakeEnvironment(packed.ktx2.subarray(0, 900), { name: 'short.ktx2' }),
    { code: 'corrupt_file', message: /short\.ktx2/ });
  await assert.rejects(welkin.bakeEnvironment(file, { ...options, ktx2Format: 'png' }), /ktx2Format is "png"; it may be/);
});
