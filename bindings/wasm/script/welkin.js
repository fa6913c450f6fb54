// Exports of the plain script tag's global `welkin`.
export * from '../package/index.js';
export { setSphericalPolynomial } from '../package/babylon.js';
export { environmentTexture, setLightProbe } from '../package/three.js';
