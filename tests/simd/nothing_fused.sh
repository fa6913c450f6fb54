#!/usr/bin/env bash
# nothing_fused.sh OBJDUMP ARCHIVE: the library's code for ARM has no multiplication that is fused with an addition, which
# rounds once where x86 rounds twice, and no division or root by estimates.
set -euo pipefail

objdump="${1:?usage: nothing_fused.sh OBJDUMP ARCHIVE}"
code="$("$objdump" -d --no-show-raw-insn "${2:?}")"
found="$(awk '/>:$/ { name = $2 } $2 ~ /^(f(n?m(add|sub)|ml[as]l?2?|recp[esx]|rsqrt[es])|bfml.*|fcmla)$/ { print name, $0 }' <<<"$code" | head)"
if [[ -n "$found" ]]; then
  echo "fused or estimated:"
  echo "$found"
  exit 1
fi
# A pattern of another disassembler's words would find nothing.
grep -q -P '\tfmul\t' <<<"$code" || { echo "no multiplication was found in $2"; exit 1; }
