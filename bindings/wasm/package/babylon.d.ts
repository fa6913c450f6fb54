import type { BaseTexture, CubeMapToSphericalPolynomialTools, SphericalPolynomial, Vector3 } from '@babylonjs/core';
import type { Pixels, ProjectionOptions } from './index.js';

/**
 * Gives a cube texture its `sphericalPolynomial` once the worker has it; the engine computes none of its own, and the
 * page does not wait. `faces`: pixels that are there already; without them the texture is read back.
 */
export function setSphericalPolynomial(texture: BaseTexture, options: ProjectionOptions & {
  SphericalPolynomial: typeof SphericalPolynomial;
  Vector3: typeof Vector3;
  faces?: Pixels[];
}): Promise<SphericalPolynomial>;

/**
 * Patches Babylon.js, which is `BABYLON` or an object with exports of its modules: spherical polynomials of all cube
 * textures, and of HDRCubeTexture and EXRCubeTexture where given, come from the worker instead of the page's thread.
 * Returns a function that takes the patch out.
 */
export function installPolynomials(babylon: {
  CubeMapToSphericalPolynomialTools: typeof CubeMapToSphericalPolynomialTools;
  SphericalPolynomial: typeof SphericalPolynomial;
  Vector3: typeof Vector3;
  HDRCubeTexture?: { prototype: object };
  EXRCubeTexture?: { prototype: object };
}, options?: ProjectionOptions): () => void;
