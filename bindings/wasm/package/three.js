// three.js: light probes and prefiltered cubemaps from results of the worker. The library itself is handed in.

/** three.js samples cube textures at (-x, y, z): coefficients odd in x change their sign. */
const ODD_IN_X = [3, 4, 7];

/**
 * Writes a result's coefficients of radiance to a `LightProbe`. `mirrored`: they were projected from the faces of a
 * `CubeTexture` as they are; not so those of a picture (`bakeEnvironment`, `projectEquirect`, `sky`).
 */
export function setLightProbe(probe, { radiance }, { mirrored = false } = {}) {
  for (let k = 0; k < 9; ++k) {
    const sign = mirrored && ODD_IN_X.includes(k) ? -1 : 1;
    probe.sh.coefficients[k].set(...radiance.subarray(3 * k, 3 * k + 3)).multiplyScalar(sign);
  }
  return probe;
}

/**
 * A texture for `scene.environment` out of a chain that was made with `mirrorX: true` (schedule 'filament', the
 * default), which three.js uses as it is: its PMREMGenerator does not run. The last mip is that of roughness 1, whose lobe is the cosine's, so that it is the
 * diffuse light too.
 */
export function environmentTexture(THREE, { specular }) {
  if (!specular.mirrored) throw new Error('three.js needs a chain that was made with mirrorX: true');
  const images = Array.from({ length: 6 }, (_, face) => ({
    width: specular.size,
    height: specular.size,
    mipmaps: specular.mips.map(({ size, faces }) => ({ data: faces[face], width: size, height: size })),
  }));
  const texture = new THREE.CompressedCubeTexture(images, THREE.RGBAFormat,
    specular.format === 'rgba32f' ? THREE.FloatType : THREE.HalfFloatType);
  texture.minFilter = THREE.LinearMipmapLinearFilter;
  texture.magFilter = THREE.LinearFilter;
  texture.generateMipmaps = false;
  texture.colorSpace = THREE.LinearSRGBColorSpace;
  texture.isPMREMTexture = true;
  texture.needsUpdate = true;
  return texture;
}
