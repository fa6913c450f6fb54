// The truth's own check, by three.js's conventions and none of Welkin's: the integral that a prefiltered texel stands for,
// summed over all pixels of the picture.
import { readFileSync } from "node:fs";

/** A .pfm in colour: rows from below to above, little-endian. */
function readPfm(path) {
  const bytes = readFileSync(path);
  const [head] = bytes.toString("latin1", 0, 64).match(/^PF\s\d+\s\d+\s-[\d.]+\n/);
  const [width, height] = head.split(/\s/).slice(1, 3).map(Number);
  return { width, height, rgb: new Float32Array(bytes.buffer.slice(bytes.byteOffset + head.length)) };
}

/** What three.js's `equirectUv` finds at a pixel, and the pixel's solid angle. Row 0 is the lowest. */
function pixelsOf({ width, height, rgb }) {
  const direction = new Float64Array(3 * width * height);
  const area = new Float64Array(width * height);
  for (let row = 0, at = 0; row < height; ++row) {
    const latitude = ((row + 0.5) / height - 0.5) * Math.PI;
    for (let column = 0; column < width; ++column, ++at) {
      const longitude = ((column + 0.5) / width - 0.5) * 2 * Math.PI;
      direction[3 * at] = Math.cos(longitude) * Math.cos(latitude);
      direction[3 * at + 1] = Math.sin(latitude);
      direction[3 * at + 2] = Math.sin(longitude) * Math.cos(latitude);
      area[at] = Math.cos(latitude);
    }
  }
  return { direction, area, rgb };
}

/** GGX with N = V = R, weighted by the cosine: light from each pixel times D cos, over the sum of D cos. */
function prefiltered({ direction, area, rgb }, [x, y, z], roughness) {
  const squared = roughness ** 4; // of alpha
  const sum = [0, 0, 0, 0];
  for (let at = 0; at < area.length; ++at) {
    const cosine = direction[3 * at] * x + direction[3 * at + 1] * y + direction[3 * at + 2] * z;
    if (cosine <= 0) continue;
    const halfway = ((1 + cosine) / 2) * (squared - 1) + 1;
    const weight = (area[at] * cosine) / (halfway * halfway);
    for (let channel = 0; channel < 3; ++channel) sum[channel] += weight * rgb[3 * at + channel];
    sum[3] += weight;
  }
  return sum.slice(0, 3).map((value) => value / sum[3]);
}

/** OpenGL's directions of a cube's texels. three.js asks a `CubeTexture` for (-x, y, z). */
const FACES = [(s, t) => [1, -t, -s], (s, t) => [-1, -t, s], (s, t) => [s, 1, t], (s, t) => [s, -1, -t],
               (s, t) => [s, -t, 1], (s, t) => [-s, -t, -1]];

/** Root mean square of chain - integral over that of the integral, at two texels of each face of mip 0 (rgba32f). */
export function errorOfTruth({ pixelWidth: size, levels }, pfm, roughness) {
  const pixels = pixelsOf(readPfm(pfm));
  const texels = new Float32Array(levels[0].levelData.slice().buffer);
  let [difference, power] = [0, 0];
  FACES.forEach((face, index) => {
    for (const [column, row] of [[0.31, 0.22], [0.66, 0.89]].map((place) => place.map((part) => Math.floor(part * size)))) {
      const [x, y, z] = face((2 * column + 1) / size - 1, (2 * row + 1) / size - 1);
      const length = Math.hypot(x, y, z);
      const summed = prefiltered(pixels, [-x / length, y / length, z / length], roughness);
      const at = 4 * ((index * size + row) * size + column);
      for (let channel = 0; channel < 3; ++channel) {
        difference += (texels[at + channel] - summed[channel]) ** 2;
        power += summed[channel] ** 2;
      }
    }
  });
  return Math.sqrt(difference / power);
}
