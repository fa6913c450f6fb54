// The table of docs/guides/engine_files.md: what a page waits for until the first frame that a file lights, by three.js.
//
//   node first_frame.mjs --modules DIR --browser CHROMIUM --welkin WELKIN --work DIR --image FILE.hdr [--runs 5] [--only uastc|halves|exr|hdr]
//
// DIR of --modules is a folder of client_test.sh's, or another with three, esbuild and playwright-core in node_modules. For
// each file: bytes, the median of the time from its request to pixels over a loopback and over 20 Mbit/s with 40 ms,
// each in a page of its own, and bytes of textures afterwards and at most.
import { execFileSync } from "node:child_process";
import { createServer } from "node:http";
import { existsSync, mkdirSync, readFileSync, statSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join, normalize, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { gzipSync } from "node:zlib";

const flags = process.argv.slice(2);
const flag = (name) => (flags.includes(name) ? flags[flags.indexOf(name) + 1] : undefined);
const here = new URL(".", import.meta.url).pathname;
const [modules, work] = [resolve(flag("--modules")), resolve(flag("--work"))];
const load = (name) => import(pathToFileURL(createRequire(`${modules}/`).resolve(name)).href);
const { chromium } = (await load("playwright-core")).default;
const { build } = (await load("esbuild")).default;

mkdirSync(work, { recursive: true });
const run = (...words) => execFileSync(flag("--welkin"), words, { stdio: ["ignore", "ignore", "inherit"] });
const image = flag("--image");
run("bake", image, "-o", join(work, "plain"), "--for", "three", "--no-previews", "--size", "256");
run("bake", image, "-o", join(work, "packed"), "--for", "three", "--no-previews", "--size", "256", "--supercompression", "zstd");
run("convert", image, join(work, "picture.exr"));
writeFileSync(join(work, "picture.hdr"), readFileSync(image));
writeFileSync(join(work, "index.html"), '<!doctype html><canvas></canvas><script type="module" src="page.js"></script>');
await build({ entryPoints: [join(here, "first_frame.source.js")], bundle: true, format: "esm", logLevel: "error",
              nodePaths: [join(modules, "node_modules")], outfile: join(work, "page.js") });

const basis = join(modules, "node_modules/three/examples/jsm/libs"); // has basis/, the transcoder
const TYPES = { html: "text/html", js: "text/javascript", wasm: "application/wasm" };
const server = createServer((request, response) => {
  const name = normalize(decodeURIComponent(new URL(request.url, "http://x").pathname));
  const path = [work, basis].map((folder) => join(folder, name)).find((candidate) => existsSync(candidate));
  if (!path) return response.writeHead(404).end();
  const type = TYPES[path.split(".").pop()];
  const bytes = readFileSync(path);
  response.writeHead(200, { "content-type": type ?? "application/octet-stream", "cache-control": "no-store",
                            ...(type ? { "content-encoding": "gzip" } : {}) });
  response.end(type ? gzipSync(bytes) : bytes);
});
await new Promise((ready) => server.listen(0, "127.0.0.1", ready));
const browser = await chromium.launch({ executablePath: flag("--browser"),
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist",
         "--disable-background-networking"] });

async function measure(kind, url, slow) {
  const context = await browser.newContext();
  const page = await context.newPage();
  page.setDefaultTimeout(180_000);
  await page.goto(`http://127.0.0.1:${server.address().port}/index.html`);
  await page.waitForFunction("window.client");
  if (slow) {
    const session = await context.newCDPSession(page);
    await session.send("Network.enable");
    await session.send("Network.emulateNetworkConditions",
      { offline: false, latency: 40, downloadThroughput: 20e6 / 8, uploadThroughput: 20e6 / 8 });
  }
  const result = await page.evaluate(([k, u]) => window.client.firstFrame(k, u), [kind, url]);
  await context.close();
  return result;
}

const median = (values) => values.sort((a, b) => a - b)[values.length >> 1];
const FILES = [["UASTC HDR, Zstandard", "uastc", "packed/specular_uastc.ktx2"], ["UASTC HDR", "uastc", "plain/specular_uastc.ktx2"],
               ["half floats, Zstandard", "halves", "packed/specular.ktx2"], ["half floats", "halves", "plain/specular.ktx2"],
               [".exr, prefiltered by three.js", "exr", "picture.exr"], [".hdr, prefiltered by three.js", "hdr", "picture.hdr"]];
const packed = (name) => gzipSync(readFileSync(join(basis, "basis", name)), { level: 9 }).length;
console.log(`transcoder, once a page, gzip: ${((packed("basis_transcoder.js") + packed("basis_transcoder.wasm")) / 1000).toFixed(0)} KB`);
console.log(`Chromium ${browser.version()}\n\n| file | KB | first frame, ms | over 20 Mbit/s, ms | loading, ms | textures, MB | at most, MB |\n|---|---|---|---|---|---|---|`);
for (const [name, kind, file] of FILES.filter(([, kind]) => !flag("--only") || flag("--only") === kind)) {
  const runs = [];
  const slow = [];
  for (let k = 0; k < Number(flag("--runs") ?? 5); ++k) {
    runs.push(await measure(kind, file, false));
    slow.push(await measure(kind, file, true));
  }
  const of = (list, what) => Math.round(median(list.map((one) => one[what])));
  console.log(`| ${name} | ${Math.round(statSync(join(work, file)).size / 1000)} | ${of(runs, "milliseconds")} | ${of(slow, "milliseconds")} | ${
    of(runs, "loading")} | ${(runs[0].now / 1e6).toFixed(1)} | ${(runs[0].most / 1e6).toFixed(1)} |`);
}
await browser.close();
server.close();
