// Babylon.js: a cube texture's spherical polynomial, computed in the worker.
import { projectCubemap, projectSlices } from './index.js';

/** Reads six faces of a cube texture back as Babylon.js does for itself: those of a render target are upside down. */
async function facesOf(texture) {
  const engine = texture.getScene()?.getEngine();
  engine?.flushFramebuffer();
  const order = texture.isRenderTarget ? [0, 1, 3, 2, 4, 5] : [0, 1, 2, 3, 4, 5];
  return Promise.all(order.map((face) => texture.readPixels(face, 0, undefined, false)));
}

/** Babylon.js keeps `maximum` and `preserveColour` as static members of its tools; 4096 is its default. */
const CLAMP = 4096;

const SLICE = 2 ** 22; // bytes that one task of the page reads back or copies

/** Lets the page draw and answer between two slices. */
const pause = () => new Promise((resolve) => { setTimeout(resolve); });

const powerOfTwoBelow = (value) => 2 ** Math.floor(Math.log2(Math.max(1, value)));

/** The mip that Babylon.js reads for `_sphericalPolynomialTargetSize`; without mips, all texels are read. */
function levelOf(texture, size) {
  const target = texture._sphericalPolynomialTargetSize > 0 ? powerOfTwoBelow(texture._sphericalPolynomialTargetSize) : 0;
  const hasMips = !texture.noMipmap && texture._texture?.generateMipMaps === true;
  return target > 0 && target < size && hasMips ? Math.round(Math.log2(size / target)) : 0;
}

/** Reads a texture back in strips of rows; the first strip says whether they are floats. */
async function* stripsOf(texture, level, size, known) {
  texture.getScene()?.getEngine().flushFramebuffer();
  const order = texture.isRenderTarget ? [0, 1, 3, 2, 4, 5] : [0, 1, 2, 3, 4, 5];
  const rows = Math.max(1, Math.min(size, Math.floor(SLICE / (16 * size))));
  for (let face = 0; face < 6; ++face) {
    for (let y = 0; y < size; y += rows) {
      const height = Math.min(rows, size - y);
      const pixels = await texture.readPixels(order[face], level, undefined, false, false, 0, y, size, height);
      known.floats = pixels instanceof Float32Array;
      const part = pixels.byteLength === pixels.buffer.byteLength ? pixels : pixels.slice();
      yield { face, offset: y * part.byteLength / height, slice: part.buffer };
      await pause();
    }
  }
}

/** The first of an asynchronous generator's values is looked at before the rest is sent. */
async function* withFirst(first, rest) {
  yield first;
  yield* rest;
}

/** Faces in memory, a copied slice at a time. */
async function* slicesOf(faces) {
  for (let face = 0; face < 6; ++face) {
    const bytes = new Uint8Array(faces[face].buffer, faces[face].byteOffset, faces[face].byteLength);
    for (let offset = 0; offset < bytes.length; offset += SLICE) {
      yield { face, offset, slice: bytes.slice(offset, offset + SLICE).buffer };
      await pause();
    }
  }
}

/**
 * Patches Babylon.js: polynomials that its getter would compute on the page's thread come from the worker, for every cube
 * texture; so do those of HDRCubeTexture and EXRCubeTexture. Give it `BABYLON`, or an object with those of its modules'
 * exports that are in use. Returns a function that takes the patch out.
 */
export function installPolynomials({ CubeMapToSphericalPolynomialTools: tools, SphericalPolynomial, Vector3, HDRCubeTexture,
  EXRCubeTexture }, options = {}) {
  const computed = async (slices, given) => {
    const { polynomial } = await projectSlices(slices, { linear: true, preserveColour: tools.PRESERVE_CLAMPED_COLORS,
      clamp: tools.MAX_HDRI_VALUE, ...given, ...options });
    const made = new SphericalPolynomial();
    for (const [name, [x, y, z]] of Object.entries(polynomial)) made[name] = new Vector3(x, y, z);
    return made;
  };
  const readBack = async (texture) => {
    const whole = texture.getSize().width;
    const level = levelOf(texture, whole);
    const size = Math.max(1, whole >> level);
    const known = {};
    const strips = stripsOf(texture, level, size, known);
    const { value: first } = await strips.next();
    return computed(withFirst(first, strips), { size, format: known.floats ? 'rgba32f' : 'rgba8', gamma: texture.gammaSpace });
  };
  const undo = [];
  const replace = (object, name, make) => {
    const own = object[name];
    object[name] = make(own);
    undo.push(() => { object[name] = own; });
  };
  // If the worker fails, Babylon.js computes it after all.
  replace(tools, 'ConvertCubeMapTextureToSphericalPolynomial', (own) => (texture) =>
    (texture.isCube ? readBack(texture).catch(() => own.call(tools, texture)) : null));
  for (const { prototype } of [HDRCubeTexture, EXRCubeTexture].filter(Boolean)) {
    replace(prototype, '_getCubeMapTextureDataAsync', (own) => async function read(...given) {
      const data = await own.apply(this, given);
      // Faces in gamma space are converted in place right after this. They stay with Babylon.js.
      if (!this._generateHarmonics || this.gammaSpace || !(data.right instanceof Float32Array)) return data;
      const faces = ['right', 'left', 'up', 'down', 'front', 'back'].map((name) => data[name]);
      const internal = this._texture;
      internal._sphericalPolynomialPromise = computed(slicesOf(faces), { size: data.size, format: data.format === 5 ? 'rgba32f' : 'rgb32f' })
        .catch(() => tools.ConvertCubeMapToSphericalPolynomial(data)).then((made) => {
          internal._sphericalPolynomial = made;
          internal._sphericalPolynomialComputed = true;
          return made;
        });
      this._generateHarmonics = false; // read once, in the microtask after this one
      setTimeout(() => { this._generateHarmonics = true; });
      return data;
    });
  }
  return () => { for (const step of undo.splice(0).reverse()) step(); };
}

/**
 * Gives a cube texture its `sphericalPolynomial` when the worker has it. Until then the getter is null, as it is while
 * the engine itself waits for pixels, and the engine computes none of its own.
 */
export async function setSphericalPolynomial(texture, { SphericalPolynomial, Vector3, faces, clamp = CLAMP, ...options }) {
  const internal = texture._texture;
  const work = (async () => {
    const pixels = faces ?? (await facesOf(texture));
    const { polynomial } = await projectCubemap(pixels, {
      linear: true, gamma: texture.gammaSpace, clamp, transfer: faces === undefined, ...options,
    });
    const made = new SphericalPolynomial();
    for (const [name, [x, y, z]] of Object.entries(polynomial)) made[name] = new Vector3(x, y, z);
    return made;
  })();
  // Where the engine looks for its own computation that is under way: it starts none.
  if (internal) internal._sphericalPolynomialPromise = work;
  try {
    const made = await work;
    texture.sphericalPolynomial = made;
    if (internal) internal._sphericalPolynomialComputed = true;
    return made;
  } catch (error) {
    if (internal && internal._sphericalPolynomialPromise === work) internal._sphericalPolynomialPromise = null;
    throw error;
  }
}
