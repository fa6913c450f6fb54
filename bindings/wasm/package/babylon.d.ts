import type { BaseTexture, SphericalPolynomial, Vector3 } from '@babylonjs/core';
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
