#!/usr/bin/env bash
# Builds the Blender extension and tests it in every Blender it is for, installed from its zip as a user does.
# usage: run.sh PROGRAM [ZIP]
# Pictures to look at go to the folder OSCULATE_PICTURES, where that is set.
set -euo pipefail
program=$(realpath "$1")
cd "$(dirname "$0")"
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
export PYTHONDONTWRITEBYTECODE=1
if [ $# -ge 2 ]; then
    zip=$(realpath "$2")
else
    zip=$out/osculate.zip
    ../../blender/build.sh "$zip"
fi
for version in 4.2.23 4.5.15 5.0.1; do
    python=$(../clients/python.sh "bpy-${version%.*}" "bpy==$version")
    # Blender's own check of a zip.
    check=$(find "$(dirname "$python")/../lib" -path '*bl_pkg/cli/blender_ext.py')
    "$python" "$check" validate "$zip" >"$out/validate.log" || { cat "$out/validate.log"; exit 1; }
    for test in test_*.py; do
        echo "Blender $version, $test"
        folder=$out/$version-${test%.py}
        mkdir "$folder"
        "$python" "$test" "$program" "$zip" "$folder"
    done
done
