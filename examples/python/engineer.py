# %% [markdown]
# # Curvature of a part, in your own tools
# You have a CAD part as STL and want to find its fillets, look at one place closely, and see all of it in PyVista,
# trimesh or MeshLab. Run it as a script, or cell by cell: `python engineer.py [PART [OUTPUT_FOLDER]]`.

# %%
import sys
from pathlib import Path

import numpy as np
import osculate

here = Path(__file__).resolve().parent
path = Path(sys.argv[1]) if len(sys.argv) > 1 else here.parents[1] / "fixtures" / "cylinder_holes.stl"
out = Path(sys.argv[2]) if len(sys.argv) > 2 else Path(".")

# %% [markdown]
# ## Radii of the round surfaces
# k is positive where the surface bends away from its normal: holes have a negative one.

# %%
part = osculate.read(path)
curvature = part.annotate()
round_faces = curvature.face_class > 0
larger = np.where(np.abs(curvature.k_max) > np.abs(curvature.k_min), curvature.k_max, curvature.k_min)
radii, counts = np.unique(np.round(1 / larger[round_faces], 1), return_counts=True)
for i in np.argsort(counts)[::-1][:4]:
    kind = "a hole or groove" if radii[i] < 0 else "a boss or outer surface"
    print(f"{counts[i]} faces of radius {abs(radii[i])}: {kind}")

# %% [markdown]
# ## Conditions
# The conditions of `--select` work on the values too.

# %%
narrow = curvature.select("class=parabolic and k_max>0.05")
print(f"{narrow.sum()} faces bend outwards like a cylinder of a radius below 20")

# %% [markdown]
# ## One place closely
# The disk around a face: normal curvature along every diameter.

# %%
face = int(np.flatnonzero(round_faces)[0])
disk = part.disk(face=face, diameters=6)
for angle, k in zip(np.degrees(disk.angle[:6]), disk.curvature):
    print(f"{angle:5.0f} degrees: {k:+.4f} per unit")

# %% [markdown]
# ## In other libraries
# Values land on the faces: `face_attributes` of trimesh, cell data of PyVista. Both are optional.

# %%
try:
    theirs = osculate.bridges.pyvista.mesh(part, curvature)
    theirs.save(out / "part.vtp")
    print("part.vtp has cell data:", ", ".join(theirs.cell_data.keys()))
except osculate.MissingPackageError as missing:
    print(missing)
try:
    theirs = osculate.bridges.trimesh.mesh(part, curvature)
    theirs.visual.face_colors = curvature.colors(color_by="k_max", range=(-0.2, 0.2))
    theirs.export(out / "part_trimesh.ply")
    print("trimesh has", ", ".join(theirs.face_attributes))
except osculate.MissingPackageError as missing:
    print(missing)

# %% [markdown]
# ## In MeshLab and Blender
# PLY gives MeshLab a number per face; GLB gives Blender attributes. A legend comes along.

# %%
osculate.convert(path, out / "part.ply", color_by="k_min")
osculate.convert(path, out / "part.glb", unit="mm", color_by="k_max", range=(-0.2, 0.2), legend=out / "legend.png")
print(sorted(file.name for file in out.glob("part.*")))
