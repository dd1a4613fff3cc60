"""Measures what the extension costs. usage: python speed.py PROGRAM ZIP FOLDER"""

import time

from harness import FOLDER, MODULE, call, empty, install, load, obj_of, only, osculate, quiet, select

import bpy

FACES, RUNS = 500_000, 5


def best(work):
    def once():
        start = time.perf_counter()
        work()
        return time.perf_counter() - start
    return min(once() for _ in range(RUNS))


def main():
    install()
    print("| surface | layout | import without | with | ratio | annotate |\n|---|---|---|---|---|---|")
    for shape in ("torus", "wave"):
        given = FOLDER / f"{shape}.ply"
        osculate("synth", shape, "--faces", FACES, "-o", given, "-q")
        for layout in ("indexed", "faces"):
            path = FOLDER / f"{shape}-{layout}.glb"
            osculate("annotate", given, "-o", path, "--layout", layout, "-q")
            took = []
            for enable in (bpy.ops.preferences.addon_disable, bpy.ops.preferences.addon_enable):
                with quiet():
                    enable(module=MODULE)
                took.append(best(lambda: load(path)))
            mesh = only(load(path)[0])
            select(obj_of(mesh))
            annotate = best(lambda: call(bpy.ops.osculate.annotate))
            print(f"| {shape}, {len(mesh.polygons):,} faces | `{layout}` | {took[0]:.2f} s | {took[1]:.2f} s | "
                  f"{took[1] / took[0]:.2f} | {annotate:.2f} s |", flush=True)
            empty()


main()
