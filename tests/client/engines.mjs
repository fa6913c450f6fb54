// What is asked of each engine: which of our files it loads, what is baked wrongly on purpose, and how far off the balls
// may be.
import { BALLS } from "./balls.js";

/** Texels along an edge of a cubemap's face: ours and the engine's own. three.js makes none that is smaller. */
export const SIZE = 256;
/** Pixels across a picture: as many as go round such a cubemap. three.js chooses its cubemap's size by them. */
export const PICTURE = 4 * SIZE;
/** Texels along an edge of the truth's faces. */
export const TRUTH = 512;

/** A folder's name, what is baked into it beside the picture, and how the page loads which of its files. */
const file = (name, kind, of, ...options) => ({ name, kind, of, options });

/** Ways to bake a file that is not the picture's. */
const TURNED = [["mirrored", "--mirror"], ["turned", "--yaw", "90"], ["back", "--yaw", "180"],
                ["overhead", "--rotation", "0,0,1,0"]];

export const ENGINES = {
  babylon: {
    files: [file("env", "env", "environment.env", "--formats", "env"),
            file("dds", "dds", "specular.dds", "--for", "babylon", "--formats", "dds")],
    truth: file("truth", "truth", "specular.dds", "--for", "babylon", "--formats", "dds", "--ktx2-format", "rgba32f"),
    /** The roughness that the shader makes of a material's: it adds 0.0005 to alpha. */
    roughness: (given) => Math.min(1, Math.sqrt(given * given + 0.0005)),
    wrong: [...TURNED, ["with another schedule", "--roughness", "filament"], ["without mips", "--mips", "5"]],
  },
  three: {
    files: [file("dds", "dds", "specular.dds", "--for", "three", "--formats", "dds", "--ktx2-format", "bc6h"),
            file("ktx2", "ktx2", "specular.ktx2", "--for", "three", "--formats", "ktx2")],
    truth: file("truth", "truth", "specular.ktx2", "--for", "three", "--formats", "ktx2", "--ktx2-format", "rgba32f"),
    /** The least roughness that the shader knows. */
    roughness: (given) => Math.max(given, 0.045),
    wrong: [...TURNED, ["with another schedule", "--roughness", "linear"], ["without its last mip", "--mips", "4"]],
    /** Passes, draws and shaders of a first frame with a file of ours, and with the picture. */
    checkFrame({ passes, draws, prefilters }, ours) {
      if (ours) return passes === 1 && draws === BALLS.length && prefilters.length === 0;
      return passes > 1 && draws > BALLS.length && prefilters.length > 0;
    },
  },
};
