// The reference in three.js's conventions and none of Welkin's: the integral that a prefiltered texel holds, summed over
// all pixels of an image.

/** A .pfm in colour from its bytes: rows from below to above, little-endian. */
export function readPfm(bytes) {
  const [head] = new TextDecoder("latin1").decode(bytes.subarray(0, 64)).match(/^PF\s\d+\s\d+\s-[\d.]+\n/);
  const [width, height] = head.split(/\s/).slice(1, 3).map(Number);
  return { width, height, rgb: new Float32Array(Uint8Array.from(bytes.subarray(head.length)).buffer) };
}

/** Where three.js's `equirectUv` has the point (column, row) of an image. Row 0 is the lowest. */
function directionOf(width, height, column, row) {
  const [latitude, longitude] = [(row / height - 0.5) * Math.PI, (column / width - 0.5) * 2 * Math.PI];
  return [Math.cos(longitude) * Math.cos(latitude), Math.sin(latitude), Math.sin(longitude) * Math.cos(latitude)];
}

/** An image with the direction and the solid angle of each pixel. */
export function pixelsOf({ width, height, rgb }) {
  const direction = new Float64Array(3 * width * height);
  const area = new Float64Array(width * height);
  for (let row = 0, at = 0; row < height; ++row)
    for (let column = 0; column < width; ++column, ++at) {
      direction.set(directionOf(width, height, column + 0.5, row + 0.5), 3 * at);
      area[at] = Math.cos(((row + 0.5) / height - 0.5) * Math.PI);
    }
  return { width, height, direction, area, rgb };
}

/** D cos of GGX with N = V = R, by the cosine and the square of alpha. */
function lobe(cosine, squared) {
  const halfway = ((1 + cosine) / 2) * (squared - 1) + 1;
  return cosine <= 0 ? 0 : cosine / (halfway * halfway);
}

/** The mean of the lobe over a pixel's own points, for lobes as narrow as a pixel. */
function lobeOver({ width, height }, at, [x, y, z], squared) {
  const POINTS = 6; // along an edge
  const [row, column] = [Math.floor(at / width), at % width];
  let sum = 0;
  for (let k = 0; k < POINTS * POINTS; ++k) {
    const [dx, dy] = [((k % POINTS) + 0.5) / POINTS, (Math.floor(k / POINTS) + 0.5) / POINTS];
    const [a, b, c] = directionOf(width, height, column + dx, row + dy);
    sum += lobe(a * x + b * y + c * z, squared);
  }
  return sum / (POINTS * POINTS);
}

/** Light from each pixel times D cos, over the sum of D cos. */
export function prefiltered(pixels, towards, roughness) {
  const { direction, area, rgb } = pixels;
  const [x, y, z] = towards;
  const squared = roughness ** 4; // of alpha
  const near = roughness < 0.1 ? 0.998 : 2; // the cosine from which pixels are looked at closely
  let [red, green, blue, sum] = [0, 0, 0, 0];
  for (let at = 0; at < area.length; ++at) {
    const cosine = direction[3 * at] * x + direction[3 * at + 1] * y + direction[3 * at + 2] * z;
    if (cosine <= 0) continue;
    const weight = area[at] * (cosine > near ? lobeOver(pixels, at, towards, squared) : lobe(cosine, squared));
    red += weight * rgb[3 * at];
    green += weight * rgb[3 * at + 1];
    blue += weight * rgb[3 * at + 2];
    sum += weight;
  }
  return [red / sum, green / sum, blue / sum];
}
