#!/usr/bin/env bash
# Writes reports of fixtures and synthetic meshes and looks at them in headless Chromium. Screenshots come to lie
# in target/report-screenshots.
# usage: run.sh PROGRAM
set -euo pipefail
program=$(realpath "$1")
cd "$(dirname "$0")"
fixtures=$(realpath ../../fixtures)
screenshots=$(realpath -m ../../target/report-screenshots)
mkdir -p "$screenshots"
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
../clients/setup.sh >/dev/null

# 3: written, and the input has defects.
run() { "$program" "$@" -q || [ $? = 3 ]; }
report() { run report "$@"; }

# A mesh with borders, and what the program says of it.
run synth wave --faces 6000 --jitter 0.2 -o "$out/wave.stl"
report "$out/wave.stl" -o "$out/part.html"
run annotate "$out/wave.stl" -o "$out/part.csv" --attributes default,shape_index,curvedness
for quantity in mean k_max class; do
    name=part-$quantity
    [ $quantity = mean ] && name=part
    run annotate "$out/wave.stl" -o "$out/$name.ply" --color-by $quantity
done
report "$fixtures/suzanne.ply" --up z -o "$out/scan.html"
run annotate "$fixtures/cylinder_holes.stl" -o "$out/a.glb" --estimator tangent --attributes all
run annotate "$fixtures/cylinder_holes.stl" -o "$out/b.glb" --estimator osculating
report "$out/a.glb" "$out/b.glb" -o "$out/pair.html"
run annotate "$out/a.glb" --reuse -o "$out/a.csv"
run annotate "$out/b.glb" --reuse -o "$out/b.csv"
report "$fixtures/fillet_degenerate.stl" -o "$out/defects.html"
report "$fixtures/scene.glb" -o "$out/scene.html"
report "$fixtures/cylinder_holes.stl" --estimator osculating --color-by gauss_perimeter --unit mm -o "$out/sections.html"
run annotate "$fixtures/character.glb" -o "$out/character.glb"
report "$out/character.glb" -o "$out/reused.html"
run synth torus --faces 60000 -o "$out/torus.ply"
report "$out/torus.ply" --max-faces 10000 -o "$out/thin.html"
run annotate "$out/torus.ply" -o "$out/thin.csv"
run synth ellipsoid --faces 200000 --jitter 0.2 -o "$out/large.stl"
report "$out/large.stl" -o "$out/large.html"

# Names that would break out of a page or script it, were they not text.
hostile="$out/\"'><img src=x onerror=hacked=1>$(printf '\342\200\256')lts.obj"
{
    echo "g </script><script>window.hacked=1</script>"
    echo "v 0 0 0"; echo "v 1 0 0"; echo "v 0 1 0"; echo "v 0 0 1"
    echo "f 1 3 2"; echo "f 1 2 4"
    printf 'g \342\200\256"onload=alert(1)\342\200\250`${hacked}\n'
    echo "f 2 3 4"; echo "f 3 1 4"
} >"$hostile"
report "$hostile" -o "$out/hostile.html"
# Too small for 32-bit curvature: no face has an estimate.
run synth sphere --radius 1e-25 --faces 600 -o "$out/tiny.obj"
report "$out/tiny.obj" -o "$out/tiny.html"

node page.mjs "$out" "$screenshots" "$(command -v chromium)"
