// Opens the page of `welkin bake --preview html` in Chromium and looks at its pixels.
//
//   node preview.mjs --modules DIR --browser CHROMIUM --welkin WELKIN --work DIR [--shot FILE.png]
//
// The environment is linear in the direction, so that each pixel of the backdrop and of a mirror is known in closed form:
// whether the page shows it the right way round, and what its sliders, the mouse and the comparison do to it. The page may
// ask no network. Exit code 1 if anything is not as it should be.
import { execFileSync } from "node:child_process";
import { mkdirSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const flags = process.argv.slice(2);
const flag = (name) => (flags.includes(name) ? flags[flags.indexOf(name) + 1] : undefined);
const modules = resolve(flag("--modules"));
const folder = join(resolve(flag("--work")), "preview");
const { chromium } = (await import(pathToFileURL(createRequire(`${modules}/`).resolve("playwright-core")).href)).default;

const [WIDTH, HEIGHT] = [480, 320];
const GOLD = [1, 0.766, 0.336];
const ALLOWED = 4; // of 255: a cubemap's interpolation, shared exponents and 8 bits

/** Red grows towards +x, green upwards, blue towards +z: by Welkin's directions. */
const light = ([x, y, z]) => [0.5 + 0.4 * x, 0.5 + 0.4 * y, 0.5 + 0.4 * z];

/** A lat-long by DESIGN: the centre looks along +z, +x lies a quarter in from the left. */
function writeImage(path, height) {
  const pixels = new Float32Array(3 * 2 * height * height);
  for (let row = 0; row < height; ++row)
    for (let column = 0; column < 2 * height; ++column) {
      const [latitude, longitude] = [Math.PI * (0.5 - (row + 0.5) / height), Math.PI * (1 - (column + 0.5) / height)];
      const across = Math.cos(latitude);
      pixels.set(light([Math.sin(longitude) * across, Math.sin(latitude), Math.cos(longitude) * across]),
                 3 * ((height - 1 - row) * 2 * height + column)); // the bottom row comes first
    }
  writeFileSync(path, Buffer.concat([Buffer.from(`PF\n${2 * height} ${height}\n-1.0\n`), Buffer.from(pixels.buffer)]));
}

const plus = (a, b, k = 1) => a.map((value, i) => value + k * b[i]);
const dot = (a, b) => a.reduce((sum, value, i) => sum + value * b[i], 0);
const unit = (v) => v.map((value) => value / Math.hypot(...v));

/** The page's camera where it begins: eye and the ray through a point of the image, in [-1, 1] each. */
const PITCH = 0.05;
const BACK = [0, Math.sin(PITCH), Math.cos(PITCH)];
const UP = [0, Math.cos(PITCH), -Math.sin(PITCH)];
const EYE = BACK.map((value) => 8 * value);
const SLOPE = Math.tan(Math.PI / 8);
const rayThrough = (x, y) => unit(plus(plus([SLOPE * (WIDTH / HEIGHT) * x, 0, 0], UP, SLOPE * y), BACK, -1));

/** Returns the position of a point of the world in the image. */
function pointOf(point) {
  const [right, up, away] = [point[0], dot(point, UP), 8 - dot(point, BACK)];
  return [right / away / (SLOPE * (WIDTH / HEIGHT)), up / away / SLOPE];
}

/** 0 to 255: Narkowicz's curve and sRGB, as all previews. */
const shown = (radiance) => radiance.map((x) => {
  const y = Math.min(1, Math.max(0, (x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14)));
  return 255 * (y <= 0.0031308 ? 12.92 * y : 1.055 * y ** (1 / 2.4) - 0.055);
});

/** What the mirror at `centre` shows of the light along a ray, and how much of it gold reflects where it is looked at. */
function mirrored(ray, centre, radius) {
  const from = plus(EYE, centre, -1);
  const b = dot(from, ray);
  const point = plus(EYE, ray, -b - Math.sqrt(b * b - dot(from, from) + radius * radius));
  const normal = unit(plus(point, centre, -1));
  const grazing = (1 + dot(ray, normal)) ** 5; // Schlick
  return light(plus(ray, normal, -2 * dot(ray, normal))).map((value, i) => value * (GOLD[i] + (1 - GOLD[i]) * grazing));
}

mkdirSync(folder, { recursive: true });
writeImage(join(folder, "picture.pfm"), 128);
execFileSync(flag("--welkin"), ["bake", join(folder, "picture.pfm"), "-o", join(folder, "out"), "--size", "128", "--preview", "html", "-q"]);

const browser = await chromium.launch({ executablePath: flag("--browser"),
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"] });
const failures = [];
const check = (holds, message) => holds || failures.push(message);
try {
  const page = await browser.newPage({ viewport: { width: WIDTH, height: HEIGHT } });
  const asked = [];
  page.on("request", (request) => request.url().startsWith("file:") || asked.push(request.url()));
  page.on("pageerror", (error) => failures.push(`the page: ${error.message}`));
  await page.goto(pathToFileURL(join(folder, "out", "preview.html")).href);

  /** Sets a control as a hand does, waits until it is drawn, and returns all pixels, row 0 below. */
  const rendered = async (id, value) => Buffer.from(await page.evaluate(async ([id, value]) => {
    if (id) {
      document.getElementById(id).value = value;
      document.getElementById(id).dispatchEvent(new Event("input", { bubbles: true }));
    }
    for (let i = 0; i < 3; ++i) await new Promise(requestAnimationFrame);
    const gl = document.querySelector("canvas").getContext("webgl2");
    const bytes = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
    gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    let text = "";
    for (let at = 0; at < bytes.length; at += 8192) text += String.fromCharCode(...bytes.subarray(at, at + 8192));
    return btoa(text);
  }, [id, value]), "base64");
  const pixel = (bytes, [x, y]) => {
    const [column, row] = [Math.floor((x + 1) / 2 * WIDTH), Math.floor((y + 1) / 2 * HEIGHT)];
    return bytes.subarray(4 * (row * WIDTH + column), 4 * (row * WIDTH + column) + 3);
  };
  const off = (bytes, point, wanted) => Math.max(...shown(wanted).map((value, i) => Math.abs(value - pixel(bytes, point)[i])));
  const changed = (a, b) => a.reduce((count, value, at) => count + (value !== b[at]), 0) / a.length;

  const CORNERS = [[-0.97, 0.1], [0.97, 0.1], [-0.9, -0.95], [0.9, -0.95], [0.8, 0.95]];
  const backdrop = (bytes, to, gain = 1) =>
    Math.max(...CORNERS.map((point) => off(bytes, point, light(to(rayThrough(...point))).map((value) => gain * value))));
  const same = (d) => d;
  const plain = await rendered("exposure", 0);
  const rows = { backdrop: backdrop(plain, same) };
  check(backdrop(plain, ([x, y, z]) => [-x, y, z]) > 10 * ALLOWED, "a mirrored backdrop would be taken for a right one");

  // The smoothest metal is the first on the left, a mirror of gold.
  const centre = [-2.85, -0.7, 0];
  const places = [[0, 0], [-0.2, 0], [0.2, 0], [0, 0.2], [0, -0.2]].map(([x, y]) => pointOf(plus(centre, [x, y, 0.3])));
  rows.mirror = Math.max(...places.map((point) => off(plain, point, mirrored(rayThrough(...point), centre, 0.42))));
  const [left, rightOf] = [pixel(plain, places[1]), pixel(plain, places[2])];
  check(rightOf[0] > left[0] + 20, "the mirror does not show on its right what lies on the right");

  rows["exposure -1"] = backdrop(await rendered("exposure", -1), same, 0.5);
  await rendered("exposure", 0);
  rows["rotation 90"] = backdrop(await rendered("rotation", 90), ([x, y, z]) => [-z, y, x]);
  const back = await rendered("rotation", 0);
  check(changed(back, plain) === 0, "a rotation by 0 is not the first picture again");
  rows["rougher backdrop"] = changed(await rendered("backdrop", 3), plain); // a share of bytes
  check(rows["rougher backdrop"] > 0.3, "the backdrop does not change with its mip");
  await rendered("backdrop", -1);
  for (const [id, value, least] of [["roughness", 0.9, 0.005], ["metalness", 0, 0.005], ["compare", 1, 0.01]]) {
    rows[id] = changed(await rendered(id, value), plain);
    check(rows[id] > least, `${id} changes ${rows[id]} of the picture`);
  }
  await page.mouse.move(340, 280);
  await page.mouse.down();
  await page.mouse.move(440, 280, { steps: 4 });
  await page.mouse.up();
  const yaw = -0.6; // 100 pixels at 0.006 radians
  const turned = ([x, y, z]) => [Math.cos(yaw) * x + Math.sin(yaw) * z, y, -Math.sin(yaw) * x + Math.cos(yaw) * z];
  rows["dragged by 100 pixels"] = backdrop(await rendered(), turned);
  if (flag("--shot")) await page.screenshot({ path: flag("--shot") });

  for (const [name, value] of Object.entries(rows)) console.log(`${name}: ${value.toFixed(3)}`);
  for (const name of ["backdrop", "mirror", "exposure -1", "rotation 90", "dragged by 100 pixels"])
    check(rows[name] <= ALLOWED, `${name}: ${rows[name]} of 255 from the closed form`);
  check(asked.length === 0, `the page asked for ${asked.join(" ")}`);
} finally {
  await browser.close();
}
for (const failure of failures) console.error(`FAILED: ${failure}`);
process.exit(failures.length ? 1 : 0);
