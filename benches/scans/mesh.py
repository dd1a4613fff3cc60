"""Triangle meshes as arrays: points (n, 3) and faces (m, 3)."""

import numpy as np
import pymeshlab


def read(path):
    """The mesh of any file that MeshLab reads."""
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(str(path))
    mesh = meshes.current_mesh()
    return np.array(mesh.vertex_matrix()), np.array(mesh.face_matrix(), np.int64)


def write(path, points, faces):
    """Binary PLY with 64-bit coordinates, so that copies differ by what was done to them only."""
    rows = np.empty(len(faces), [("corners", "u1"), ("indices", "<i4", 3)])
    rows["corners"], rows["indices"] = 3, faces
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n"
        "property double x\nproperty double y\nproperty double z\n"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    with open(path, "wb") as file:
        file.write(header.encode())
        file.write(np.ascontiguousarray(points, "<f8").tobytes())
        file.write(rows.tobytes())


def cleaned(points, faces):
    """Without what peers fall over: equal points welded; no face with a repeated vertex, without area
    or over the vertices of an earlier one; no unused point."""
    _, first, new = np.unique(points, axis=0, return_index=True, return_inverse=True)
    points, faces = points[first], new.reshape(-1)[faces]
    normals = np.linalg.norm(cross(points, faces), axis=1)
    faces = faces[normals > 1e-12 * np.ptp(points, axis=0).max() ** 2]
    _, first = np.unique(np.sort(faces, axis=1), axis=0, return_index=True)
    faces = faces[np.sort(first)]
    used, faces = np.unique(faces, return_inverse=True)
    return points[used], faces.reshape(-1, 3)


def cross(points, faces):
    """Normals of the faces, twice their area long."""
    a, b, c = (points[faces[:, i]] for i in range(3))
    return np.cross(b - a, c - a)


def normals(points, faces):
    """Unit normals of the faces."""
    n = cross(points, faces)
    return n / np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-300)


def edges(faces):
    """The edges, each once, and how many faces each has."""
    sides = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    return np.unique(np.sort(sides, axis=1), axis=0, return_counts=True)


def lengths(points, pairs):
    """Lengths of the edges."""
    return np.linalg.norm(points[pairs[:, 0]] - points[pairs[:, 1]], axis=1)


def mean_edge(points, faces):
    """Mean length of the edges."""
    return lengths(points, edges(faces)[0]).mean()
