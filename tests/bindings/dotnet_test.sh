#!/usr/bin/env bash
# Compiles and runs OnRecord.cs with Mono: dotnet_test.sh LIBRARY WORK
set -euo pipefail
for program in mcs mono cc; do
  command -v "$program" >/dev/null || { echo "skipped: there is no $program"; exit 77; }
done
root="$(cd "$(dirname "$0")/../.." && pwd)"
mkdir -p "$2"
# A program in C that prints sizes and offsets of every structure that Welkin.cs declares.
{
  echo '#include <stdio.h>'
  echo '#include "welkin/welkin.h"'
  echo 'int main(void) {'
  sed -n '/LayoutKind.Sequential/,/^    }/p' "$root/bindings/dotnet/Welkin.cs" | tr '\n' ' ' |
    sed 's/\[[^]]*\]//g; s/public struct/\n&/g' | sed -n 's/^public struct \(welkin_[a-z_]*\) {\([^}]*\)}.*/\1 \2/p' |
    while read -r name fields; do
      echo "printf(\"$name %d\\n\", (int)sizeof($name));"
      for field in $(tr ';,' '\n' <<<"$fields" | sed -n 's/.*[ ]*\b\([a-z_0-9]\+\) *$/\1/p'); do
        echo "printf(\"$name $field %d\\n\", (int)offsetof($name, $field));"
      done
    done
  echo 'return 0; }'
} >"$2/layouts.c"
cc -I "$root/include" -o "$2/layouts" "$2/layouts.c"
"$2/layouts" >"$2/layouts.txt"
[[ "$(wc -l <"$2/layouts.txt")" -gt 60 ]] || { echo "layouts.txt lacks structures"; exit 1; }
mcs -langversion:7.2 -warnaserror -out:"$2/OnRecord.exe" "$root/bindings/dotnet/Welkin.cs" "$root/tests/bindings/OnRecord.cs"
LD_LIBRARY_PATH="$(dirname "$1")" mono "$2/OnRecord.exe" "$root/tests/portability/core_hashes.txt" <"$2/layouts.txt"
