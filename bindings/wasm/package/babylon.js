// Babylon.js: a cube texture's spherical polynomial, computed in the worker.
import { projectCubemap } from './index.js';

/** Reads six faces of a cube texture back as Babylon.js does for itself: those of a render target are upside down. */
async function facesOf(texture) {
  const engine = texture.getScene()?.getEngine();
  engine?.flushFramebuffer();
  const order = texture.isRenderTarget ? [0, 1, 3, 2, 4, 5] : [0, 1, 2, 3, 4, 5];
  return Promise.all(order.map((face) => texture.readPixels(face, 0, undefined, false)));
}

/** Babylon.js keeps `maximum` and `preserveColour` as static members of its tools; 4096 is its default. */
const CLAMP = 4096;

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
