// Promise: WebAssembly gives the bits that are on record of x86-64.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';

import { build, source } from './places.mjs';

for (const part of ['core', 'file']) {
  test(`${part}: the bits on record`, () => {
    const printed = execFileSync(process.execPath,
      ['--no-experimental-fetch', path.join(build, `bin/${part}_hashes.js`)], { encoding: 'utf8' });
    const recorded = readFileSync(path.join(source, `tests/portability/${part}_hashes.txt`), 'utf8');
    assert.deepEqual(printed.split('\n'), recorded.split('\n'));
    assert.ok(recorded.split('\n').length > 30);
  });
}
