// The cases of each engine: the files of ours that it loads, files that are wrong on purpose, and bounds on the errors of
// the spheres.
import { SPHERES } from "./spheres.js";

/** Texels along an edge of a cubemap's face: ours and the engine's own. three.js makes none that is smaller. */
export const SIZE = 256;
/** Pixels across an image: as many as go round such a cubemap. three.js chooses its cubemap's size by them. */
export const IMAGE_WIDTH = 4 * SIZE;
/** Texels along an edge of the reference's faces. */
export const TRUTH = 512;

/** Ways to bake a file that is not the image's; a name and options of `welkin bake`. */
const MIRRORED = ["mirrored", "--mirror"];
const TURNED = [MIRRORED, ["turned", "--yaw", "90"], ["back", "--yaw", "180"], ["overhead", "--rotation", "0,0,1,0"]];

/** Roughness of the mips of a chain of three.js's, from 256 texels to 8, but for the last. */
const WITHOUT_LAST = [0, 1, 2, 3, 4].map((mip) => `${1 - Math.sqrt(1 - mip / 5)}`).join(",");

export const ENGINES = {
  babylon: {
    // The .env always has the mips and the roughness that Babylon.js expects, whatever the options.
    files: [{ name: "env", kind: "env", of: "environment.env", options: ["--formats", "env"], wrong: TURNED },
            { name: "dds", kind: "dds", of: "specular.dds", options: ["--for", "babylon", "--formats", "dds"],
              wrong: [MIRRORED, ["with another schedule", "--roughness", "filament"], ["of five mips", "--mips", "5"]] },
            // In glTF's axes, and seen from where these have the image's centre.
            { name: "glb", kind: "gltf", of: "environment.glb", options: ["--for", "gltf"], wrong: TURNED }],
    truth: { of: "specular.dds", options: ["--for", "babylon", "--formats", "dds"] },
    /** The roughness that the shader makes of a material's: it adds 0.0005 to alpha. */
    roughness: (given) => Math.min(1, Math.sqrt(given * given + 0.0005)),
  },
  three: {
    // The folder of --for three: as many mips as three.js makes itself.
    files: [{ name: "dds", kind: "dds", of: "specular.dds", options: ["--for", "three"],
              wrong: [...TURNED, ["with another schedule", "--roughness", "linear"],
                      ["without its last mip", "--roughness", WITHOUT_LAST]] },
            { name: "ktx2", kind: "ktx2", of: "specular.ktx2", options: ["--for", "three"],
              wrong: [MIRRORED, ["without its last mip", "--roughness", WITHOUT_LAST]] },
            { name: "uastc", kind: "uastc", of: "specular_uastc.ktx2", options: ["--for", "three"], wrong: [MIRRORED] },
            { name: "ktx2 of 5 mips", kind: "ktx2", of: "specular.ktx2",
              options: ["--for", "three", "--formats", "ktx2", "--mips", "5"], wrong: [] }],
    truth: { of: "specular.ktx2", options: ["--for", "three", "--formats", "ktx2"] },
    /** The least roughness that the shader knows. */
    roughness: (given) => Math.max(given, 0.045),
    /** Passes, draws and shaders of a first frame with a file of ours, and with the image. */
    checkFrame({ passes, draws, prefilters }, ours) {
      if (ours) return passes === 1 && draws === SPHERES.length && prefilters.length === 0;
      return passes > 1 && draws > SPHERES.length && prefilters.length > 0;
    },
    /** The reference is checked by a direct sum where lobes are much wider than a pixel, within this bound. */
    direct: { roughness: [0.375, 0.75], allowed: 0.001 },
  },
  playcanvas: {
    // 512 texels, the default of EnvLighting.generateAtlas.
    files: [{ name: "atlas", kind: "atlas", of: "env_atlas.json", options: ["--for", "playcanvas"],
              wrong: [...TURNED, ["with PlayCanvas' schedule", "--roughness", "0,0.18,0.36,0.55,0.73,0.91"],
                      ["with another schedule", "--roughness", "0,0.1,0.2,0.4,0.6,1"]] }],
    truth: { of: "specular.ktx2", options: ["--formats", "ktx2"] },
    roughness: (given) => given,
    /** After its own prefilter no further asset gets ready in the same browser, under SwiftShader. */
    freshBrowser: true,
  },
};
