# SPDX-License-Identifier: MIT
"""The operator that estimates: beside Blender's own work where it has a window, at once where it has none."""

import threading
import time

import bpy

from . import settings, wheel
from .estimate import Cancelled, Refused, clear, collect


class OSCULATE_OT_annotate(bpy.types.Operator):
    """Estimate the curvature of every face of the selected meshes and keep it as attributes of the faces"""

    bl_idname = "osculate.annotate"
    bl_label = "Annotate"
    bl_options = {"REGISTER", "UNDO"}

    _timer = None

    def invoke(self, context, event):
        if bpy.app.background or context.window is None:
            return self.execute(context)
        if not self._begin(context):
            return {"CANCELLED"}
        self._thread = threading.Thread(target=self._work, daemon=True)
        self._thread.start()
        manager = context.window_manager
        self._timer = manager.event_timer_add(0.05, window=context.window)
        manager.progress_begin(0, 100)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC" and event.value == "PRESS":
            self._stop.set()
            context.workspace.status_text_set("Osculate: cancelling")
            return {"RUNNING_MODAL"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        if self._thread.is_alive():
            context.window_manager.progress_update(100 * self._share)
            if not self._stop.is_set():
                context.workspace.status_text_set(f"Osculate: {100 * self._share:.0f} % (Esc cancels)")
            return {"RUNNING_MODAL"}
        self._end_waiting(context)
        return self._finish(context)

    def cancel(self, context):
        """Blender is closing the window or loading another file."""
        self._stop.set()
        self._thread.join()
        self._end_waiting(context)

    def execute(self, context):
        if not self._begin(context):
            return {"CANCELLED"}
        self._work()
        return self._finish(context)

    def _begin(self, context):
        """Copies what the work needs; False where there is nothing to do, which has been said then."""
        self._stop, self._share, self._error = threading.Event(), 0.0, None
        self._started = time.perf_counter()
        group = context.scene.osculate
        try:
            wheel.osculate()
            objects = context.selected_objects or [obj for obj in [context.active_object] if obj]
            self._jobs, skipped = collect(context, objects, group.use_modifiers)
        except (Refused, wheel.Missing) as reason:
            self.report({"ERROR"}, str(reason))
            return False
        for reason in skipped:
            self.report({"WARNING"}, reason)
        self._settings = settings.chosen(group)
        self._mark_sharp = group.mark_sharp
        return True

    def _work(self):
        """On a thread of its own: nothing here touches Blender."""
        def progress(stage, done, total):
            if self._stop.is_set():
                raise Cancelled
            self._share = (number + done / max(total, 1)) / len(self._jobs)
        try:
            for number, job in enumerate(self._jobs):
                if self._stop.is_set():
                    raise Cancelled
                job.run(self._settings, progress)
        except BaseException as error:  # told on Blender's thread
            self._error = error

    def _finish(self, context):
        if self._stop.is_set() or isinstance(self._error, Cancelled):
            self.report({"INFO"}, "Cancelled; nothing was changed.")
            return {"CANCELLED"}
        if self._error is not None:
            self.report({"ERROR"}, str(self._error) or type(self._error).__name__)
            return {"CANCELLED"}
        angle = settings.feature_angle(context.scene.osculate, self._settings)
        said, refused = [], []
        for job in self._jobs:
            try:
                said.append(job.write(context, angle, self._mark_sharp))
                for defect in job.defects:
                    self.report({"WARNING"}, f"\"{job.object_name}\": {defect}")
            except Refused as reason:
                refused.append(str(reason))
                self.report({"ERROR"}, str(reason))
        if said:
            self.report({"INFO"}, f"{'; '.join(said)}: {time.perf_counter() - self._started:.2f} s")
        return {"FINISHED"} if said else {"CANCELLED"}

    def _end_waiting(self, context):
        manager = context.window_manager
        manager.event_timer_remove(self._timer)
        manager.progress_end()
        context.workspace.status_text_set(None)


class OSCULATE_OT_clear(bpy.types.Operator):
    """Take the values of faces and edges off the selected meshes"""

    bl_idname = "osculate.clear"
    bl_label = "Remove Values"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        meshes = {obj.data for obj in context.selected_objects if obj.type == "MESH" and obj.mode != "EDIT"}
        count = sum(clear(mesh) for mesh in meshes)
        if not count:
            self.report({"ERROR"}, "None of the selected objects has values that could be removed.")
            return {"CANCELLED"}
        self.report({"INFO"}, f"Removed the values of {count} meshes.")
        return {"FINISHED"}


class OSCULATE_OT_reset(bpy.types.Operator):
    """Give all settings of the estimate their defaults"""

    bl_idname = "osculate.reset_settings"
    bl_label = "Defaults"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        settings.reset(context.scene.osculate)
        return {"FINISHED"}


_CLASSES = (OSCULATE_OT_annotate, OSCULATE_OT_clear, OSCULATE_OT_reset)


def register():
    for cls in _CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)
