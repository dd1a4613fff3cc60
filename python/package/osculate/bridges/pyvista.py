"""PyVista: cell data of ``PolyData``."""

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


def arrays(theirs: Any) -> tuple[Any, Any]:
    """Vertices (n, 3) and faces (m, 3) of a ``PolyData`` of triangles.

    Raises ``UsageError`` where other cells are among them, since values could then not be told apart by cell.
    """
    if theirs.n_cells == 0:
        raise EmptyMeshError("there are no faces")
    if theirs.n_lines or theirs.n_verts or theirs.n_strips:
        raise UsageError("the mesh has lines, vertices or strips besides its faces; take mesh.extract_surface() first")
    if not theirs.is_all_triangles:
        raise UsageError("the mesh has faces with more than three corners; take mesh.triangulate() first")
    return np.asarray(theirs.points), theirs.regular_faces


def annotate(theirs: Any, *, progress: Progress = None, **settings: Unpack[AnnotateSettings]) -> FaceCurvature:
    """Estimates a ``PolyData`` and puts the values into its cell data."""
    curvature = annotate_arrays(*arrays(theirs), progress=progress, **settings)
    attach(theirs, curvature)
    return curvature


def attach(theirs: Any, curvature: FaceCurvature) -> None:
    """Puts values into the cell data of a ``PolyData``."""
    for name, array in attached(curvature, theirs.n_cells).items():
        theirs.cell_data[name] = array


def mesh(ours: Mesh, curvature: FaceCurvature | None = None) -> Any:
    """A ``PolyData`` with the same faces in the same order, and values where they are given."""
    theirs = needed("pyvista").PolyData.from_regular_faces(ours.vertices, ours.faces.astype(np.int64))
    if curvature is not None:
        attach(theirs, curvature)
    return theirs
