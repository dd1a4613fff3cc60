"""Meshes that several tests use."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

Arrays = tuple[NDArray[np.float64], NDArray[np.int64]]

#: Meshes that the repository has.
FIXTURES = Path(__file__).resolve().parents[2] / "fixtures"


def torus(around: int = 60, across: int = 30, major: float = 3.0, minor: float = 1.0) -> Arrays:
    """Closed, outward normals: k_max is 1 / minor, k_min = cos v / (major + minor cos v)."""
    u, v = np.meshgrid(2 * np.pi * np.arange(around) / around, 2 * np.pi * np.arange(across) / across, indexing="ij")
    r = major + minor * np.cos(v)
    vertices = np.stack([r * np.cos(u), r * np.sin(u), minor * np.sin(v)], axis=-1).reshape(-1, 3)
    i, j = (index.ravel() for index in np.meshgrid(np.arange(around), np.arange(across), indexing="ij"))

    def at(a: Any, b: Any) -> Any:
        return (a % around) * across + b % across

    a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
    faces = np.stack([np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)], axis=1).reshape(-1, 3)
    return vertices, faces


def exact_k_min(vertices: Any, faces: Any, major: float = 3.0) -> NDArray[np.float64]:
    """k_min of the torus at the faces' centres."""
    centre = vertices[faces].mean(axis=1)
    beyond = np.hypot(centre[:, 0], centre[:, 1]) - major
    v = np.arctan2(centre[:, 2], beyond)
    result: NDArray[np.float64] = np.cos(v) / (major + np.cos(v))
    return result


@pytest.fixture(scope="session")
def ring() -> Arrays:
    return torus()


@pytest.fixture(scope="session")
def square() -> Arrays:
    """Two faces over the unit square."""
    return np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float), np.array([[0, 1, 2], [0, 2, 3]])
