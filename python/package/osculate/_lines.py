"""Disks, traces and sections. Points are in the coordinates of the vertices."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Disk:
    """The paper's disk: 2n legs of one length, walked over the mesh from a centre in n planes through its normal."""

    #: The face that the centre lies in.
    face: int
    #: Shares of the face's corners in the centre, (3,).
    weights: tuple[float, float, float]
    #: The centre, (3,).
    centre: NDArray[np.float64]
    #: Unit normal there, (3,).
    normal: NDArray[np.float64]
    #: Unit tangents: of angle 0 and of a right angle, (3,) each.
    x: NDArray[np.float64]
    y: NDArray[np.float64]
    #: k_max, k_min, mean, gauss, gauss_perimeter, radius, coverage, face_class, dir_max and dir_min of the centre.
    value: dict[str, Any]
    #: Angle of each leg from ``x``, radians, (2n,).
    angle: NDArray[np.float64]
    #: Length of each leg, (2n,): ``value["radius"]`` where nothing stopped it.
    length: NDArray[np.float64]
    #: Why each leg ended: length, boundary, feature, non_manifold, turned, closed or missed.
    stop: list[str]
    #: The way of each leg, (points, 3), from the centre.
    legs: list[NDArray[np.float64]]
    #: Normal curvature along each diameter, 1/length, (n,): of the plane at ``angle[:n]``. NaN where it cannot tell.
    curvature: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Trace:
    """A path along a principal direction, in steps of the disk's radius; m centres."""

    #: The centres of the disks, (m, 3).
    centres: NDArray[np.float64]
    #: The faces that they lie in, (m,).
    faces: NDArray[np.uint32]
    #: Direction of the step from each centre, (m, 3); of the last, of the step into it.
    directions: NDArray[np.float64]
    #: Principal curvatures at the centres, 1/length, (m,).
    k_max: NDArray[np.float32]
    k_min: NDArray[np.float32]
    #: Length of the step from each centre, (m,).
    radius: NDArray[np.float32]
    #: The way over the surface through all centres, (points, 3).
    path: NDArray[np.float64]
    #: Why it ended: steps, boundary, feature, non_manifold, umbilic or stuck.
    end: str
    #: The same at its beginning, for a trace both ways.
    backward_end: str | None


@dataclass(frozen=True, eq=False)
class Polyline:
    """A chain of points."""

    #: The points, (points, 3).
    points: NDArray[np.float64]
    #: True when the last is joined to the first.
    closed: bool
    #: Its length.
    length: float
