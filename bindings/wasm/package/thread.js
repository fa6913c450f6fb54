// A worker of the Web Worker: one of a module's threads.
import { runThread } from './threads.js';

self.onmessage = ({ data }) => runThread(data, () => self.postMessage('ready'));
