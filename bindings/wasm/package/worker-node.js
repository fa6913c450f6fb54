// The worker thread of Node.js: an engine on its parent's messages.
import { readFile } from 'node:fs/promises';
import { parentPort } from 'node:worker_threads';

import { Engine, serve } from './engine.js';

async function load(name) {
  return WebAssembly.compile(await readFile(new URL(`./welkin-${name}.wasm`, import.meta.url)));
}

const answer = serve(new Engine(load), (message, transfer) => parentPort.postMessage(message, transfer));
parentPort.on('message', answer);
