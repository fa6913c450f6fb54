// node gpu_peers.mjs CONFIGURATION.json
// {"modules": folder that holds node_modules, "browser": Chromium's program, "image": a Radiance .hdr, "size": texels along
// an edge, "folder": where chains go}. three.js and Babylon.js prefilter the image in a page, by WebGL. Writes each mip's six
// faces, RGB floats as the engine's texture has them, mip after mip, to FOLDER/ENGINE.f32 and prints [{engine, version, size,
// mips}]. What is not installed or fails is left out.
import { spawn } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import { join, normalize } from "node:path";

const wanted = JSON.parse(readFileSync(process.argv[2], "utf8"));
const DEADLINE = 240_000; // milliseconds: long, because the CPU draws what takes a GPU milliseconds

const page = `<!doctype html><meta charset="utf-8">
<script type="importmap">{"imports": {"three": "/node_modules/three/build/three.module.js",
  "three/addons/": "/node_modules/three/examples/jsm/", "@babylonjs/core/": "/node_modules/@babylonjs/core/"}}</script>
<canvas id="canvas" width="64" height="64"></canvas>
<script type="module">
const post = (path, body) => fetch(path, { method: "POST", body });
const rgb = (rgba) => {
  const values = new Float32Array((rgba.length / 4) * 3);
  for (let from = 0, to = 0; from < rgba.length; from += 4) for (let c = 0; c < 3; ++c) values[to++] = rgba[from + c];
  return values;
};

async function three() {
  const THREE = await import("three");
  const { HDRLoader } = await import("three/addons/loaders/HDRLoader.js");
  const renderer = new THREE.WebGLRenderer();
  const texture = await new HDRLoader().setDataType(THREE.FloatType).loadAsync("/image.hdr");
  texture.mapping = THREE.EquirectangularReflectionMapping;
  const target = new THREE.PMREMGenerator(renderer).fromEquirectangular(texture);
  const gl = renderer.getContext();
  const handle = renderer.properties.get(target.texture).__webglTexture;
  const mips = target.texture.mipmaps.length;
  const faces = [];
  gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
  for (let mip = 0; mip < mips; ++mip)
    for (let face = 0; face < 6; ++face) {
      const size = target.width >> mip;
      const values = new Float32Array(4 * size * size);
      gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_CUBE_MAP_POSITIVE_X + face, handle, mip);
      gl.readPixels(0, 0, size, size, gl.RGBA, gl.FLOAT, values);
      faces.push(rgb(values));
    }
  return { version: "three.js r" + THREE.REVISION, size: target.width, mips, faces };
}

async function babylon() {
  const { Engine } = await import("@babylonjs/core/Engines/engine.js");
  const { Scene } = await import("@babylonjs/core/scene.js");
  const { HDRCubeTexture } = await import("@babylonjs/core/Materials/Textures/hdrCubeTexture.js");
  for (const name of ["rawTexture", "readTexture", "renderTargetCube", "cubeTexture"])
    await import("@babylonjs/core/Engines/Extensions/engine." + name + ".js");
  await import("@babylonjs/core/Materials/Textures/baseTexture.polynomial.js");
  const engine = new Engine(document.getElementById("canvas"), false);
  const scene = new Scene(engine);
  // With mips, harmonics, linear, prefiltered, supersampled: as its own documentation loads an image.
  const texture = await new Promise((done, failed) => {
    const made = new HDRCubeTexture("/image.hdr", scene, SIZE, false, true, false, true, () => done(made),
                                    (message) => failed(new Error(message)), true);
  });
  const size = texture.getSize().width;
  const faces = [];
  const mips = Math.log2(size) + 1;
  for (let mip = 0; mip < mips; ++mip)
    for (let face = 0; face < 6; ++face) faces.push(rgb(Float32Array.from(await texture.readPixels(face, mip))));
  return { version: "Babylon.js " + Engine.Version, size, mips, faces };
}

const found = [];
for (const [name, make] of Object.entries({ three, babylon })) {
  try {
    const { faces, ...about } = await make();
    await post("/" + name + ".f32", new Blob(faces));
    found.push({ engine: name, ...about });
  } catch (trouble) {
    await post("/trouble", name + ": " + (trouble.stack ?? trouble));
  }
}
await post("/end", JSON.stringify(found));
</script>`.replace("SIZE", wanted.size);

const profile = mkdtempSync(join(tmpdir(), "welkin-browser-"));
let browser;
function end(code) {
  browser?.kill("SIGKILL");
  server.close();
  server.closeAllConnections();
  setTimeout(() => { rmSync(profile, { recursive: true, force: true }); process.exit(code); }, 300);
}

async function received(request) {
  const parts = [];
  for await (const part of request) parts.push(part);
  return Buffer.concat(parts);
}

const server = createServer(async (request, response) => {
  const name = normalize(decodeURIComponent(new URL(request.url, "http://x").pathname));
  if (request.method === "POST") {
    const body = await received(request);
    response.end();
    if (name === "/end") { console.log(body.toString()); return end(0); }
    if (name === "/trouble") return console.error(body.toString());
    return writeFileSync(join(wanted.folder, name), body);
  }
  const path = name === "/image.hdr" ? wanted.image : join(wanted.modules, name);
  if (name === "/") { response.setHeader("content-type", "text/html"); return response.end(page); }
  if (!existsSync(path)) { console.error("missing " + name); return response.writeHead(404).end(); }
  response.setHeader("content-type", name.endsWith(".js") ? "text/javascript" : "application/octet-stream");
  response.end(readFileSync(path));
}).listen(0, "127.0.0.1", () => {
  const url = `http://127.0.0.1:${server.address().port}/`;
  // SwiftShader draws on the CPU, so that no GPU is needed and every machine gives the same.
  browser = spawn(wanted.browser, ["--headless", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--disable-background-networking", `--user-data-dir=${profile}`,
    "--remote-debugging-port=0", url], { stdio: "ignore" });
  browser.on("error", () => end(1));
  browser.on("exit", () => end(1));
});
setTimeout(() => end(1), DEADLINE).unref();
