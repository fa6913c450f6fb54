// three.js: light probes and prefiltered cubemaps from results of the worker. The library itself is handed in.

/** three.js samples cube textures at (-x, y, z): coefficients odd in x change their sign. */
const ODD_IN_X = [3, 4, 7];

/**
 * Writes a result's coefficients of radiance to a `LightProbe`. `mirrored`: they were projected from the faces of a
 * `CubeTexture` as they are; not so those of an image (`bakeEnvironment`, `projectEquirect`, `sky`).
 */
export function setLightProbe(probe, { radiance }, { mirrored = false } = {}) {
  for (let k = 0; k < 9; ++k) {
    const sign = mirrored && ODD_IN_X.includes(k) ? -1 : 1;
    probe.sh.coefficients[k].set(...radiance.subarray(3 * k, 3 * k + 3)).multiplyScalar(sign);
  }
  return probe;
}

const typeOf = (THREE, format) => (format === 'rgba32f' ? THREE.FloatType : THREE.HalfFloatType);

function mirroredFaces(faces) {
  if (!faces) throw new Error('the result has no such faces: they were not asked for');
  if (!faces.mirrored) throw new Error("three.js needs mirrored faces: bake with for: 'three'");
  return faces;
}

/**
 * A texture for `scene.environment` out of a chain that was made with `for: 'three'`, which three.js uses as it is: its
 * PMREMGenerator does not run. The last mip has roughness 1, whose lobe is the cosine, so it is the diffuse light too.
 */
export function environmentTexture(THREE, { specular }) {
  const { size: edge, format, mips } = mirroredFaces(specular);
  const images = Array.from({ length: 6 }, (_, face) => ({
    width: edge,
    height: edge,
    mipmaps: mips.map(({ size, faces }) => ({ data: faces[face], width: size, height: size })),
  }));
  const texture = new THREE.CompressedCubeTexture(images, THREE.RGBAFormat, typeOf(THREE, format));
  texture.minFilter = THREE.LinearMipmapLinearFilter;
  texture.magFilter = THREE.LinearFilter;
  texture.generateMipmaps = false;
  texture.colorSpace = THREE.LinearSRGBColorSpace;
  texture.isPMREMTexture = true;
  texture.needsUpdate = true;
  return texture;
}

/** A texture for `scene.background` out of a result that was made with `for: 'three'` and `background`. */
export function backgroundTexture(THREE, { background }) {
  const { size, format, faces } = mirroredFaces(background);
  const type = typeOf(THREE, format);
  const texture = new THREE.CubeTexture(faces.map((data) => new THREE.DataTexture(data, size, size, THREE.RGBAFormat, type)));
  texture.format = THREE.RGBAFormat;
  texture.type = type;
  texture.colorSpace = THREE.LinearSRGBColorSpace;
  texture.minFilter = THREE.LinearFilter;
  texture.magFilter = THREE.LinearFilter;
  texture.generateMipmaps = false;
  texture.needsUpdate = true;
  return texture;
}
