// The code of a user of our files in PlayCanvas: loads an atlas, and lights spheres with it. Bundled by client.mjs, which
// drives it through `window.client`.
import * as pc from "playcanvas";
import { read } from "ktx-parse";
import { SPHERES, HALF, centre, figure } from "./spheres.js";

const loaded = (asset) =>
  new Promise((done, failed) => {
    asset.ready(() => done(asset.resource));
    asset.on("error", (message) => failed(new Error(message)));
    app.assets.add(asset);
    app.assets.load(asset);
  });

/** Our atlas: the lines of the README that `--for playcanvas` writes. */
async function atlas(url) {
  const folder = url.slice(0, url.lastIndexOf("/") + 1);
  const { name, type, file, data } = await (await fetch(url)).json();
  return loaded(new pc.Asset(name, type, { ...file, url: folder + file.url }, data));
}

/** The image, prefiltered by PlayCanvas itself as its documentation says, into an atlas of `size` texels. */
async function panorama(url, size) {
  const image = await loaded(new pc.Asset(url, "texture", { url }, { mipmaps: false, projection: "equirect" }));
  const source = pc.EnvLighting.generateLightingSource(image);
  const made = pc.EnvLighting.generateAtlas(source, { size });
  source.destroy();
  return made;
}

/** A cubemap of floats in the world's axes, for the reference: mip 0 of a chain. */
async function texels(url) {
  const { pixelWidth: size, levels, vkFormat } = read(new Uint8Array(await (await fetch(url)).arrayBuffer()));
  if (vkFormat !== 109) throw new Error(`${url} has Vulkan's format ${vkFormat}, not R32G32B32A32_SFLOAT`);
  const values = new Float32Array(levels[0].levelData.slice().buffer);
  const faces = [0, 1, 2, 3, 4, 5].map((face) => values.slice(4 * size * size * face, 4 * size * size * (face + 1)));
  return new pc.Texture(device, {
    cubemap: true, width: size, height: size, format: pc.PIXELFORMAT_RGBA32F, mipmaps: false, levels: [faces],
    minFilter: pc.FILTER_LINEAR, magFilter: pc.FILTER_LINEAR, addressU: pc.ADDRESS_CLAMP_TO_EDGE, addressV: pc.ADDRESS_CLAMP_TO_EDGE,
  });
}

/** Instead of the atlas, the shader looks up the reference's cubemaps, by directions of the world. */
const EXACT = {
  reflectionEnvPS: `
    uniform float material_reflectivity;
    uniform samplerCube exactRadiance;
    vec3 calcReflection(vec3 direction, float gloss) {
      return processEnvironment(textureLod(exactRadiance, cubeMapProject(direction), 0.0).rgb);
    }
    void addReflection(vec3 direction, float gloss) {
      dReflection += vec4(calcReflection(direction, gloss), material_reflectivity);
    }`,
  ambientPS: `
    uniform samplerCube exactIrradiance;
    void addAmbient(vec3 normal) {
      dDiffuseLight += processEnvironment(textureLod(exactIrradiance, cubeMapRotate(normal), 0.0).rgb);
    }`,
};

function material({ roughness, metallic, albedo }, exact) {
  const made = new pc.StandardMaterial();
  made.useMetalness = true;
  made.metalness = metallic;
  made.gloss = 1 - roughness;
  made.diffuse.set(albedo ** (1 / 2.2), albedo ** (1 / 2.2), albedo ** (1 / 2.2)); // which the engine raises to 2.2
  if (exact) {
    for (const [name, code] of Object.entries(EXACT)) made.getShaderChunks(pc.SHADERLANGUAGE_GLSL).set(name, code);
    made.shaderChunksVersion = pc.CHUNKAPI_2_8;
    made.setParameter("exactRadiance", exact.radiance);
    made.setParameter("exactIrradiance", exact.irradiance);
  }
  made.update();
  return made;
}

/** Orthographic; the shader takes the view from the camera's place all the same, so that this is far away. */
function view(target) {
  const camera = new pc.Entity();
  camera.addComponent("camera", {
    projection: pc.PROJECTION_ORTHOGRAPHIC, orthoHeight: HALF.y, farClip: 4000, clearColor: new pc.Color(0, 0, 0, 0),
    toneMapping: pc.TONEMAP_NONE, gammaCorrection: pc.GAMMA_NONE, renderTarget: target,
    layers: [pc.LAYERID_WORLD], // without the sky, which an atlas also draws
  });
  camera.setPosition(0, 0, 2000);
  return camera;
}

function row(exact) {
  const mesh = pc.Mesh.fromGeometry(device, new pc.SphereGeometry({ radius: 1, latitudeBands: 64, longitudeBands: 128 }));
  return SPHERES.map((look, index) => {
    const sphere = new pc.Entity();
    sphere.addComponent("render", { meshInstances: [new pc.MeshInstance(mesh, material(look, exact?.[index]))] });
    sphere.setPosition(centre(index), 0, 0);
    return sphere;
  });
}

async function truth({ urls, irradiance }) {
  const textures = new Map(await Promise.all([...new Set([...urls, irradiance])].map(async (url) => [url, await texels(url)])));
  app.scene.envAtlas = new pc.Texture(device, { width: 4, height: 4, type: pc.TEXTURETYPE_RGBP }); // so that lookups are compiled at all
  return urls.map((url) => ({ radiance: textures.get(url), irradiance: textures.get(irradiance) }));
}

const frames = (count) => new Promise((done) => {
  const step = () => { if (--count === 0) { app.off("frameend", step); done(); } };
  app.on("frameend", step);
});

/** Linear light of the row, `pixels` of them to a sphere's square: floats, red green blue alpha, row 0 below. */
async function measure(source, pixels) {
  const exact = source.kind === "truth" ? await truth(source) : undefined;
  if (!exact) app.scene.envAtlas = await (source.kind === "picture" ? panorama(source.url, 2 * source.size) : atlas(source.url));
  const size = { width: SPHERES.length * pixels, height: pixels };
  const colorBuffer = new pc.Texture(device, { ...size, format: pc.PIXELFORMAT_RGBA32F, mipmaps: false });
  const target = new pc.RenderTarget({ colorBuffer, depth: true });
  const entities = [view(target), ...row(exact)];
  entities.forEach((entity) => app.root.addChild(entity));
  await frames(3);
  const light = Array.from(await colorBuffer.read(0, 0, size.width, size.height, { renderTarget: target, immediate: true }));
  entities.forEach((entity) => entity.destroy());
  return { ...size, light };
}

const canvas = document.getElementById("canvas");
const device = await pc.createGraphicsDevice(canvas, { deviceTypes: ["webgl2"], antialias: false });
const app = new pc.AppBase(canvas);
const options = new pc.AppOptions();
options.graphicsDevice = device;
options.componentSystems = [pc.RenderComponentSystem, pc.CameraComponentSystem, pc.LightComponentSystem];
options.resourceHandlers = [pc.TextureHandler];
app.init(options);
app.start();

window.client = {
  about: () => `PlayCanvas ${pc.version}, ${device.unmaskedRenderer}`,
  measure,
  figure: async (ours, theirs, pixels, gain) =>
    figure(await measure(ours, 2 * pixels), await measure(theirs, 2 * pixels), gain),
};
