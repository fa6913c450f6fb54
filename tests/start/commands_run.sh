#!/usr/bin/env bash
# commands_run.sh WELKIN SOURCE WORK: every command of README.md and docs/tutorials/first_light.md as printed, page by page, in a folder
# that holds nothing of the reader's: indented lines, and words in backquotes that begin with "welkin" or
# "scripts/welkin". The built program WELKIN stands for both. What builds, tests, serves or fetches is left out by name;
# any other command is a failure, as is one that nobody can run.
set -euo pipefail

welkin="$1"
source="$2"
work="$3"
rm -rf "$work"

# Command lines of a page, in its order. A photograph that a page names as its own figures' is not the reader's.
commands_of() {
  awk '/^```/ { fenced = !fenced; next }
       fenced { next }
       /^    [^ ]/ { sub(/^ +/, ""); print; next }
       { text = text " " $0 }
       /^$/ || /^[-|#]/ { spans(text); text = "" }
       END { spans(text) }
       function spans(rest,   parts, count, k) {
         count = split(rest, parts, "`")
         for (k = 2; k <= count; k += 2) if (parts[k] ~ /^(scripts\/)?welkin [a-z]/) print parts[k]
       }' "$1" | sed -e 's/  *# .*//' -e 's/ *$//' | grep -v venice_sunset_1k.hdr
}

run=0
for page in README.md docs/tutorials/first_light.md; do
  folder="$work/$(basename "$page" .md)"
  mkdir -p "$folder/scripts" "$folder/bin"
  ln -s "$welkin" "$folder/scripts/welkin"
  ln -s "$welkin" "$folder/bin/welkin"
  ln -s "$source/examples" "$folder/examples"
  while IFS= read -r line; do
    case "$line" in
      scripts/welkin\ * | welkin\ * | cp\ examples/start/*) ;;
      scripts/test | "WELKIN_NO_INSTALL=1 scripts/welkin "* | "cmake --preset "* | "npm install "* | "python3 -m http.server")
        continue ;;
      *) echo "$page: nobody knows how to try this command: $line" >&2; exit 1 ;;
    esac
    if ! (cd "$folder" && PATH="$folder/bin:$PATH" bash -euc "$line") >"$work/said" 2>&1 </dev/null; then
      cat "$work/said" >&2
      echo "$page: this command fails in a folder without files of the reader's: $line" >&2
      exit 1
    fi
    run=$((run + 1))
  done < <(commands_of "$source/$page")
done
[[ $run -ge 12 ]] || { echo "only $run commands were found" >&2; exit 1; }
echo "$run commands run as printed"
