#!/usr/bin/env bash
# A mesh of 50 million faces, binary STL to GLB (layout indexed) and PLY: seconds of each stage and the largest
# memory. Needs 15 GB in TMPDIR.
#
# usage: benches/huge.sh [FACES]      $OSCULATE: a program to take instead of building it
set -euo pipefail
faces=${1:-50000000}
here=$(cd "$(dirname "$0")" && pwd)
if [ -z "${OSCULATE:-}" ]; then
    (cd "$here/.." && cargo build --release --quiet --bin osculate)
    OSCULATE=${CARGO_TARGET_DIR:-$here/../target}/release/osculate
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$OSCULATE" synth torus --faces "$faces" -o "$folder/mesh.stl" -q
for output in "mesh.glb --layout indexed" mesh.ply; do
    # shellcheck disable=SC2086
    HERE=$here python3 - "$OSCULATE" annotate "$folder/mesh.stl" -o "$folder/"$output -q --stats "$folder/stats.json" <<'PYTHON'
import json, os, sys
sys.path.insert(0, os.environ["HERE"])
import common
command = sys.argv[1:]
result = common.run(command)
stats = json.load(open(command[-1]))
output = command[command.index("-o") + 1]
stages = ", ".join(f"{name} {seconds:.1f}" for name, seconds in stats["seconds"].items())
print(f"{stats['faces']:,} faces to {os.path.basename(output)} ({os.path.getsize(output) / 1e9:.2f} GB): {result['wall']:.1f} s ({stages}), "
      f"{result['anonymous'] / 1024:.2f} GB anonymous at the peak, {result['peak'] / 1024:.2f} GB in all")
PYTHON
    rm -f "$folder/mesh.glb" "$folder/mesh.ply"
done
