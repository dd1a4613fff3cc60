#!/bin/sh
# Installs the packages of requirements.txt outside the repository and prints the Python that has
# them. Does nothing when those very packages are installed there already.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
dir=${XDG_CACHE_HOME:-$HOME/.cache}/osculate/readers
mkdir -p "$dir"
# Tests run at the same time; only one of them is to install.
exec 9>"$dir.lock"
if command -v flock >/dev/null; then flock 9; fi
if ! cmp -s "$here/requirements.txt" "$dir/installed.txt"; then
    rm -f "$dir/installed.txt"
    python3 -m venv "$dir" >&2
    "$dir/bin/pip" install -q --disable-pip-version-check -r "$here/requirements.txt" >&2
    # Written last: an install that broke off is done again.
    cp "$here/requirements.txt" "$dir/installed.txt"
fi
echo "$dir/bin/python"
