# SPDX-License-Identifier: MIT
"""Arrays to and from attributes of a mesh, without a loop in Python."""

import numpy as np

#: Type of array and name of the element's field, for each type of attribute.
FIELDS = {
    "FLOAT": (np.float32, "value"),
    "INT": (np.int32, "value"),
    "BOOLEAN": (bool, "value"),
    "FLOAT_VECTOR": (np.float32, "vector"),
    "INT32_2D": (np.int32, "value"),
}
WIDTHS = {"FLOAT_VECTOR": 3, "INT32_2D": 2}

#: Custom property of a mesh that says where its values come from; named as in glTF.
MARK = "osculate"


def put(mesh, name, kind, domain, values):
    """Writes an attribute, replacing one of that name and other type. `values`: one row for each element."""
    attribute = mesh.attributes.get(name)
    if attribute is not None and (attribute.data_type, attribute.domain) != (kind, domain):
        mesh.attributes.remove(attribute)
        attribute = None
    if attribute is None:
        attribute = mesh.attributes.new(name, kind, domain)
    dtype, field = FIELDS[kind]
    attribute.data.foreach_set(field, np.ascontiguousarray(values, dtype).reshape(-1))


def get(mesh, name):
    """The values of an attribute, one row for each element; None where the mesh has no such attribute."""
    attribute = mesh.attributes.get(name)
    if attribute is None or attribute.data_type not in FIELDS:
        return None
    dtype, field = FIELDS[attribute.data_type]
    width = WIDTHS.get(attribute.data_type, 1)
    values = np.empty(len(attribute.data) * width, dtype)
    attribute.data.foreach_get(field, values)
    return values if width == 1 else values.reshape(-1, width)


def positions(mesh):
    """Positions of the vertices, vertices x 3."""
    return _built_in(mesh, "position", "FLOAT_VECTOR", len(mesh.vertices))


def corner_vertices(mesh):
    """The vertex of each corner."""
    return _built_in(mesh, ".corner_vert", "INT", len(mesh.loops))


def corner_edges(mesh):
    """The edge from each corner to the next of its face."""
    return _built_in(mesh, ".corner_edge", "INT", len(mesh.loops))


def edge_vertices(mesh):
    """The two vertices of each edge, edges x 2."""
    return _built_in(mesh, ".edge_verts", "INT32_2D", len(mesh.edges))


def corner_faces(mesh):
    """The face of each corner."""
    faces = np.arange(len(mesh.polygons), dtype=np.int32)
    if is_triangles(mesh):
        return np.repeat(faces, 3)
    totals = np.empty(len(faces), np.int32)
    mesh.polygons.foreach_get("loop_total", totals)
    return np.repeat(faces, totals)


def face_normals(mesh):
    """Unit normals by the winding of the faces, faces x 3; 0 for a face without area that Blender gives none."""
    if not mesh.has_custom_normals:
        found = np.empty(3 * len(mesh.polygons), np.float32)
        mesh.polygon_normals.foreach_get("vector", found)
        return found.reshape(-1, 3)
    # Blender's would be the mean of the normals that the mesh was given.
    points = positions(mesh).astype(np.float64)[corner_vertices(mesh)]
    faces, starts = corner_faces(mesh), first_corners(mesh)
    points -= points[starts][faces]
    following = np.roll(points, -1, axis=0)
    # The last corner of a face is followed by its first, which lies at zero.
    following[np.append(starts[1:], len(points)) - 1] = 0
    crossed = np.cross(points, following)
    normals = np.stack([np.bincount(faces, crossed[:, i], len(starts)) for i in range(3)], axis=1)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0)


def first_corners(mesh):
    """The first corner of each face."""
    if is_triangles(mesh):
        return np.arange(0, len(mesh.loops), 3)
    found = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_start", found)
    return found


def is_triangles(mesh):
    """No face has more than three corners."""
    return len(mesh.loops) == 3 * len(mesh.polygons)


def _built_in(mesh, name, kind, count):
    # As attributes these are copied in one piece; as members of vertices and loops one by one. An empty mesh
    # may be without them.
    found = get(mesh, name)
    if found is not None:
        return found
    dtype, width = FIELDS[kind][0], WIDTHS.get(kind, 1)
    return np.zeros((count, width) if width > 1 else count, dtype)
