"""Copies of a scan that show the same surface by another mesh."""

import numpy as np
import pymeshlab
from scipy.spatial import cKDTree

from . import mesh

# A flip keeps the surface: no two of the old and the new triangles' normals are further apart.
LARGEST_TURN = np.radians(20)
# And it keeps triangles well shaped.
LEAST_ANGLE = np.radians(20)


def noisy(points, faces, strength, seed):
    """Gaussian noise on every coordinate, `strength` mean edges strong."""
    random = np.random.default_rng(seed)
    return points + random.normal(size=points.shape) * strength * mesh.mean_edge(points, faces), faces


def halved(points, faces):
    """Half the faces, by MeshLab's quadric edge collapse with its default settings."""
    meshes = pymeshlab.MeshSet()
    meshes.add_mesh(pymeshlab.Mesh(points, faces))
    meshes.meshing_decimation_quadric_edge_collapse(targetfacenum=len(faces) // 2)
    half = meshes.current_mesh()
    return mesh.cleaned(np.array(half.vertex_matrix()), np.array(half.face_matrix(), np.int64))


def retriangulated(points, faces, seed, share=0.2, jitter=0.1):
    """Up to `share` of the edges flipped, at random among those that can be; then every vertex moved in its
    tangent plane by up to `jitter` of its mean edge along each axis (borders stay)."""
    random = np.random.default_rng(seed)
    faces = flipped(points, faces, random, share)
    pairs, uses = mesh.edges(faces)
    length = mesh.lengths(points, pairs)
    total, count, shortest = np.zeros(len(points)), np.zeros(len(points)), np.full(len(points), np.inf)
    for end in pairs.T:
        np.add.at(total, end, length)
        np.add.at(count, end, 1)
        np.minimum.at(shortest, end, length)
    normal = np.zeros_like(points)
    for corner in faces.T:
        np.add.at(normal, corner, mesh.cross(points, faces))
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    # Beside a short edge a share of the mean would turn faces over.
    reach = np.minimum(jitter * total / np.maximum(count, 1), 0.3 * shortest)
    move = random.uniform(-1, 1, points.shape) * reach[:, None]
    move -= (move * normal).sum(axis=1, keepdims=True) * normal
    move[pairs[uses != 2]] = 0
    return points + move, faces


def flipped(points, faces, random, share):
    """The faces after random edge flips. One edge at a time, in plain numbers: each flip changes which
    others are possible."""
    at = [tuple(p) for p in points.tolist()]
    triangles = [tuple(f) for f in faces.tolist()]
    beside = {}
    for index, (a, b, c) in enumerate(triangles):
        for edge in ((a, b), (b, c), (c, a)):
            beside.setdefault(key(*edge), []).append(index)
    order = list(beside)
    random.shuffle(order)
    left = int(share * len(order))
    for a, b in map(tuple, order):
        if left == 0:
            break
        owners = beside.get((a, b), ())
        if len(owners) != 2:
            continue
        first, second = owners
        if not follows(triangles[first], a, b):
            a, b = b, a
        if not (follows(triangles[first], a, b) and follows(triangles[second], b, a)):
            continue
        c, d = (next(v for v in triangles[f] if v not in (a, b)) for f in owners)
        if c == d or key(c, d) in beside or not keeps_surface(at, a, b, c, d):
            continue
        for edge, old, new in (((b, c), first, second), ((a, d), second, first)):
            owners_of_side = beside[key(*edge)]
            owners_of_side[owners_of_side.index(old)] = new
        del beside[key(a, b)]
        beside[key(c, d)] = [first, second]
        triangles[first], triangles[second] = (a, d, c), (d, b, c)
        left -= 1
    return np.array(triangles)


def key(a, b):
    return (a, b) if a < b else (b, a)


def follows(triangle, a, b):
    """True where the triangle runs from a to b."""
    return (a, b) in zip(triangle, triangle[1:] + triangle[:1])


def keeps_surface(at, a, b, c, d):
    """True where c-d may take the place of a-b between the triangles a b c and b a d."""
    turn, corner = np.cos(LARGEST_TURN), np.cos(LEAST_ANGLE)
    old = [unit_normal(at, a, b, c), unit_normal(at, b, a, d)]
    new = [unit_normal(at, a, d, c), unit_normal(at, d, b, c)]
    pairs = [(*old,), (*new,), *((m, n) for m in old for n in new)]
    if any(dot(m, n) < turn for m, n in pairs):
        return False
    return max(widest_cosine(at, a, d, c), widest_cosine(at, d, b, c)) <= corner


def unit_normal(at, a, b, c):
    u, v = minus(at[b], at[a]), minus(at[c], at[a])
    n = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    length = dot(n, n) ** 0.5
    return tuple(x / length for x in n) if length > 0 else (0.0, 0.0, 0.0)


def widest_cosine(at, a, b, c):
    """Cosine of the triangle's smallest angle."""
    worst = -1.0
    for p, q, r in ((a, b, c), (b, c, a), (c, a, b)):
        u, v = minus(at[q], at[p]), minus(at[r], at[p])
        length = (dot(u, u) * dot(v, v)) ** 0.5
        worst = max(worst, dot(u, v) / length if length > 0 else 1.0)
    return worst


def minus(p, q):
    return (p[0] - q[0], p[1] - q[1], p[2] - q[2])


def dot(p, q):
    return p[0] * q[0] + p[1] * q[1] + p[2] * q[2]


def nearest(original, copy):
    """For every face of the copy the original's face with the nearest barycentre that looks the same way."""
    centres = [points[faces].mean(axis=1) for points, faces in (original, copy)]
    near = cKDTree(centres[0]).query(centres[1], 8)[1]
    turned = np.einsum("ijk,ik->ij", mesh.normals(*original)[near], mesh.normals(*copy)) > 0.3
    # Of a thin wall's two sides, its own; the nearest where none looks the same way.
    return near[np.arange(len(near)), turned.argmax(axis=1)]
