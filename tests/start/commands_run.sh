#!/usr/bin/env bash
# commands_run.sh WELKIN SOURCE WORK [PAGE...]: runs every command of README.md and of the pages for users (tutorials,
# guides, reference, explanation) as printed, page by page, in a folder that holds nothing of the reader's: indented
# lines, and words in backquotes that begin with "welkin" or "scripts/welkin". The built program WELKIN stands for both.
# Commands that build, test, serve or fetch are skipped by name; other commands that this script does not know are errors.
# Words in backquotes are skipped if they only name a command or an option, or stand for many (capitals, "...", "|"). Many
# pages begin with the same sample, which is computed once.
set -euo pipefail

welkin="$1"
source="$2"
work="$3"
pages=("${@:4}")
if [[ ${#pages[@]} -eq 0 ]]; then
  cd "$source"
  pages=(README.md docs/index.md docs/pictures.md docs/{tutorials,guides,reference,explanation}/*.md)
fi
rm -rf "$work"
mkdir -p "$work"

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
         for (k = 2; k <= count; k += 2) {
           gsub(/ +/, " ", parts[k])  # a line may end within
           if (parts[k] !~ /^(scripts\/)?welkin [a-z]+ ./ || parts[k] ~ /[A-Z][A-Z]|[A-Z]$|[A-Z] |\.\.\.|\|/) continue
           if (parts[k] ~ /^(scripts\/)?welkin (help|completion) |^(scripts\/)?welkin batch [a-z]+$/) continue
           if (parts[k] ~ /^(scripts\/)?welkin (bake|sh|batch run) --/ && parts[k] !~ /--sky/) continue
           print parts[k]
         }
       }' "$1" | sed -e 's/  *# .*//' -e 's/ *$//' | grep -v -e venice_sunset_1k.hdr || true
}

# Stands for the command.
cat >"$work/welkin" <<END
#!/bin/sh
if [ "\$*" = "sample -o sample.hdr" ]; then
  [ -e "$work/sample.hdr" ] || "$welkin" sample -o "$work/sample.hdr" || exit
  exec cp "$work/sample.hdr" .
fi
exec "$welkin" "\$@"
END
chmod +x "$work/welkin"

run=0
for page in "${pages[@]}"; do
  folder="$work/$(basename "$page" .md)"
  mkdir -p "$folder/scripts" "$folder/bin"
  ln -s "$work/welkin" "$folder/scripts/welkin"
  ln -s "$work/welkin" "$folder/bin/welkin"
  ln -s "$source/examples" "$folder/examples"
  while IFS= read -r line; do
    case "$line" in
      *"welkin report"*) continue ;;  # minutes; tests/report has tests of its own
      scripts/welkin\ * | welkin\ * | cp\ examples/start/* | mkdir\ *) ;;
      scripts/test | scripts/plot-report\ * | "WELKIN_NO_INSTALL=1 scripts/welkin "* | "cmake --"* | "cpack --"* | \
        "npm install "* | "python3 -m http.server") continue ;;
      *) echo "$page: this command cannot be tried; name it in $0: $line" >&2; exit 1 ;;
    esac
    if ! (cd "$folder" && PATH="$folder/bin:$PATH" bash -euc "$line") >"$work/said" 2>&1 </dev/null; then
      cat "$work/said" >&2
      echo "$page: this command fails in a folder without files of the reader's: $line" >&2
      exit 1
    fi
    run=$((run + 1))
  done < <(commands_of "$source/$page")
  rm -rf "$folder"
done
[[ ${#pages[@]} -lt 4 || $run -ge 60 ]] || { echo "only $run commands were found" >&2; exit 1; }
echo "$run commands run as printed"
