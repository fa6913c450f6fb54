// A JPEG with a gain map, as three.js' loader and the npm package @monogrid/gainmap-js read it. Bundled by ultra_hdr.mjs.
import * as THREE from "three";
import { UltraHDRLoader } from "three/addons/loaders/UltraHDRLoader.js";
import { HDRJPGLoader } from "@monogrid/gainmap-js";

/** RGBA floats, row 0 on top. */
const floats = (values, width, height, bottomUp) =>
  Array.from({ length: height }, (_, row) =>
    Array.from(values.subarray(4 * width * (bottomUp ? height - 1 - row : row), 4 * width * ((bottomUp ? height - 1 - row : row) + 1)),
               values instanceof Uint16Array ? THREE.DataUtils.fromHalfFloat : (value) => value)).flat();

window.client = {
  three: async (url) => {
    const { image } = await new UltraHDRLoader().setDataType(THREE.FloatType).loadAsync(url);
    return { width: image.width, height: image.height, light: floats(image.data, image.width, image.height, false) };
  },
  gainmap: async (url) => {
    const renderer = new THREE.WebGLRenderer();
    const decoded = await new HDRJPGLoader(renderer).loadAsync(url);
    const [width, height] = [decoded.width, decoded.height];
    const light = floats(decoded.toArray(), width, height, true);
    decoded.dispose();
    renderer.dispose();
    return { width, height, light };
  },
};
