#!/usr/bin/env bash
# Writes every fixture as glTF in every way there is, has Khronos' validator read it, and compares what
# arrives in Blender, MeshLab, three.js, glTF-Transform, trimesh and PyVista with the CSV's numbers.
# usage: run.sh PROGRAM [--write]
# --write puts the table of the clients (docs/compatibility.md) in place instead of comparing with it.
set -euo pipefail
program=$(realpath "$1")
write_table=${2:-}
cd "$(dirname "$0")"
fixtures=$(realpath ../../fixtures)
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
./setup.sh >/dev/null

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
    write "$input" "$name-variants.glb" --variants mean,gauss,k_max,shape_index,class
    write "$input" "$name-plain.glb" --color-by none --attributes none
    "$program" annotate "$input" -o - --format gltf -q >"$out/$name-embedded.gltf" || [ $? = 3 ]
    case $input in
        *.stl | *.obj | *.ply | *.off | *.3mf)
            write "$input" "$name-mm.glb" --up z --unit mm
            write "$input" "$name-vertex.glb" --color vertex --color-by gauss
            write "$input" "$name-srgb.glb" --color vertex-srgb
            ;;
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

# No message of any severity but those that the input has as well.
check() { node validate.mjs "$@"; }
for file in "$out"/*.glb "$out"/*.gltf; do
    allow=()
    for scene in "$fixtures"/*.glb "$fixtures"/*.gltf; do
        case $(basename "$file") in "$(basename "$scene" | tr . _)"*) allow=(--allow-from "$scene") ;; esac
    done
    check "${allow[@]}" "$file" | grep -v "(in the input too)" || [ "${PIPESTATUS[0]}" = 0 ]
done
echo "$(ls "$out"/*.glb "$out"/*.gltf | wc -l) files without a message from the validator"

# Fails where there is a message that docs/file-format.md does not name. (`! grep` would not end the script.)
only_documented() {
    if grep -vE 'info (UNSUPPORTED_EXTENSION|UNUSED_OBJECT)|\(in the input too\)' "$out/messages"; then exit 1; fi
}

# Layout `indexed` has the messages that docs/file-format.md names, and no other.
for file in suzanne.stl scene.glb character.glb; do
    write "$fixtures/$file" "indexed-$file.glb" --layout indexed
    node validate.mjs --allow-from "$fixtures/scene.glb" --allow-from "$fixtures/character.glb" "$out/indexed-$file.glb" >"$out/messages" || true
    only_documented
done

# So have metadata and compression.
for file in suzanne.stl scene.glb character.glb; do
    for way in "--metadata" "--compress meshopt" "--metadata --compress meshopt --layout faces"; do
        # shellcheck disable=SC2086 # options, word by word
        write "$fixtures/$file" extended.glb $way
        node validate.mjs --allow-from "$fixtures/scene.glb" --allow-from "$fixtures/character.glb" "$out/extended.glb" >"$out/messages" || true
        only_documented
    done
done

# Files of all formats as trimesh reads them.
export PYTHONDONTWRITEBYTECODE=1
# shellcheck disable=SC2046 # one word for each package
python=$(./python.sh readers $(cat requirements.txt))
"$python" ../../fixtures/make_variants.py "$out/variants"
"$python" differential.py "$program" "$out/variants"

# The clients.
seen=$out/clients
mkdir "$seen"
python=$(./python.sh views trimesh==5.2.0 pyvista==0.49.1 numpy pillow)
"$python" write.py "$program" "$seen"
"$python" views.py "$seen" >"$seen/views.jsonl" 2>"$out/views.log"
for version in 4.2.23 4.5.15 5.0.1; do
    python=$(./python.sh "bpy-${version%.*}" "bpy==$version")
    "$python" blender.py "$seen" >"$seen/blender-$version.jsonl" 2>"$out/blender.log"
done
"$(./python.sh meshlab-2025 pymeshlab==2025.7 numpy)" meshlab.py "$seen" >"$seen/meshlab-2025.jsonl"
"$(./python.sh meshlab-2022 pymeshlab==2022.2.post4 numpy)" meshlab.py "$seen" >"$seen/meshlab-2022.jsonl"
node transform.mjs "$seen" >"$seen/transform.jsonl"
node three.mjs "$seen" "$(command -v chromium)" >"$seen/three.jsonl"
node cesium.mjs "$seen" "$(command -v chromium)" >"$seen/cesium.jsonl"
"$(./python.sh views trimesh==5.2.0 pyvista==0.49.1 numpy pillow)" matrix.py "$seen" ../../docs/compatibility.md $write_table
