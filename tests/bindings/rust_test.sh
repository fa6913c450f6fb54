#!/usr/bin/env bash
# Tests the crate with an installed library: rust_test.sh BUILD WORK
set -euo pipefail
PATH="$PATH:$HOME/.cargo/bin"
for program in cargo pkg-config; do
  command -v "$program" >/dev/null || { echo "skipped: there is no $program"; exit 77; }
done
rm -rf "$2/installed"
cmake --install "$1" --prefix "$2/installed" --component library >/dev/null
folder="$(dirname "$(find "$2/installed" -name welkin.pc)")"
export PKG_CONFIG_PATH="$folder" LD_LIBRARY_PATH="$(dirname "$folder")" CARGO_TARGET_DIR="$2/target"
unset WELKIN_SOURCE
cd "$(dirname "$0")/../../bindings/rust"
cargo test --offline --locked
cargo test --offline --locked --features welkin-sys/files
