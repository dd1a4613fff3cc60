#!/usr/bin/env python3
"""Curvature of CAD parts against the exact one of their surfaces: writes a part of docs/accuracy.md.

Makes parts with CadQuery, meshes them as the CAD kernel does for STL files in three finenesses, asks the kernel for the
exact curvature at every facet, and compares. Counts facets and area that are off by more than a tenth of the facet's
larger curvature, or of a hundredth of the part's largest where the facet hardly bends.

usage: benches/cad.py [--before PROGRAM]     $OSCULATE: a program to take instead of building it
Makes a Python environment in ~/.cache/osculate/cad where it is missing."""
import argparse
import csv
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import common

CACHE = Path.home() / ".cache" / "osculate" / "cad"
# Largest distance of the mesh from the surface, in units, and largest angle between facets, in radians.
FINENESS = {"fine": (0.01, 0.2), "medium": (0.05, 0.35), "coarse": (0.1, 0.5)}
ESTIMATORS = {"auto": [], "osculating": ["--estimator", "osculating"]}


def parts():
    import cadquery as cq
    # Planes remember what was drawn on them.
    def xy():
        return cq.Workplane("XY")

    def xz():
        return cq.Workplane("XZ")

    box = xy().box(40, 30, 20)
    half = 15 / math.sqrt(2)
    bend = xz().lineTo(0, 30).threePointArc((15 - half, 30 + half), (15, 45)).lineTo(40, 45)
    profile = xz().moveTo(6, 0).lineTo(25, 0).lineTo(25, 5).lineTo(12, 5).lineTo(12, 20).lineTo(6, 20).close()
    angle = xz().lineTo(40, 0).lineTo(40, 5).lineTo(5, 5).lineTo(5, 30).lineTo(0, 30).close().extrude(25)
    plate = xy().box(60, 40, 8).edges("|Z").fillet(8).faces(">Z").workplane().rect(40, 20, forConstruction=True).vertices()
    wing = xy().spline([(0, 0), (5, 3.2), (15, 4.4), (35, 2.6), (50, 0.2)])
    wing = wing.spline([(50, 0.2), (30, -0.8), (10, -1.6), (0, 0)], includeCurrent=False).close()
    tray = xy().box(60, 40, 20).edges("|Z").fillet(8).edges("<Z").fillet(4)
    flask = xy().ellipse(20, 9).extrude(40).edges(">Z").fillet(4).faces(">Z").workplane().circle(5).extrude(6)
    return {
        "block, two radii": box.edges("|Z").fillet(6).faces("|Z").edges().fillet(4).faces(">Z").workplane().hole(10),
        "block, one radius": box.edges().fillet(4).faces(">Z").workplane().hole(10),
        "block, chamfered": box.edges("|Z").fillet(5).faces(">Z").edges().chamfer(3).faces(">Z").workplane().hole(8),
        "bracket": angle.edges("|Y").fillet(2).faces(">Z").edges().fillet(1),
        "bent pipe": xy().circle(4).sweep(bend),
        "flange": profile.revolve(360, (0, 0, 0), (0, 1, 0)).edges().fillet(1.5),
        "plate, countersunk": plate.cskHole(4, 8, 82).faces("<Z").edges().fillet(1),
        "wing": wing.extrude(60),
        "tray": tray.faces(">Z").shell(-2),
        "flask": flask.faces(">Z").edges().fillet(1),
        "plate with slot": xy().slot2D(60, 20).extrude(10).edges(">Z").fillet(3).faces(">Z").workplane().slot2D(30, 8).cutBlind(-5),
    }


def mesh(part, fineness):
    """Corners of all facets, and the exact k_max and k_min of each, not a number where it has none."""
    import numpy as np
    from OCP.BRep import BRep_Tool
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.BRepLProp import BRepLProp_SLProps
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.GeomAPI import GeomAPI_ProjectPointOnSurf
    from OCP.TopAbs import TopAbs_REVERSED
    from OCP.TopLoc import TopLoc_Location
    from OCP.gp import gp_Pnt
    distance, angle = fineness
    BRepMesh_IncrementalMesh(part.wrapped, distance, False, angle, False)
    triangles, exact = [], []
    for face in part.Faces():
        place = TopLoc_Location()
        facets = BRep_Tool.Triangulation_s(face.wrapped, place)
        if facets is None:
            continue
        nodes = [facets.Node(i).Transformed(place.Transformation()) for i in range(1, facets.NbNodes() + 1)]
        points = np.array([[p.X(), p.Y(), p.Z()] for p in nodes])
        is_turned = face.wrapped.Orientation() == TopAbs_REVERSED
        adaptor, surface = BRepAdaptor_Surface(face.wrapped), BRep_Tool.Surface_s(face.wrapped)
        for i in range(1, facets.NbTriangles() + 1):
            a, b, c = facets.Triangle(i).Get()
            triangle = points[[a - 1, c - 1, b - 1] if is_turned else [a - 1, b - 1, c - 1]]
            foot = GeomAPI_ProjectPointOnSurf(gp_Pnt(*triangle.mean(0)), surface)
            ks = [math.nan, math.nan]
            if foot.NbPoints():
                local = BRepLProp_SLProps(adaptor, *foot.LowerDistanceParameters(), 2, 1e-9)
                if local.IsCurvatureDefined():
                    # The kernel's sign is that of a surface that bends towards its normal.
                    sign = 1 if is_turned else -1
                    ks = sorted((sign * local.MinCurvature(), sign * local.MaxCurvature()), reverse=True)
            triangles.append(triangle)
            exact.append(ks)
    return np.array(triangles, dtype="<f4"), np.array(exact)


def write_stl(path, triangles):
    import numpy as np
    records = np.zeros(len(triangles), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
    records["corners"] = triangles
    path.write_bytes(bytes(80) + np.uint32(len(triangles)).tobytes() + records.tobytes())


def wrong(program, stl, options, triangles, exact):
    """Shares of the facets and of the area that are off."""
    import numpy as np
    table = stl.with_suffix(".csv")
    subprocess.run([program, "annotate", stl, "-o", table, "-q", *options], stderr=subprocess.DEVNULL)
    rows = list(csv.DictReader(table.open()))
    found = np.array([[float(row[name] or "inf") for name in ("k_max", "k_min")] for row in rows])
    t = triangles.astype(float)
    area = np.linalg.norm(np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0]), axis=1)
    known = ~np.isnan(exact).any(1)
    size = np.maximum(abs(exact).max(1), 0.01 * np.nanmax(abs(exact)))
    is_off = known & (abs(found - exact).max(1) > 0.1 * size)
    return is_off.sum() / known.sum(), area[is_off].sum() / area[known].sum()


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--before", help="another program to compare with")
    options = arguments.parse_args()
    if Path(sys.prefix) != CACHE:
        if not (CACHE / "bin/python").exists():
            subprocess.run([sys.executable, "-m", "venv", CACHE], check=True)
            subprocess.run([CACHE / "bin/pip", "install", "-q", "cadquery==2.8.0", "cadquery-ocp==7.9.3.1.1"], check=True)
        os.execv(CACHE / "bin/python", [str(CACHE / "bin/python"), *sys.argv])
    programs = {name: (common.program(), extra) for name, extra in ESTIMATORS.items()}
    if options.before:
        programs["before"] = (options.before, [])
    lines = ["Cells: share of the facets / share of the area that is off by more than a tenth, in percent.", "",
             f"| part | facets | {' | '.join(programs)} |", f"|---|---|{'---|' * len(programs)}"]
    sums = {name: [0.0, 0.0] for name in programs}
    count = 0
    with tempfile.TemporaryDirectory() as folder:
        stl = Path(folder) / "part.stl"
        for part, shape in parts().items():
            for word, fineness in FINENESS.items():
                triangles, exact = mesh(shape.val().copy(), fineness)
                write_stl(stl, triangles)
                cells = []
                for name, (program, extra) in programs.items():
                    shares = wrong(program, stl, extra, triangles, exact)
                    sums[name] = [a + b for a, b in zip(sums[name], shares)]
                    cells.append(" / ".join(f"{100 * share:.1f}" for share in shares))
                count += 1
                lines.append(f"| {part}, {word} | {len(triangles):,} | {' | '.join(cells)} |")
                print(lines[-1], file=sys.stderr)
    means = [" / ".join(f"{100 * s / count:.1f}" for s in sums[name]) for name in programs]
    lines.append(f"| mean of all | | {' | '.join(means)} |")
    if options.before:
        print("\n".join(lines))
    else:
        common.write("benches/cad.py", "CAD parts", "\n".join(lines), common.ROOT / "docs" / "accuracy.md")


main()
