// Opens the page in Chromium and asks Babylon.js what it makes of our .env files.
//
//   node client.mjs --modules DIR --browser CHROMIUM --welkin WELKIN --work DIR [--shared HDR_DIR] [--screenshot FILE.png]
//
// For every picture: `welkin bake PICTURE.hdr -o DIR --formats env`, balls lit by that .env, the same balls lit by Babylon.js's own
// HDRCubeTexture of the picture (prefilterOnLoad), and how far the two are apart. An .env that is mirrored, turned or
// upside down must be seen to be. Exit code 1 if anything is not as it should be.
import { execFileSync } from "node:child_process";
import { createServer } from "node:http";
import { existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join, normalize, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const flags = process.argv.slice(2);
const flag = (name) => (flags.includes(name) ? flags[flags.indexOf(name) + 1] : undefined);
const here = new URL(".", import.meta.url).pathname;
const modules = resolve(flag("--modules"));
const work = resolve(flag("--work"));
const welkin = flag("--welkin");
const load = (name) => import(pathToFileURL(createRequire(`${modules}/`).resolve(name)).href);
const { chromium } = (await load("playwright-core")).default;
const { build } = (await load("esbuild")).default;

const SIZE = 128; // texels along an edge of a cubemap's face
const PIXELS = 64; // to the square that a ball stands in

// How far apart two pictures of a ball may be: root mean square of the difference over that of Babylon.js's, by roughness
// 0, 0.15, 0.3, 0.5, 0.75, 1 and for the white ball. What is left is Babylon.js's way from the picture to the cube: it takes
// nearest pixels, half a pixel off. That shows where the balls are mirrors, and a small sun comes out some percent
// stronger or weaker on all of them.
const TOLERANCE = [0.16, 0.05, 0.02, 0.015, 0.015, 0.015, 0.015];
const TOLERANCE_WITH_SUN = [0.16, 0.12, 0.15, 0.12, 0.08, 0.06, 0.06];

const TYPES = { html: "text/html", js: "text/javascript" };

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
  const browser = await chromium.launch({
    executablePath: flag("--browser"),
    // No graphics card is asked for: SwiftShader draws, the same everywhere.
    args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
           "--ignore-gpu-blocklist", "--disable-background-networking"],
  });
  const page = await browser.newPage({ viewport: { width: 1024, height: 320 } });
  page.setDefaultTimeout(120_000);
  page.on("pageerror", (error) => console.error(`page: ${error.message}`));
  page.on("console", (message) => { if (message.type() === "error") console.error(`page: ${message.text()}`); });
  await page.goto(`${url}/index.html`);
  await page.waitForFunction("window.client");
  const ask = (name, ...values) => page.evaluate(([n, v]) => window.client[n](...v), [name, values]);
  return { browser, ask };
}

/** For each ball: root mean square of a - b over that of b, all channels, and the ratio of their means. */
function compare(a, b) {
  const balls = a.width / a.height;
  return Array.from({ length: balls }, (_, ball) => {
    let [difference, power, ours, theirs] = [0, 0, 0, 0];
    for (let row = 0; row < a.height; ++row)
      for (let column = ball * a.height; column < (ball + 1) * a.height; ++column) {
        const at = (row * a.width + column) * 4;
        if (a.light[at + 3] === 0) continue;
        for (let channel = at; channel < at + 3; ++channel) {
          difference += (a.light[channel] - b.light[channel]) ** 2;
          power += b.light[channel] ** 2;
          ours += a.light[channel];
          theirs += b.light[channel];
        }
      }
    return { rms: Math.sqrt(difference / power), mean: ours / theirs };
  });
}

const failures = [];
function check(holds, message) {
  if (!holds) failures.push(message);
}

/** Ways to bake an .env that is not the picture's. The first picture goes through all of them. */
const WRONG = [["mirrored", "--mirror"], ["turned", "--yaw", "90"], ["back", "--yaw", "180"], ["overhead", "--rotation", "0,0,1,0"]];

const percent = (value) => `${(100 * value).toFixed(2)} %`;
const within = (balls, tolerance) => balls.every(({ rms }, ball) => rms <= tolerance[ball]);

/** Bakes PICTURE with more options; where the .env is, as the page sees it. */
function bake(picture, folder, ...options) {
  execFileSync(welkin, ["bake", join(work, "files", picture), "-o", join(work, "files", folder), "--formats", "env",
                        "--size", `${SIZE}`, "--no-previews", ...options], { stdio: ["ignore", "ignore", "inherit"] });
  return `/${folder}/environment.env`;
}

function pictures() {
  const files = join(work, "files");
  rmSync(files, { recursive: true, force: true });
  mkdirSync(files, { recursive: true });
  const run = (...words) => execFileSync(welkin, words, { stdio: ["ignore", "ignore", "inherit"] });
  const width = `${8 * SIZE}`; // two by two pixels to a texel of the cube
  run("testmap", "-o", join(files, "labels.hdr"), "--size", width);
  // A computed sky without the sun's disc: Babylon.js takes the nearest pixel, and would miss or double so small a spot.
  run("sky", "--sun-elevation", "40", "--sun-azimuth", "90", "-o", files, "--formats", "hdr", "--size", "1",
      "--background-size", `${2 * SIZE}`, "--picture-height", `${4 * SIZE}`, "--irradiance", "0", "--no-brdf",
      "--no-previews");
  const list = [{ picture: "labels.hdr", tolerance: TOLERANCE },
                { picture: "environment.hdr", tolerance: TOLERANCE }];
  for (const [name, tolerance] of [["venice_sunset_1k.hdr", TOLERANCE_WITH_SUN], ["potsdamer_platz_1k.hdr", TOLERANCE]]) {
    const path = flag("--shared") && join(flag("--shared"), "env", name);
    if (!path || !existsSync(path)) continue;
    run("convert", path, join(files, name), "--size", width);
    list.push({ picture: name, tolerance });
  }
  return list;
}

await build({ entryPoints: [join(here, "page.source.js")], bundle: true, format: "esm", logLevel: "error",
              nodePaths: [join(modules, "node_modules")], outfile: join(work, "page.js") });
const list = pictures();
const server = await serve([work, here, join(work, "files")]);
const { browser, ask } = await openPage(`http://127.0.0.1:${server.address().port}`);
try {
  const about = await ask("about");
  console.log(`Babylon.js ${about.babylon} in ${browser.version()}, ${about.renderer}`);
  for (const { picture, tolerance } of list) {
    const theirs = await ask("measure", { url: `/${picture}`, size: SIZE }, PIXELS);
    const ours = await ask("measure", { url: bake(picture, "straight") }, PIXELS);
    const balls = compare(ours, theirs);
    console.log(`${picture}: difference by roughness ${ours.roughness.join(" ")} and white: ` +
                `${balls.map(({ rms }) => percent(rms)).join("  ")}; means: ${balls.map(({ mean }) => mean.toFixed(4)).join(" ")}`);
    check(within(balls, tolerance), `${picture}: the difference is above ${tolerance.map(percent).join("  ")}`);
    for (const [folder, ...options] of picture === list[0].picture ? WRONG : WRONG.slice(0, 1)) {
      const wrong = compare(await ask("measure", { url: bake(picture, folder, ...options) }, PIXELS), theirs);
      console.log(`  ${folder}: ${wrong.map(({ rms }) => percent(rms)).join("  ")}`);
      check(!within(wrong, tolerance), `${picture}: an .env that is ${folder} is not told from a right one`);
      check(wrong[0].rms > 3 * balls[0].rms, `${picture}: the mirror ball of an .env that is ${folder} looks too much alike`);
    }
  }
  if (flag("--screenshot")) {
    const last = list[list.length - 1].picture;
    const shown = await ask("show", { url: bake(last, "straight") }, { url: `/${last}`, size: SIZE });
    writeFileSync(flag("--screenshot"), Buffer.from(shown.split(",")[1], "base64"));
  }
} finally {
  await browser.close();
  server.close();
}
for (const failure of failures) console.log(`FAILED: ${failure}`);
process.exit(failures.length > 0 ? 1 : 0);
