// What a user of our .env writes: load it, light some balls with it. Bundled by client.mjs, which drives it through
// `window.client`. Two rows of balls: above lit by the texture under test, below by Babylon.js's own.
import {
  ArcRotateCamera, Color3, Color4, Constants, CubeTexture, Engine, HDRCubeTexture, MeshBuilder, PBRMaterial,
  RenderTargetTexture, Scene, Vector3,
} from "@babylonjs/core";

/** Roughness of the metal balls; behind them stands a white matte one. */
const ROUGHNESS = [0, 0.15, 0.3, 0.5, 0.75, 1];
const SPACING = 2.2;

const canvas = document.getElementById("canvas");
const engine = new Engine(canvas, true, { preserveDrawingBuffer: true });

const loaded = (start) =>
  new Promise((resolve, reject) => {
    const texture = start(() => resolve(texture), (message, error) => reject(new Error(`${message}: ${error}`)));
  });

/** Our file, as any application loads an .env. */
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

function material(scene, texture, roughness) {
  const made = new PBRMaterial("material", scene);
  made.reflectionTexture = texture;
  made.albedoColor = Color3.White();
  made.metallic = roughness === null ? 0 : 1;
  made.roughness = roughness ?? 1;
  if (roughness === null) made.metallicF0Factor = 0; // light that is scattered, and none that is reflected
  made.realTimeFiltering = false;
  made.enableSpecularAntiAliasing = false;
  return made;
}

/** A row of balls at height `y`, seen from -z, where Babylon.js's camera stands as a rule. */
function row(scene, texture, y) {
  [...ROUGHNESS, null].forEach((roughness, index) => {
    const ball = MeshBuilder.CreateSphere("ball", { diameter: 2, segments: 64 }, scene);
    ball.position = new Vector3((index - ROUGHNESS.length / 2) * SPACING, y, 0);
    ball.material = material(scene, texture, roughness);
  });
}

/** Orthographic: every ball sees the same, a pixel's normal does not depend on the ball. */
function view(scene, rows) {
  const camera = new ArcRotateCamera("camera", -Math.PI / 2, Math.PI / 2, 10, Vector3.Zero(), scene);
  camera.mode = ArcRotateCamera.ORTHOGRAPHIC_CAMERA;
  const half = { x: ((ROUGHNESS.length + 1) * SPACING) / 2, y: (rows * SPACING) / 2 };
  Object.assign(camera, { orthoLeft: -half.x, orthoRight: half.x, orthoTop: half.y, orthoBottom: -half.y });
  return camera;
}

const frame = (scene) =>
  new Promise((resolve) => scene.executeWhenReady(() => { scene.render(); resolve(); }));

async function polynomial(texture) {
  for (let tries = 0; tries < 2000 && !texture.sphericalPolynomial; ++tries)
    await new Promise((resolve) => setTimeout(resolve, 5));
  const terms = texture.sphericalPolynomial;
  return Object.fromEntries(["x", "y", "z", "xx", "yy", "zz", "yz", "zx", "xy"].map((t) => [t, terms[t].asArray()]));
}

const open = (scene, source) =>
  source.url.endsWith(".hdr") ? panorama(scene, source.url, source.size) : environment(scene, source.url);

window.client = {
  about: () => ({ babylon: Engine.Version, renderer: engine.getGlInfo().renderer, version: engine.getGlInfo().version }),

  /** Linear light of one row of balls, `pixels` of them to a ball's square: floats, red green blue alpha, row 0 below. */
  async measure(source, pixels) {
    const scene = new Scene(engine);
    scene.clearColor = new Color4(0, 0, 0, 0);
    scene.imageProcessingConfiguration.applyByPostProcess = true; // which there is none of: the balls' light as it is
    const texture = await open(scene, source);
    const terms = await polynomial(texture);
    row(scene, texture, 0);
    const camera = view(scene, 1);
    const size = { width: (ROUGHNESS.length + 1) * pixels, height: pixels };
    const target = new RenderTargetTexture("target", size, scene, false, true, Constants.TEXTURETYPE_FLOAT);
    target.renderList = scene.meshes;
    target.activeCamera = camera;
    target.clearColor = scene.clearColor;
    scene.customRenderTargets.push(target);
    await frame(scene);
    await new Promise((resolve) => target.isReadyForRendering() ? resolve() : setTimeout(resolve, 200));
    scene.render();
    const light = Array.from(await target.readPixels());
    const report = { ...size, light, terms, roughness: ROUGHNESS, size: texture.getSize().width,
                     lodGenerationScale: texture.lodGenerationScale };
    scene.dispose();
    return report;
  },

  /** Both rows with tone mapping, on the canvas. */
  async show(ours, theirs) {
    const scene = new Scene(engine);
    scene.clearColor = new Color4(0.12, 0.12, 0.13, 1);
    scene.imageProcessingConfiguration.toneMappingEnabled = true;
    scene.imageProcessingConfiguration.toneMappingType = 1; // ACES
    row(scene, await open(scene, ours), SPACING / 2);
    row(scene, await open(scene, theirs), -SPACING / 2);
    view(scene, 2);
    await frame(scene);
    scene.render();
    const picture = canvas.toDataURL("image/png");
    scene.dispose();
    return picture;
  },
};
