// Makes the worker of a page with a plain script tag, whose files are in folders next to the script's.
let folder = new URL('../', document.currentScript.src).href;

export function configurePlatform({ path }) {
  if (path) folder = new URL(path, location.href).href.replace(/\/?$/, '/');
}

export function makeWorker(listen, fail) {
  const address = `${folder}worker.js`;
  // A page of one origin cannot run a worker from another, but a worker of its own may import from there.
  const from = new URL(address).origin === location.origin ? address
    : URL.createObjectURL(new Blob([`import ${JSON.stringify(address)};`], { type: 'text/javascript' }));
  const worker = new Worker(from, { type: 'module', name: 'welkin' });
  worker.onmessage = (event) => listen(event.data);
  worker.onerror = (event) => fail(new Error(event.message || 'the worker could not be loaded'));
  return {
    post: (message, transfer) => worker.postMessage(message, transfer),
    stop: () => worker.terminate(),
  };
}
