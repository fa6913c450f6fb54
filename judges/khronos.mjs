// Asks Khronos' own reader, libktx as WebAssembly in npm's @khronosgroup/gltf-viewer, what is in our .ktx2 and .ktx files,
// and WebGL for their texels. (tests/textures/khronos.mjs compares the bytes that libktx uploads, without a browser, in CI.)
//
//   node khronos.mjs MODULES SAMPLES           SAMPLES is the folder that texture_samples wrote
//
// libktx checks the file, unpacks it and uploads it to WebGL 2; a shader then reads each texel of each face and level, which
// must be the texels that went in. Prints a table in Markdown.
import { readFileSync, readdirSync } from "node:fs";
import { join, resolve } from "node:path";

import { pageOf, show } from "./browser.mjs";

const [modules, samples] = process.argv.slice(2).map((each) => resolve(each));
const files = readdirSync(samples).filter((name) => /\.ktx2?$/.test(name) && !/^(octahedral|probes)/.test(name)).sort();

const page = pageOf(`
const files = ${JSON.stringify(files)};
const canvas = document.createElement("canvas");
const gl = canvas.getContext("webgl2");
const extensions = ["EXT_color_buffer_float", "OES_texture_float_linear", "EXT_texture_compression_bptc", "WEBGL_compressed_texture_astc"];
const has = Object.fromEntries(extensions.map((name) => [name, gl.getExtension(name) !== null]));
has["ASTC's HDR profile"] = gl.getExtension("WEBGL_compressed_texture_astc")?.getSupportedProfiles().includes("hdr") ?? false;
const ktx = await LIBKTX({ preinitializedWebGLContext: gl, locateFile: () => "/viewer/libs/libktx.wasm" });
ktx.GL.makeContextCurrent(ktx.GL.createContext(null, { majorVersion: 2.0 }));

const compile = (cube) => {
  const program = gl.createProgram();
  const shader = (kind, text) => {
    const made = gl.createShader(kind);
    gl.shaderSource(made, "#version 300 es\\n" + text);
    gl.compileShader(made);
    if (!gl.getShaderParameter(made, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(made));
    gl.attachShader(program, made);
  };
  shader(gl.VERTEX_SHADER, "void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0, 1); }");
  shader(gl.FRAGMENT_SHADER, "precision highp float; precision highp sampler2D; precision highp samplerCube;\\n" +
    "uniform sampler" + (cube ? "Cube" : "2D") + " picture; uniform int level; uniform int face; uniform vec2 size; out vec4 colour;\\n" +
    "void main() {\\n" + (cube ? "vec2 p = 2.0 * gl_FragCoord.xy / size - 1.0;\\n" +
    "vec3 d = face == 0 ? vec3(1, -p.y, -p.x) : face == 1 ? vec3(-1, -p.y, p.x) : face == 2 ? vec3(p.x, 1, p.y) :\\n" +
    "face == 3 ? vec3(p.x, -1, -p.y) : face == 4 ? vec3(p.x, -p.y, 1) : vec3(-p.x, -p.y, -1);\\n" +
    "colour = textureLod(picture, d, float(level)); }" : "colour = texelFetch(picture, ivec2(gl_FragCoord.xy), level); }"));
  gl.linkProgram(program);
  return program;
};
const programs = { cube: compile(true), flat: compile(false) };
const found = [];
for (const name of files) {
  const data = new Uint8Array(await (await fetch("/samples/" + name)).arrayBuffer());
  let texture, uploaded;
  try {
    texture = new ktx.ktxTexture(data);
    uploaded = texture.glUpload();
  } catch (trouble) {
    found.push({ name, trouble: String(trouble.message ?? trouble) });
    continue;
  }
  const about = { name, width: texture.baseWidth, height: texture.baseHeight, error: uploaded.error?.constructor?.name + " " + uploaded.error?.value };
  try { about.vkFormat = texture.vkFormat; about.scheme = texture.supercompressScheme?.value; about.orientation = texture.orientation; } catch { }
  if (!uploaded.texture) { found.push({ ...about, trouble: "reads it; glUpload: GL error 0x" + (uploaded.error?.value ?? uploaded.error ?? 0).toString(16) }); continue; }
  const cube = uploaded.target === gl.TEXTURE_CUBE_MAP;
  gl.bindTexture(uploaded.target, uploaded.texture);
  for (const which of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
    gl.texParameteri(uploaded.target, which, which === gl.TEXTURE_MIN_FILTER ? gl.NEAREST_MIPMAP_NEAREST : gl.NEAREST);
  const program = cube ? programs.cube : programs.flat;
  gl.useProgram(program);
  const values = [];
  const target = gl.createTexture();
  const levels = cube ? Math.log2(texture.baseWidth) + 1 : 1;
  if (!cube) gl.texParameteri(uploaded.target, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
  for (let level = 0; level < levels; ++level) for (let face = 0; face < (cube ? 6 : 1); ++face) {
    const [width, height] = [texture.baseWidth >> level, texture.baseHeight >> level];
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, target);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, width, height, 0, gl.RGBA, gl.FLOAT, null);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(uploaded.target, uploaded.texture);
    const buffer = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, buffer);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, target, 0);
    gl.viewport(0, 0, width, height);
    gl.uniform1i(gl.getUniformLocation(program, "level"), level);
    gl.uniform1i(gl.getUniformLocation(program, "face"), face);
    gl.uniform2f(gl.getUniformLocation(program, "size"), width, height);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    const rgba = new Float32Array(4 * width * height);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.FLOAT, rgba);
    for (let i = 0; i < rgba.length; i += 4) values.push(rgba[i], rgba[i + 1], rgba[i + 2]);
  }
  found.push({ ...about, cube, glError: gl.getError(), values });
}
await post("/end", JSON.stringify({ has, found }));
`, '<script src="/viewer/libs/libktx.js"></script>');

const { has, found } = await show(page, { viewer: join(modules, "node_modules/@khronosgroup/gltf-viewer/dist"), samples });
const floats = (name) => { const bytes = readFileSync(join(samples, name)); return new Float32Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length)); };
const truth = { cube: floats("chain.f32"), flat: floats("lat_long.f32") };
/** How far a texel may be off, of its largest channel: what the format rounds. Blocks: as our own reader decodes them. */
const ALLOWED = { rgba16f: 0, rgba32f: 0, b10g11r11: 2 ** -6, e5b9g9r9: 2 ** -9 * 1.001, image: 0 };
let failed = 0;
const hdr = has["ASTC's HDR profile"];
console.log("| file | libktx | texels compared | largest difference, of a texel's largest channel |\n|---|---|---|---|");
for (const one of found) {
  if (one.trouble) {
    console.log(`| ${one.name} | ${one.trouble} | | |`);
    continue;
  }
  if (/^u?astc/.test(one.name) && !hdr) {
    console.log(`| ${one.name} | reads and uploads it (VkFormat ${one.vkFormat}) | none: this browser decodes ASTC's LDR profile alone | |`);
    continue;
  }
  const kind = Object.keys(ALLOWED).find((each) => one.name.startsWith(each));
  let wanted = one.cube ? truth.cube : truth.flat;
  let allowed = ALLOWED[kind];
  if (!kind) { // blocks: WebGL's decoder against ours
    if (one.name.startsWith("bc6h")) wanted = floats("bc6h.f32"), allowed = 2 ** -9;
    else wanted = floats(one.name.replace(/(_zstd)?\.ktx2$/, ".f32")), allowed = 2 ** -9;
  }
  let worst = one.values.length === wanted.length ? 0 : Infinity;
  for (let i = 0; i < wanted.length; i += 3) {
    const largest = Math.max(wanted[i], wanted[i + 1], wanted[i + 2], 2 ** -14);
    for (let c = i; c < i + 3; ++c) worst = Math.max(worst, Math.abs(one.values[c] - wanted[c]) / largest);
  }
  if (!(worst <= allowed)) ++failed;
  console.log(`| ${one.name} | reads it (VkFormat ${one.vkFormat ?? "-"}) | ${wanted.length / 3} | ${worst.toExponential(1)}${worst <= allowed ? "" : " FAILED"} |`);
}
console.log("\nThis browser's WebGL: " + Object.entries(has).map(([name, there]) => `${name} ${there ? "yes" : "no"}`).join(", "));
console.log(`${found.length} files, ${found.filter((one) => one.trouble).length} without texels, ${failed} that differ`);
process.exit(failed ? 1 : 0);
