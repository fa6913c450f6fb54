// node perf/harmonics_peers.mjs FOLDER, which holds node_modules/three: microseconds of CPU time of three.js for the
// work of `welkin_perf --benchmark_filter=Harmonics` (three.js has no product and no rotation).
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";

const file = createRequire(`${process.argv[2]}/`).resolve("three").replace("three.cjs", "three.module.js");
const { REVISION, SphericalHarmonics3, Vector3 } = await import(pathToFileURL(file).href);
const light = new SphericalHarmonics3();
light.coefficients.forEach((c, k) => c.set(Math.cos(1.7 * k), Math.cos(3.4 * k), Math.cos(5.1 * k)));
const directions = Array.from({ length: 1000 }, (_, k) => new Vector3().setFromSphericalCoords(1, Math.acos(1 - (2 * k + 1) / 1000), k));
const values = directions.map(() => new Vector3());
let least = Infinity;
for (let run = 0; run < 2000; ++run) {
  const before = process.cpuUsage();
  for (let times = 0; times < 20; ++times) directions.forEach((d, k) => light.getAt(d, values[k]));
  const { user, system } = process.cpuUsage(before);
  least = Math.min(least, (user + system) / 20);
}
console.log(`three.js r${REVISION}: 1000 directions of three bands ${least.toFixed(1)} us`);
