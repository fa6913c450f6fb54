#!/usr/bin/env bash
# kernel_symbols.sh OBJECT_FOLDER NM SET...: the objects of one instruction set define nothing that another object could be
# linked to by mistake. An inline function that two of them emit under the same name is kept once, and the copy
# that is kept may need instructions that the machine has not.
set -euo pipefail

folder="${1:?usage: kernel_symbols.sh OBJECT_FOLDER NM SET...}"
nm="${2:?}"
shift 2
status=0
for isa in "$@"; do
  mapfile -t objects < <(find "$folder/welkin_kernels_$isa.dir" -name '*.o')
  [[ ${#objects[@]} -gt 0 ]] || { echo "no objects of $isa below $folder"; exit 1; }
  # Defined and visible outside the object: all of it must carry the instruction set's own namespace. (DW.ref is a
  # pointer to the exception personality, the same for all.)
  foreign="$("$nm" -C --defined-only --extern-only "${objects[@]}" |
    awk 'NF > 2 { $1 = ""; $2 = $2; print }' | sed 's/^ *//' |
    grep -v -E "^[A-Za-z] (.*)(::${isa}::|xsimd_${isa}::)" | grep -v -E '^V DW\.ref\.' | sort -u || true)"
  if [[ -n "$foreign" ]]; then
    echo "$isa objects define symbols outside their namespace:"
    echo "$foreign"
    status=1
  fi
done
exit "$status"
