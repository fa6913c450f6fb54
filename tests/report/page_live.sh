#!/bin/sh
# The report's page in a real browser: its script runs, every point has its words, nothing is asked of a network.
#   page_live.sh WELKIN WORK_DIR
# Exit code 77, for ctest to call it skipped, where there is no Chromium.
set -eu
welkin=$1
work=$2

for name in chromium-headless-shell chromium; do
  if command -v "$name" >/dev/null; then browser=$name; break; fi
done
if [ -z "${browser-}" ]; then
  echo "SKIPPED: Chromium is not installed"
  exit 77
fi

mkdir -p "$work"
"$welkin" report --scale tiny --no-peers --passes irradiance,brdf -o "$work/page.html" --json "$work/page.json" >/dev/null
# No name resolves: a page that wanted anything from elsewhere would miss it.
"$browser" --headless --no-sandbox --disable-gpu --host-resolver-rules="MAP * ~NOTFOUND" --virtual-time-budget=5000 \
  --dump-dom "file://$(readlink -f "$work/page.html")" >"$work/dom.html" 2>"$work/browser.log" || {
  cat "$work/browser.log"
  exit 1
}
if grep -q 'NaN\|Infinity\|undefined' "$work/dom.html" && ! grep -q 'NaN\|Infinity\|undefined' "$work/page.html"; then
  echo "FAILED: the page shows a value that is none"
  exit 1
fi
plots=$(grep -o '<svg xmlns="[^"]*" viewBox="0 0 860 [0-9]' "$work/dom.html" | wc -l)
if [ "$plots" -lt 2 ]; then
  echo "FAILED: $plots plots"
  exit 1
fi
points=$(grep -c '"setting":' "$work/page.json")
recommended=$(grep -c '"target":' "$work/page.json")
wanted=$((points - recommended))
if ! grep -q "data-ready=\"$wanted\"" "$work/dom.html"; then
  echo "FAILED: the page's script did not find $wanted points: $(grep -o 'data-ready="[0-9]*"' "$work/dom.html" || echo it did not end)"
  exit 1
fi
rows=$(grep -o '<tr data-label="[^$]' "$work/dom.html" | wc -l)
if [ "$rows" -ne "$wanted" ]; then
  echo "FAILED: $rows rows for $wanted settings"
  exit 1
fi
echo "$wanted points, each with its words"
