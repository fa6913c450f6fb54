// Measures how soon a page draws its first frame that a file lights, and the GPU memory of its textures. Bundled by
// first_frame.mjs, which opens the page again for each file.
import * as THREE from "three";
import { EXRLoader } from "three/addons/loaders/EXRLoader.js";
import { HDRLoader } from "three/addons/loaders/HDRLoader.js";
import { KTX2Loader } from "three/addons/loaders/KTX2Loader.js";

/** Bytes of a texel or, of blocks, of 4 x 4 texels, by WebGL's number of the format; those that three.js allocates here. */
const BYTES = { 0x8058: 4, 0x8c43: 4, 0x8814: 16, 0x881a: 8, 0x822f: 4, 0x8e8f: -16, 0x93b0: -16, 0x81a6: 4, 0x1908: 4 };

/** Counts the bytes of textures that are alive, and the most there were. */
function countTextures(gl) {
  const bytes = new Map();
  const bound = new Map();
  const count = { now: 0, most: 0 };
  const before = (name, work) => {
    const call = gl[name].bind(gl);
    gl[name] = (...values) => (work(...values), call(...values));
  };
  const add = (target, format, width, height, levels, faces) => {
    if (!(format in BYTES)) throw new Error(`a texture has the format ${format.toString(16)}`);
    let sum = 0;
    for (let level = 0; level < levels; ++level) {
      const [w, h] = [Math.max(1, width >> level), Math.max(1, height >> level)];
      sum += BYTES[format] < 0 ? -BYTES[format] * Math.ceil(w / 4) * Math.ceil(h / 4) : BYTES[format] * w * h;
    }
    const texture = bound.get(target);
    bytes.set(texture, (bytes.get(texture) ?? 0) + sum * faces);
    count.now += sum * faces;
    count.most = Math.max(count.most, count.now);
  };
  before("bindTexture", (target, texture) => bound.set(target, texture));
  before("texStorage2D", (target, levels, format, w, h) => add(target, format, w, h, levels, target === gl.TEXTURE_CUBE_MAP ? 6 : 1));
  before("texImage2D", (target, level, format, ...rest) => {
    if (rest.length < 6) return; // an image of the page's: none is loaded here
    const [width, height] = rest;
    const face = target >= gl.TEXTURE_CUBE_MAP_POSITIVE_X && target <= gl.TEXTURE_CUBE_MAP_NEGATIVE_Z;
    add(face ? gl.TEXTURE_CUBE_MAP : target, format, width, height, 1, 1);
  });
  before("deleteTexture", (texture) => {
    count.now -= bytes.get(texture) ?? 0;
    bytes.delete(texture);
  });
  return count;
}

const panorama = async (loader, url) =>
  Object.assign(await loader.loadAsync(url), { mapping: THREE.EquirectangularReflectionMapping });

const OPEN = {
  uastc: async (url, renderer) => {
    const loader = new KTX2Loader().setTranscoderPath("basis/").detectSupport(renderer);
    return Object.assign(await loader.loadAsync(url), { isPMREMTexture: true });
  },
  halves: async (url, renderer) => {
    const { image: { width, height }, mipmaps } = await new KTX2Loader().detectSupport(renderer).loadAsync(url);
    const images = [0, 1, 2, 3, 4, 5].map((face) => ({ width, height, mipmaps: mipmaps.map(({ data, width, height }) =>
      ({ width, height, data: data.subarray((data.length / 6) * face, (data.length / 6) * (face + 1)) })) }));
    const texture = new THREE.CompressedCubeTexture(images, THREE.RGBAFormat, THREE.HalfFloatType);
    return Object.assign(texture, { minFilter: THREE.LinearMipmapLinearFilter, isPMREMTexture: true, needsUpdate: true });
  },
  exr: (url) => panorama(new EXRLoader(), url),
  hdr: (url) => panorama(new HDRLoader(), url),
};

/** Milliseconds from the request of the file to pixels, and bytes of textures. A page has its shapes and its renderer. */
async function firstFrame(kind, url) {
  const renderer = new THREE.WebGLRenderer({ canvas: document.querySelector("canvas"), antialias: false });
  renderer.setSize(640, 160, false);
  const gl = renderer.getContext();
  const count = countTextures(gl);
  const scene = new THREE.Scene();
  const camera = new THREE.OrthographicCamera(-10, 10, 2.5, -2.5, 0.1, 20);
  camera.position.z = 10;
  const shape = new THREE.SphereGeometry(1, 64, 32);
  for (let k = 0; k < 9; ++k) {
    const sphere = new THREE.Mesh(shape, new THREE.MeshStandardMaterial({ metalness: 1, roughness: k / 8 }));
    sphere.position.x = 2.2 * (k - 4);
    scene.add(sphere);
  }
  const pixel = new Uint8Array(4);
  const draw = () => {
    renderer.render(scene, camera);
    gl.readPixels(320, 80, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel); // waits for what was drawn
  };
  const begun = performance.now();
  scene.environment = await OPEN[kind](url, renderer);
  const loaded = performance.now();
  draw();
  const drawn = performance.now();
  if (pixel[0] + pixel[1] + pixel[2] === 0) throw new Error(`${url} lights nothing`);
  return { milliseconds: drawn - begun, loading: loaded - begun, now: count.now, most: count.most };
}

window.client = { firstFrame };
