#!/bin/sh
# Real clients of our files: Babylon.js, PlayCanvas and three.js in Debian's Chromium, without a screen.
#   client_test.sh CLIENT_DIR WELKIN SHARED_HDR_DIR WORK_DIR --engine babylon|playcanvas|three [MORE ARGUMENTS OF client.mjs]
#   client_test.sh CLIENT_DIR WELKIN SHARED_HDR_DIR WORK_DIR preview.mjs|ultra_hdr.mjs [MORE ARGUMENTS]
# CLIENT_DIR holds client.mjs and the package.json with the pinned packages, which are installed into WORK_DIR (once).
# Chromium is installed with apt-get where it is missing and that may be done. Exit code 77, for ctest to call it skipped,
# where Node.js, the packages or Chromium cannot be had.
set -eu
here=$1
welkin=$2
shared=$3
work=$4
shift 4

skip() {
  echo "SKIPPED: $1"
  exit 77
}

command -v node >/dev/null || skip "node is not installed"
command -v npm >/dev/null || skip "npm is not installed"

# The headless shell is a third of the whole browser, and draws the same.
browser=
find_browser() {
  for name in chromium-headless-shell chromium; do
    if command -v "$name" >/dev/null; then
      browser=$(command -v "$name")
      return 0
    fi
  done
  return 1
}
install_browser() {
  command -v apt-get >/dev/null || return 1
  as_root=
  if [ "$(id -u)" != 0 ]; then
    as_root="sudo -n"
    $as_root true 2>/dev/null || return 1
  fi
  get="env DEBIAN_FRONTEND=noninteractive timeout 240 apt-get -q -y"
  $as_root $get install --no-install-recommends chromium-headless-shell ||
    { $as_root $get update && $as_root $get install --no-install-recommends chromium-headless-shell; }
}

mkdir -p "$work"
if ! find_browser; then
  install_browser >"$work/apt.log" 2>&1 </dev/null || { tail -n 3 "$work/apt.log"; skip "Chromium is not there and cannot be installed"; }
  find_browser || skip "Chromium is not where Debian's package puts it"
fi

cp "$here/package.json" "$here/.npmrc" "$work/"
# npm writes .package-lock.json last, so that an interrupted install does not pass for one.
if ! cmp -s "$here/package-lock.json" "$work/package-lock.json" || ! [ -e "$work/node_modules/.package-lock.json" ]; then
  cp "$here/package-lock.json" "$work/"
  if ! (cd "$work" && timeout 120 npm ci --prefer-offline --ignore-scripts --fetch-retries=1 --fetch-timeout=30000 >npm.log 2>&1); then
    cat "$work/npm.log"
    # A package that is not the one that was locked is a failure; a registry out of reach is not ours.
    if grep -Eq 'EINTEGRITY|EUSAGE' "$work/npm.log"; then exit 1; fi
    rm -f "$work/package-lock.json"
    skip "npm could not install the packages (its words are above)"
  fi
fi

script=client.mjs
case ${1-} in
  *.mjs)
    script=$1
    shift
    ;;
esac
exec node "$here/$script" --modules "$work" --browser "$browser" --welkin "$welkin" --work "$work" --shared "$shared" "$@"
