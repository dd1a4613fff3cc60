# SPDX-License-Identifier: MIT
"""The table of quantities as Blender has them: one attribute each, named as in glTF.

A direction, which glTF carries as three numbers, is one vector here. `tests/blender` holds the table
against the columns that the program writes."""

from typing import NamedTuple


class Quantity(NamedTuple):
    """A value that every face has."""

    #: CSV column, `--attributes` token and field of the Python package.
    token: str
    #: Name of the attribute.
    attribute: str
    #: Name shown to people.
    label: str
    #: Type of the attribute: FLOAT, INT or FLOAT_VECTOR.
    type: str = "FLOAT"
    #: Zero divides two kinds of surface.
    is_signed: bool = False
    #: Colours can show it.
    is_shown: bool = True

    @property
    def columns(self):
        """Names in the glTF extension, one for each number."""
        return [f"{self.token}_{axis}" for axis in "xyz"] if self.type == "FLOAT_VECTOR" else [self.token]

    @property
    def gltf_attributes(self):
        """Names of the glTF attributes, one for each number."""
        return [f"{self.attribute}_{axis}" for axis in "XYZ"] if self.type == "FLOAT_VECTOR" else [self.attribute]


QUANTITIES = (
    Quantity("face", "_FACE_ID", "Face number", "INT", is_shown=False),
    Quantity("class", "_CURVATURE_CLASS", "Class", "INT"),
    Quantity("k_max", "_CURVATURE_MAX", "Largest curvature", is_signed=True),
    Quantity("k_min", "_CURVATURE_MIN", "Smallest curvature", is_signed=True),
    Quantity("mean", "_CURVATURE_MEAN", "Mean curvature", is_signed=True),
    Quantity("gauss", "_CURVATURE_GAUSS", "Gaussian curvature", is_signed=True),
    Quantity("gauss_perimeter", "_CURVATURE_GAUSS_PERIMETER", "Gaussian curvature by perimeter", is_signed=True),
    Quantity("shape_index", "_SHAPE_INDEX", "Shape index", is_signed=True),
    Quantity("curvedness", "_CURVEDNESS", "Curvedness"),
    Quantity("dir_max", "_DIRECTION_MAX", "Direction of the largest curvature", "FLOAT_VECTOR", is_shown=False),
    Quantity("dir_min", "_DIRECTION_MIN", "Direction of the smallest curvature", "FLOAT_VECTOR", is_shown=False),
    Quantity("radius", "_RADIUS", "Radius", is_shown=False),
    Quantity("coverage", "_COVERAGE", "Coverage"),
    Quantity("confidence", "_CONFIDENCE", "Confidence"),
)

BY_TOKEN = {quantity.token: quantity for quantity in QUANTITIES}

#: Class codes, from -1.
CLASSES = ("not estimated", "flat", "parabolic", "elliptic", "umbilic", "hyperbolic")
NOT_ESTIMATED = -1

#: Attributes of edges.
EDGE_KIND, DIHEDRAL = "_EDGE_KIND", "_DIHEDRAL"
#: Codes of edge kinds, as in files of edges.
INNER, BOUNDARY, FEATURE, NON_MANIFOLD = range(4)
KINDS = {"boundary": BOUNDARY, "feature": FEATURE, "non_manifold": NON_MANIFOLD}


def fallback(quantity):
    """The value of a face that has none, as in files."""
    return NOT_ESTIMATED if quantity.token == "class" else 0
