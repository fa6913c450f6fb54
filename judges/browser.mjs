// Shows a page in Chromium, drawn by SwiftShader, and returns what the page posts to /end.
//
// `folders` maps the first part of an address to a folder on disk; "/" is `page`. What the page posts elsewhere is given
// to `received(name, bytes)`.
import { spawn } from "node:child_process";
import { createReadStream, existsSync, mkdtempSync, rmSync, statSync } from "node:fs";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import { join, normalize } from "node:path";

const TYPES = { js: "text/javascript", mjs: "text/javascript", wasm: "application/wasm", json: "application/json", html: "text/html" };

export async function show(page, folders, received = () => {}, seconds = 240, flags = []) {
  const program = ["/usr/bin/chromium-headless-shell", "/usr/bin/chromium"].find((name) => existsSync(name));
  if (!program) throw new Error("Chromium is not on this machine (Debian: chromium)");
  const profile = mkdtempSync(join(tmpdir(), "welkin-judge-"));
  let browser;
  let finish;
  const ended = new Promise((done, failed) => (finish = { done, failed }));
  const server = createServer(async (request, response) => {
    const name = normalize(decodeURIComponent(new URL(request.url, "http://x").pathname));
    if (request.method === "POST") {
      const parts = [];
      for await (const part of request) parts.push(part);
      response.end();
      const body = Buffer.concat(parts);
      if (name === "/end") return finish.done(JSON.parse(body.toString()));
      if (name === "/trouble") return finish.failed(new Error(body.toString()));
      if (name === "/say") return console.error(body.toString());
      return received(name.slice(1), body);
    }
    if (name === "/") return response.setHeader("content-type", "text/html").end(page);
    const [, first, ...rest] = name.split("/");
    const path = folders[first] && join(folders[first], ...rest);
    if (!path || !existsSync(path) || !statSync(path).isFile()) return response.writeHead(404).end();
    response.setHeader("content-type", TYPES[path.split(".").pop()] ?? "application/octet-stream");
    createReadStream(path).pipe(response);
  });
  await new Promise((done) => server.listen(0, "127.0.0.1", done));
  browser = spawn(program, ["--headless", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist", "--disable-background-networking", "--enable-unsafe-webgpu", ...flags, `--user-data-dir=${profile}`,
    "--remote-debugging-port=0", `http://127.0.0.1:${server.address().port}/`], { stdio: "ignore" });
  browser.on("exit", () => finish.failed(new Error("Chromium ended")));
  const clock = setTimeout(() => finish.failed(new Error(`nothing in ${seconds} s`)), 1000 * seconds);
  try {
    return await ended;
  } finally {
    clearTimeout(clock);
    browser.removeAllListeners("exit");
    browser.kill("SIGKILL");
    server.close();
    server.closeAllConnections();
    await new Promise((done) => setTimeout(done, 300));
    try {
      rmSync(profile, { recursive: true, force: true, maxRetries: 20 });
    } catch { } // a process of Chromium's still writes there
  }
}

/** A page whose module reports what it throws. */
export const pageOf = (script, head = "") => `<!doctype html><meta charset="utf-8">${head}
<script type="module">
const post = (path, body) => fetch(path, { method: "POST", body });
const say = (text) => post("/say", String(text));
addEventListener("error", (event) => post("/trouble", event.message + " " + (event.error?.stack ?? event.error?.message ?? "")));
addEventListener("unhandledrejection", (event) => post("/trouble", String(event.reason?.stack ?? event.reason)));
${script}
</script>`;
