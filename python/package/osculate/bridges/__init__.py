"""To and from the meshes and tables of other libraries.

Each module has ``annotate(theirs, **settings)``, which estimates a mesh of theirs and hands it back with the values on
its faces, in place; ``arrays(theirs)``, the ``(vertices, faces)`` that ``osculate.annotate`` and ``osculate.Mesh`` take;
``attach(theirs, curvature)``; and ``mesh(ours, curvature=None)``, a mesh of theirs from ours:

>>> import trimesh, osculate
>>> ball = trimesh.creation.icosphere(radius=2.0)
>>> _ = osculate.bridges.trimesh.annotate(ball)
>>> ball.face_attributes["k_max"].round(2)[:3]
array([0.5, 0.5, 0.5], dtype=float32)

``tables`` goes to and from pandas and Arrow. The values on faces are named as in CSV (``k_max``, ``dir_max``, ...);
those that the setting ``attributes`` chose are attached, but ``face`` and ``method``. The other library is imported when
a function is called, and is never needed otherwise.
"""

from __future__ import annotations

from . import meshio, open3d, pyvista, tables, trimesh

__all__ = ["meshio", "open3d", "pyvista", "tables", "trimesh"]
