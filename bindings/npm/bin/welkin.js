#!/usr/bin/env node
// The command of this machine's package, or WebAssembly where there is none (WELKIN_WASM=1 forces it).
import { spawn } from 'node:child_process';
import { createRequire } from 'node:module';
import process from 'node:process';

const SIGNALS = ['SIGINT', 'SIGTERM', 'SIGHUP'];

/** The path of this platform's program, or null. A package manager installs only the package that suits its machine. */
function nativeProgram() {
  const suffix = process.platform === 'win32' ? '.exe' : '';
  try {
    return createRequire(import.meta.url).resolve(`@welkin/${process.platform}-${process.arch}/bin/welkin${suffix}`);
  } catch {
    return null;
  }
}

/** Runs the program in this one's place: same streams, signals passed on, same exit code. */
function become(program, words) {
  const child = spawn(program, words, { stdio: 'inherit' });
  for (const signal of SIGNALS) process.on(signal, () => child.kill(signal));
  child.on('error', (error) => {
    console.error(`welkin: ${program} does not start: ${error.message}`);
    process.exitCode = 1;
  });
  child.on('exit', (code, signal) => {
    for (const name of SIGNALS) process.removeAllListeners(name);
    if (signal) process.kill(process.pid, signal);
    else process.exitCode = code;
  });
}

const words = process.argv.slice(2);
const program = process.env.WELKIN_WASM ? null : nativeProgram();
if (program) become(program, words);
else process.exitCode = await (await import('./webassembly.js')).run(words);
