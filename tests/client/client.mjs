// Opens a page in Chromium and asks an engine what it makes of our files.
//
//   node client.mjs --engine babylon|playcanvas|three --modules DIR --browser CHROMIUM --welkin WELKIN --work DIR
//                   [--shared HDR_DIR] [--most IMAGES] [--all-wrong] [--figure FILE.png [--figure-of IMAGE.hdr]] [--record]
//                   [--spheres FOLDER [--figure-of IMAGE.hdr]]
//
// Draws, for every image, spheres that the files of `welkin bake IMAGE.hdr -o DIR ...` light, the same spheres lit by the
// engine's own prefilter of the image, and the same lit by cubemaps that hold each sphere's own roughness (the reference).
// Prints how far they differ, and checks that against the bounds. The check must also fail for a mirrored file; with
// --all-wrong, for the first image, also for rotated files and for files with other mips. three.js must not prefilter our
// files. Exit code 1 if a check fails. If WELKIN_RANDOM_TRIALS is set, --most is no limit.
import { execFileSync } from "node:child_process";
import { createServer } from "node:http";
import { existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join, normalize, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { SPHERES } from "./spheres.js";
import { compare, percent, tableRow, within } from "./compare.mjs";
import { errorOfTruth } from "./direct.mjs";
import { ENGINES, IMAGE_WIDTH, SIZE, TRUTH } from "./engines.mjs";

const flags = process.argv.slice(2);
const flag = (name) => (flags.includes(name) ? flags[flags.indexOf(name) + 1] : undefined);
const here = new URL(".", import.meta.url).pathname;
const modules = resolve(flag("--modules"));
const work = resolve(flag("--work"));
const files = join(work, "files");
const engine = ENGINES[flag("--engine")];
const load = (name) => import(pathToFileURL(createRequire(`${modules}/`).resolve(name)).href);
const { chromium } = (await load("playwright-core")).default;
const { build } = (await load("esbuild")).default;
const ktx = await load("ktx-parse");

const PIXELS = 64; // to the square that a sphere stands in
const FIGURE_PIXELS = 104;
const FIGURE_GAIN = 4; // of the differences in the figure's last row
const BOUNDS_GAIN = 64; // the same of two error bounds

const TYPES = { html: "text/html", js: "text/javascript", wasm: "application/wasm" };

/** The page and the files under `folders`, on the loopback interface alone. */
function serve(folders) {
  const answer = (request, response) => {
    const name = normalize(decodeURIComponent(new URL(request.url, "http://x").pathname));
    const path = folders.map((folder) => join(folder, name)).find((candidate) => existsSync(candidate));
    if (!path) return response.writeHead(404).end();
    response.writeHead(200, { "content-type": TYPES[path.split(".").pop()] ?? "application/octet-stream" });
    response.end(readFileSync(path));
  };
  return new Promise((ready) => {
    const server = createServer(answer).listen(0, "127.0.0.1", () => ready(server));
  });
}

async function openPage(url) {
  const launch = () => chromium.launch({
    executablePath: flag("--browser"),
    // SwiftShader draws on the CPU, the same on every machine.
    args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
           "--ignore-gpu-blocklist", "--disable-background-networking"],
  });
  const open = async (browser) => {
    const page = await browser.newPage({ viewport: { width: 1024, height: 320 } });
    page.setDefaultTimeout(120_000);
    page.on("pageerror", (error) => console.error(`page: ${error.message}`));
    page.on("console", (message) => { if (message.type() === "error") console.error(`page: ${message.text()}`); });
    await page.goto(`${url}/index.html`);
    await page.waitForFunction("window.client");
    return page;
  };
  const browser = await launch();
  const ask = async (page, name, ...values) => page.evaluate(([n, v]) => window.client[n](...v), [name, values]);
  if (!engine.freshBrowser) {
    const page = await open(browser);
    return { browser, ask: (...words) => ask(page, ...words) };
  }
  const askAnew = async (...words) => {
    const another = await launch();
    try {
      return await ask(await open(another), ...words);
    } finally {
      await another.close();
    }
  };
  return { browser, ask: askAnew };
}

const run = (...words) => execFileSync(flag("--welkin"), words, { stdio: ["ignore", "ignore", "inherit"] });

/** Bakes `image` into a folder; returns where its specular chain is, as the page sees it. */
function bake(image, folder, of, ...options) {
  // Only an .env has diffuse light in addition to its chain.
  run("bake", join(files, image), "-o", join(files, folder), ...(of.endsWith(".env") ? [] : ["--irradiance", "0"]),
      "--no-brdf", "--no-previews", "--background-size", "16", ...(options.includes("--size") ? [] : ["--size", `${SIZE}`]), ...options);
  return `/${folder}/${of}`;
}

const ours = (image, { name, kind, of, options }, ...more) =>
  ({ kind, url: bake(image, name, of, ...options, ...more) });

/**
 * For each sphere a cubemap of floats whose mip 0 has the sphere's own roughness. Mip 1 has roughness 1, whose lobe is the
 * cosine's: diffuse light, for three.js. Babylon.js is given that as a cubemap of its own.
 */
function truth(image) {
  const { of, options } = engine.truth;
  const exact = [...options, "--ktx2-format", "rgba32f", "--size", `${TRUTH}`, "--roughness"];
  const wanted = SPHERES.map(({ roughness }) => engine.roughness(roughness));
  const chainOf = (roughness) =>
    bake(image, `truth-${roughness}`, of, ...exact, roughness < 1 ? `${roughness},1` : "1");
  const chains = new Map([...new Set(wanted)].map((roughness) => [roughness, chainOf(roughness)]));
  if (engine.direct) checkTruth(image, chains);
  return { kind: "truth", urls: wanted.map((roughness) => chains.get(roughness)), irradiance: chains.get(1) };
}

function checkTruth(image, chains) {
  const pfm = join(files, "picture.pfm");
  run("convert", join(files, image), pfm, "--size", `${IMAGE_WIDTH}`);
  for (const roughness of engine.direct.roughness) {
    const error = errorOfTruth(ktx.read(readFileSync(join(files, chains.get(roughness)))), pfm, roughness);
    console.log(`${image}: the truth of roughness ${roughness} is ${error.toExponential(1)} from a sum over the picture's pixels`);
    check(error <= engine.direct.allowed, `${image}: the truth of roughness ${roughness} is not true`);
  }
}

function images() {
  rmSync(files, { recursive: true, force: true });
  mkdirSync(files, { recursive: true });
  run("testmap", "-o", join(files, "testmap.hdr"), "--size", `${IMAGE_WIDTH}`);
  const list = ["testmap.hdr"];
  for (const name of ["potsdamer_platz_1k.hdr", "venice_sunset_1k.hdr"]) {
    const path = flag("--shared") && join(flag("--shared"), "env", name);
    if (!path || !existsSync(path)) continue;
    run("convert", path, join(files, name), "--size", `${IMAGE_WIDTH}`);
    list.push(name);
  }
  return process.env.WELKIN_RANDOM_TRIALS ? list : list.slice(0, flag("--most") ?? list.length);
}

const failures = [];
function check(holds, message) {
  if (!holds) failures.push(message);
}

// The last measurements by engine, image and row; --record writes them again. An error may be 1.5 times its measurement
// plus a thousandth, which leaves a margin for other versions of Chromium.
const RECORD = join(here, "measured.json");
const measured = existsSync(RECORD) ? JSON.parse(readFileSync(RECORD, "utf8")) : {};
const found = {};
const allowed = (image, name) => measured[flag("--engine")]?.[image]?.[name]?.map((error) => 1.5 * error + 0.001);

function checkRow(image, name, spheres) {
  console.log(tableRow(`${image}, ${name}`, spheres));
  (found[image] ??= {})[name] = spheres.map((error) => Number(error.toPrecision(3)));
  if (flags.includes("--record")) return;
  const bounds = allowed(image, name);
  check(bounds && within(spheres, bounds), `${image}, ${name}: more than ${bounds?.map(percent).join("  ")}`);
}

function checkFrame(name, { frame }, isOurs) {
  if (!engine.checkFrame) return;
  console.log(`${name}: a first frame in ${frame.passes} passes, ${frame.draws} draws, ` +
              `prefilter's shaders: ${frame.prefilters.join(" ") || "none"}`);
  check(engine.checkFrame(frame, isOurs), `${name}: the first frame ${isOurs ? "prefilters" : "does not prefilter"}`);
}

async function judge(ask, image, isFirst) {
  const exact = await ask("measure", truth(image), PIXELS);
  const theirs = await ask("measure", { kind: "picture", url: `/${image}`, size: SIZE }, PIXELS);
  checkFrame(`${image}, theirs`, theirs, false);
  checkRow(image, "theirs - truth", compare(theirs, exact));
  for (const file of engine.files) {
    const made = await ask("measure", ours(image, file), PIXELS);
    checkFrame(`${image}, ${file.name}`, made, true);
    checkRow(image, `${file.name} - truth`, compare(made, exact));
    checkRow(image, `${file.name} - theirs`, compare(made, theirs));
    for (const [how, ...options] of isFirst && flags.includes("--all-wrong") ? file.wrong : file.wrong.slice(0, 1)) {
      const wrong = compare(await ask("measure", ours(image, file, ...options), PIXELS), exact);
      console.log(tableRow(`${image}, ${file.name} ${how}`, wrong));
      check(!within(wrong, allowed(image, `${file.name} - truth`) ?? [0]),
            `${image}: ${file.name} ${how} is not told from a right one`);
    }
  }
}

const writePng = (path, dataUrl) => writeFileSync(path, Buffer.from(dataUrl.split(",")[1], "base64"));

/**
 * Draws two images in the folder of --spheres: a chain within 1 % above one within 0.01 %, and a chain above spheres that are
 * integrated directly, in all pixels. Below both, the difference.
 */
async function drawSpheres(ask, image) {
  const halves = engine.files.find(({ kind }) => kind === "ktx2");
  const [loose, tight] = ["1e-2", "1e-4"].map((bound) =>
    ours(image, { ...halves, name: `bound-${bound}` }, "--rms-error", bound));
  writePng(join(flag("--spheres"), "spheres_bounds.png"), await ask("figure", loose, tight, FIGURE_PIXELS, BOUNDS_GAIN));
  run("convert", join(files, image), join(files, "picture.pfm"), "--size", `${IMAGE_WIDTH}`);
  const chain = ours(image, halves);
  const direct = { kind: "direct", picture: "/picture.pfm", like: chain };
  writePng(join(flag("--spheres"), "spheres_direct.png"), await ask("figure", chain, direct, PIXELS, FIGURE_GAIN));
  const [read, integrated] = [await ask("measure", chain, PIXELS), await ask("measure", direct, PIXELS)];
  console.log(tableRow(`${image}, ${halves.name} - directly integrated spheres`, compare(read, integrated)));
}

await build({ entryPoints: [join(here, `${flag("--engine")}.source.js`)], bundle: true, format: "esm", logLevel: "error",
              nodePaths: [join(modules, "node_modules")], outfile: join(work, "page.js") });
const list = images();
const basis = join(modules, "node_modules/three/examples/jsm/libs"); // has basis/, the transcoder
const server = await serve([work, here, files, basis]);
const { browser, ask } = await openPage(`http://127.0.0.1:${server.address().port}`);
try {
  console.log(`${await ask("about")}, in Chromium ${browser.version()}`);
  console.log(`| | ${SPHERES.map(({ name }) => name).join(" | ")} |`);
  for (const image of flags.includes("--spheres") ? [] : list) await judge(ask, image, image === list[0]);
  if (flag("--spheres")) await drawSpheres(ask, flag("--figure-of") ?? list[list.length - 1]);
  if (flag("--figure")) {
    const image = flag("--figure-of") ?? list[list.length - 1];
    const theirs = { kind: "picture", url: `/${image}`, size: SIZE };
    const drawn = await ask("figure", ours(image, engine.files[0]), theirs, FIGURE_PIXELS, FIGURE_GAIN);
    writePng(flag("--figure"), drawn);
  }
} finally {
  await browser.close();
  server.close();
}
if (flags.includes("--record")) {
  const text = JSON.stringify({ ...measured, [flag("--engine")]: found }, null, 1);
  writeFileSync(RECORD, `${text.replace(/\n\s+(?=[\d\]])/g, " ")}\n`); // a row of numbers in a line
}
for (const failure of failures) console.log(`FAILED: ${failure}`);
process.exit(failures.length > 0 ? 1 : 0);
