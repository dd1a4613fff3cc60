#!/bin/sh
# Installs Python packages in a folder of their own outside the repository and prints its interpreter.
# usage: python.sh NAME PACKAGE...
set -eu
dir=${XDG_CACHE_HOME:-$HOME/.cache}/osculate/$1
shift
mkdir -p "$(dirname "$dir")"
exec 9>"$dir.lock"
if command -v flock >/dev/null; then flock 9; fi
# Written last: an install that broke off is done again.
if [ "$(cat "$dir/installed.txt" 2>/dev/null)" != "$*" ]; then
    [ -x "$dir/bin/python" ] || python3.11 -m venv "$dir"
    "$dir/bin/pip" install -q --disable-pip-version-check "$@" >&2
    echo "$*" >"$dir/installed.txt"
fi
echo "$dir/bin/python"
