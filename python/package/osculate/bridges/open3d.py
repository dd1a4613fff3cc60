"""Open3D: triangle attributes of ``open3d.t.geometry.TriangleMesh``; legacy meshes are read."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from .._curvature import FaceCurvature
from .._mesh import Mesh
from .._mesh import annotate as annotate_arrays
from .._progress import Progress
from ..errors import EmptyMeshError, UsageTypeError
from ._common import attached, needed

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ..settings import AnnotateSettings


def arrays(theirs: Any) -> tuple[Any, Any]:
    """Vertices (n, 3) and faces (m, 3) of a ``TriangleMesh``, of tensors or legacy."""
    if not _is_tensor(theirs):
        return np.asarray(theirs.vertices), np.asarray(theirs.triangles)
    if "positions" not in theirs.vertex or "indices" not in theirs.triangle:
        raise EmptyMeshError("there are no faces")
    return theirs.vertex.positions.cpu().numpy(), theirs.triangle.indices.cpu().numpy()


def annotate(theirs: Any, *, progress: Progress = None, **settings: Unpack[AnnotateSettings]) -> FaceCurvature:
    """Estimates a ``TriangleMesh``; one of tensors gets the values as triangle attributes, a legacy one has no place
    for them."""
    curvature = annotate_arrays(*arrays(theirs), progress=progress, **settings)
    if _is_tensor(theirs):
        attach(theirs, curvature)
    return curvature


def attach(theirs: Any, curvature: FaceCurvature) -> None:
    """Puts values into the triangle attributes of a ``TriangleMesh`` of tensors; ``class`` as int32, since Open3D
    writes no smaller integers."""
    if not _is_tensor(theirs):
        raise UsageTypeError("legacy meshes have no attributes of triangles; use TriangleMesh.from_legacy(mesh) first")
    o3d = needed("open3d")
    for name, array in attached(curvature, theirs.triangle.indices.shape[0]).items():
        array = array.astype(np.int32) if array.dtype == np.int8 else array
        theirs.triangle[name] = o3d.core.Tensor(array if array.ndim == 2 else array[:, None], device=theirs.device)


def mesh(ours: Mesh, curvature: FaceCurvature | None = None) -> Any:
    """A ``TriangleMesh`` of tensors with the same faces in the same order, and values where they are given."""
    o3d = needed("open3d")
    theirs = o3d.t.geometry.TriangleMesh(o3d.core.Tensor(ours.vertices), o3d.core.Tensor(ours.faces.astype(np.int64)))
    if curvature is not None:
        attach(theirs, curvature)
    return theirs


def _is_tensor(theirs: Any) -> bool:
    return hasattr(theirs, "triangle")
