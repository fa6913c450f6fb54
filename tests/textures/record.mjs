// Asks other programs' readers what is in the files that texture_samples wrote, and compares with what went in.
//
//   node record.mjs --modules DIR --check SAMPLES     DIR holds node_modules (npm ci)
//
// Readers: ktx-parse and three.js's KTX2Loader, EXRLoader, HDRLoader; Filament's Ktx1Bundle; Babylon.js's DDSTools and its .env parser. (three's
// DDSLoader knows no float formats but BC6H.) formats.mjs unpacks texels; written here is Babylon.js's
// fromRGBD, which it has for the GPU alone.
import { existsSync, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { inflateSync } from "node:zlib";

import { FORMATS, fromHalf, rgbOf } from "./formats.mjs";

const flags = process.argv.slice(2);
const flag = (name) => (flags.includes(name) ? flags[flags.indexOf(name) + 1] : undefined);
const modules = flag("--modules");
const samples = flag("--check");
if (!modules || !samples) {
  console.error("usage: node record.mjs --modules DIR --check SAMPLES");
  process.exit(2);
}
const load = (file) => import(pathToFileURL(`${resolve(modules)}/node_modules/${file}`).href);
const bytesOf = (file) => new Uint8Array(readFileSync(`${samples}/${file}`)); // at the start of a buffer of its own
const floatsOf = (file) => new Float32Array(bytesOf(file).buffer);

const three = await load("three/build/three.module.js");
const ktx = await load("ktx-parse/dist/ktx-parse.modern.js");

const SIZE = 8;
const chain = floatsOf("chain.f32");
const levels = [];
for (let size = SIZE, at = 0; size >= 1; size /= 2) {
  levels.push({ size, rgb: chain.subarray(at, (at += 18 * size * size)) });
}

let checks = 0;
let failed = 0;
function check(right, what) {
  ++checks;
  if (right) return;
  ++failed;
  console.error(`NOT AS IT WAS WRITTEN: ${what}`);
}
/** Whether every value is within `relative` (or `relative(largest)`) of the texel's largest channel. */
function same(found, wanted, relative, what) {
  let worst = found.length === wanted.length ? 0 : Infinity;
  for (let i = 0; i < wanted.length; i += 3) {
    const largest = Math.max(wanted[i], wanted[i + 1], wanted[i + 2]);
    const allowed = largest * (typeof relative === "function" ? relative(largest) : relative);
    for (let c = i; c < i + 3; ++c) worst = Math.max(worst, Math.abs(found[c] - wanted[c]) - allowed);
  }
  check(worst <= 0 && !found.some(Number.isNaN), `${what}: ${found.length} values, up to ${worst} more off than allowed`);
}
// --- KTX2
const { KTX2Loader } = await load("three/examples/jsm/loaders/KTX2Loader.js");
const loader = new KTX2Loader();
loader.workerConfig = {}; // what detectSupport finds out, for transcoding alone
for (const [name, format] of Object.entries(FORMATS)) {
  for (const packing of ["", "_zlib", "_zstd"]) {
    const file = `${name}${packing}.ktx2`;
    const container = ktx.read(bytesOf(file));
    check(container.vkFormat === format.number, `${file}: VkFormat ${container.vkFormat}`);
    check(container.faceCount === 6 && container.pixelWidth === SIZE && container.levels.length === levels.length, `${file}: shape`);
    const roughness = new TextDecoder().decode(container.keyValue.roughness); // bytes, but for KTX's own keys
    check(container.keyValue.KTXorientation === "rd" && roughness === "0 0.25 1\0", `${file}: key/value data`);
    const descriptor = container.dataFormatDescriptor[0];
    check(descriptor.colorModel === 1 && descriptor.colorPrimaries === 1 && descriptor.transferFunction === 1, `${file}: colours`);
    check(descriptor.bytesPlane[0] === format.bytes, `${file}: ${descriptor.bytesPlane[0]} bytes per texel`); // packed or not
    const bits = descriptor.samples.filter((sample) => !(sample.channelType & 0x20)).reduce((sum, sample) => sum + sample.bitLength + 1, 0);
    check(bits === { rgba16f: 64, rgba32f: 128, b10g11r11: 32, e5b9g9r9: 27 }[name], `${file}: ${bits} bits`);
    if (packing === "_zlib") { // three.js has no zlib for it
      container.levels.forEach((level, i) => {
        const raw = new Uint8Array(inflateSync(level.levelData));
        check(raw.length === level.uncompressedByteLength, `${file}: level ${i} unpacks`);
        same(format.rgb(new format.array(raw.buffer)), levels[i].rgb, format.tolerance, `${file} level ${i}`);
      });
      continue;
    }
    const texture = await new Promise((done, no) => loader.parse(bytesOf(file).buffer, done, no));
    check(texture.mipmaps.length === levels.length, `${file}: ${texture.mipmaps.length} levels in three.js`);
    texture.mipmaps.forEach((mip, i) => same(format.rgb(mip.data), levels[i].rgb, format.tolerance, `${file} level ${i} in three.js`));
  }
}

const flat = floatsOf("lat_long.f32"); // the same 16 x 8 texels
for (const [file, format] of [["image.ktx2", FORMATS.rgba16f], ["image_zstd.ktx2", FORMATS.rgba32f]]) {
  const texture = await new Promise((done, no) => loader.parse(bytesOf(file).buffer, done, no));
  check(texture.mipmaps.length === 1 && texture.mipmaps[0].width === 16 && texture.mipmaps[0].height === 8, `${file}: shape`);
  same(format.rgb(texture.mipmaps[0].data), flat, 0, `${file} in three.js`);
}

// --- KTX of the first version: the reader of Filament, whose only types of floats these are.
{
  const wasmBinary = readFileSync(`${resolve(modules)}/node_modules/filament/filament.wasm`);
  const filament = await (await load("filament/filament.js")).default({ wasmBinary });
  const inFilament = (bytes) => {
    const buffer = new filament.driver$BufferDescriptor(bytes.length);
    buffer.getBytes().set(bytes);
    return new filament.Ktx1Bundle(buffer);
  };
  const pixels = filament.PixelDataType;
  const types = { rgba16f: pixels.HALF, rgba32f: pixels.FLOAT, b10g11r11: pixels.UINT_10F_11F_11F_REV };
  for (const [name, type] of Object.entries(types)) {
    const file = `${name}.ktx`;
    const bundle = inFilament(bytesOf(file));
    check(bundle.isCubemap() && !bundle.isCompressed() && bundle.getNumMipLevels() === levels.length, `${file}: shape`);
    check(bundle.getPixelDataType() === type, `${file}: type of the texels`);
    check(bundle.getMetadata("sh") === "1 2 3\n", `${file}: harmonics`);
    levels.forEach(({ rgb }, i) => {
      const bytes = bundle._getCubeBlob(i).getBytes().slice();
      const { array, rgb: decode, tolerance } = FORMATS[name];
      same(decode(new array(bytes.buffer)), rgb, tolerance, `${file} level ${i} in Filament`);
    });
  }
  const blocks = inFilament(bytesOf("bc6h.ktx"));
  check(blocks.isCompressed() && blocks.isCubemap(), "bc6h.ktx: blocks");
  const wanted = ktx.read(bytesOf("bc6h.ktx2")).levels;
  wanted.forEach(({ levelData }, i) => {
    const bytes = blocks._getCubeBlob(i).getBytes();
    check(Buffer.compare(Buffer.from(bytes), Buffer.from(levelData)) === 0, `bc6h.ktx: level ${i} in Filament`);
  });
}

// --- DDS
// Blocks of BC6H: three.js's DDSLoader and ktx-parse find the same bytes for each face of each level.
{
  const { DDSLoader } = await load("three/examples/jsm/loaders/DDSLoader.js");
  const dds = new DDSLoader().parse(bytesOf("bc6h.dds").buffer, true);
  check(dds.format === three.RGB_BPTC_UNSIGNED_Format && dds.isCubemap, "bc6h.dds: format");
  check(dds.width === SIZE && dds.mipmapCount === levels.length, "bc6h.dds: shape");
  const container = ktx.read(bytesOf("bc6h.ktx2"));
  check(container.vkFormat === 143 && container.faceCount === 6, "bc6h.ktx2: format"); // BC6H_UFLOAT_BLOCK
  check(container.levels.length === levels.length, "bc6h.ktx2: levels");
  for (const [level, { levelData }] of container.levels.entries()) {
    const length = levelData.length / 6;
    for (let face = 0; face < 6; ++face) {
      const { data, width } = dds.mipmaps[face * levels.length + level];
      const wanted = levelData.subarray(face * length, (face + 1) * length);
      check(width === levels[level].size && Buffer.compare(data, wanted) === 0, `bc6h.dds level ${level}, face ${face}`);
    }
  }
}
// Blocks of ASTC with high dynamic range: a compressed cube in three.js, each face and level with the blocks that the file
// has there.
for (const [name, number, edge, format] of [
  ["astc4x4", 1000066000, 4, three.RGBA_ASTC_4x4_Format], ["astc6x6", 1000066004, 6, three.RGBA_ASTC_6x6_Format]]) {
  if (!existsSync(`${samples}/${name}.ktx2`)) continue; // Welkin was built without astcenc
  const container = ktx.read(bytesOf(`${name}.ktx2`));
  check(container.vkFormat === number && container.typeSize === 1 && container.faceCount === 6, `${name}: format`);
  const [descriptor] = container.dataFormatDescriptor;
  check(descriptor.colorModel === 162 && descriptor.colorPrimaries === 1 && descriptor.transferFunction === 1, `${name}: colours`);
  check([...descriptor.texelBlockDimension].join() === `${edge - 1},${edge - 1},0,0`, `${name}: block ${descriptor.texelBlockDimension}`);
  check(descriptor.bytesPlane[0] === 16 && descriptor.samples.length === 1, `${name}: bytes of a block`);
  const [{ bitOffset, bitLength, channelType }] = descriptor.samples;
  check(bitOffset === 0 && bitLength === 127 && channelType === 0xc0, `${name}: sample`); // signed float
  for (const packing of ["", "_zstd"]) {
    const texture = await new Promise((done, no) => loader.parse(bytesOf(`${name}${packing}.ktx2`).buffer, done, no));
    check(texture.isCompressedCubeTexture && texture.format === format, `${name}${packing}: a compressed cube in three.js`);
    // (three.js r187 has no type for 6 x 6 and leaves it to the format.)
    check(texture.type === (edge === 4 ? three.HalfFloatType : texture.type), `${name}${packing}: type in three.js`);
    check(texture.colorSpace === three.LinearSRGBColorSpace, `${name}${packing}: linear in three.js`);
    check(texture.image.length === 6, `${name}${packing}: ${texture.image.length} faces in three.js`);
    texture.image.forEach(({ mipmaps, width }, face) => {
      check(width === SIZE && mipmaps.length === levels.length, `${name}${packing}: levels in three.js`);
      mipmaps.forEach(({ data }, level) => {
        const length = 16 * Math.ceil(levels[level].size / edge) ** 2;
        const wanted = container.levels[level].levelData.subarray(face * length, (face + 1) * length);
        const found = new Uint8Array(data.buffer, data.byteOffset, data.byteLength); // of 4 x 4 it makes 16-bit words
        check(Buffer.compare(found, wanted) === 0, `${name}${packing} level ${level}, face ${face} in three.js`);
      });
    });
  }
}

// UASTC HDR: Basis Universal's transcoder, which three.js's KTX2Loader asks where a GPU has no ASTC, accepts every block for
// BC6H; the halves that it makes are those that astcenc does, which our reader asks.
if (existsSync(`${samples}/uastc_hdr.f32`)) {
  const decoded = floatsOf("uastc_hdr.f32");
  const home = `${resolve(modules)}/node_modules/three/examples/jsm/libs/basis/basis_transcoder`;
  const BASIS = new Function("require", "__filename", "__dirname", `${readFileSync(`${home}.js`, "utf8")}; return BASIS;`)(
    createRequire(import.meta.url), `${home}.js`, resolve(home, ".."));
  const basis = await BASIS({ wasmBinary: readFileSync(`${home}.wasm`) });
  basis.initializeBasis();
  const BC6H = 22, RGBA_HALF = 25; // basist::transcoder_texture_format
  for (const name of ["uastc_hdr.ktx2", "uastc_hdr_zstd.ktx2"]) {
    const file = new basis.KTX2File(bytesOf(name));
    check(file.isValid() && file.isHDR() && file.getFaces() === 6 && file.getLevels() === levels.length, `${name} in Basis Universal`);
    file.startTranscoding();
    let at = 0;
    for (const [level, { size }] of levels.entries()) {
      for (let face = 0; face < 6; ++face) {
        const made = (format) => {
          const bytes = new Uint8Array(file.getImageTranscodedSizeInBytes(level, 0, face, format));
          check(file.transcodeImage(bytes, level, 0, face, format, 0, -1, -1), `${name} level ${level}, face ${face}: format ${format}`);
          return bytes;
        };
        check(made(BC6H).length === 16 * Math.ceil(size / 4) ** 2, `${name} level ${level}: blocks of BC6H`);
        const halves = new Uint16Array(made(RGBA_HALF).buffer);
        same(rgbOf(halves, fromHalf), decoded.subarray(at, (at += 3 * size * size)), 2 ** -9, `${name} level ${level}, face ${face}`);
      }
    }
    file.close();
    file.delete();
  }
  const [{ colorModel, samples: [sample] }] = ktx.read(bytesOf("uastc_hdr.ktx2")).dataFormatDescriptor;
  check(colorModel === 167 && sample.channelType === 0x80, "uastc_hdr.ktx2: descriptor"); // as Basis Universal 2.5 has it
}

const { DDSTools } = await load("@babylonjs/core/Misc/dds.pure.js");
for (const name of ["rgba16f", "rgba32f"]) {
  const data = bytesOf(`${name}.dds`);
  const info = DDSTools.GetDDSInfo(data);
  check(info.isCube && info.mipmapCount === levels.length && info.width === SIZE, `${name}.dds: shape`);
  const uploads = [];
  const engine = {
    getCaps: () => ({ textureFloat: true, textureHalfFloat: true, textureFloatLinearFiltering: true, textureHalfFloatLinearFiltering: true }),
    _getRGBABufferInternalSizedFormat: () => 0,
    _uploadDataToTextureDirectly: (texture, values, face, level) => uploads.push({ values: values.slice(), face, level }),
  };
  DDSTools.UploadDDSLevels(engine, {}, data, info, true, 6);
  check(uploads.length === 6 * levels.length, `${name}.dds: ${uploads.length} faces`);
  for (const { values, face, level } of uploads) {
    const length = levels[level].rgb.length / 6;
    const found = rgbOf(values, name === "rgba16f" ? fromHalf : undefined);
    same(found, levels[level].rgb.subarray(face * length, (face + 1) * length), 0, `${name}.dds level ${level}, face ${face}`);
  }
}

{
  const data = bytesOf("image.dds");
  const info = DDSTools.GetDDSInfo(data);
  check(!info.isCube && info.width === 16 && info.height === 8 && info.mipmapCount === 1, "image.dds: shape");
  const halves = new Uint16Array(data.buffer, 148);
  same(rgbOf(halves, fromHalf), flat, 0, "image.dds");
}

// --- OpenEXR and Radiance
const { EXRLoader } = await load("three/examples/jsm/loaders/EXRLoader.js");
const { HDRLoader } = await load("three/examples/jsm/loaders/HDRLoader.js");
/** Returns rows from the top. */
function imageOf(parsed) {
  const rgb = rgbOf(parsed.data);
  const row = 3 * parsed.width;
  const turned = [];
  for (let y = parsed.height - 1; y >= 0; --y) turned.push(...rgb.slice(y * row, (y + 1) * row));
  return turned;
}
/** Our faces in OpenEXR's frames: columns mirrored, but rows on +Y and -Y. */
function openExrFaces({ size, rgb }) {
  const faces = [];
  for (let face = 0; face < 6; ++face) for (let y = 0; y < size; ++y) for (let x = 0; x < size; ++x) {
    const vertical = face === 2 || face === 3;
    const at = ((face * size + (vertical ? size - 1 - y : y)) * size + (vertical ? x : size - 1 - x)) * 3;
    faces.push(rgb[at], rgb[at + 1], rgb[at + 2]);
  }
  return faces;
}
const exr = (file) => {
  const reader = new EXRLoader();
  reader.setDataType(three.FloatType);
  return reader.parse(bytesOf(file).buffer);
};
for (const file of ["half.exr", "float.exr"]) {
  const parsed = exr(file);
  check(parsed.width === SIZE && parsed.height === 6 * SIZE, `${file}: ${parsed.width} x ${parsed.height}`);
  same(imageOf(parsed), openExrFaces(levels[0]), 0, `${file} in three.js`);
}
const latLong = floatsOf("lat_long.f32");
same(imageOf(exr("lat_long.exr")), latLong, 0, "lat_long.exr in three.js");
const radiance = new HDRLoader();
radiance.setDataType(three.FloatType);
same(rgbOf(radiance.parse(bytesOf("lat_long.hdr").buffer).data), latLong, 1 / 128, "lat_long.hdr in three.js");

// --- .env
const env = await load("@babylonjs/core/Misc/environmentTextureTools.pure.js");
const { PNG } = (await load("pngjs/lib/png.js")).default;
const data = bytesOf("sky.env");
const info = env.GetEnvInfo(data);
check(info && info.version === 2 && info.width === SIZE && info.imageType === "image/png", "sky.env: manifest");
check(info.specular.lodGenerationScale === 0.8, "sky.env: lodGenerationScale");
const holder = {};
env.UploadEnvSpherical(holder, info);
const polynomial = holder._sphericalPolynomial;
const WANTED = { x: [1, 2, 3], y: [-0.1, 0.2, 0.3], z: [0, 0, 1e-9], xx: [4, 5, 6], yy: [1 / 3, 0.25, 1e10], zz: [7, 8, 9], yz: [0.5, 1, -2], zx: [0.125, 0.0625, 3], xy: [11, 12, 13] };
for (const [term, rgb] of Object.entries(WANTED)) {
  check(JSON.stringify(polynomial[term].asArray()) === JSON.stringify(rgb), `sky.env: polynomial ${term} is ${polynomial[term].asArray()}`);
}
/** fromRGBD of helperFunctions, and rows from the top. */
function decodeRGBD(chunk, size, what) {
  const png = PNG.sync.read(Buffer.from(chunk));
  check(png.width === size && png.height === size, `${what}: ${png.width} x ${png.height}`);
  const rgb = [];
  for (let y = size - 1; y >= 0; --y) for (let i = y * size; i < (y + 1) * size; ++i) {
    for (let c = 0; c < 3; ++c) rgb.push((png.data[4 * i + c] / 255) ** 2.2 / (png.data[4 * i + 3] / 255));
  }
  return rgb;
}
// Half a byte as a share of the encoded colour, which is above 0.72 for values above 1; of the 1/2.2th power.
const RGBD_STEP = (largest) => (1.01 * 0.5 * 2.2) / 255 / Math.min(0.72, largest ** (1 / 2.2));
env.CreateRadianceImageDataArrayBufferViews(data, info).forEach((faces, level) => {
  const { size, rgb } = levels[level];
  faces.forEach((chunk, face) => {
    const what = `sky.env level ${level}, face ${face}`;
    same(decodeRGBD(chunk, size, what), rgb.subarray(face * 3 * size * size, (face + 1) * 3 * size * size), RGBD_STEP, what);
  });
});
const irradiance = env.CreateIrradianceImageDataArrayBufferViews(data, info);
check(irradiance.length === 6, "sky.env: irradiance texture");
irradiance.forEach((chunk, face) => {
  const what = `sky.env irradiance, face ${face}`;
  same(decodeRGBD(chunk, SIZE, what), levels[0].rgb.subarray(face * 192, (face + 1) * 192), RGBD_STEP, what);
});
check(JSON.stringify(info.irradiance.irradianceTexture.dominantDirection) === "[0.6,0,-0.8]", "sky.env: dominant direction");

// Probes: three.js's ObjectLoader makes a LightProbe of each, with its light and place, and the grid of the guide's lines
// has its probes there and takes the texture.
{
  const { LightProbeGridWebGL } = await load("three/examples/jsm/lighting/LightProbeGridWebGL.js");
  const jsonOf = (file) => JSON.parse(Buffer.from(bytesOf(file)).toString());
  const described = jsonOf("probes.json");
  const group = new three.ObjectLoader().parse(jsonOf("probes_three.json"));
  const { name, offset, bytes } = described.arrays.entries[0];
  const light = new Float64Array(bytesOf("probes.bin").buffer, offset, bytes / 8);
  check(name === "coefficients" && group.children.length === 6, "probes_three.json: six probes");
  const { counts, centre, size, texture } = group.userData;
  const grid = new LightProbeGridWebGL(...size, ...counts);
  grid.position.set(...centre);
  grid.updateBoundingBox();
  group.children.forEach((probe, k) => {
    check(probe.isLightProbe && probe.intensity === 1, `probes_three.json: ${probe.type}`);
    check(probe.sh.toArray().every((value, i) => value === light[27 * k + i]), `probes_three.json: light of ${k}`);
    const at = new three.Vector3().setFromMatrixPosition(probe.matrix);
    const [i, j] = [k % 3, Math.floor(k / 3)];
    check(at.distanceTo(grid.getProbePosition(i, j, 0, new three.Vector3())) < 1e-12, `probes_three.json: place of ${k}`);
    check(at.distanceTo(new three.Vector3(-1 + 0.75 * i, 0.5 + 1.5 * j, 2)) < 1e-12, `probes_three.json: grid of ${k}`);
  });
  const file = ktx.read(bytesOf(texture));
  const data = new Uint16Array(file.levels[0].levelData.slice().buffer);
  grid.texture = new three.Data3DTexture(data, file.pixelWidth, file.pixelHeight, file.pixelDepth);
  check(file.pixelWidth === 3 && file.pixelHeight === 2 && file.pixelDepth === 7 * 3, `${texture}: size`);
  const half = three.DataUtils.fromHalfFloat; // of the second volume's only slice: the fifth number of probe 4
  check(Math.abs(half(data[4 * (4 + 6 * (3 + 1))]) - light[27 * 4 + 4]) < 1e-3 * Math.abs(light[27 * 4 + 4]), `${texture}: texel`);
}

console.log(`${checks - failed} of ${checks} checks hold`);
process.exit(failed === 0 ? 0 : 1);
