#!/usr/bin/env bash
# Makes one zip that Blender installs: the extension, its licence and the wheels given, or the one that is built
# here for this system.
# usage: build.sh OUTPUT.zip [WHEEL...]
set -euo pipefail
[ $# -ge 1 ] || { echo "usage: build.sh OUTPUT.zip [WHEEL...]" >&2; exit 2; }
mkdir -p "$(dirname "$1")"
output=$(realpath "$1")
shift
wheels=()
for wheel in "$@"; do wheels+=("$(realpath "$wheel")"); done
cd "$(dirname "$0")"

made=$(mktemp -d)
trap 'rm -rf "$made"' EXIT
if [ ${#wheels[@]} = 0 ]; then
    # Not from here: Python would take our modules for its own.
    python=$(cd .. && tests/clients/python.sh maturin "maturin>=1.9,<2")
    # The compiled crates stay from run to run, and are those of tests/python/run.sh.
    export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-$(realpath ..)/target}/python
    # maturin gives the wheel the lowest manylinux tag that it fulfils.
    (cd ../python && "$python" -m maturin build --release --locked --quiet --out "$made" >&2)
    wheels=("$made"/*.whl)
fi
"${PYTHON:-python3}" pack.py "$output" "${wheels[@]}"
