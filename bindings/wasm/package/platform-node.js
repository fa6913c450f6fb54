// How a program in Node.js makes a worker.
import { Worker } from 'node:worker_threads';

export function configurePlatform() {}

export function makeWorker(listen, fail) {
  const worker = new Worker(new URL('./worker-node.js', import.meta.url), { name: 'welkin' });
  let busy = false;
  worker.on('message', (message) => {
    if (message.progress === undefined) {
      busy = false;
      worker.unref(); // an idle worker does not keep the program alive
    }
    listen(message);
  });
  worker.on('error', fail);
  worker.unref();
  return {
    post: (message, transfer) => {
      if (!busy) worker.ref();
      busy = true;
      worker.postMessage(message, transfer);
    },
    stop: () => void worker.terminate(),
  };
}
