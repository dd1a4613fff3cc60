#!/usr/bin/env bash
# Writes every fixture as glTF in every way there is and has Khronos' validator read it.
# usage: run.sh PROGRAM
set -euo pipefail
program=$(realpath "$1")
cd "$(dirname "$0")"
fixtures=$(realpath ../../fixtures)
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
./setup.sh >/dev/null
python=$(./python.sh)

count=0
write() { # INPUT NAME OPTION...
    local input=$1 name=$2 code=0
    shift 2
    "$program" annotate "$input" -o "$out/$name" -q "$@" || code=$?
    # 3: written, and the input has defects.
    [ "$code" = 0 ] || [ "$code" = 3 ] || { echo "$input $*: exit code $code"; exit 1; }
    count=$((count + 1))
}

for input in "$fixtures"/*.{stl,obj,ply,off,3mf,glb,gltf}; do
    name=$(basename "$input" | tr . _)
    write "$input" "$name.glb"
    write "$input" "$name-apart.gltf"
    write "$input" "$name-all.glb" --attributes all --color-by class
    write "$input" "$name-vertex.glb" --color vertex --color-by gauss
    write "$input" "$name-srgb.glb" --color vertex-srgb
    write "$input" "$name-plain.glb" --color-by none --attributes none
    "$program" annotate "$input" -o - --format gltf -q >"$out/$name-embedded.gltf" || [ $? = 3 ]
    case $input in
        *.stl | *.obj | *.ply | *.off | *.3mf) write "$input" "$name-mm.glb" --up z --unit mm ;;
    esac
done
# Files of lines: disks, traces, sections, edges.
torus=$out/torus.ply
"$program" synth torus --faces 3000 -o "$torus" -q
"$program" disk "$torus" --face 7 -o "$out/disk.glb" -q
"$program" trace "$torus" --face 7 --steps 9 -o "$out/trace.glb" -q
"$program" trace "$torus" --seeds 20 --both --steps 9 -o "$out/traces.glb" -q
"$program" section "$torus" --plane 0,1,0,-0.5 -o "$out/section.glb" -q
write "$fixtures/cylinder_holes.stl" edges-of.glb --edges "$out/edges.glb" --view 1,2,3
write "$fixtures/suzanne.stl" edges-of-suzanne.glb --edges "$out/edges-suzanne.glb"

# No message of any severity: none of the inputs has one that its output could keep.
node validate.mjs "$out"/*.glb "$out"/*.gltf
echo "$(ls "$out"/*.glb "$out"/*.gltf | wc -l) files without a message from the validator"

# Files of all formats as trimesh reads them.
"$python" ../../fixtures/make_variants.py "$out/variants"
"$python" differential.py "$program" "$out/variants"
