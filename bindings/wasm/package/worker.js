// The Web Worker: an engine on the page's messages. The modules' addresses are spelled out, so that bundlers find them.
import { Engine, serve } from './engine.js';

const ADDRESSES = {
  project: new URL('./welkin-project.wasm', import.meta.url),
  prefilter: new URL('./welkin-prefilter.wasm', import.meta.url),
  environment: new URL('./welkin-environment.wasm', import.meta.url),
  codecs: new URL('./welkin-codecs.wasm', import.meta.url),
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

const answer = serve(new Engine(load), (message, transfer) => self.postMessage(message, transfer));
self.onmessage = (event) => answer(event.data);
