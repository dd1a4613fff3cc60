# SPDX-License-Identifier: MIT
"""What Osculate wrote into one primitive of a glTF file."""

import re

import numpy as np

from .quantities import KINDS, QUANTITIES, fallback
from .store import MARK

FACE_VALUES = "OSCULATE_face_values"
OWN_ATTRIBUTES = {name for quantity in QUANTITIES for name in quantity.gltf_attributes}
#: Attributes that say nothing of the surface: ours for vertices, and rows of our table of faces.
_ASIDE = re.compile(r"_[A-Z_]+_VERTEX|_FEATURE_ID_\d+")


def mark_of(gltf_mesh):
    """What the file says of the run that annotated a mesh; None for a mesh that Osculate did not write."""
    for extras in [gltf_mesh.extras] + [primitive.extras for primitive in gltf_mesh.primitives]:
        if isinstance(extras, dict) and isinstance(extras.get(MARK), dict):
            return extras[MARK]
    return None


def decoded(gltf, accessor):
    """The rows of an accessor."""
    from io_scene_gltf2.io.imp.gltf2_io_binary import BinaryData
    return BinaryData.decode_accessor(gltf, accessor)


class Primitive:
    """A primitive of triangles and its values.

    corners: faces x 3, vertices of the primitive.  values: {column: one number for each face}.
    edges: {kind: pairs x 2 vertices of the primitive}, None in layout `faces`."""

    def __init__(self, gltf, primitive):
        self.given = primitive
        self.corners = _triangles(gltf, primitive)
        self.values, self.edges = {}, None
        if self.corners is None:
            return
        extension = (primitive.extensions or {}).get(FACE_VALUES)
        if extension is not None:
            self.values = {column: decoded(gltf, found["accessor"]).reshape(-1)
                           for column, found in extension["values"].items()}
            self.edges = {KINDS[kind]: decoded(gltf, found["accessor"]).reshape(-1, 2).astype(np.int64)
                          for kind, found in extension.get("edges", {}).items() if kind in KINDS}
        else:
            first = self.corners[:, 0]
            for quantity in QUANTITIES:
                for column, name in zip(quantity.columns, quantity.gltf_attributes):
                    if name in primitive.attributes:
                        self.values[column] = decoded(gltf, primitive.attributes[name]).reshape(-1)[first]
        for column, values in self.values.items():
            if len(values) != len(self.corners):
                raise ValueError(f"{len(values)} values of {column} for {len(self.corners)} faces")

    @property
    def face_count(self):
        return 0 if self.corners is None else len(self.corners)

    def quantity(self, quantity):
        """The values of a quantity, None where the file has none. Directions are turned to Z up."""
        if not all(column in self.values for column in quantity.columns):
            return None
        columns = [self.values[column] for column in quantity.columns]
        if quantity.type == "FLOAT_VECTOR":
            x, y, z = columns
            return np.stack((x, -z, y), axis=1)
        return np.rint(columns[0]).astype(np.int32) if quantity.type == "INT" else columns[0]

    def rows(self, quantity):
        """The same; where there are none, what stands for it."""
        found = self.quantity(quantity)
        if found is not None:
            return found
        shape = (self.face_count, 3) if quantity.type == "FLOAT_VECTOR" else self.face_count
        return np.full(shape, fallback(quantity))

    def edge_kinds(self):
        """The kind of the edge from each corner to the next, 0 for inner ones."""
        kinds = np.zeros(self.corners.size, np.int32)
        start, end = self.corners.reshape(-1), self.corners[:, (1, 2, 0)].reshape(-1)
        for kind, pairs in (self.edges or {}).items():
            at_end = np.zeros(int(self.corners.max(initial=-1)) + 1, bool)
            at_end[pairs] = True
            sides = np.flatnonzero(at_end[start] & at_end[end])
            low, high = np.minimum(start[sides], end[sides]), np.maximum(start[sides], end[sides])
            number = low.astype(np.int64) << 32 | high
            kinds[sides[np.isin(number, pairs[:, 0] << 32 | pairs[:, 1])]] = kind
        return kinds

    def own_looks(self, gltf):
        """Texture coordinates and colours that are ours: names of attributes."""
        mappings = (self.given.extensions or {}).get("KHR_materials_variants", {}).get("mappings", [])
        numbers = {self.given.material} | {mapping.get("material") for mapping in mappings}
        names = set()
        for material in (gltf.data.materials[number] for number in numbers if number is not None):
            mark = material.extras.get(MARK) if isinstance(material.extras, dict) else None
            if not isinstance(mark, dict):
                continue
            look = material.pbr_metallic_roughness
            texture = look.base_color_texture if look else None
            if texture is not None:
                names.add(f"TEXCOORD_{texture.tex_coord or 0}")
            elif mark.get("attribute"):
                names.add(mark["attribute"])
        return names & set(self.given.attributes)

    def surface_attributes(self, own_looks):
        """Accessors of what tells vertices apart that Osculate did not split."""
        given = {name: number for name, number in self.given.attributes.items()
                 if name not in OWN_ATTRIBUTES and name not in own_looks and not _ASIDE.fullmatch(name)}
        morphs = [number for target in self.given.targets or [] for number in target.values()]
        return list(given.values()) + morphs


def _triangles(gltf, primitive):
    """Corners of the faces; None for points and lines, and for what only another extension can read."""
    mode = 4 if primitive.mode is None else primitive.mode
    packed = "KHR_draco_mesh_compression" in (primitive.extensions or {})
    if mode not in (4, 5, 6) or "POSITION" not in primitive.attributes or packed:
        return None
    if primitive.indices is None:
        indices = np.arange(gltf.data.accessors[primitive.attributes["POSITION"]].count)
    else:
        indices = decoded(gltf, primitive.indices).reshape(-1).astype(np.int64)
    if mode == 4:
        return indices[:len(indices) // 3 * 3].reshape(-1, 3)
    if mode == 5:
        strip = np.stack((indices[:-2], indices[1:-1], indices[2:]), axis=1)
        strip[1::2, 1:] = strip[1::2, :0:-1]
        return strip
    return np.stack((np.full(max(len(indices) - 2, 0), indices[0]), indices[1:-1], indices[2:]), axis=1)
