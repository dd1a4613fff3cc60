"""trimesh: ``Trimesh.face_attributes``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .._curvature import FaceCurvature
from .._mesh import Mesh
from .._mesh import annotate as annotate_arrays
from .._progress import Progress
from ._common import attached, needed

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ..settings import AnnotateSettings


def arrays(theirs: Any) -> tuple[Any, Any]:
    """Vertices (n, 3) and faces (m, 3) of a ``Trimesh``."""
    return theirs.vertices.view(type=_ndarray()), theirs.faces.view(type=_ndarray())


def annotate(theirs: Any, *, progress: Progress = None, **settings: Unpack[AnnotateSettings]) -> FaceCurvature:
    """Estimates a ``Trimesh`` and puts the values into its ``face_attributes``."""
    curvature = annotate_arrays(*arrays(theirs), progress=progress, **settings)
    attach(theirs, curvature)
    return curvature


def attach(theirs: Any, curvature: FaceCurvature) -> None:
    """Puts values into the ``face_attributes`` of a ``Trimesh``."""
    theirs.face_attributes.update(attached(curvature, len(theirs.faces)))


def mesh(ours: Mesh, curvature: FaceCurvature | None = None) -> Any:
    """A ``Trimesh`` with the same faces in the same order, and values where they are given."""
    theirs = needed("trimesh").Trimesh(ours.vertices, ours.faces, process=False)
    if curvature is not None:
        attach(theirs, curvature)
    return theirs


def _ndarray() -> Any:
    import numpy

    return numpy.ndarray
