#!/usr/bin/env bash
# Builds the Python package's wheel, installs it beside the libraries that it has bridges to, and runs its tests, the
# type checkers and the examples.
# usage: run.sh [WHEEL]    with WHEEL, tests that one instead of building it
set -euo pipefail
cd "$(dirname "$0")"
top=$(realpath ../..)
package=$top/python
export PYTHONDONTWRITEBYTECODE=1 PIP_DISABLE_PIP_VERSION_CHECK=1
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

# shellcheck disable=SC2046 # one word for each package
python=$(../clients/python.sh python $(cat requirements.txt))

wheel=${1:-}
if [ -z "$wheel" ]; then
    # The compiled crates stay from run to run.
    export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-$top/target}/python
    (cd "$package" && "$python" -m maturin build --release --locked --quiet --out "$out" --interpreter "$python")
    wheel=$(ls "$out"/osculate-*.whl)
fi
size=$(stat -c %s "$wheel")
echo "$(basename "$wheel"): $((size / 1024)) KB"
[ "$size" -lt 10000000 ] || { echo "the wheel is 10 MB or larger"; exit 1; }
case $wheel in *-cp39-abi3-*) ;; *) echo "the wheel is not of the stable interface of Python 3.9"; exit 1 ;; esac
"$python" -m pip install -q --force-reinstall --no-deps "$wheel"

echo "== tests"
# Away from the sources, so that the installed package is tested.
(cd "$out" && "$python" -m pytest -q -p no:cacheprovider "$package/tests")

echo "== types"
config=$(realpath mypy.ini)
(cd "$out" && "$python" -m mypy --config-file "$config" --cache-dir "$out/mypy" -p osculate)
(cd "$package/tests" && "$python" -m mypy --config-file "$config" --cache-dir "$out/mypy" ./*.py ../make_settings.py)
(cd "$out" && "$python" -m mypy.stubtest osculate._native --mypy-config-file "$config")

echo "== examples"
for example in "$top"/examples/python/*.py; do
    (mkdir -p "$out/example" && cd "$out/example" && "$python" "$example" >"$out/said" 2>&1) ||
        { cat "$out/said"; echo "$(basename "$example") failed"; exit 1; }
    echo "$(basename "$example"): $(wc -l <"$out/said") lines"
done

echo "== documentation"
"$python" "$package/tests/documented.py" "$top/README.md" "$top/docs/python.md" "$package/README.md" >"$out/said" 2>&1 ||
    { cat "$out/said"; exit 1; }

# Other versions of Python, where they are.
for other in python3.9 python3.10 python3.12 python3.13 python3.14; do
    "$other" -c 'import ensurepip' 2>/dev/null || continue
    home=${XDG_CACHE_HOME:-$HOME/.cache}/osculate/$other
    [ -x "$home/bin/python" ] || "$other" -m venv "$home"
    "$home/bin/python" -m pip install -q numpy
    "$home/bin/python" -m pip install -q --force-reinstall --no-deps "$wheel"
    (cd "$out" && "$home/bin/python" -c "
import osculate
c = osculate.annotate([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
assert c.face_class.tolist() == [0] and c.radius.shape == (1,)")
    echo "$("$home/bin/python" --version): works"
done
