"""Vertices and faces as the native half takes them: contiguous, of a width it knows, and copied only where they are
not so already."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import EmptyMeshError, UsageError, UsageTypeError


def as_vertices(vertices: ArrayLike) -> NDArray[Any]:
    """Floats (n, 3) of 32 or 64 bits."""
    array = _array(vertices, "vertices", "three numbers each")
    if array.dtype.kind not in "fiu":
        raise UsageTypeError(f"vertices must be numbers, not {array.dtype}")
    if array.ndim != 2 or array.shape[1] != 3:
        hint = ", transposed?" if array.ndim == 2 and array.shape[0] == 3 else ""
        raise UsageError(f"vertices must have the shape (n, 3), not {array.shape}{hint}")
    narrow = array.dtype.kind == "f" and array.dtype.itemsize <= 4
    return np.require(array, np.float32 if narrow else np.float64, ["C", "A"])


def as_faces(faces: ArrayLike, vertex_count: int) -> NDArray[np.uint32]:
    """Vertex numbers (m, 3), 0 to ``vertex_count - 1``."""
    array = _array(faces, "faces", "three vertex numbers each; triangulate faces with more corners first")
    if array.size == 0:
        raise EmptyMeshError("there are no faces")
    if array.dtype.kind not in "iu":
        hint = "; use faces.astype(int) if they are whole" if array.dtype.kind == "f" else ""
        raise UsageTypeError(f"faces must be integers, the numbers of vertices, not {array.dtype}{hint}")
    if array.ndim != 2 or array.shape[1] != 3:
        hint = ""
        if array.ndim == 2 and array.shape[1] > 3:
            hint = "; triangulate faces with more corners first"
        elif array.ndim == 2 and array.shape[0] == 3:
            hint = ", transposed?"
        raise UsageError(f"faces must have the shape (m, 3), not {array.shape}{hint}")
    # Numbers of 32 bits without a sign are checked where they are used.
    if array.dtype != np.uint32 and (int(array.min()) < 0 or int(array.max()) >= vertex_count):
        face = int(np.nonzero(((array < 0) | (array >= vertex_count)).any(axis=1))[0][0])
        vertex = next(int(v) for v in array[face] if not 0 <= v < vertex_count)
        there = f"{vertex_count} vertices, numbered from 0" if vertex_count else "no vertices"
        raise UsageError(f"face {face} names vertex {vertex}, but there are {there}")
    return np.require(array, np.uint32, ["C", "A"])


def _array(given: ArrayLike, name: str, what: str) -> NDArray[Any]:
    if isinstance(given, np.ma.MaskedArray) and np.ma.is_masked(given):
        raise UsageError(f"{name} are partly masked; take the masked rows out first")
    try:
        array = np.asarray(given)
    except (TypeError, ValueError, RuntimeError) as error:
        raise UsageError(f"{name} cannot be read as an array of {what} ({error})") from error
    if array.dtype.kind == "O":
        raise UsageTypeError(f"{name} must be an array of {what}, not of Python objects")
    return array
