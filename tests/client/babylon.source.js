// The code of a user of our files in Babylon.js: loads one, and lights spheres with it. Bundled by client.mjs, which drives it
// through `window.client`.
import {
  AppendSceneAsync, ArcRotateCamera, Color3, Color4, Constants, CubeTexture, Engine, HDRCubeTexture, MeshBuilder,
  PBRMaterial, RenderTargetTexture, Scene, Vector3,
} from "@babylonjs/core";
import "@babylonjs/loaders/glTF/2.0/glTFLoader.js";
import "@babylonjs/loaders/glTF/glTFFileLoader.js";
import "@babylonjs/loaders/glTF/2.0/Extensions/EXT_lights_image_based.js";
import { SPHERES, HALF, centre, figure } from "./spheres.js";

const canvas = document.getElementById("canvas");
const engine = new Engine(canvas, true, { preserveDrawingBuffer: true });

const loaded = (start) =>
  new Promise((resolve, reject) => {
    const texture = start(() => resolve(texture), (message, error) => reject(new Error(`${message}: ${error}`)));
  });

/** Our .env or .dds, as any application loads it. */
const environment = (scene, url) =>
  loaded((done) => {
    const texture = CubeTexture.CreateFromPrefilteredData(url, scene);
    if (texture.isReady()) done();
    else texture.onLoadObservable.addOnce(done);
    return texture;
  });

/** The same image, prefiltered by Babylon.js itself: with mips, harmonics, linear, prefiltered, supersampled. */
const panorama = (scene, url, size) =>
  loaded((done, failed) => new HDRCubeTexture(url, scene, size, false, true, false, true, done, failed, true));

/** Babylon.js has the centre of an image at +z, where its camera stands. */
const AHEAD = new Vector3(0, 0, 1);

/** A model of glTF: one node at (1, 0, 0), where glTF's images have their centre. */
const MODEL = { asset: { version: "2.0" }, scene: 0, scenes: [{ nodes: [0] }],
                nodes: [{ name: "ahead", translation: [1, 0, 0] }] };

/** A light in a .glb, and where the loader puts what a model has at glTF's +x. */
async function gltfLight(scene, url) {
  await AppendSceneAsync(url, scene);
  scene.environmentTexture.gammaSpace = false; // its pixels are linear, which the loader does not say
  await AppendSceneAsync(`data:${JSON.stringify(MODEL)}`, scene, { pluginExtension: ".gltf" });
  const ahead = scene.getNodeByName("ahead");
  ahead.computeWorldMatrix(true);
  return { texture: scene.environmentTexture, ahead: ahead.getAbsolutePosition().clone() };
}

async function harmonicsOf(texture) {
  for (let tries = 0; tries < 2000 && !texture.sphericalPolynomial; ++tries)
    await new Promise((resolve) => setTimeout(resolve, 5));
  if (!texture.sphericalPolynomial) throw new Error("Babylon.js made no harmonics");
}

/** A cubemap whose sharpest mip has the roughness of one sphere, and one of diffuse light in place of harmonics. */
async function exact(scene, url, irradiance) {
  const texture = await environment(scene, url);
  texture.lodGenerationScale = 0; // every roughness is looked up in mip 0
  texture.irradianceTexture = irradiance;
  return texture;
}

/** The texture of each sphere, the same for all of them unless they are the reference; and the direction of the image's centre. */
async function open(scene, source) {
  if (source.kind === "truth") {
    const irradiance = await environment(scene, source.irradiance);
    return { textures: await Promise.all(source.urls.map((url) => exact(scene, url, irradiance))), ahead: AHEAD };
  }
  if (source.kind === "gltf") {
    const { texture, ahead } = await gltfLight(scene, source.url);
    return { textures: SPHERES.map(() => texture), ahead };
  }
  const texture = await (source.kind === "picture" ? panorama(scene, source.url, source.size)
                                                   : environment(scene, source.url));
  await harmonicsOf(texture);
  return { textures: SPHERES.map(() => texture), ahead: AHEAD };
}

function material(scene, texture, { roughness, metallic, albedo, matte }) {
  const made = new PBRMaterial("material", scene);
  made.reflectionTexture = texture;
  made.albedoColor = new Color3(albedo, albedo, albedo);
  made.metallic = metallic;
  made.roughness = roughness;
  if (matte) made.metallicF0Factor = 0; // light that is scattered, and none that is reflected
  made.realTimeFiltering = false;
  made.enableSpecularAntiAliasing = false;
  return made;
}

/** The spheres in a row, sphere 0 on the viewer's left. */
function row(scene, { textures, ahead }) {
  SPHERES.forEach((look, index) => {
    const sphere = MeshBuilder.CreateSphere("sphere", { diameter: 2, segments: 64 }, scene);
    // Left-handed: seen from +z, +x is on the left.
    sphere.position = new Vector3(-ahead.z, 0, ahead.x).scale(centre(index));
    sphere.material = material(scene, textures[index], look);
  });
}

/**
 * Orthographic, so that a pixel's normal does not depend on the sphere. The shader takes the view from the camera's place
 * all the same, so that this is far away. From the image's centre, because our sunny image's sun is reflected there.
 */
function view(scene, { ahead }) {
  const camera = new ArcRotateCamera("camera", Math.atan2(ahead.z, ahead.x), Math.PI / 2, 2000, Vector3.Zero(), scene);
  camera.mode = ArcRotateCamera.ORTHOGRAPHIC_CAMERA;
  Object.assign(camera, { orthoLeft: -HALF.x, orthoRight: HALF.x, orthoTop: HALF.y, orthoBottom: -HALF.y });
  return camera;
}

const frame = (scene) =>
  new Promise((resolve) => scene.executeWhenReady(() => { scene.render(); resolve(); }));

/** Linear light of the row, `pixels` of them to a sphere's square: floats, red green blue alpha, row 0 below. */
async function measure(source, pixels) {
  const scene = new Scene(engine);
  scene.clearColor = new Color4(0, 0, 0, 0);
  scene.imageProcessingConfiguration.applyByPostProcess = true; // which there is none of: the spheres' light as it is
  const light = await open(scene, source);
  row(scene, light);
  const size = { width: SPHERES.length * pixels, height: pixels };
  const target = new RenderTargetTexture("target", size, scene, false, true, Constants.TEXTURETYPE_FLOAT);
  target.renderList = scene.meshes;
  target.activeCamera = view(scene, light);
  target.clearColor = scene.clearColor;
  scene.customRenderTargets.push(target);
  await frame(scene);
  await new Promise((resolve) => target.isReadyForRendering() ? resolve() : setTimeout(resolve, 200));
  scene.render();
  const pixelsOfRow = Array.from(await target.readPixels());
  scene.dispose();
  return { ...size, light: pixelsOfRow };
}

window.client = {
  about: () => `Babylon.js ${Engine.Version}, ${engine.getGlInfo().renderer}`,
  measure,
  figure: async (ours, theirs, pixels, gain) =>
    figure(await measure(ours, 2 * pixels), await measure(theirs, 2 * pixels), gain),
};
