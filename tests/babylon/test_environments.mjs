// The JavaScript twin of tests/support/test_environments.cpp: the same cubemaps, bit for bit.
//
// Only + - * / sqrt, comparisons and 32-bit integer arithmetic in IEEE double, then one rounding to float:
// both languages define all of these exactly. A change here is a change there.

/** Normal, direction of u (columns), direction of v (rows) of +X -X +Y -Y +Z -Z. */
const FRAMES = [
  [[1, 0, 0], [0, 0, -1], [0, -1, 0]],
  [[-1, 0, 0], [0, 0, 1], [0, -1, 0]],
  [[0, 1, 0], [1, 0, 0], [0, 0, 1]],
  [[0, -1, 0], [1, 0, 0], [0, 0, -1]],
  [[0, 0, 1], [1, 0, 0], [0, -1, 0]],
  [[0, 0, -1], [-1, 0, 0], [0, -1, 0]],
];

/** Bijection of 32 bits in which every input bit reaches every output bit. */
function mixed(bits) {
  let z = bits >>> 0;
  z = Math.imul(z ^ (z >>> 16), 0x21f0aaad) >>> 0;
  z = Math.imul(z ^ (z >>> 15), 0x735a2d97) >>> 0;
  return (z ^ (z >>> 15)) >>> 0;
}

/** Uniform in [0, 1), a function of seed and counter alone. */
const noise = (seed, counter) => mixed(mixed(seed) + counter) / 4294967296;

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/** A third of the way up, unit length to within rounding: (3, 2, -6) / 7. */
const SUN = [3 / 7, 2 / 7, -6 / 7];
const SUN_COLOUR = [1, 0.92, 0.8];
const SPECIAL = [NaN, Infinity, -Infinity, -1, -0, 1e-42, 4096, 4096.5, 1e30, -1e30, 3e38];
const NAN_BEARING = [NaN, -1, -0, 1e-42, 5];

/** Sky over ground with a tint that the seed chooses; 0.1 to 1.8. */
function smooth(seed, direction) {
  const up = 0.5 + 0.5 * direction[1];
  const colour = [0.3 + 0.5 * (up * up), 0.2 + 0.8 * (up * up), 0.1 + 1.2 * (up * up)];
  for (let k = 0; k < 3; ++k) {
    const axis = [0, 1, 2].map((i) => noise(seed, 0x80000000 + 3 * k + i) - 0.5);
    const along = dot(direction, axis);
    colour[k] += 0.6 * (along * along);
  }
  return colour;
}

/** A lobe of radiance `peak` that falls to zero where 1 - cos(angle to the sun) reaches `width`. */
function addSun(colour, direction, peak, width) {
  const height = 1 - (1 - dot(direction, SUN)) / width;
  if (height > 0) for (let k = 0; k < 3; ++k) colour[k] += SUN_COLOUR[k] * peak * (height * height);
  return colour;
}

/** Dense enough that six texels have some, thin enough that a reduction to 8 x 8 finds no NaN in most blocks. */
const oddShare = (texels) => (texels < 2000 ? 0.15 : 0.005);

/** Noise in which a share of the values is drawn from `list`. */
function sprinkled(seed, counter, share, list) {
  const value = noise(seed, counter);
  return value < share ? list[Math.floor(noise(seed, counter + 0x40000000) * list.length)] : value;
}

/** Radiance of one texel: `at` is {direction, texel, texels, cell}. */
function radiance(content, seed, at) {
  const perChannel = (f) => [0, 1, 2].map((k) => f(4 * at.texel + k));
  switch (content) {
    case "random": return perChannel((i) => noise(seed, i));
    case "smooth": return smooth(seed, at.direction);
    case "high_range": {
      const tail = perChannel((i) => 0.02 / (1.0001 - noise(seed, i)));
      const sky = smooth(seed, at.direction);
      return addSun([0, 1, 2].map((k) => sky[k] + tail[k]), at.direction, 3000, 0.02);
    }
    case "clamped": return perChannel((i) => { const r = noise(seed, i); return 20000 * (r * r * r); });
    case "sun_disc": return addSun(smooth(seed, at.direction), at.direction, 60000, 0.002);
    case "gamma_encoded": return perChannel((i) => 1.5 * noise(seed, i) - 0.2);
    case "special_values": return perChannel((i) => sprinkled(seed, i, oddShare(at.texels), SPECIAL));
    case "nan_bearing": return perChannel((i) => sprinkled(seed, i, oddShare(at.texels), NAN_BEARING));
    case "blocks": return [0, 1, 2].map((k) => {
      const r = noise(seed, 4 * at.cell + k);
      return r < 0.5 ? 0.01 : 20 * (r - 0.5);
    });
    case "uniform": return [0.5, 1, 2];
    case "one_texel_sun":
      return at.texel === Math.floor(noise(seed, 0x80000000) * at.texels) ? [1e6, 9e5, 8e5] : perChannel((i) => noise(seed, i));
    default: throw new Error(`no content ${content}`);
  }
}

/** Alpha must never matter: a number that would show, and none at all where the colours have such texels too. */
const alpha = (content, seed, texel) =>
  content === "special_values" || content === "nan_bearing" ? NaN : 1000 + noise(seed, 4 * texel + 3);

/** 0..1 in 256 equal steps; what lies outside, and NaN, goes to the ends. */
const asByte = (value) => (value >= 1 ? 255 : value > 0 ? Math.floor(value * 256) : 0);

/** Six faces one after the other, interleaved, as Float32Array; or Uint8Array if `bytes`. */
export function makeCubemap(content, size, channels, seed, bytes = false) {
  const texels = 6 * size * size;
  const pixels = new (bytes ? Uint8Array : Float32Array)(texels * channels);
  let texel = 0;
  for (let face = 0; face < 6; ++face) {
    const [normal, along, down] = FRAMES[face];
    for (let row = 0; row < size; ++row) {
      for (let column = 0; column < size; ++column, ++texel) {
        const u = (2 * column + 1) / size - 1;
        const v = (2 * row + 1) / size - 1;
        const raw = [0, 1, 2].map((i) => normal[i] + u * along[i] + v * down[i]);
        const length = Math.sqrt(dot(raw, raw));
        const cell = 16 * face + 4 * Math.floor((4 * row) / size) + Math.floor((4 * column) / size);
        const at = { direction: raw.map((c) => c / length), texel, texels, cell };
        const colour = radiance(content, seed, at);
        if (channels === 4) colour.push(alpha(content, seed, texel));
        for (let k = 0; k < channels; ++k) pixels[texel * channels + k] = bytes ? asByte(colour[k]) : colour[k];
      }
    }
  }
  return pixels;
}

/** FNV-1a over the channels' bits (32 a float, 8 a byte; every NaN as 7fc00000): tells that both twins agree. */
export function checksum(pixels) {
  const words = pixels instanceof Float32Array ? new Uint32Array(pixels.buffer) : pixels;
  let hash = 0x811c9dc5;
  for (let i = 0; i < words.length; ++i) {
    const word = Number.isNaN(pixels[i]) ? 0x7fc00000 : words[i];
    hash = Math.imul(hash ^ word, 0x01000193) >>> 0;
  }
  return hash;
}
