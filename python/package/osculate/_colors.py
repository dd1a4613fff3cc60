"""Colour maps and scales."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from . import _native

#: Names of all colour maps; "classes", that of the classes, stands apart.
COLORMAPS: tuple[str, ...] = tuple(_native.colormaps())


def palette(name: str) -> NDArray[np.uint8]:
    """The sRGB colours of a map, (256, 3): 255 from the least value to the greatest, so that the middle of a range has
    a colour of its own, and last the grey of faces without an estimate.

    ``name``: one of ``COLORMAPS``, or "classes", where each class has a fifth of the 255.
    """
    return np.frombuffer(_native.palette(name), np.uint8).reshape(256, 3)


@dataclass(frozen=True, eq=False)
class ColorScale:
    """Colours of faces, and what a legend of them needs."""

    #: The quantity that is shown.
    quantity: str
    #: The name of its map.
    colormap: str
    #: The value that has the first colour, in the quantity's unit.
    low: float
    #: The value that has the last colour.
    high: float
    #: Number of faces beyond the range, which have the colour of its nearer end.
    clipped: int
    #: Where in ``palette`` the colour of each face is, (n,).
    indices: NDArray[np.uint8]

    @cached_property
    def palette(self) -> NDArray[np.uint8]:
        """The colours of the map, (256, 3)."""
        return palette(self.colormap)

    @cached_property
    def colors(self) -> NDArray[np.uint8]:
        """The sRGB colour of each face, (n, 3)."""
        return self.palette[self.indices]
