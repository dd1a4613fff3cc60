#!/bin/sh
# Makes the README's pictures anew, with the program itself.
#
#     docs/figures/readme.sh [PROGRAM]      default: target/release/osculate
set -eu
program=${1:-$(dirname "$0")/../../target/release/osculate}
case $program in
    /*) ;;
    *) program=$PWD/$program ;;
esac
cd "$(dirname "$0")/../.."
picture() { # INPUT NAME OPTION...
    input=$1 name=$2
    shift 2
    "$program" report "$input" --png "docs/figures/$name.png" --size 560x420 -q "$@"
}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$program" synth torus --faces 40000 -o "$folder/torus.stl" -q
"$program" synth fillet-box --faces 12000 -o "$folder/box.stl" -q
picture fixtures/suzanne.stl readme-mean --color-by mean --range -3:3 --view -0.5,0.9,-0.25
picture "$folder/torus.stl" readme-gauss --color-by gauss
picture "$folder/box.stl" readme-class --color-by class
