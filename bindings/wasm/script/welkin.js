// What the plain script tag's global `welkin` holds.
export * from '../package/index.js';
export { setSphericalPolynomial } from '../package/babylon.js';
export { environmentTexture, setLightProbe } from '../package/three.js';
