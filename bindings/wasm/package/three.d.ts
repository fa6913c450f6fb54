import type * as Three from 'three';
import type { Chain, CubeFaces, SphericalHarmonics } from './index.js';

/** Writes coefficients to a light probe. `mirrored`: they were projected from the faces of a `CubeTexture`, which three.js mirrors. */
export function setLightProbe(probe: Three.LightProbe, light: Pick<SphericalHarmonics, 'radiance'>,
  options?: { mirrored?: boolean }): Three.LightProbe;

/** Returns a texture for `scene.environment` from a result of `for: 'three'`. It also gives diffuse light. */
export function environmentTexture(THREE: typeof Three, light: { specular: Chain | null }): Three.CompressedCubeTexture;

/** Returns a texture for `scene.background` from a result of `for: 'three'` with `background`. */
export function backgroundTexture(THREE: typeof Three, light: { background: CubeFaces | null }): Three.CubeTexture;
