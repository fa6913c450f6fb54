// The worker thread of Node.js: an engine on its parent's messages.
import { readFile } from 'node:fs/promises';
import { parentPort, Worker } from 'node:worker_threads';

import { Engine, serve } from './engine.js';

async function load(name) {
  return WebAssembly.compile(await readFile(new URL(`./welkin-${name}.wasm`, import.meta.url)));
}

function makeThread(data) {
  return new Promise((resolve, reject) => {
    const thread = new Worker(new URL('./thread-node.js', import.meta.url), { workerData: data, name: 'welkin thread' });
    thread.once('message', () => resolve(thread));
    thread.once('error', reject);
  });
}

const answer = serve(new Engine(load, makeThread), (message, transfer) => parentPort.postMessage(message, transfer));
parentPort.on('message', answer);
