// Where the package and its companions lie.
import path from 'node:path';

export const build = path.resolve(process.env.WELKIN_WASM_BUILD ?? 'build/wasm');
export const packageFolder = path.join(build, 'welkin-wasm');
export const modules = path.join(build, 'tests');
export const source = path.resolve(import.meta.dirname, '../../..');
