"""Curvature of every face of a triangle mesh, on NumPy arrays and mesh files.

>>> import osculate
>>> vertices = [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]
>>> faces = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]]
>>> curvature = osculate.annotate(vertices, faces)
>>> curvature.k_max
array([0., 0., 0., 0.], dtype=float32)

``annotate`` takes arrays and gives a ``FaceCurvature``, whose fields are arrays. ``read`` gives a ``Mesh`` from a file,
``convert`` goes from file to file, ``inspect`` says what is in one. Disks, traces and sections are methods of
``Mesh``; ``osculate.bridges`` goes to and from trimesh, PyVista, Open3D, meshio, pandas and Arrow. Settings, names and
defaults are those of the command line, which is ``python -m osculate``.
"""

from __future__ import annotations

from . import bridges, errors, settings
from ._colors import COLORMAPS, ColorScale, palette
from ._curvature import CLASSES, METHODS, QUANTITIES, FaceCurvature
from ._files import convert, inspect
from ._lines import Disk, Polyline, Trace
from ._mesh import Mesh, annotate, read
from ._native import VERSION as __version__
from .errors import (
    BugError,
    BusyError,
    DefectWarning,
    EmptyMeshError,
    Error,
    ExistsError,
    FileError,
    MissingFileError,
    MissingPackageError,
    ParseError,
    TooLargeError,
    UsageError,
    UsageTypeError,
)

__all__ = [
    "CLASSES",
    "COLORMAPS",
    "METHODS",
    "QUANTITIES",
    "BugError",
    "BusyError",
    "ColorScale",
    "DefectWarning",
    "Disk",
    "EmptyMeshError",
    "Error",
    "ExistsError",
    "FaceCurvature",
    "FileError",
    "Mesh",
    "MissingFileError",
    "MissingPackageError",
    "ParseError",
    "Polyline",
    "TooLargeError",
    "Trace",
    "UsageError",
    "UsageTypeError",
    "__version__",
    "annotate",
    "bridges",
    "convert",
    "errors",
    "inspect",
    "palette",
    "read",
    "settings",
]
