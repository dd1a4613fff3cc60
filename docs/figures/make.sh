#!/bin/sh
# Makes the figures of docs/figures.md anew: runs the commands that stand there, so that text and
# pictures cannot part. Meshes and lines go to target/figures.
#
#     docs/figures/make.sh [PROGRAM]      default: target/release/osculate
set -eu
program=${1:-$(dirname "$0")/../../target/release/osculate}
case $program in
    /*) ;;
    *) program=$PWD/$program ;;
esac
cd "$(dirname "$0")/../.."
[ -x "$program" ] || { echo "$program is missing: cargo build --release" >&2; exit 1; }
PYTHON=${XDG_CACHE_HOME:-$HOME/.cache}/osculate/bpy-4.5/bin/python
[ -x "$PYTHON" ] || { echo "$PYTHON is missing: run fixtures/make.sh once" >&2; exit 1; }
export PYTHONDONTWRITEBYTECODE=1

osculate() { "$program" "$@"; }

# Emptied, as the commands take every disk that is there.
rm -rf target/figures
mkdir -p target/figures
awk '/^```/ { inside = !inside && $0 == "```sh"; next } inside' docs/figures.md >target/figures/commands.sh
set -x
. target/figures/commands.sh
