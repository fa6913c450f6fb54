// Debian's Chromium without a screen, driven by playwright-core.
import { existsSync, mkdtempSync } from 'node:fs';
import os from 'node:os';
import path from 'node:path';

import { companion } from '../support.mjs';

export const chromium = ['/usr/bin/chromium-headless-shell', '/usr/bin/chromium'].find((name) => existsSync(name));

export async function openBrowser() {
  const { default: playwright } = await companion('playwright-core/index.mjs');
  const profile = mkdtempSync(path.join(os.tmpdir(), 'welkin-wasm-'));
  return playwright.chromium.launchPersistentContext(profile, {
    executablePath: chromium,
    headless: true,
    viewport: { width: 960, height: 540 },
    args: ['--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking',
      '--disable-component-update', '--disable-sync', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
      '--ignore-gpu-blocklist'],
  });
}
