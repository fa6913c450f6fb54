// What a user of our files writes for Babylon.js: load one, light some balls with it. Bundled by client.mjs, which drives
// it through `window.client`.
import {
  ArcRotateCamera, Color3, Color4, Constants, CubeTexture, Engine, HDRCubeTexture, MeshBuilder, PBRMaterial,
  RenderTargetTexture, Scene, Vector3,
} from "@babylonjs/core";
import { BALLS, HALF, centre, figure } from "./balls.js";

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

/** The same picture, prefiltered by Babylon.js itself: with mips, harmonics, linear, prefiltered, supersampled. */
const panorama = (scene, url, size) =>
  loaded((done, failed) => new HDRCubeTexture(url, scene, size, false, true, false, true, done, failed, true));

async function harmonicsOf(texture) {
  for (let tries = 0; tries < 2000 && !texture.sphericalPolynomial; ++tries)
    await new Promise((resolve) => setTimeout(resolve, 5));
  if (!texture.sphericalPolynomial) throw new Error("Babylon.js made no harmonics");
}

/** A cubemap whose sharpest mip has the roughness of one ball, and one of diffuse light in place of harmonics. */
async function exact(scene, url, irradiance) {
  const texture = await environment(scene, url);
  texture.lodGenerationScale = 0; // every roughness is looked up in mip 0
  texture.irradianceTexture = irradiance;
  return texture;
}

/** The texture of each ball: the same for all of them, unless they are the truth. */
async function open(scene, source) {
  if (source.kind === "truth") {
    const irradiance = await environment(scene, source.irradiance);
    return Promise.all(source.urls.map((url) => exact(scene, url, irradiance)));
  }
  const texture = await (source.kind === "picture" ? panorama(scene, source.url, source.size)
                                                   : environment(scene, source.url));
  await harmonicsOf(texture);
  return BALLS.map(() => texture);
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

/** The balls in a row, ball 0 on the viewer's left. */
function row(scene, textures) {
  BALLS.forEach((look, index) => {
    const ball = MeshBuilder.CreateSphere("ball", { diameter: 2, segments: 64 }, scene);
    ball.position = new Vector3(-centre(index), 0, 0); // seen from +z, +x is on the left
    ball.material = material(scene, textures[index], look);
  });
}

/**
 * Orthographic, so that a pixel's normal does not depend on the ball. The shader takes the view from the camera's place
 * all the same, so that this is far away. From +z, because our sunny picture's sun is reflected there.
 */
function view(scene) {
  const camera = new ArcRotateCamera("camera", Math.PI / 2, Math.PI / 2, 2000, Vector3.Zero(), scene);
  camera.mode = ArcRotateCamera.ORTHOGRAPHIC_CAMERA;
  Object.assign(camera, { orthoLeft: -HALF.x, orthoRight: HALF.x, orthoTop: HALF.y, orthoBottom: -HALF.y });
  return camera;
}

const frame = (scene) =>
  new Promise((resolve) => scene.executeWhenReady(() => { scene.render(); resolve(); }));

/** Linear light of the row, `pixels` of them to a ball's square: floats, red green blue alpha, row 0 below. */
async function measure(source, pixels) {
  const scene = new Scene(engine);
  scene.clearColor = new Color4(0, 0, 0, 0);
  scene.imageProcessingConfiguration.applyByPostProcess = true; // which there is none of: the balls' light as it is
  row(scene, await open(scene, source));
  const size = { width: BALLS.length * pixels, height: pixels };
  const target = new RenderTargetTexture("target", size, scene, false, true, Constants.TEXTURETYPE_FLOAT);
  target.renderList = scene.meshes;
  target.activeCamera = view(scene);
  target.clearColor = scene.clearColor;
  scene.customRenderTargets.push(target);
  await frame(scene);
  await new Promise((resolve) => target.isReadyForRendering() ? resolve() : setTimeout(resolve, 200));
  scene.render();
  const light = Array.from(await target.readPixels());
  scene.dispose();
  return { ...size, light };
}

window.client = {
  about: () => `Babylon.js ${Engine.Version}, ${engine.getGlInfo().renderer}`,
  measure,
  figure: async (ours, theirs, pixels, gain) =>
    figure(await measure(ours, 2 * pixels), await measure(theirs, 2 * pixels), gain),
};
