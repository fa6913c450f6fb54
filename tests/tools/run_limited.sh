#!/bin/sh
# run_limited.sh WELKIN KILOBYTES FILE: runs `info` and `sh` on the file with so much address space (0: no limit, the
# sanitizers need more than the limit) and ten seconds each, and prints for both
#   FILE COMMAND EXIT_CODE LINES_ON_STANDARD_ERROR FIRST_WORD_OF_THEM
[ "$2" = 0 ] || ulimit -v "$2" || exit 3
for command in info sh; do
  errors=$(timeout 10 "$1" "$command" "$3" 2>&1 >/dev/null)
  code=$?
  lines=$(printf %s "${errors:+$errors
}" | wc -l)
  echo "$3 $command $code $lines ${errors%% *}" | head -n 1
done
