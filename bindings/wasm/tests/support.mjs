// What the tests share: the package, where it and its companions lie, and pictures.
import path from 'node:path';
import { pathToFileURL } from 'node:url';

import { modules, packageFolder } from './places.mjs';

export * from './places.mjs';

/** A file of a package that the tests run beside ours. */
export const companion = (name) => import(pathToFileURL(path.join(modules, 'node_modules', name)));
export const welkin = await import(pathToFileURL(path.join(packageFolder, 'index.js')));

/** Numbers that look random and are the same everywhere. */
export function numbers(seed) {
  let state = (seed * 2654435761 + 1) >>> 0;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return (state >>> 8) / 2 ** 24;
  };
}

/** Six faces of floats: noise, and a bright spot. */
export function faces(size, channels, seed = 1) {
  const next = numbers(seed);
  return Array.from({ length: 6 }, (_, face) => {
    const values = Float32Array.from({ length: size * size * channels }, () => next());
    if (face === 2) values[0] = 50;
    return values;
  });
}

/** A Radiance file without runs: old pixels, four bytes each. */
export function radianceFile(width, height, colourAt) {
  const head = new TextEncoder().encode(`#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y ${height} +X ${width}\n`);
  const bytes = new Uint8Array(head.length + 4 * width * height);
  bytes.set(head);
  let at = head.length;
  for (let row = 0; row < height; ++row) {
    for (let column = 0; column < width; ++column, at += 4) {
      const colour = colourAt(column, row);
      const largest = Math.max(...colour);
      if (largest < 1e-30) continue;
      const exponent = Math.floor(Math.log2(largest)) + 1;
      for (let c = 0; c < 3; ++c) bytes[at + c] = Math.min(255, Math.floor((colour[c] * 256) / 2 ** exponent));
      bytes[at + 3] = exponent + 128;
    }
  }
  return bytes;
}

export const median = (values) => values.slice().sort((a, b) => a - b)[Math.floor(values.length / 2)];
