# %% [markdown]
# # A scan to annotated glTF
# You have a scan (STL, OBJ, PLY) and want a glTF whose faces carry curvature, and the numbers behind it.
# Run it as a script, or cell by cell in an editor that knows `# %%`: `python scan.py [SCAN [OUTPUT_FOLDER]]`.

# %%
import sys
from pathlib import Path

import numpy as np
import osculate

here = Path(__file__).resolve().parent
scan = Path(sys.argv[1]) if len(sys.argv) > 1 else here.parents[1] / "fixtures" / "suzanne.ply"
out = Path(sys.argv[2]) if len(sys.argv) > 2 else Path(".")

# %% [markdown]
# ## What is in it
# Counts, extent and defects, and the settings that this file seems to need.

# %%
found = osculate.inspect(scan)
print(f"{found['faces']} faces, {found['vertices']} vertices, {found['components']} components")
print(f"edges: {found['edges']}")
for sentence in found["suggestions"]:
    print("suggestion:", sentence)

# %% [markdown]
# ## Annotate it
# The same settings as `osculate annotate`, with underscores. `progress=True` would show bars.

# %%
summary = osculate.convert(scan, out / "scan.glb", up="z", variants=["mean", "gauss", "class"], summarise=True)
spread = summary["curvature"]["percentiles"]["mean"]
print(f"mean curvature: half of the faces between {spread['p25']:.3g} and {spread['p75']:.3g} per unit of length")

# %% [markdown]
# ## The numbers
# `confidence` tells how far to trust a face: half of the values below say little.

# %%
mesh = osculate.read(scan)
curvature = mesh.annotate()
trusted = curvature.confidence > 0.5
print(f"{trusted.mean():.0%} of the faces are known to a twentieth of their curvature")
sharpest = np.argsort(curvature.curvedness)[-5:]
print("the most curved faces:", sharpest, "with", curvature.curvedness[sharpest])

# %% [markdown]
# ## At a scale
# A radius asks for curvature at a scale, in file units: larger smooths.

# %%
size = np.ptp(mesh.vertices, axis=0).max()
for share in (0.02, 0.05, 0.1):
    smooth = mesh.annotate(radius=share * size)
    print(f"radius {share * size:.3g}: median curvedness {np.nanmedian(smooth.curvedness):.3g}")
