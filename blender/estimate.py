# SPDX-License-Identifier: MIT
"""From objects to attributes, in three steps: `collect` and `write` on Blender's thread, `run` on any."""

import re
import warnings

import numpy as np

from . import edges, store, wheel
from .quantities import BY_TOKEN, EDGE_KIND, DIHEDRAL
from .triangles import Triangles, columns_of


class Refused(Exception):
    """A sentence for the user: what cannot be done and what to do about it."""


class Cancelled(Exception):
    """The user has pressed Esc."""


class Job:
    """One mesh: where its triangles come from, and later the values of its faces."""

    def __init__(self, obj, depsgraph=None):
        self.object_name, self.mesh_name = obj.name, obj.data.name
        self.is_evaluated = depsgraph is not None
        self.triangles = self._read(obj, depsgraph)
        self.columns, self.settings, self.defects = None, None, []
        #: Why there is nothing to write, where there is not.
        self.refusal = None

    def _read(self, obj, depsgraph):
        if depsgraph is None:
            return Triangles(obj.data)
        evaluated = obj.evaluated_get(depsgraph)
        try:
            return Triangles(evaluated.to_mesh())
        finally:
            evaluated.to_mesh_clear()

    def run(self, settings, progress):
        """Estimates. Needs nothing of Blender; `progress(stage, done, total)` may raise."""
        osculate = wheel.osculate()
        try:
            curvature = osculate.annotate(
                self.triangles.vertices, self.triangles.corners, progress=progress, **settings)
        except osculate.EmptyMeshError as error:
            # No reason to leave out the other objects.
            self.refusal = f"\"{self.object_name}\": {error}, so there is nothing to estimate."
            return
        self.columns = self.triangles.of_faces(columns_of(curvature, curvature.attributes))
        self.settings, self.defects = curvature.settings, curvature.defects

    def write(self, context, feature_angle, mark_sharp):
        """Puts the values on the mesh, or on a new object where modifiers change faces. Returns a sentence."""
        import bpy
        if self.refusal is not None:
            raise Refused(self.refusal)
        obj = bpy.data.objects.get(self.object_name)
        depsgraph = context.evaluated_depsgraph_get() if self.is_evaluated else None
        if obj is None or obj.type != "MESH" or obj.mode == "EDIT" or not self._read(obj, depsgraph).is_same(
                self.triangles):
            raise Refused(f"\"{self.object_name}\" has changed while it was estimated; nothing was written. Run it again.")
        mesh, made = obj.data, ""
        # Other objects of the same mesh have other modifiers, or none.
        if self.is_evaluated and (mesh.users > 1 or not np.array_equal(
                store.corner_vertices(mesh), self._corners(obj, depsgraph))):
            mesh = bpy.data.meshes.new_from_object(obj.evaluated_get(depsgraph), depsgraph=depsgraph)
            mesh.name = f"{obj.name} evaluated"
            new = bpy.data.objects.new(mesh.name, mesh)
            new.matrix_world = obj.matrix_world
            for collection in obj.users_collection:
                collection.objects.link(new)
            made = f" as new object \"{new.name}\""
        put_values(mesh, self.columns, self.settings)
        kinds = edges.write(mesh, feature_angle)
        if mark_sharp:
            edges.mark_sharp(mesh, kinds)
        mesh.update()
        return self._said(mesh, made)

    def _corners(self, obj, depsgraph):
        evaluated = obj.evaluated_get(depsgraph)
        try:
            return store.corner_vertices(evaluated.to_mesh())
        finally:
            evaluated.to_mesh_clear()

    def _said(self, mesh, made):
        parts = [f"{len(mesh.polygons)} faces of \"{self.object_name}\"{made}"]
        without = int((self.columns["class"] == -1).sum())
        loose = int((np.bincount(store.corner_edges(mesh), minlength=len(mesh.edges)) == 0).sum())
        for count, what in ((without, "without estimate"), (self.triangles.polygons(), "as means of their triangles"),
                            (loose, "loose edges left out")):
            if count:
                parts.append(f"{count} {what}")
        return ", ".join(parts)


def put_values(mesh, columns, settings):
    """Writes attributes of faces and what they were made with, in the place of those of an earlier run."""
    if store.MARK in mesh:
        clear(mesh)
    store.put(mesh, BY_TOKEN["face"].attribute, "INT", "FACE", np.arange(len(mesh.polygons)))
    for token, values in columns.items():
        quantity = BY_TOKEN[token]
        store.put(mesh, quantity.attribute, quantity.type, "FACE", values)
    mesh[store.MARK] = {
        "schema": 1, "version": wheel.osculate().__version__, "faces": len(mesh.polygons),
        "settings": {name: value for name, value in settings.items() if value is not None}}


def collect(context, objects, use_modifiers):
    """A job for each mesh among the objects, and a sentence for each object that has none.

    Raises Refused where there is nothing to do."""
    _leave_defects_to_us()
    depsgraph = context.evaluated_depsgraph_get() if use_modifiers else None
    jobs, skipped, seen = [], [], set()
    for obj in objects:
        reason = _reason_against(obj)
        if reason is not None:
            skipped.append(reason)
        elif use_modifiers or obj.data not in seen:
            seen.add(obj.data)
            job = Job(obj, depsgraph)
            if job.triangles.face_count:
                jobs.append(job)
            else:
                skipped.append(f"\"{obj.name}\" has no faces, so there is nothing to estimate.")
    if not jobs:
        raise Refused(" ".join(skipped) or "Select one or more mesh objects first.")
    return jobs, skipped


def _leave_defects_to_us():
    """Defects are told when the work is done, not as warnings of Python. Filters are the whole process's: this one is
    set on Blender's thread, stays, and is for warnings that name this module alone."""
    warnings.filterwarnings("ignore", category=wheel.osculate().DefectWarning, module=re.escape(__name__) + r"\Z")


def _reason_against(obj):
    if obj.type != "MESH":
        return (f"\"{obj.name}\" is no mesh ({obj.type.lower().replace('_', ' ')}); convert it with Object > Convert > "
                "Mesh, or select a mesh.")
    if obj.mode == "EDIT":
        return f"\"{obj.name}\" is in Edit Mode, in which values cannot be written; leave it with Tab and run again."
    if obj.library is not None or obj.data.library is not None:
        return f"\"{obj.name}\" is linked from another file; make it local with Object > Relations > Make Local."
    return None


def clear(mesh):
    """Takes off a mesh all that `write` and imports put on it, but sharp edges. True if there was anything."""
    names = {quantity.attribute for quantity in BY_TOKEN.values()} | {EDGE_KIND, DIHEDRAL}
    found = [attribute.name for attribute in mesh.attributes if attribute.name in names]
    for name in found:
        mesh.attributes.remove(mesh.attributes[name])
    had = store.MARK in mesh
    if had:
        del mesh[store.MARK]
    return bool(found) or had
