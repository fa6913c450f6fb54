#!/usr/bin/env bash
# no_install.sh SCRIPT WORK: scripts/install-dependencies on a machine where libspng-dev alone is missing. It lists that,
# and calls apt-get as root; with WELKIN_NO_INSTALL=1 it lists that, calls nothing and fails. Stand-ins for dpkg-query,
# apt-get and sudo come first in PATH.
set -euo pipefail

script="$1"
work="$2"
rm -rf "$work"
mkdir -p "$work/bin"
cat >"$work/bin/dpkg-query" <<'STUB'
#!/usr/bin/env bash
for package in "${@:3}"; do [[ "$package" == libspng-dev ]] || echo "installed $package"; done
STUB
cat >"$work/bin/apt-get" <<STUB
#!/usr/bin/env bash
echo "\$@" >>"$work/calls"
STUB
printf '#!/usr/bin/env bash\nexec "$@"\n' >"$work/bin/sudo"
chmod +x "$work/bin/"*

fail() { echo "$1" >&2; cat "$work/said" >&2; exit 1; }
# runs EXIT_CODE: the script, whose exit status must be that.
runs() {
  local code=0
  rm -f "$work/calls"
  PATH="$work/bin:$PATH" bash "$script" >"$work/output" 2>"$work/said" || code=$?
  [[ $code -eq $1 ]] || fail "exit status $code instead of $1"
  [[ ! -s "$work/output" ]] || fail "standard output is not empty"
  grep -q '^  libspng-dev  *libspng, reads PNG files' "$work/said" || fail "libspng-dev is not listed"
  [[ "$(grep -c '^  ' "$work/said")" -eq 1 ]] || fail "what is there is listed"
}

export WELKIN_NO_INSTALL=1
runs 1
[[ ! -e "$work/calls" ]] || fail "apt-get was called"
grep -q 'apt-get install libspng-dev' "$work/said" || fail "nothing says what to do"

for WELKIN_NO_INSTALL in 0 ''; do
  runs 0
  grep -q 'install libspng-dev' "$work/calls" || fail "apt-get was not called"
  grep -q 'as root (WELKIN_NO_INSTALL=1' "$work/said" || fail "nothing says how to forbid it"
done
