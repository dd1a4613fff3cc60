"""Meshes: from arrays, or from files."""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import as_faces, as_vertices
from ._curvature import FaceCurvature
from ._given import texts
from ._lines import Disk, Polyline, Trace
from ._progress import Progress, reporting
from .errors import DefectWarning, UsageTypeError

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .settings import (
        AnnotateSettings,
        DiskSettings,
        EstimateSettings,
        MeshSettings,
        ReadSettings,
        TraceSettings,
        WriteSettings,
    )

Path = Union[str, "os.PathLike[str]"]


class Mesh:
    """A triangle mesh: welded, connected, every edge classified.

    ``vertices`` (n, 3), floats or integers, and ``faces`` (m, 3), integers of any width. Contiguous arrays of float32
    or float64 and of uint32 are read where they lie; others are copied first. Neither is changed, and neither may be
    changed by another thread before the call is over.

    Vertices at equal positions count as one, as in files, so that meshes which were split for texture coordinates or
    normals are whole again. ``indexed=True`` goes by the numbers alone instead.

    Settings: ``weld`` (0: distance up to which vertices become one), ``feature_angle`` (40 degrees) and ``threads``.

    Raises ``UsageError`` or ``UsageTypeError`` for arrays that are no mesh, and ``EmptyMeshError``; warns of defects
    with ``DefectWarning``.
    """

    def __init__(
        self, vertices: ArrayLike, faces: ArrayLike, *, indexed: bool = False, **settings: Unpack[MeshSettings]
    ) -> None:
        points = as_vertices(vertices)
        corners = as_faces(faces, len(points))
        self._native = _native.Mesh.from_arrays((points, corners, bool(indexed)), texts("Mesh", settings))
        warn(self.defects)

    def __len__(self) -> int:
        return self._native.face_count()

    def __repr__(self) -> str:
        return f"<osculate.Mesh of {len(self)} faces>"

    @cached_property
    def vertices(self) -> NDArray[np.float64]:
        """Positions of the welded vertices, (n, 3), numbered by their first use in the faces."""
        return self._native.vertices()

    @cached_property
    def faces(self) -> NDArray[np.uint32]:
        """Vertex numbers of each face, (m, 3): faces in the order of the input, each in its own winding."""
        return self._native.faces()

    @cached_property
    def report(self) -> dict[str, Any]:
        """Counts of faces, vertices, edges of each kind, components and defects, and bounds."""
        report: dict[str, Any] = json.loads(self._native.report())
        return report

    @cached_property
    def defects(self) -> list[str]:
        """One sentence for each kind of defect and for each repair of the reader; empty for a sound mesh."""
        return self._native.defects()

    @cached_property
    def notes(self) -> list[str]:
        """One sentence for each thing that is no defect but worth knowing."""
        return self._native.notes()

    @cached_property
    def stored(self) -> FaceCurvature | None:
        """The values that a glTF file carries from an earlier run of Osculate, in the file's axes and units; None
        where it has none, or not all that are needed."""
        stored = self._native.stored()
        if stored is None:
            return None
        values, settings = stored
        return FaceCurvature(values, json.loads(settings), self.report, self.defects)

    def annotate(self, *, progress: Progress = None, **settings: Unpack[EstimateSettings]) -> FaceCurvature:
        """Estimates the curvature of every face.

        Settings, as on the command line: ``estimator``, ``radius``, ``radius_factor``, ``diameters``,
        ``class_tolerance``, ``attributes`` and ``threads`` (``osculate.settings.EstimateSettings``).
        """
        given = texts("estimate", settings)
        with reporting(progress) as callback:
            values = self._native.estimate(given, callback)
        return FaceCurvature(values, json.loads(self._native.settings(given)), self.report, self.defects)

    def write(
        self,
        path: Path,
        curvature: FaceCurvature,
        *,
        progress: Progress = None,
        **settings: Unpack[WriteSettings],
    ) -> dict[str, Any]:
        """Writes the mesh with its curvature: ``path`` is .glb, .gltf, .ply, .csv or .npz.

        The file is the one that ``osculate.convert`` writes; a mesh that was read from a glTF scene goes out with the
        scene around it. It appears whole or not at all, and is replaced where it exists unless ``no_clobber``.

        ``curvature`` is that of this mesh: of ``annotate``, or of ``osculate.annotate`` on the same arrays. Settings
        are those of ``osculate.convert`` that say what is written and how it looks
        (``osculate.settings.WriteSettings``); ``attributes`` are by default those of ``curvature``.

        Gives ``settings``, ``units``, ``legend`` (range, colours and unit of the colour scale), ``notes`` and, with
        ``select``, ``selected_faces``.

        Raises ``UsageError`` where ``curvature`` has another number of faces, ``FileError`` or ``TooLargeError``.
        """
        if not isinstance(curvature, FaceCurvature):
            raise UsageTypeError(f"curvature must be what annotate gives, not {type(curvature).__name__}")
        given = texts("write", settings)
        with reporting(progress) as callback:
            written = self._native.write(path, curvature._values, json.dumps(curvature.settings), given, callback)
        result: dict[str, Any] = json.loads(written)
        return result

    def disk(self, **settings: Unpack[DiskSettings]) -> Disk:
        """The disk of one face: its legs, and the curvature read off them.

        Settings: ``face`` and perhaps ``at``, or ``point`` (the nearest point of the mesh), and those of estimation.
        """
        found = self._native.disk(texts("disk", settings))
        return Disk(**found)

    def trace(self, *, progress: Progress = None, **settings: Unpack[TraceSettings]) -> list[Trace]:
        """Paths along a principal direction: one from a place, or one from each of so many seeds.

        Settings: ``face``, ``at``, ``point`` or ``seeds``; ``along`` ("max"), ``steps`` (100), ``both``; and those of
        estimation. Directions are those of disks, with the default estimator too.
        """
        given = texts("trace", settings)
        with reporting(progress) as callback:
            return [Trace(**trace) for trace in self._native.trace(given, callback)]

    def section(self, plane: Sequence[float] | NDArray[Any], *, progress: Progress = None) -> list[Polyline]:
        """The polylines in which the plane a x + b y + c z + d = 0 cuts the mesh, ``plane`` being (a, b, c, d).

        A watertight mesh gives closed ones only; a plane that misses the mesh gives none.
        """
        given = texts("section", {"plane": plane})
        with reporting(progress) as callback:
            return [Polyline(*line) for line in self._native.section(given, callback)]


def read(path: Path, *, progress: Progress = None, **settings: Unpack[ReadSettings]) -> Mesh:
    """Reads a mesh file: STL, OBJ, PLY, OFF, 3MF, glTF or GLB, told by its content, also compressed with gzip.

    Polygons are triangulated; vertices are in the file's own axes and units. Settings: ``weld``, ``feature_angle``,
    ``input_format``, ``allow_folder`` and ``threads``.

    Raises ``FileError`` or ``MissingFileError``, ``ParseError`` with the place in the file, ``EmptyMeshError``; warns
    of defects with ``DefectWarning``.
    """
    with reporting(progress) as callback:
        native = _native.Mesh.read(path, texts("read", settings), callback)
    mesh = Mesh.__new__(Mesh)
    mesh._native = native
    warn(mesh.defects, str(path))
    return mesh


def annotate(
    vertices: ArrayLike,
    faces: ArrayLike,
    *,
    indexed: bool = False,
    progress: Progress = None,
    **settings: Unpack[AnnotateSettings],
) -> FaceCurvature:
    """Estimates the curvature of every face of a mesh in arrays.

    ``vertices`` (n, 3) and ``faces`` (m, 3) as for ``Mesh``, with ``indexed``. ``progress``: True for bars (tqdm), or a
    callable, given stage, done and total; what it raises cancels the work, as Ctrl-C does. Other threads of Python
    run meanwhile.

    Settings, as on the command line: ``estimator``, ``radius``, ``radius_factor``, ``diameters``, ``class_tolerance``,
    ``weld``, ``feature_angle``, ``attributes`` and ``threads`` (``osculate.settings.AnnotateSettings``).

    Raises ``UsageError`` or ``UsageTypeError`` for arrays that are no mesh or settings out of range, and
    ``EmptyMeshError``; warns of defects with ``DefectWarning``.
    """
    points = as_vertices(vertices)
    corners = as_faces(faces, len(points))
    given = texts("annotate", settings)
    with reporting(progress) as callback:
        facts, values = _native.Mesh.annotate_arrays((points, corners, bool(indexed)), given, callback)
    report, defects, used = facts
    warn(defects)
    return FaceCurvature(values, json.loads(used), json.loads(report), defects)


def warn(defects: list[str], path: str | None = None) -> None:
    """Tells the caller of our caller of defects."""
    if defects:
        where = "" if path is None else f"{path}: "
        warnings.warn(where + "; ".join(defects), DefectWarning, stacklevel=3)
