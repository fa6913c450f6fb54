#!/bin/sh
# Asks the real npm packages again and compares with what is recorded of them.
#   live_test.sh RECORDER_DIR DATA_FILE WORK_DIR [PROGRAM ARGUMENTS...]
# RECORDER_DIR holds PROGRAM (record.mjs) and the package.json with the pinned packages, which are installed into WORK_DIR (once,
# 10 seconds; minutes where disks and processors are busy). Exit code 77, for ctest to call it skipped, where Node.js
# or the packages cannot be had.
set -eu
here=$1
data=$2
work=$3
shift 3
[ $# -gt 0 ] || set -- record.mjs

skip() {
  echo "SKIPPED: $1"
  exit 77
}

command -v node >/dev/null || skip "node is not installed"
command -v npm >/dev/null || skip "npm is not installed"

mkdir -p "$work"
cp "$here/package.json" "$here/.npmrc" "$work/"
# npm writes .package-lock.json last, so that an interrupted install does not pass for one.
if ! cmp -s "$here/package-lock.json" "$work/package-lock.json" || ! [ -e "$work/node_modules/.package-lock.json" ]; then
  cp "$here/package-lock.json" "$work/"
  installed=no
  for _ in first second; do
    if (cd "$work" && timeout --kill-after=10 150 npm ci --prefer-offline --fetch-retries=1 --fetch-timeout=15000 >npm.log 2>&1); then
      installed=yes
      break
    fi
    # A package that is not the one that was locked is a failure; a registry out of reach is not ours.
    if grep -Eq 'EINTEGRITY|EUSAGE' "$work/npm.log"; then
      cat "$work/npm.log"
      exit 1
    fi
  done
  if [ "$installed" = no ]; then
    cat "$work/npm.log"
    rm -f "$work/package-lock.json"
    skip "npm could not install the packages (its words are above)"
  fi
fi

program=$1
shift
node "$here/$program" --modules "$work" --check "$data" "$@"
