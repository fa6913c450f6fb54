// `welkin bake` by WebAssembly, for machines without a program of their own: one thread, and the options below.
import { mkdir, readFile, writeFile } from 'node:fs/promises';
import { basename, extname, join } from 'node:path';
import { parseArgs } from 'node:util';
import { bakeEnvironment, dispose, sky, WelkinError } from 'welkin-wasm';

const HELP = `Usage: welkin bake [INPUT | --sky] [-o DIR] [OPTIONS]

There is no program for this machine, so WebAssembly does the work: one thread, and fewer options.

  INPUT                    An OpenEXR, Radiance .hdr, PFM, PNG, KTX2, DDS or Babylon.js .env file
  --sky                    A computed sky instead of a file
  --sun-elevation DEGREES  The sky's sun, default 40
  -o,--output DIR          The folder to write to, created if necessary (default the input's name, or sky)
  --size N                 Texels per edge of the specular cubemap (default 256)
  --rms-error X            Bound on a mip's relative rms error (default 1e-3)
  --bands N                Bands of the spherical harmonics (default 3)
  --for three|babylon      Write what this engine loads

Written: specular.ktx2, sh.json, and environment.env with --for babylon.
Exit codes: 0 done; 1 a bad file; 2 a bad command line.
`;

const OPTIONS = {
  sky: { type: 'boolean' },
  'sun-elevation': { type: 'string' },
  output: { type: 'string', short: 'o' },
  size: { type: 'string' },
  'rms-error': { type: 'string' },
  bands: { type: 'string' },
  for: { type: 'string' },
  quiet: { type: 'boolean', short: 'q' },
  help: { type: 'boolean', short: 'h' },
};

class UsageError extends Error {}

function numberOf(values, name) {
  if (values[name] === undefined) return undefined;
  const value = Number(values[name]);
  if (values[name].trim() === '' || !Number.isFinite(value)) throw new UsageError(`--${name} is "${values[name]}", no number`);
  return value;
}

/** The command line as what to bake, where to, and options of welkin-wasm. */
function request(words) {
  const [command, ...rest] = words;
  if (command !== 'bake') throw new UsageError(`there is no "${command}" without a program for this machine, only "bake"`);
  let parsed;
  try {
    parsed = parseArgs({ args: rest, options: OPTIONS, allowPositionals: true });
  } catch (error) {
    throw new UsageError(error.message);
  }
  const { values, positionals } = parsed;
  if (values.help) return { help: true };
  if (positionals.length + (values.sky ? 1 : 0) !== 1) throw new UsageError('bake takes one INPUT, or --sky');
  if (values.for !== undefined && !['three', 'babylon'].includes(values.for)) {
    throw new UsageError(`--for is "${values.for}"; without a program for this machine it may be three or babylon`);
  }
  const [input] = positionals;
  const options = { size: numberOf(values, 'size'), rmsError: numberOf(values, 'rms-error'), bands: numberOf(values, 'bands'),
    for: values.for, ktx2: true, env: values.for === 'babylon' ? true : undefined };
  for (const name of Object.keys(options)) if (options[name] === undefined) delete options[name];
  if (values.sky) options.sunElevation = numberOf(values, 'sun-elevation') ?? 40;
  else if (values['sun-elevation'] !== undefined) throw new UsageError('--sun-elevation belongs to --sky');
  return { input, folder: values.output ?? (input ? basename(input, extname(input)) : 'sky'), quiet: values.quiet, options };
}

async function bake({ input, folder, quiet, options }) {
  const bar = process.stderr.isTTY && !quiet;
  if (bar) options.onProgress = (share) => process.stderr.write(`\r  ${Math.round(100 * share)} %`);
  const light = input === undefined ? await sky({ ...options, tables: 'full' })
    : await bakeEnvironment(await readFile(input), { ...options, name: input });
  if (bar) process.stderr.write('\r\x1b[K');
  await mkdir(folder, { recursive: true });
  const files = { 'specular.ktx2': light.ktx2,
    'sh.json': JSON.stringify({ bands: light.bands, radiance: [...light.radiance], babylon: light.polynomial, sun: light.sun }) };
  if (light.env) files['environment.env'] = light.env;
  for (const [name, bytes] of Object.entries(files)) {
    await writeFile(join(folder, name), bytes);
    if (!quiet) console.log(join(folder, name));
  }
}

/** Does what the words say; returns the exit code. */
export async function run(words) {
  try {
    if (words.length === 0 || ['-h', '--help', 'help'].includes(words[0])) {
      console.log(HELP);
      return words.length === 0 ? 2 : 0;
    }
    const what = request(words);
    if (what.help) console.log(HELP);
    else await bake(what);
    return 0;
  } catch (error) {
    console.error(`welkin: ${error.message}`);
    if (error instanceof UsageError || (error instanceof WelkinError && error.code === 'invalid_argument')) return 2;
    if (error instanceof WelkinError || error.code) return 1;
    throw error;
  } finally {
    dispose();
  }
}
