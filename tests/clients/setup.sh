#!/bin/sh
# Installs the packages of package.json outside the repository and prints the
# folder. Does nothing when that very package.json is installed there already.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
dir=${XDG_CACHE_HOME:-$HOME/.cache}/osculate/npm
mkdir -p "$dir"
# Tests run at the same time; only one of them is to install.
exec 9>"$dir.lock"
if command -v flock >/dev/null; then flock 9; fi
if ! cmp -s "$here/package.json" "$dir/installed.json"; then
    rm -f "$dir/installed.json" "$dir/package-lock.json"
    cp "$here/package.json" "$dir/package.json"
    (cd "$dir" && npm install --no-audit --no-fund --loglevel=error >&2)
    # Written last: an install that broke off is done again.
    cp "$here/package.json" "$dir/installed.json"
fi
echo "$dir"
