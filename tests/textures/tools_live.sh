#!/bin/sh
# Asks OpenEXR's and OpenImageIO's own tools what is in the files that texture_samples wrote.
#   tools_live.sh SAMPLES
# Exit code 77, for ctest to call it skipped, where none of the tools is installed.
set -eu
samples=$1
asked=0
fail() {
  echo "NOT AS IT WAS WRITTEN: $1"
  exit 1
}

if command -v exrheader >/dev/null; then
  asked=$((asked + 1))
  for file in half float; do
    header=$(exrheader "$samples/$file.exr")
    echo "$header" | grep -q "cube-face map" || fail "$file.exr: exrheader sees no cube: $header"
    echo "$header" | grep -q "mip-map" || fail "$file.exr: exrheader sees no mip map: $header"
    echo "$header" | grep -q "welkinLevels (type int): 4" || fail "$file.exr: exrheader sees no welkinLevels: $header"
  done
fi
if command -v exrenvmap >/dev/null; then
  asked=$((asked + 1))
  # OpenEXR's own resampling of the cube takes every level's faces as its own.
  exrenvmap -l "$samples/float.exr" "$samples/from_exrenvmap.exr" || fail "float.exr: exrenvmap cannot turn it into a lat-long"
fi
if command -v exrcheck >/dev/null; then
  asked=$((asked + 1))
  for file in half float; do exrcheck "$samples/$file.exr" >/dev/null || fail "$file.exr: exrcheck"; done
fi
if command -v oiiotool >/dev/null; then
  asked=$((asked + 1))
  info=$(oiiotool --info -v "$samples/half.exr")
  echo "$info" | grep -q "8x48 4x24 2x12 1x6" || fail "half.exr: levels in OpenImageIO: $info"
  # A level as floats, equal to the same level of the other file: halves hold the samples exactly.
  for level in 0 1 2 3; do
    oiiotool "$samples/half.exr" --selectmip $level "$samples/float.exr" --selectmip $level --diff >/dev/null ||
      fail "level $level of half.exr and float.exr differ in OpenImageIO"
  done
  # Blocks of BC6H as OpenImageIO decodes them, equal to the last bit to what our reader makes of them.
  oiiotool --info -v "$samples/bc6h.dds" | grep -q 'BC6HU' || fail "bc6h.dds: OpenImageIO sees no BC6H"
  oiiotool "$samples/bc6h.dds" "$samples/bc6h_decoded.pfm" --fail 0 --warn 0 --hardfail 0 --diff >/dev/null ||
    fail "bc6h.dds: OpenImageIO decodes other texels than ours"
fi
if [ "$asked" = 0 ]; then
  echo "SKIPPED: neither OpenEXR's tools (openexr) nor OpenImageIO's (openimageio-tools) are installed"
  exit 77
fi
echo "$asked tools asked"
