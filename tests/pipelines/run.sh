#!/usr/bin/env bash
# Runs every recipe of docs/pipelines.md (examples/pipelines) and compares what comes out with `osculate annotate`.
# usage: run.sh PROGRAM PYTHON    the program, and a Python that has the package with its extra `ray`
set -euo pipefail
program=$(realpath "$1")
# Not resolved: a virtual environment is known by its link.
python=$2
cd "$(dirname "$0")"
recipes=$(realpath ../../examples/pipelines)
fixtures=$(realpath ../../fixtures)
packages=$(../clients/setup.sh)
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
export OSCULATE=$program PYTHONDONTWRITEBYTECODE=1

meshes() { # FOLDER: good ones, one with defects, one in a folder of its own, one that is none
    mkdir -p "$1/sub"
    cp "$fixtures"/{suzanne.stl,fillet_degenerate.stl,scene.glb} "$1"
    cp "$fixtures/suzanne.ply" "$1/sub/head.ply"
    echo "v 0 0" >"$1/broken.obj"
}
fail() { echo "$*"; exit 1; }
# What the recipes must write, one by one.
meshes "$out/in"
mkdir -p "$out/expected/sub"
for file in suzanne.stl fillet_degenerate.stl scene.glb sub/head.ply; do
    "$program" annotate "$out/in/$file" -o "$out/expected/$file.glb" -q || [ $? = 3 ]
done
same() { # FOLDER
    (cd "$out/expected" && find . -type f) | while read -r file; do cmp "$out/expected/$file" "$1/$file"; done
}

echo "== make"
make_all() { make -s -j2 -k -f "$recipes/Makefile" IN="$out/in" OUT="$out/made" "$@" >>"$out/make.log" 2>&1; }
if make_all; then fail "make does not tell that a file failed"; fi
grep -q 'broken.obj: line 1' "$out/make.log" || fail "make does not say which file failed"
same "$out/made"
rm "$out/in/broken.obj"
make_all || { cat "$out/make.log"; exit 1; }
touch "$out/made/stamp"
make_all
[ -z "$(find "$out/made" -name '*.glb' -newer "$out/made/stamp")" ] || fail "make did again what was done"
touch "$out/in/sub/head.ply"
make_all
[ "$(find "$out/made" -name '*.glb' -newer "$out/made/stamp")" = "$out/made/sub/head.ply.glb" ] ||
    fail "make did not do what had changed, and that alone"
make_all FLAGS="--color-by gauss"
[ "$(find "$out/made" -name '*.glb' -newer "$out/made/stamp" | wc -l)" = 4 ] || fail "other flags did not count"

echo "== GitHub workflow"
"$python" workflow.py "$recipes/annotate.yml" "$program" "$fixtures" "$out/repository"

echo "== glTF-Transform"
mkdir "$out/step"
cp "$recipes/curvature.mjs" "$out/step"
ln -s "$packages/node_modules" "$out/step/node_modules"
arguments=()
for name in suzanne.glb character.glb scene.glb two_meshes.glb; do
    node "$out/step/curvature.mjs" "$fixtures/$name" "$out/step/$name" --variants mean,gauss 2>>"$out/step/log"
    "$program" annotate "$fixtures/$name" -o "$out/step/direct-$name" --variants mean,gauss -q
    arguments+=("$fixtures/$name" "$out/step/$name" "$out/step/direct-$name")
done
node step.mjs "${arguments[@]}"
# A mesh that cannot be annotated is an exception with the program's words.
if node "$out/step/curvature.mjs" "$fixtures/suzanne.glb" "$out/step/none.glb" --select "k_max>1e30" 2>"$out/step/log"; then
    fail "the step does not fail where the program does"
fi
grep -q "fulfils --select" "$out/step/log" && [ ! -e "$out/step/none.glb" ] || fail "the step does not say why it failed"

echo "== Ray"
echo "v 0 0" >"$out/in/broken.obj"
if "$python" "$recipes/cluster.py" "$out/in" "$out/rayed" --keep-extension >"$out/ray.said" 2>"$out/ray.log"; then
    fail "the script does not tell that a file failed"
fi
grep -q 'broken.obj: line 1' "$out/ray.said" || { cat "$out/ray.log"; fail "the script does not say which file failed"; }
same "$out/rayed"
rm "$out/in/broken.obj"
"$python" "$recipes/cluster.py" "$out/in" "$out/rayed" --keep-extension 2>"$out/ray.log" || { cat "$out/ray.log"; exit 1; }
grep -q '4 files .* 4 skipped' "$out/ray.log" || { cat "$out/ray.log"; fail "the script did again what was done"; }
