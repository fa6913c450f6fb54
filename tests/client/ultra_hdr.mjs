// Reads tests/data/ultra_hdr.jpg by `welkin convert`, by three.js' UltraHDRLoader and by the npm package
// @monogrid/gainmap-js, which wrote it, and says how far they are apart.
//
//   node ultra_hdr.mjs --modules DIR --browser CHROMIUM --welkin WELKIN --work DIR
//
// docs/reference/files.md has the figures. Exit code 1 if they are no longer so.
import { execFileSync } from "node:child_process";
import { copyFileSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const flags = process.argv.slice(2);
const flag = (name) => flags[flags.indexOf(name) + 1];
const modules = resolve(flag("--modules"));
const here = new URL(".", import.meta.url).pathname;
const work = join(resolve(flag("--work")), "ultra_hdr");
const load = (name) => import(pathToFileURL(createRequire(`${modules}/`).resolve(name)).href);
const { chromium } = (await load("playwright-core")).default;
const { build } = (await load("esbuild")).default;

/** A PFM as RGBA floats, row 0 on top. */
function readPfm(path) {
  const bytes = readFileSync(path);
  const [, width, height] = bytes.subarray(0, 64).toString("latin1").match(/^PF\s+(\d+)\s+(\d+)\s+-[\d.]+\n/).map(Number);
  const body = bytes.subarray(bytes.length - 12 * width * height);
  const light = [];
  for (let row = height - 1; row >= 0; --row)
    for (let column = 0; column < width; ++column)
      light.push(...[0, 1, 2].map((channel) => body.readFloatLE(4 * (3 * (row * width + column) + channel))), 1);
  return { width, height, light };
}

/** Root mean square of a - b over that of b. */
function difference(a, b) {
  if (a.width !== b.width || a.height !== b.height) return Infinity;
  let [off, power] = [0, 0];
  for (let at = 0; at < b.light.length; ++at) {
    if (at % 4 === 3) continue;
    off += (a.light[at] - b.light[at]) ** 2;
    power += b.light[at] ** 2;
  }
  return Math.sqrt(off / power);
}

mkdirSync(work, { recursive: true });
const file = join(work, "ultra_hdr.jpg");
copyFileSync(join(here, "../data/ultra_hdr.jpg"), file);
execFileSync(flag("--welkin"), ["convert", file, join(work, "ours.pfm")], { stdio: ["ignore", "ignore", "inherit"] });
const ours = readPfm(join(work, "ours.pfm"));
await build({ entryPoints: [join(here, "ultra_hdr.source.js")], bundle: true, format: "iife", logLevel: "error",
              nodePaths: [join(modules, "node_modules")], outfile: join(work, "page.js") });
writeFileSync(join(work, "page.html"), '<!doctype html><meta charset="utf-8"><script src="page.js"></script>');

const browser = await chromium.launch({ executablePath: flag("--browser"),
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"] });
const failures = [];
try {
  const page = await browser.newPage();
  page.on("pageerror", (error) => failures.push(`the page: ${error.message}`));
  await page.goto(pathToFileURL(join(work, "page.html")).href);
  const url = `data:image/jpeg;base64,${readFileSync(file).toString("base64")}`;
  const theirs = {};
  for (const name of ["gainmap", "three"]) theirs[name] = await page.evaluate(([n, u]) => window.client[n](u), [name, url]);
  for (const [name, a, b, least, most] of [
    ["welkin - gainmap-js", ours, theirs.gainmap, 0, 0.0005],
    ["three.js - gainmap-js", theirs.three, theirs.gainmap, 0.03, 0.06],
    ["three.js - welkin", theirs.three, ours, 0.03, 0.06],
  ]) {
    const found = difference(a, b);
    console.log(`${name}: ${(100 * found).toFixed(3)} % rms`);
    if (!(found >= least && found <= most)) failures.push(`${name}: ${found} is not within ${least} and ${most}`);
  }
} finally {
  await browser.close();
}
for (const failure of failures) console.error(`FAILED: ${failure}`);
process.exit(failures.length ? 1 : 0);
