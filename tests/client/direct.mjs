// Checks the reference: a chain's texels against the sum over all pixels of the image.
import { readFileSync } from "node:fs";
import { pixelsOf, prefiltered, readPfm } from "./integral.js";

/** OpenGL's directions of a cube's texels. three.js asks a `CubeTexture` for (-x, y, z). */
const FACES = [(s, t) => [1, -t, -s], (s, t) => [-1, -t, s], (s, t) => [s, 1, t], (s, t) => [s, -1, -t],
               (s, t) => [s, -t, 1], (s, t) => [-s, -t, -1]];

/** Root mean square of chain - integral over that of the integral, at two texels of each face of mip 0 (rgba32f). */
export function errorOfTruth({ pixelWidth: size, levels }, pfm, roughness) {
  const pixels = pixelsOf(readPfm(readFileSync(pfm)));
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
