// node build.mjs MODULES OUT: bundles the package for a plain script tag with MODULES' esbuild.
import { createRequire } from 'node:module';
import path from 'node:path';
import { fileURLToPath } from 'node:url';

const [modules, out] = process.argv.slice(2).map((name) => path.resolve(name));
const here = path.dirname(fileURLToPath(import.meta.url));
const { build } = createRequire(`${modules}/package.json`)('esbuild');
await build({
  entryPoints: [path.join(here, 'welkin.js')],
  outfile: out,
  bundle: true,
  minify: true,
  format: 'iife',
  globalName: 'welkin',
  target: 'es2022',
  logLevel: 'warning',
  plugins: [{
    name: 'platform',
    setup: (one) => one.onResolve({ filter: /^#platform$/ }, () => ({ path: path.join(here, 'platform-script.js') })),
  }],
});
