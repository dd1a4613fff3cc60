"""Measures what the extension costs: wall clock, and in brackets seconds of the processor, which say more where other
work runs. usage: python speed.py PROGRAM ZIP FOLDER"""

import time

from harness import FOLDER, MODULE, call, empty, install, load, obj_of, only, osculate, quiet, select

import bpy

FACES, RUNS = 500_000, 5


def best(work):
    def once():
        start = time.perf_counter(), time.process_time()
        work()
        return time.perf_counter() - start[0], time.process_time() - start[1]
    runs = [once() for _ in range(RUNS)]
    return min(wall for wall, _ in runs), min(cpu for _, cpu in runs)


def told(times):
    return f"{times[0]:.2f} s ({times[1]:.2f})"


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
            print(f"| {shape}, {len(mesh.polygons):,} faces | `{layout}` | {told(took[0])} | {told(took[1])} | "
                  f"{took[1][0] / took[0][0]:.2f} ({took[1][1] / took[0][1]:.2f}) | {told(annotate)} |", flush=True)
            empty()


main()
