// The Web Worker: an engine on the page's messages. The modules' addresses are spelled out, so that bundlers find them.
import { Engine, serve } from './engine.js';

const ADDRESSES = {
  threads: new URL('./welkin-threads.wasm', import.meta.url),
  project: new URL('./welkin-project.wasm', import.meta.url),
  prefilter: new URL('./welkin-prefilter.wasm', import.meta.url),
  sky: new URL('./welkin-sky.wasm', import.meta.url),
  environment: new URL('./welkin-environment.wasm', import.meta.url),
  codecs: new URL('./welkin-codecs.wasm', import.meta.url),
  textures: new URL('./welkin-textures.wasm', import.meta.url),
};

async function load(name) {
  const response = await fetch(ADDRESSES[name]);
  if (!response.ok) throw new Error(`${ADDRESSES[name]} could not be loaded: ${response.status}`);
  // Servers that do not know the type of .wasm keep it from being compiled while it arrives.
  if (response.headers.get('content-type')?.startsWith('application/wasm')) {
    return WebAssembly.compileStreaming(response);
  }
  return WebAssembly.compile(await response.arrayBuffer());
}

/** As platform-browser.js makes this worker: from another origin by a script that imports it. */
function newThread() {
  if (new URL(import.meta.url).origin === self.origin) {
    return new Worker(new URL('./thread.js', import.meta.url), { type: 'module', name: 'welkin thread' });
  }
  const code = `import ${JSON.stringify(new URL('./thread.js', import.meta.url).href)};`;
  return new Worker(URL.createObjectURL(new Blob([code], { type: 'text/javascript' })), { type: 'module', name: 'welkin thread' });
}

function makeThread(data) {
  return new Promise((resolve, reject) => {
    const thread = newThread();
    thread.onmessage = () => resolve(thread);
    thread.onerror = (event) => reject(new Error(event.message || 'a thread could not be loaded'));
    thread.postMessage(data);
  });
}

const answer = serve(new Engine(load, self.crossOriginIsolated ? makeThread : null), (message, transfer) => self.postMessage(message, transfer));
self.onmessage = (event) => answer(event.data);
