// Promise: WebAssembly gives the bits that are on record of x86-64.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';

import { build, source } from './support.mjs';

/** The spectral transform flushes denormals to zero where the processor can. WebAssembly cannot, and light so faint that
 * factors of it are denormal has other last bits there. */
const DARK = ['prefilter/cubemap_times_1e-27', 'prefilter/lat_long_times_1e-27'];

for (const part of ['core', 'file']) {
  test(`${part}: the bits on record`, () => {
    const lines = (text) => text.split('\n').filter((line) => !DARK.includes(line.split(' ')[0]));
    const printed = execFileSync(process.execPath,
      ['--no-experimental-fetch', path.join(build, `bin/${part}_hashes.js`)], { encoding: 'utf8' });
    const recorded = readFileSync(path.join(source, `tests/portability/${part}_hashes.txt`), 'utf8');
    assert.deepEqual(lines(printed), lines(recorded));
    assert.ok(recorded.split('\n').length > 30);
  });
}
