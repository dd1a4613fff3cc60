"""What the bridges share."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._curvature import FaceCurvature
from ..errors import MissingPackageError, UsageError


def needed(package: str) -> Any:
    """The package, imported."""
    import importlib

    try:
        return importlib.import_module(package)
    except ModuleNotFoundError as error:
        raise MissingPackageError(f"this needs {package}: pip install {package}") from error
    except ImportError as error:
        raise MissingPackageError(f"{package} is installed but does not work: {error}") from error


def attached(curvature: FaceCurvature, faces: int) -> dict[str, NDArray[Any]]:
    """The arrays that are put on the faces of a mesh, by name; directions are (n, 3)."""
    if len(curvature) != faces:
        raise UsageError(f"the values are of {len(curvature)} faces, but the mesh has {faces}")
    return {name: curvature[name] for name in curvature.attributes if name not in ("face", "method")}


def triangles(faces: NDArray[Any]) -> NDArray[Any]:
    """Faces (m, 3) of a library that has none as (0,) or the like."""
    return faces.reshape(-1, 3) if faces.size == 0 else np.asarray(faces)
