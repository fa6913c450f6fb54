// How a browser's page makes a worker. Bundlers know this form and bring the worker and its modules along.

/** The folder that holds the worker and the modules, where `configure` named one. */
let folder = null;

export function configurePlatform({ path }) {
  if (path !== undefined) folder = path === null ? null : new URL(path, globalThis.location?.href).href.replace(/\/?$/, '/');
}

/** `{ post, stop }`; `listen` gets each message, `fail` an error of the worker itself. */
export function makeWorker(listen, fail) {
  const worker = folder === null
    ? new Worker(new URL('./worker.js', import.meta.url), { type: 'module', name: 'welkin' })
    : workerOf(folder);
  worker.onmessage = (event) => listen(event.data);
  worker.onerror = (event) => fail(new Error(event.message || 'the worker could not be loaded'));
  return {
    post: (message, transfer) => worker.postMessage(message, transfer),
    stop: () => worker.terminate(),
  };
}

/** A page of one origin cannot run a worker from another, but a worker of its own may import from there. */
function workerOf(base) {
  const code = `import ${JSON.stringify(`${base}worker.js`)};`;
  const address = URL.createObjectURL(new Blob([code], { type: 'text/javascript' }));
  return new Worker(address, { type: 'module', name: 'welkin' });
}
