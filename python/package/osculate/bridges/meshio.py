"""meshio: cell data of the block of triangles."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from .._curvature import FaceCurvature
from .._mesh import Mesh
from .._mesh import annotate as annotate_arrays
from .._progress import Progress
from ..errors import EmptyMeshError, UsageError
from ._common import attached, needed

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ..settings import AnnotateSettings

#: Cells that are no surface: values of faces are beside them, NaN or -1.
_BESIDE = ("vertex", "line")


def arrays(theirs: Any) -> tuple[Any, Any]:
    """Vertices (n, 3) and the triangles (m, 3) of all blocks of a ``Mesh``, in their order.

    Raises ``UsageError`` where other faces or volumes are among them.
    """
    other = sorted({block.type for block in theirs.cells if block.type not in ("triangle", *_BESIDE)})
    if other:
        raise UsageError(f"the mesh has cells of type {', '.join(other)}; triangulate it first, only triangles are faces")
    blocks = [block.data for block in theirs.cells if block.type == "triangle"]
    if not blocks:
        raise EmptyMeshError("there are no faces")
    points = np.asarray(theirs.points)
    if points.ndim == 2 and points.shape[1] == 2:
        points = np.column_stack([points, np.zeros(len(points), points.dtype)])
    return points, blocks[0] if len(blocks) == 1 else np.concatenate(blocks)


def annotate(theirs: Any, *, progress: Progress = None, **settings: Unpack[AnnotateSettings]) -> FaceCurvature:
    """Estimates a ``Mesh`` and puts the values into its cell data."""
    curvature = annotate_arrays(*arrays(theirs), progress=progress, **settings)
    attach(theirs, curvature)
    return curvature


def attach(theirs: Any, curvature: FaceCurvature) -> None:
    """Puts values into the cell data of a ``Mesh``; cells that are points or lines get NaN, and class -1."""
    faces = sum(len(block.data) for block in theirs.cells if block.type == "triangle")
    for name, array in attached(curvature, faces).items():
        blocks, first = [], 0
        for block in theirs.cells:
            count = len(block.data)
            if block.type == "triangle":
                blocks.append(array[first : first + count])
                first += count
            else:
                none = -1 if array.dtype.kind == "i" else np.nan
                blocks.append(np.full((count, *array.shape[1:]), none, array.dtype))
        theirs.cell_data[name] = blocks


def mesh(ours: Mesh, curvature: FaceCurvature | None = None) -> Any:
    """A ``Mesh`` with one block of triangles in the same order, and values where they are given."""
    theirs = needed("meshio").Mesh(ours.vertices, [("triangle", ours.faces.astype(np.int64))])
    if curvature is not None:
        attach(theirs, curvature)
    return theirs
