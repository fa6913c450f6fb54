#!/bin/sh
# `welkin report` has three.js and Babylon.js prefilter in Chromium: checks that their chains come in Welkin's axes.
#   webgl_live.sh WELKIN MODULES_DIR WORK_DIR PLOT_REPORT
# Exit code 77, for ctest to call it skipped, where there is no Chromium, Node.js or packages.
set -eu
welkin=$1
modules=$2
work=$3
plot=$4

command -v node >/dev/null || { echo "SKIPPED: node is not installed"; exit 77; }
command -v chromium-headless-shell >/dev/null || command -v chromium >/dev/null ||
  { echo "SKIPPED: Chromium is not installed"; exit 77; }
[ -d "$modules/node_modules/three" ] || { echo "SKIPPED: $modules has no packages"; exit 77; }

mkdir -p "$work"
"$welkin" report --quick --passes lookups --node-modules "$modules" --json "$work/webgl.json" >/dev/null
# Read in other axes, a chain errs by half of its light and more.
node - "$work/webgl.json" <<'SCRIPT'
const found = JSON.parse(require("node:fs").readFileSync(process.argv[2], "utf8")).measurements;
for (const peer of ["three.js", "Babylon.js"]) {
  const one = found.find((other) => other.peer?.startsWith(peer));
  const allowed = 2 * Math.max(...found.filter((other) => other.peer === null).map((other) => other.error_rms));
  console.log(`${peer}: ${one?.error_rms}, allowed ${allowed}`);
  if (!(one?.error_rms < allowed) || one.seconds !== null) { console.log("FAILED"); process.exit(1); }
}
SCRIPT
"$plot" "$work/webgl.json" "$work"
[ "$(grep -o 'not timed</text>' "$work/lookups.svg" | wc -l)" -ge 1 ] || { echo "FAILED: no line for them"; exit 1; }
