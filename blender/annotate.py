# SPDX-License-Identifier: MIT
"""The operator that estimates: beside Blender's own work where it has a window, at once where it has none."""

import time

import bpy

from . import settings, wheel
from .estimate import Cancelled, Refused, clear, collect
from .objects import selected_meshes
from .work import Work


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
        self._work.start()
        manager = context.window_manager
        self._timer = manager.event_timer_add(0.05, window=context.window)
        manager.progress_begin(0, 100)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC" and event.value == "PRESS":
            self._work.cancel()
            context.workspace.status_text_set("Osculate: cancelling")
            return {"RUNNING_MODAL"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        if not self._work.is_running():
            self._end_waiting(context)
            return self._finish(context)
        context.window_manager.progress_update(100 * self._work.share)
        if not self._work.is_cancelled():
            context.workspace.status_text_set(f"Osculate: {100 * self._work.share:.0f} % (Esc cancels)")
        return {"RUNNING_MODAL"}

    def cancel(self, context):
        """Blender is closing the window or loading another file."""
        self._work.cancel()
        self._work.wait()
        self._end_waiting(context)

    def execute(self, context):
        if not self._begin(context):
            return {"CANCELLED"}
        self._work.run()
        return self._finish(context)

    def _begin(self, context):
        """Copies what the work needs; False where there is nothing to do, which has been said then."""
        self._started = time.perf_counter()
        group = context.scene.osculate
        try:
            wheel.osculate()
            objects = context.selected_objects or [obj for obj in [context.active_object] if obj]
            jobs, skipped = collect(context, objects, group.use_modifiers)
        except (Refused, wheel.Missing) as reason:
            self.report({"ERROR"}, str(reason))
            return False
        for reason in skipped:
            self.report({"WARNING"}, reason)
        self._work = Work(jobs, settings.chosen(group))
        self._angle = settings.feature_angle(group, self._work.settings)
        self._mark_sharp = group.mark_sharp
        return True

    def _finish(self, context):
        error = self._work.error
        if isinstance(error, Cancelled):
            self.report({"INFO"}, "Cancelled; nothing was changed.")
            return {"CANCELLED"}
        if error is not None:
            self.report({"ERROR"}, str(error) or type(error).__name__)
            return {"CANCELLED"}
        said, refused = [], []
        for job in self._work.jobs:
            try:
                said.append(job.write(context, self._angle, self._mark_sharp))
                for defect in job.defects:
                    self.report({"WARNING"}, f"\"{job.object_name}\": {defect}")
            except Refused as reason:
                refused.append(str(reason))
        for reason in refused:
            # To scripts an error is an exception, which would hide that the others are done.
            self.report({"WARNING"} if said else {"ERROR"}, reason)
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
        meshes = {obj.data for obj in selected_meshes(context)}
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


register, unregister = bpy.utils.register_classes_factory((OSCULATE_OT_annotate, OSCULATE_OT_clear, OSCULATE_OT_reset))
