#!/usr/bin/env bash
# Compares welkin-sys/src/bindings.rs with what bindgen writes now: generated_test.sh WORK
set -euo pipefail
PATH="$PATH:$HOME/.cargo/bin"
for program in bindgen rustfmt; do
  command -v "$program" >/dev/null || { echo "skipped: there is no $program"; exit 77; }
done
[[ "$(bindgen --version)" == "bindgen 0.60.1" ]] || { echo "skipped: not the bindgen of Debian 12"; exit 77; }
rust="$(dirname "$0")/../../bindings/rust"
"$rust/generate" "$1/bindings.rs"
diff "$rust/welkin-sys/src/bindings.rs" "$1/bindings.rs" || { echo "run bindings/rust/generate"; exit 1; }
