// A worker thread of the worker thread of Node.js: one of a module's threads.
import { parentPort, workerData } from 'node:worker_threads';

import { runThread } from './threads.js';

runThread(workerData, () => parentPort.postMessage('ready'));
