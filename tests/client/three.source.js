// The code of a user of our files in three.js: loads one, and lights spheres with it. Bundled by client.mjs, which drives it
// through `window.client`.
import * as THREE from "three";
import { DDSLoader } from "three/addons/loaders/DDSLoader.js";
import { HDRLoader } from "three/addons/loaders/HDRLoader.js";
import { KTX2Loader } from "three/addons/loaders/KTX2Loader.js";
import { read } from "ktx-parse";
import { SPHERES, HALF, centre, figure } from "./spheres.js";
import { pixelsOf, prefiltered, readPfm } from "./integral.js";

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

/** A chain in UASTC HDR, through Basis Universal's transcoder: the lines of the README that `--for three` writes. */
async function transcoded(url, renderer) {
  const loader = new KTX2Loader().setTranscoderPath("basis/").detectSupport(renderer);
  return Object.assign(await loader.loadAsync(url), { isPMREMTexture: true });
}

/** A chain in floats, for the reference. */
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

/** The image itself, which three.js prefilters when it first draws with it. */
async function panorama(url) {
  const texture = await new HDRLoader().loadAsync(url);
  texture.mapping = THREE.EquirectangularReflectionMapping;
  return texture;
}

const OPEN = { dds: blocks, ktx2: halves, uastc: transcoded, picture: panorama };

const RADIANCE = "textureLod( envMap, envMapRotation * reflectVec, roughnessToMip( roughness ) )";
const IRRADIANCE = "textureLod( envMap, envMapRotation * worldNormal, ENVMAP_MAX_LOD )";
const END = "gl_FragColor = vec4( outgoingLight, diffuseColor.a );";

/**
 * Changes to chunks of shaders: to look everything up in mip 0, whatever the roughness (`exact`, the reference for one
 * sphere); to show the directions of its lookups (`directions`, `normals`); or to read reflected and diffuse light from
 * an image, pixel by pixel, instead of looking it up (`given`).
 */
const CHANGES = {
  ours: [],
  exact: [["envmap_physical_pars_fragment", "roughnessToMip( roughness )", "0.0"]],
  directions: [["envmap_physical_pars_fragment", RADIANCE, `${RADIANCE}; looked = reflectVec`],
               ["opaque_fragment", END, "gl_FragColor = vec4( looked, 1.0 );"]],
  normals: [["envmap_physical_pars_fragment", IRRADIANCE, `${IRRADIANCE}; looked = worldNormal`],
            ["opaque_fragment", END, "gl_FragColor = vec4( looked, 1.0 );"]],
  given: [["envmap_physical_pars_fragment", RADIANCE, "texelFetch( radianceGiven, ivec2( gl_FragCoord.xy ), 0 )"],
          ["envmap_physical_pars_fragment", IRRADIANCE, "texelFetch( irradianceGiven, ivec2( gl_FragCoord.xy ), 0 )"]],
};

/** Removes from the shader the growth of roughness with the curvature between pixels, and makes the changes. */
function settle(material, kind, uniforms = {}) {
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, uniforms);
    const text = {};
    for (const [chunk, from, to] of [["lights_physical_fragment", "material.roughness += geometryRoughness;", ""], ...CHANGES[kind]]) {
      const before = text[chunk] ?? THREE.ShaderChunk[chunk];
      if (!before.includes(from)) throw new Error(`three.js's ${chunk} is not what it was: it has no ${from}`);
      text[chunk] = before.replaceAll(from, to);
    }
    for (const [chunk, changed] of Object.entries(text))
      shader.fragmentShader = shader.fragmentShader.replace(`#include <${chunk}>`, () => changed);
    shader.fragmentShader = `vec3 looked;\nuniform sampler2D radianceGiven, irradianceGiven;\n${shader.fragmentShader}`;
  };
  material.customProgramCacheKey = () => kind;
  return material;
}

function row(scene, kind, uniforms) {
  const shape = new THREE.SphereGeometry(1, 128, 64);
  return SPHERES.map(({ roughness, metallic, albedo }, index) => {
    const color = new THREE.Color().setRGB(albedo, albedo, albedo, THREE.LinearSRGBColorSpace);
    const material = new THREE.MeshStandardMaterial({ color, roughness, metalness: metallic });
    const sphere = new THREE.Mesh(shape, settle(material, kind, uniforms));
    sphere.position.x = centre(index);
    scene.add(sphere);
    return sphere;
  });
}

/** Orthographic: every sphere sees the same, a pixel's normal does not depend on the sphere. */
function view() {
  const camera = new THREE.OrthographicCamera(-HALF.x, HALF.x, HALF.y, -HALF.y, 0.1, 20);
  camera.position.z = 10;
  return camera;
}

async function light(scene, spheres, source, renderer) {
  if (source.kind === "truth") {
    const textures = await Promise.all(source.urls.map(texels));
    spheres.forEach((sphere, index) => (sphere.material.envMap = textures[index]));
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

/** Draws a row into floats, red green blue alpha, row 0 below: `pixels` of them to a sphere's square. */
async function draw(source, pixels, kind, uniforms) {
  const renderer = new THREE.WebGLRenderer();
  const scene = new THREE.Scene();
  const spheres = row(scene, kind, uniforms);
  await light(scene, spheres, source, renderer);
  const size = { width: SPHERES.length * pixels, height: pixels };
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
  return { ...size, light: values, frame };
}

/** Linear light of the row. */
async function measure(source, pixels) {
  const drawn = await (source.kind === "direct" ? direct(source, pixels)
                                                : draw(source, pixels, source.kind === "truth" ? "exact" : "ours"));
  return { ...drawn, light: Array.from(drawn.light) };
}

/**
 * The row lit by sums over all pixels of an image in place of lookups: for each of its own pixels in the direction in which
 * the shader looks. `like`: a source whose chain makes the shader look at all.
 */
async function direct({ picture, like }, pixels) {
  const [looked, normals] = [await draw(like, pixels, "directions"), await draw(like, pixels, "normals")];
  const image = pixelsOf(readPfm(new Uint8Array(await bytesOf(picture))));
  const sums = new Map(); // spheres of the same roughness look in the same directions
  const sum = ({ light, width }, column, row, roughness) => {
    const at = 4 * (row * width + column);
    if (light[at + 3] === 0) return [0, 0, 0];
    const key = `${roughness} ${column % pixels} ${row}`;
    if (!sums.has(key)) {
      const [x, y, z] = light.subarray(at, at + 3);
      const length = Math.hypot(x, y, z);
      sums.set(key, prefiltered(image, [x / length, y / length, z / length], roughness));
    }
    return sums.get(key);
  };
  const texture = (drawn, roughnessOf) => {
    const values = new Float32Array(drawn.light.length).fill(1);
    sums.clear();
    for (let row = 0; row < drawn.height; ++row)
      for (let column = 0; column < drawn.width; ++column)
        values.set(sum(drawn, column, row, roughnessOf(Math.floor(column / pixels))), 4 * (row * drawn.width + column));
    const made = new THREE.DataTexture(values, drawn.width, drawn.height, THREE.RGBAFormat, THREE.FloatType);
    return { value: Object.assign(made, { needsUpdate: true }) };
  };
  const uniforms = { radianceGiven: texture(looked, (sphere) => Math.max(SPHERES[sphere].roughness, 0.045)),
                     irradianceGiven: texture(normals, () => 1) }; // whose lobe is the cosine's
  return draw(like, pixels, "given", uniforms);
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
