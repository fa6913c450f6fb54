#!/bin/sh
# The code that looks probes up, as shaders: glslangValidator takes the GLSL and the HLSL, a browser evaluates the GLSL
# (WebGL 2) and, where it has WebGPU, the WGSL, and finds what the library finds.
# If three.js is there, which other tests install, its own look-up reads the probes that are packed for it.
#   shaders_live.sh WRITE_PAGE WORK_DIR THREE_DIR
# Exit code 77, for ctest to call it skipped, where neither is installed.
set -eu
write_page=$1
work=$2
chunk=$3/src/renderers/shaders/ShaderChunk/lightprobes_pars_fragment.glsl.js
mkdir -p "$work"
"$write_page" "$work"
if [ -e "$chunk" ]; then
  sed 's/^export default/const threeChunk =/' "$chunk" >"$work/three.js"
else
  echo 'const threeChunk = "";' >"$work/three.js"
fi
looked=

if command -v glslangValidator >/dev/null; then
  glslangValidator "$work/probes.frag"
  glslangValidator -D -S comp -e main -V -o "$work/probes.spv" "$work/probes.hlsl"
  looked=yes
fi

for name in chromium-headless-shell chromium; do
  if command -v "$name" >/dev/null; then browser=$name; break; fi
done
if [ -n "${browser-}" ]; then
  "$browser" --headless --no-sandbox --use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader \
    --enable-unsafe-webgpu --use-webgpu-adapter=swiftshader --enable-features=Vulkan \
    --host-resolver-rules="MAP * ~NOTFOUND" --virtual-time-budget=20000 \
    --dump-dom "file://$(readlink -f "$work/page.html")" >"$work/dom.html" 2>"$work/browser.log" || {
    cat "$work/browser.log"
    exit 1
  }
  body=$(grep -o '<body[^>]*>' "$work/dom.html")
  echo "largest differences: $body"
  for language in glsl wgsl three; do
    most=1e-5
    [ $language != three ] || most=5e-4  # its texture is of halves
    found=$(echo "$body" | sed -n "s/.*data-$language=\"\([^\"]*\)\".*/\1/p")
    case $found in
      "no "*) echo "$language: $found" ;;
      "") [ $language = wgsl ] || { echo "FAILED: the browser said nothing of $language"; exit 1; }
         echo "wgsl: the browser has no adapter that answers" ;;
      *[!0-9.e-]*) echo "FAILED: $language: $found"; exit 1 ;;
      *) awk -v found="$found" -v most=$most 'BEGIN { exit !(found < most) }' || { echo "FAILED: $language: off by $found"; exit 1; }
         looked=yes ;;
    esac
  done
fi
[ -n "$looked" ] || { echo "SKIPPED: neither glslangValidator nor Chromium is installed"; exit 77; }
