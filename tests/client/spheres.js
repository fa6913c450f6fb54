// The scene of all engines, nine spheres in a row, and a figure with several rows.

/** Seven of white metal, from the mirror to the roughest, a grey plastic one and a matte white one. */
export const SPHERES = [
  ...[0, 0.125, 0.25, 0.375, 0.5, 0.75, 1].map((roughness) => ({ name: `${roughness}`, roughness, metallic: 1, albedo: 1 })),
  { name: "plastic", roughness: 0.25, metallic: 0, albedo: 0.5 },
  { name: "white", roughness: 1, metallic: 0, albedo: 1, matte: true },
];

/** Side of the square that a sphere of radius 1 stands in. The squares fill the image from left to right. */
export const SPACING = 2.2;

/** Centre of sphere `index` along the row, whose middle is at 0. */
export const centre = (index) => (index - (SPHERES.length - 1) / 2) * SPACING;

/** Half the width and half the height of the row. */
export const HALF = { x: (SPHERES.length * SPACING) / 2, y: SPACING / 2 };

/** Narkowicz's fit of the ACES curve (2015), then sRGB, of light times `exposure`: 0 to 255. */
function shown(light, exposure) {
  const x = Math.max(0, light * exposure);
  const curve = Math.min(1, (x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14));
  return 255 * (curve <= 0.0031308 ? 12.92 * curve : 1.055 * curve ** (1 / 2.4) - 0.055);
}

/** Light such that its mean, over the spheres of the row, is shown at a third. */
function exposureOf({ light }) {
  let [sum, count] = [0, 0];
  for (let at = 0; at < light.length; at += 4) {
    if (light[at + 3] === 0) continue;
    sum += Math.min(light[at + 1], 10);
    ++count;
  }
  return (0.33 * count) / sum;
}

/** One row as a canvas; two by two of its pixels become one. Row 0 of the light is the lowest. */
function rowOf({ width, height, light }, exposure) {
  const canvas = document.createElement("canvas");
  Object.assign(canvas, { width, height });
  const pixels = new ImageData(width, height);
  for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x) {
      const from = ((height - 1 - y) * width + x) * 4;
      const to = (y * width + x) * 4;
      const inside = light[from + 3] !== 0;
      for (let channel = 0; channel < 3; ++channel)
        pixels.data[to + channel] = inside ? shown(light[from + channel], exposure) : 30;
      pixels.data[to + 3] = 255;
    }
  canvas.getContext("2d").putImageData(pixels, 0, 0);
  return canvas;
}

/** Data URL of a PNG: our row above, theirs in the middle, below `gain` times the difference's absolute value. */
export function figure(ours, theirs, gain) {
  const light = ours.light.map((value, at) => (at % 4 === 3 ? value : gain * Math.abs(value - theirs.light[at])));
  const exposure = exposureOf(theirs);
  const rows = [ours, theirs, { ...ours, light }].map((row) => rowOf(row, exposure));
  const [width, height] = [ours.width / 2, ours.height / 2];
  const canvas = document.createElement("canvas");
  Object.assign(canvas, { width, height: rows.length * height });
  const pen = canvas.getContext("2d");
  pen.imageSmoothingQuality = "high";
  rows.forEach((row, index) => pen.drawImage(row, 0, index * height, width, height));
  return canvas.toDataURL("image/png");
}
