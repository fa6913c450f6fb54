// Draws our files in Chromium by independent renderers, and reads back what the two that prefilter make of an image.
//
//   node browsers.mjs MODULES WELKIN IMAGE FOLDER [RENDERER...]
//
// MODULES holds node_modules; IMAGE is a Radiance .hdr. For each renderer FOLDER/NAME.png (what it draws), and
// FOLDER/NAME_SIZE_FACE.f32 or the like for browsers_compare.py. A renderer that fails is reported by its message.
import { execFileSync } from "node:child_process";
import { copyFileSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join, resolve } from "node:path";

import { pageOf, show } from "./browser.mjs";
import { spheresGlb } from "./spheres_glb.mjs";

const [modulesFolder, welkin, image, folder, ...only] = process.argv.slice(2);
const modules = join(resolve(modulesFolder), "node_modules");
mkdirSync(folder, { recursive: true });
for (const engine of ["gltf", "babylon", "filament"])
  execFileSync(welkin, ["bake", image, "-o", join(folder, engine), "--for", engine, "--size", "256", "--no-previews", "-q"]);
copyFileSync(image, join(folder, "picture.hdr"));
writeFileSync(join(folder, "spheres.glb"), spheresGlb([0, 0.25, 0.5, 0.75, 1]));

const png = `const asPng = async (canvas, name) => post("/" + name + ".png", await new Promise((done) => canvas.toBlob(done)));`;
const canvas = '<canvas id="canvas" width="960" height="200"></canvas>';

const mips = JSON.parse(readFileSync(join(folder, "gltf/manifest.json"), "utf8")).specular.length;
const RENDERERS = {
  // Khronos' glTF sample viewer: what its sampler makes of the image; then our lambertian.ktx2 and ggx.ktx2 in its shader.
  gltf_viewer: pageOf(`${png}
// Its sampler takes 1024 and 2048 samples for each of 256 x 256 x 6 texels: minutes without a GPU. Here 64, and faces of 64.
const source = (await (await fetch("/viewer/gltf-viewer.module.js")).text()).replace("this.textureSize = 256", "this.textureSize = 64")
  .replace("this.ggxSampleCount = 1024", "this.ggxSampleCount = 64").replace("this.lambertianSampleCount = 2048", "this.lambertianSampleCount = 64")
  .replace("this.lutResolution = 1024", "this.lutResolution = 64");
const { GltfView } = await import(URL.createObjectURL(new Blob([source], { type: "text/javascript" })));
const canvas = document.getElementById("canvas");
const gl = canvas.getContext("webgl2", { alpha: false, antialias: false, preserveDrawingBuffer: true });
gl.getExtension("EXT_color_buffer_float");
const view = new GltfView(gl);
const state = view.createState();
const loader = view.createResourceLoader(undefined, undefined, "/viewer/libs/");
state.environment = await loader.loadEnvironment("/files/picture.hdr");
state.gltf = await loader.loadGltf("/files/spheres.glb");
const scene = state.gltf.scenes[0];
state.sceneIndex = 0;
scene.applyTransformHierarchy(state.gltf);
state.renderingParameters.renderEnvironmentMap = false;
state.renderingParameters.environmentRotation = 90; // its default
state.userCamera.perspective.aspectRatio = canvas.width / canvas.height;
state.userCamera.fitViewToScene?.(state.gltf, 0);
state.userCamera.resetView?.(state.gltf, 0);
const cropped = async (name) => { // the spheres fill a fifth of the width
  const [width, height] = [Math.round(canvas.width / 5), Math.round(canvas.width / 25)];
  const copy = document.createElement("canvas");
  copy.width = width; copy.height = height;
  copy.getContext("2d").drawImage(canvas, (canvas.width - width) / 2, (canvas.height - height) / 2, width, height, 0, 0, width, height);
  await asPng(copy, name);
};
const drawn = async (name) => { for (let i = 0; i < 3; ++i) { view.renderFrame(state, canvas.width, canvas.height); await new Promise(requestAnimationFrame); } await cropped(name); };
await drawn("gltf_viewer_its_own");
// Its textures, as floats.
const images = state.environment.images;
const read = async (texture, name, size, levels) => {
  gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
  for (let level = 0; level < levels; ++level) {
    const all = new Float32Array(6 * 4 * (size >> level) ** 2);
    for (let face = 0; face < 6; ++face) {
      gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_CUBE_MAP_POSITIVE_X + face, texture, level);
      gl.readPixels(0, 0, size >> level, size >> level, gl.RGBA, gl.FLOAT, all.subarray(face * 4 * (size >> level) ** 2));
    }
    await post("/gltf_viewer_" + name + "_" + level + ".f32", all);
  }
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
};
const own = (name) => images.find((one) => one.name === name)?.image ?? images.find((one) => one.name === name)?.texture;
const mips = state.environment.mipCount;
await read(own("Specular"), "ggx", 64, mips);
await read(own("Diffuse"), "lambertian", 64, 1);
// Ours in place of them, through its own libktx.
const ours = {};
for (const [index, file] of [[0, "lambertian"], [1, "ggx"]]) {
  const bytes = new Uint8Array(await (await fetch("/files/gltf/" + file + ".ktx2")).arrayBuffer());
  const found = await view.ktxDecoder.loadKtxFromBuffer(bytes);
  ours[file] = Object.keys(found ?? {});
  const texture = found instanceof WebGLTexture ? found : found.texture ?? found.image ?? found;
  gl.bindTexture(gl.TEXTURE_CUBE_MAP, texture);
  gl.texParameteri(gl.TEXTURE_CUBE_MAP, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
  gl.texParameteri(gl.TEXTURE_CUBE_MAP, gl.TEXTURE_MIN_FILTER, index ? gl.LINEAR_MIPMAP_LINEAR : gl.LINEAR);
  state.environment.images[index].image = texture;
  state.environment.textures[index].glTexture = texture;
}
state.environment.mipCount = MIPS;
await drawn("gltf_viewer_ours");
await post("/end", JSON.stringify({ mips, ours, error: gl.getError() }));
`.replace("MIPS", mips), '<canvas id="canvas" width="2400" height="500"></canvas><script src="/viewer/libs/libktx.js"></script><script>var DracoDecoderModule = async () => ({})</script>'),

  // PlayCanvas: the atlas that it makes of the image (8-bit RGBP), and what it draws with it.
  playcanvas: pageOf(`${png}
const pc = await import("/playcanvas/build/playcanvas.mjs");
const canvas = document.getElementById("canvas");
const device = await pc.createGraphicsDevice(canvas, { deviceTypes: ["webgl2"], antialias: false });
const app = new pc.AppBase(canvas);
const options = new pc.AppOptions();
options.graphicsDevice = device;
options.componentSystems = [pc.RenderComponentSystem, pc.CameraComponentSystem, pc.LightComponentSystem];
options.resourceHandlers = [pc.TextureHandler, pc.ContainerHandler];
app.init(options);
app.start();
const load = (name, type, file, more) => new Promise((done, failed) => {
  const asset = new pc.Asset(name, type, { url: "/files/" + file }, more);
  asset.on("load", () => done(asset));
  asset.on("error", failed);
  app.assets.add(asset);
  app.assets.load(asset);
});
const picture = (await load("picture", "texture", "picture.hdr", { mipmaps: false, projection: "equirect" })).resource;
const source = pc.EnvLighting.generateLightingSource(picture);
const atlas = pc.EnvLighting.generateAtlas(source);
const gl = device.gl;
gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, atlas.impl._glTexture, 0);
const bytes = new Uint8Array(4 * atlas.width * atlas.height);
gl.readPixels(0, 0, atlas.width, atlas.height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
await post("/playcanvas_atlas.u8", bytes);
app.scene.envAtlas = atlas;
app.scene.exposure = 1;
const camera = new pc.Entity();
camera.addComponent("camera", { clearColor: new pc.Color(0, 0, 0), projection: pc.PROJECTION_ORTHOGRAPHIC, orthoHeight: 1.25, toneMapping: pc.TONEMAP_NEUTRAL });
camera.setPosition(0, 0, 10);
app.root.addChild(camera);
app.root.addChild((await load("spheres", "container", "spheres.glb")).resource.instantiateRenderEntity());
await new Promise((done) => { let frames = 0; app.on("frameend", async () => { if (++frames === 3) { await asPng(canvas, "playcanvas"); done(); } }); });
await post("/end", JSON.stringify({ version: pc.version, size: atlas.width, type: atlas.type, format: atlas.format, frame: gl.getError() }));
`, canvas),

  // Filament: environment_ibl.ktx as its own reader makes a light of it, and its own shader of glTF materials.
  filament: pageOf(`${png}
await new Promise((done) => Filament.init([], done));
const canvas = document.getElementById("canvas");
const engine = Filament.Engine.create(canvas);
const bytes = async (file) => new Uint8Array(await (await fetch("/files/" + file)).arrayBuffer());
const scene = engine.createScene();
// (createIblFromKtx1 of this version leaves the harmonics out, and then matte surfaces take the roughest mip.)
const made = engine.createIblFromKtx1(await bytes("filament/environment_ibl.ktx"));
const reflections = engine.createTextureFromKtx1(await bytes("filament/environment_ibl.ktx"));
const light = Filament.IndirectLight.Builder().reflections(reflections).irradianceSh(3, new Float32Array(made.shfloats)).build(engine);
light.setIntensity(30000);
scene.setIndirectLight(light);
const loader = engine.createAssetLoader();
const asset = loader.createAsset(await bytes("spheres.glb"));
await new Promise((done) => asset.loadResources(done, null, "/files/"));
scene.addEntities(asset.getEntities());
const camera = engine.createCamera(Filament.EntityManager.get().create());
camera.setProjection(Filament.Camera$Projection.ORTHO, -6, 6, -1.25, 1.25, 0.1, 20);
camera.lookAt([0, 0, 10], [0, 0, 0], [0, 1, 0]);
const view = engine.createView();
view.setScene(scene);
view.setCamera(camera);
view.setViewport([0, 0, canvas.width, canvas.height]);
const swap = engine.createSwapChain();
const renderer = engine.createRenderer();
const copy = document.createElement("canvas");
copy.width = canvas.width; copy.height = canvas.height;
const context = copy.getContext("2d", { willReadFrequently: true });
for (let shown = 0, i = 0; shown < 5 && i < 300; ++i) { // it leaves frames out where the last is not done yet
  renderer.render(swap, view);
  engine.execute();
  context.drawImage(canvas, 0, 0);
  if (context.getImageData(80, 100, 1, 1).data[0] > 0) ++shown;
  await new Promise(requestAnimationFrame);
}
await asPng(copy, "filament");
await post("/end", JSON.stringify({ entities: asset.getEntities().length }));
`, canvas + '<script src="/filament/filament.js"></script>'),

  // Babylon Lite: environment.env, by WebGPU.
  babylon_lite: pageOf(`${png}
if (!navigator.gpu) throw new Error("navigator.gpu is undefined");
const adapter = await navigator.gpu.requestAdapter();
if (!adapter) throw new Error("requestAdapter: no adapter");
const B = await import("/lite/lib/index.js");
const canvas = document.getElementById("canvas");
const engine = await B.createEngine(canvas);
const scene = B.createSceneContext(engine);
B.addToScene(scene, await B.loadGltf(engine, "/files/spheres.glb"));
await B.loadEnvironment(scene, "/files/babylon/environment.env", { skipSkybox: true, skipGround: true, brdfUrl: "/files/brdf.png" });
const camera = B.createDefaultCamera(scene);
camera.fov *= 0.2;
camera.alpha += Math.PI;
await B.registerScene(scene);
await B.startEngine(engine);
for (let i = 0; i < 10; ++i) await new Promise(requestAnimationFrame);
// The canvas is empty once it was shown: it is read within the task that draws it.
const blob = await new Promise((done) => {
  const submit = GPUQueue.prototype.submit;
  GPUQueue.prototype.submit = function (commands) {
    submit.call(this, commands);
    GPUQueue.prototype.submit = submit;
    queueMicrotask(() => canvas.toBlob(done));
  };
});
await post("/babylon_lite.png", blob);
await post("/end", JSON.stringify({ adapter: adapter.info?.description }));
`, canvas),
};

const folders = { files: resolve(folder), viewer: join(modules, "@khronosgroup/gltf-viewer/dist"), playcanvas: join(modules, "playcanvas"),
  filament: join(modules, "filament"), lite: join(modules, "@babylonjs/lite") };
for (const [name, page] of Object.entries(RENDERERS)) {
  if (only.length && !only.includes(name)) continue;
  try {
    const found = await show(page, folders, (file, bytes) => writeFileSync(join(folder, file.replaceAll("/", "_")), bytes), 420,
      // Without Vulkan, a canvas of WebGPU ends the GPU process ("A valid external Instance reference no longer exists").
      name === "babylon_lite" ? ["--enable-features=Vulkan", "--use-vulkan=swiftshader", "--use-webgpu-adapter=swiftshader"] : []);
    console.log(`${name}: ran; ${JSON.stringify(found)}`);
  } catch (trouble) {
    console.log(`${name}: ${trouble.message.split("\n").slice(0, 3).join(" / ")}`);
  }
}
