import type * as Three from 'three';
import type { Chain, CubeFaces, SphericalHarmonics } from './index.js';

/** Writes coefficients to a light probe. `mirrored`: they are those of a `CubeTexture`'s faces as they are. */
export function setLightProbe(probe: Three.LightProbe, light: Pick<SphericalHarmonics, 'radiance'>,
  options?: { mirrored?: boolean }): Three.LightProbe;

/** A texture for `scene.environment` out of a result that was made with `for: 'three'`. It is the diffuse light too. */
export function environmentTexture(THREE: typeof Three, light: { specular: Chain | null }): Three.CompressedCubeTexture;

/** A texture for `scene.background` out of a result that was made with `for: 'three'` and `background`. */
export function backgroundTexture(THREE: typeof Three, light: { background: CubeFaces | null }): Three.CubeTexture;
