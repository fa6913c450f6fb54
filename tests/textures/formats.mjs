// Texels of the formats that Welkin writes, by the formulas of the Vulkan specification.

export const rgbOf = (rgba, value = (x) => x) => {
  const rgb = [];
  for (let i = 0; i < rgba.length; i += 4) rgb.push(value(rgba[i]), value(rgba[i + 1]), value(rgba[i + 2]));
  return rgb;
};
const smallFloat = (bits, mantissaBits) => {
  const exponent = bits >> mantissaBits;
  const fraction = (bits & ((1 << mantissaBits) - 1)) / (1 << mantissaBits);
  return exponent === 0 ? fraction * 2 ** -14 : (1 + fraction) * 2 ** (exponent - 15);
};
export const fromHalf = (bits) => (bits & 0x8000 ? -1 : 1) * smallFloat(bits & 0x7fff, 10);

/** VkFormat, OpenGL's internal format, bytes per texel, what rounding may be off of a texel's largest channel, texels. */
export const FORMATS = {
  rgba16f: { number: 97, gl: 0x881a, bytes: 8, tolerance: 0, rgb: (words) => rgbOf(words, fromHalf), array: Uint16Array },
  rgba32f: { number: 109, gl: 0x8814, bytes: 16, tolerance: 0, rgb: (words) => rgbOf(words), array: Float32Array },
  b10g11r11: {
    number: 122, gl: 0x8c3a, bytes: 4, tolerance: 2 ** -6, array: Uint32Array,
    rgb: (words) => [...words].flatMap((w) => [smallFloat(w & 2047, 6), smallFloat((w >>> 11) & 2047, 6), smallFloat(w >>> 22, 5)]),
  },
  e5b9g9r9: {
    number: 123, gl: 0x8c3d, bytes: 4, tolerance: 2 ** -9 * 1.001, array: Uint32Array,
    rgb: (words) => [...words].flatMap((w) => [w & 511, (w >>> 9) & 511, (w >>> 18) & 511].map((m) => m * 2 ** ((w >>> 27) - 24))),
  },
};
/** The same of blocks of 16 bytes. */
export const BLOCKS = {
  bc6h: { number: 143, gl: 0x8e8f, edge: 4 }, bc6h_signed: { number: 144, gl: 0x8e8e, edge: 4 },
  astc4x4: { number: 1000066000, gl: 0x93b0, edge: 4 }, astc6x6: { number: 1000066004, gl: 0x93b4, edge: 6 },
  uastc_hdr: { number: 1000066000, gl: 0x93b0, edge: 4 },
};
