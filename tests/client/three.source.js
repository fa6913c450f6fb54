// What a user of our files writes for three.js: load one, light some balls with it. Bundled by client.mjs, which drives
// it through `window.client`.
import * as THREE from "three";
import { DDSLoader } from "three/addons/loaders/DDSLoader.js";
import { HDRLoader } from "three/addons/loaders/HDRLoader.js";
import { KTX2Loader } from "three/addons/loaders/KTX2Loader.js";
import { read } from "ktx-parse";
import { BALLS, HALF, centre, figure } from "./balls.js";

const bytesOf = async (url) => (await fetch(url)).arrayBuffer();

/** A chain in BC6H: the lines of the README that `--for three` writes. */
async function blocks(url) {
  const { width, height, mipmaps, mipmapCount: n, format } = new DDSLoader().parse(await bytesOf(url), true);
  const images = [0, 1, 2, 3, 4, 5].map((face) => ({ width, height, mipmaps: mipmaps.slice(n * face, n * (face + 1)) }));
  const texture = new THREE.CompressedCubeTexture(images, format, THREE.HalfFloatType);
  return Object.assign(texture, { minFilter: THREE.LinearMipmapLinearFilter, isPMREMTexture: true, needsUpdate: true });
}

/** A chain in halves: the lines of the README that `--for three` writes. */
async function halves(url, renderer) {
  const { image: { width, height }, mipmaps } = await new KTX2Loader().detectSupport(renderer).loadAsync(url);
  const images = [0, 1, 2, 3, 4, 5].map((face) => ({ width, height, mipmaps: mipmaps.map(({ data, width, height }) =>
    ({ width, height, data: data.subarray((data.length / 6) * face, (data.length / 6) * (face + 1)) })) }));
  const texture = new THREE.CompressedCubeTexture(images, THREE.RGBAFormat, THREE.HalfFloatType);
  return Object.assign(texture, { minFilter: THREE.LinearMipmapLinearFilter, isPMREMTexture: true, needsUpdate: true });
}

/** A chain in floats, for the truth. */
async function texels(url) {
  const { pixelWidth, levels, vkFormat } = read(new Uint8Array(await bytesOf(url)));
  if (vkFormat !== 109) throw new Error(`${url} has Vulkan's format ${vkFormat}, not R32G32B32A32_SFLOAT`);
  const images = [0, 1, 2, 3, 4, 5].map((face) => ({ width: pixelWidth, height: pixelWidth, mipmaps:
    levels.map(({ levelData }, mip) => {
      const [size, values] = [pixelWidth >> mip, new Float32Array(levelData.slice().buffer)];
      return { width: size, height: size, data: values.subarray(4 * size * size * face, 4 * size * size * (face + 1)) };
    }) }));
  const texture = new THREE.CompressedCubeTexture(images, THREE.RGBAFormat, THREE.FloatType);
  return Object.assign(texture, { minFilter: THREE.LinearMipmapLinearFilter, isPMREMTexture: true, needsUpdate: true });
}

/** The picture itself, which three.js prefilters when it first draws with it. */
async function panorama(url) {
  const texture = await new HDRLoader().loadAsync(url);
  texture.mapping = THREE.EquirectangularReflectionMapping;
  return texture;
}

const OPEN = { dds: blocks, ktx2: halves, picture: panorama };

/**
 * Takes out of the shader that a ball's roughness grows with its curvature from pixel to pixel, so that a ball has one
 * roughness. `exact`: whatever it is, it is looked up in mip 0 (the truth for one ball).
 */
function settle(material, exact) {
  material.onBeforeCompile = (shader) => {
    const change = (chunk, from, to) => {
      const text = THREE.ShaderChunk[chunk];
      if (!text.includes(from)) throw new Error(`three.js's ${chunk} is not what it was: it has no ${from}`);
      shader.fragmentShader = shader.fragmentShader.replace(`#include <${chunk}>`, text.replaceAll(from, to));
    };
    change("lights_physical_fragment", "material.roughness += geometryRoughness;", "");
    if (exact) change("envmap_physical_pars_fragment", "roughnessToMip( roughness )", "0.0");
  };
  material.customProgramCacheKey = () => `${exact}`;
  return material;
}

function row(scene, exact) {
  const shape = new THREE.SphereGeometry(1, 128, 64);
  return BALLS.map(({ roughness, metallic, albedo }, index) => {
    const color = new THREE.Color().setRGB(albedo, albedo, albedo, THREE.LinearSRGBColorSpace);
    const material = new THREE.MeshStandardMaterial({ color, roughness, metalness: metallic });
    const ball = new THREE.Mesh(shape, settle(material, exact));
    ball.position.x = centre(index);
    scene.add(ball);
    return ball;
  });
}

/** Orthographic: every ball sees the same, a pixel's normal does not depend on the ball. */
function view() {
  const camera = new THREE.OrthographicCamera(-HALF.x, HALF.x, HALF.y, -HALF.y, 0.1, 20);
  camera.position.z = 10;
  return camera;
}

async function light(scene, balls, source, renderer) {
  if (source.kind === "truth") {
    const textures = await Promise.all(source.urls.map(texels));
    balls.forEach((ball, index) => (ball.material.envMap = textures[index]));
  } else {
    scene.environment = await OPEN[source.kind](source.url, renderer);
  }
}

/** What a renderer is asked to do for its first frame: passes, and the shaders of the prefilter among its own. */
function watch(renderer) {
  let passes = 0;
  const render = renderer.render;
  renderer.render = (...values) => (++passes, render.apply(renderer, values));
  renderer.info.autoReset = false;
  renderer.info.reset();
  return () => ({
    passes,
    draws: renderer.info.render.calls,
    prefilters: renderer.info.programs.map(({ name }) => name).filter((name) => name.startsWith("PMREM")),
  });
}

/** Linear light of the row, `pixels` of them to a ball's square: floats, red green blue alpha, row 0 below. */
async function measure(source, pixels) {
  const renderer = new THREE.WebGLRenderer();
  const scene = new THREE.Scene();
  const balls = row(scene, source.kind === "truth");
  await light(scene, balls, source, renderer);
  const size = { width: BALLS.length * pixels, height: pixels };
  const target = new THREE.WebGLRenderTarget(size.width, size.height, { type: THREE.FloatType });
  renderer.setClearColor(0, 0);
  renderer.setRenderTarget(target);
  const work = watch(renderer);
  renderer.render(scene, view());
  const frame = work();
  const values = new Float32Array(4 * size.width * size.height);
  renderer.readRenderTargetPixels(target, 0, 0, size.width, size.height, values);
  renderer.dispose();
  renderer.forceContextLoss();
  return { ...size, light: Array.from(values), frame };
}

function about() {
  const renderer = new THREE.WebGLRenderer();
  const gl = renderer.getContext();
  const name = gl.getParameter(gl.getExtension("WEBGL_debug_renderer_info").UNMASKED_RENDERER_WEBGL);
  const blocksKnown = renderer.extensions.has("EXT_texture_compression_bptc");
  renderer.forceContextLoss();
  if (!blocksKnown) throw new Error("this Chromium knows no BC6H");
  return `three.js r${THREE.REVISION}, ${name}`;
}

window.client = {
  about,
  measure,
  figure: async (ours, theirs, pixels, gain) =>
    figure(await measure(ours, 2 * pixels), await measure(theirs, 2 * pixels), gain),
};
