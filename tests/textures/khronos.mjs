// Asks Khronos' own reader, libktx as WebAssembly in npm's @khronosgroup/gltf-viewer, what is in our KTX2 and KTX files.
//
//   node khronos.mjs --modules DIR --check SAMPLES [--welkin WELKIN]
//
// libktx checks a file, unpacks it and uploads it to OpenGL, which is the object `gl` here: it keeps the bytes of each face
// and level. They must be those that ktx-parse finds in the file (unpacked by Node's zlib or three.js's zstddec), in images of
// the sizes and the internal format that the file says; texels of SAMPLES, which texture_samples wrote, must be those that went
// in. WELKIN bakes the folders of each engine that has such files, and files of each format.
import { execFileSync } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, readdirSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { inflateSync } from "node:zlib";

import { BLOCKS, FORMATS } from "./formats.mjs";

const flags = process.argv.slice(2);
const flag = (name) => (flags.includes(name) ? flags[flags.indexOf(name) + 1] : undefined);
const modules = join(resolve(flag("--modules")), "node_modules");
const samples = resolve(flag("--check"));
const welkin = flag("--welkin");
const load = (file) => import(pathToFileURL(join(modules, file)).href);
const ktxParse = await load("ktx-parse/dist/ktx-parse.modern.js");
const { ZSTDDecoder } = await load("three/examples/jsm/libs/zstddec.module.js");
const zstd = new ZSTDDecoder();
await zstd.init();

// --- OpenGL for libktx
const FIRST_FACE = 0x8515; // TEXTURE_CUBE_MAP_POSITIVE_X
let uploads = [];
const keep = (target, level, internal, sizes, heap, byte, length) => {
  const bytes = Buffer.from(heap.buffer.slice(byte, byte + length));
  uploads.push({ face: target >= FIRST_FACE && target < FIRST_FACE + 6 ? target - FIRST_FACE : 0, level, internal, sizes, bytes });
};
/** Texels have 8, 16 or 4 bytes: four halves, four floats, or one packed word. */
const texelBytes = (type) => ({ 0x140b: 8, 0x1406: 16 }[type] ?? 4);
const plain = (target, level, internal, sizes, type, heap, at) =>
  keep(target, level, internal, sizes, heap, at * heap.BYTES_PER_ELEMENT, sizes.reduce((all, one) => all * one, texelBytes(type)));
const gl = {
  VERSION: 0x1f02,
  getParameter: (what) => (what === 0x1f02 ? "WebGL 2.0" : what === 0x0cf5 ? 4 : 0), // 0x0cf5: UNPACK_ALIGNMENT
  getSupportedExtensions: () => ["EXT_texture_compression_bptc", "WEBGL_compressed_texture_astc"],
  getExtension: () => ({}),
  getError: () => 0,
  createTexture: () => ({}),
  texImage2D: (target, level, internal, width, height, border, format, type, heap, at) =>
    plain(target, level, internal, [width, height], type, heap, at),
  texImage3D: (target, level, internal, width, height, depth, border, format, type, heap, at) =>
    plain(target, level, internal, [width, height, depth], type, heap, at),
  compressedTexImage2D: (target, level, internal, width, height, border, heap, at, length) =>
    keep(target, level, internal, [width, height], heap, at, length),
};
for (const name of ["pixelStorei", "bindTexture", "texParameteri", "deleteTexture"]) gl[name] = () => {};
const home = join(modules, "@khronosgroup/gltf-viewer/dist/libs/libktx");
const LIBKTX = new Function("require", "__filename", "__dirname", `${readFileSync(`${home}.js`, "utf8")}; return LIBKTX;`)(
  createRequire(import.meta.url), `${home}.js`, resolve(home, ".."));
const libktx = await LIBKTX({ preinitializedWebGLContext: gl, wasmBinary: readFileSync(`${home}.wasm`) });
libktx.GL.makeContextCurrent(libktx.GL.createContext(null, { majorVersion: 2 }));

let checks = 0;
let failed = 0;
function check(right, what) {
  ++checks;
  if (right) return;
  ++failed;
  console.error(`NOT AS IT WAS WRITTEN: ${what}`);
}
const bytesOf = (path) => new Uint8Array(readFileSync(path));

/** What libktx uploads of a file: the texture, and each image. */
function read(path) {
  uploads = [];
  const texture = new libktx.ktxTexture(bytesOf(path));
  const { error, target } = texture.glUpload();
  check(!error?.value, `${path}: glUpload: ${error?.value}`);
  return { texture, target, images: uploads };
}

/** Compares libktx's images of a KTX2 file with those of ktx-parse. */
function compareWithParser(path) {
  const { texture, images } = read(path);
  const file = ktxParse.read(bytesOf(path));
  const format = [...Object.values(FORMATS), ...Object.values(BLOCKS)].find(({ number }) => number === file.vkFormat);
  check(format, `${path}: VkFormat ${file.vkFormat}`);
  check(texture.vkFormat === file.vkFormat && images.every(({ internal }) => internal === format.gl), `${path}: formats`);
  check(texture.baseWidth === file.pixelWidth && texture.baseHeight === file.pixelHeight, `${path}: size`);
  check(images.length === file.levels.length * file.faceCount, `${path}: ${images.length} images`);
  for (const [level, { levelData, uncompressedByteLength }] of file.levels.entries()) {
    const bytes = Buffer.from(file.supercompressionScheme === 2 ? zstd.decode(levelData, uncompressedByteLength)
                              : file.supercompressionScheme === 3 ? inflateSync(levelData) : levelData);
    const each = bytes.length / file.faceCount;
    for (let face = 0; face < file.faceCount; ++face) {
      const image = images.find((one) => one.face === face && one.level === level);
      const sizes = [file.pixelWidth, file.pixelHeight, file.pixelDepth || file.layerCount].filter((size) => size > 0).map((size) => Math.max(1, size >> level));
      check(image?.sizes.join() === sizes.join(), `${path} level ${level}, face ${face}: ${image?.sizes} texels`);
      check(image?.bytes.equals(bytes.subarray(face * each, (face + 1) * each)), `${path} level ${level}, face ${face}: other bytes`);
    }
  }
  return images.length;
}

/** Compares the texels of a sample, level after level, with the floats that were written. */
function compareTexels(name, floats, { array, rgb, tolerance }) {
  const wanted = new Float32Array(bytesOf(join(samples, floats)).buffer);
  const images = read(join(samples, name)).images.sort((a, b) => a.level - b.level || a.face - b.face);
  const found = images.flatMap(({ bytes }) => rgb(new array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length))));
  let worst = found.length === wanted.length ? 0 : Infinity;
  for (let i = 0; i < wanted.length; i += 3) {
    const largest = Math.max(wanted[i], wanted[i + 1], wanted[i + 2]);
    for (let c = i; c < i + 3; ++c) worst = Math.max(worst, Math.abs(found[c] - wanted[c]) / largest);
  }
  check(worst <= tolerance, `${name}: ${found.length} values, up to ${worst} off`);
}

const folders = [samples];
const scratch = mkdtempSync(join(tmpdir(), "welkin-khronos-"));
try {
  if (welkin) {
    const bake = (folder, ...options) => {
      execFileSync(welkin, ["bake", join(scratch, "map.hdr"), "-o", join(scratch, folder), "-q", "--no-previews", "--size", "32", "--background-size", "32", "--astc-effort", "fastest", ...options]);
      folders.push(join(scratch, folder));
    };
    execFileSync(welkin, ["testmap", "-o", join(scratch, "map.hdr"), "-q"]);
    for (const engine of ["three", "filament", "bevy", "gltf"]) bake(engine, "--for", engine);
    const formats = ["rgba16f", "rgba32f", "b10g11r11", "e5b9g9r9", "bc6h", "bc6h-signed", "uastc-hdr"];
    if (existsSync(join(samples, "astc4x4.ktx2"))) formats.push("astc4x4", "astc6x6"); // Welkin was built with astcenc
    for (const format of formats) for (const packing of ["none", "zstd"])
      bake(`${format}_${packing}`, "--ktx2-format", format, "--supercompression", packing, "--lobe", "charlie", "--octahedral", "32");
  }
  let [files, images] = [0, 0];
  for (const folder of folders) for (const name of readdirSync(folder).sort()) {
    const path = join(folder, name);
    if (name.endsWith(".ktx2")) images += compareWithParser(path), ++files;
    else if (name.endsWith(".ktx")) images += read(path).images.length, ++files;
  }
  for (const [name, format] of Object.entries(FORMATS))
    for (const file of [`${name}.ktx2`, `${name}_zlib.ktx2`, `${name}_zstd.ktx2`, `${name}.ktx`]) compareTexels(file, "chain.f32", format);
  compareTexels("image.ktx2", "lat_long.f32", FORMATS.rgba16f);
  compareTexels("image_zstd.ktx2", "lat_long.f32", FORMATS.rgba32f);
  compareTexels("octahedral_zstd.ktx2", "octahedral.f32", FORMATS.rgba32f);
  console.log(`${files} files with ${images} images; ${checks} checks, ${failed} failed`);
} finally {
  rmSync(scratch, { recursive: true, force: true });
}
process.exit(failed ? 1 : 0);
