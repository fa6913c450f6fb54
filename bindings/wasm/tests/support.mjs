// Shared by the tests: the package, the paths of it and its companions, and images.
import path from 'node:path';
import { pathToFileURL } from 'node:url';
import { crc32, deflateSync } from 'node:zlib';

import { modules, packageFolder } from './places.mjs';

export * from './places.mjs';

/** A file of a package that the tests run next to ours. */
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

const joined = (parts) => new Uint8Array(Buffer.concat(parts.map((part) => Buffer.from(part))));

/** The bytes of a row as OpenEXR's ZIPS has them: even ones before odd ones, each less the one before it, deflated. */
function zips(row) {
  const half = (row.length + 1) >> 1;
  const parted = Uint8Array.from(row, (_, k) => (k < half ? row[2 * k] : row[2 * (k - half) + 1]));
  return deflateSync(parted.map((byte, k) => (k === 0 ? byte : byte - parted[k - 1] + 128)));
}

/** An OpenEXR file of floats in rows, packed by ZIPS or not at all. */
export function openExrFile(width, height, colourAt, packed) {
  const words = (...values) => new Uint8Array(Int32Array.from(values).buffer);
  const floats = (...values) => new Uint8Array(Float32Array.from(values).buffer);
  const attribute = (name, type, value) => [Buffer.from(`${name}\0${type}\0`), words(value.length), value];
  const kFloat = 2;
  const channels = joined(['B', 'G', 'R'].flatMap((name) => [Buffer.from(`${name}\0`), words(kFloat, 0, 1, 1)]).concat([[0]]));
  const window = words(0, 0, width - 1, height - 1);
  const head = joined([[0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0], ...attribute('channels', 'chlist', channels),
    ...attribute('compression', 'compression', [packed ? 2 : 0]), ...attribute('dataWindow', 'box2i', window),
    ...attribute('displayWindow', 'box2i', window), ...attribute('lineOrder', 'lineOrder', [0]),
    ...attribute('pixelAspectRatio', 'float', floats(1)), ...attribute('screenWindowCenter', 'v2f', floats(0, 0)),
    ...attribute('screenWindowWidth', 'float', floats(1)), [0]]);
  const rows = Array.from({ length: height }, (_, y) => {
    const colours = Array.from({ length: width }, (_, x) => colourAt(x, y));
    const plain = floats(...[2, 1, 0].flatMap((c) => colours.map((colour) => colour[c])));
    const deflated = packed ? zips(plain) : plain;
    const bytes = deflated.length < plain.length ? deflated : plain;
    return joined([words(y, bytes.length), bytes]);
  });
  let at = head.length + 8 * height;
  const places = rows.map((row) => { const place = at; at += row.length; return words(place, 0); });
  return joined([head, ...places, ...rows]);
}

/** A PNG file of bytes, RGB, unfiltered. */
export function pngFile(width, height, colourAt) {
  const word = (value) => [value >>> 24, (value >>> 16) & 255, (value >>> 8) & 255, value & 255];
  const chunk = (type, data) => {
    const body = joined([Buffer.from(type), data]);
    return joined([word(data.length), body, word(crc32(body))]);
  };
  const rows = Array.from({ length: height }, (_, y) => [0, ...Array.from({ length: width }, (_, x) => colourAt(x, y)).flat()]);
  return joined([[0x89, 0x50, 0x4e, 0x47, 13, 10, 26, 10],
    chunk('IHDR', [...word(width), ...word(height), 8, 2, 0, 0, 0]), chunk('IDAT', deflateSync(joined(rows))), chunk('IEND', [])]);
}

export const median = (values) => values.slice().sort((a, b) => a - b)[Math.floor(values.length / 2)];
