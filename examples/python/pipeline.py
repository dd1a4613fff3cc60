# %% [markdown]
# # Thousands of files, unattended
# You run Osculate in a pipeline: every file by itself, bad ones with their reason, results as one table.
# Run it as a script: `python pipeline.py [FOLDER [OUTPUT_FOLDER]]`. (`python -m osculate batch` does the like with a
# mirrored tree and `--resume`.)

# %%
import sys
import warnings
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import osculate

here = Path(__file__).resolve().parent

# %% [markdown]
# ## One file
# One thread each, since the files share the cores. Defects are warnings; here they are kept with the result.

# %%


def annotate(path: Path, out: Path) -> dict[str, object]:
    """One record: what became of a file."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", osculate.DefectWarning)
        try:
            # Every output has its input's whole name, since files of different formats may share the rest of it.
            osculate.convert(path, out / f"{path.name}.glb", threads=1)
            values = osculate.read(out / f"{path.name}.glb").stored
        except osculate.Error as error:
            return {"file": path.name, "error": str(error)}
    assert values is not None
    return {
        "file": path.name,
        "faces": len(values),
        "mean": float(np.nanmean(values.mean)),
        "saddles": int(values.select("class=hyperbolic").sum()),
        "defects": [str(warning.message) for warning in caught],
    }


# %% [markdown]
# ## All files
# Processes, so that Python's own work runs side by side too.

# %%


def main() -> int:
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else here.parents[1] / "fixtures"
    out = Path(sys.argv[2]) if len(sys.argv) > 2 else Path("annotated")
    out.mkdir(parents=True, exist_ok=True)
    # Material files are no meshes: among the fixtures, one that is refused.
    inputs = sorted(path for kind in ("stl", "ply", "off", "mtl") for path in folder.glob(f"*.{kind}"))
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        records = list(pool.map(annotate, inputs, [out] * len(inputs)))
    for record in records:
        print(record)
    failed = [record for record in records if "error" in record]
    print(f"{len(records) - len(failed)} annotated, {len(failed)} refused")
    return 0 if len(failed) < len(records) else 1


if __name__ == "__main__":
    sys.exit(main())
