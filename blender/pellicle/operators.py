"""What the buttons of the panel do."""

import os
import re

import bpy
from bpy.app.handlers import persistent

from . import cache, export, settings
from .job import DONE, FAILED, RUNNING, STOPPED, Job


class Bake:
    """A bake in progress: the setup of the scene as it was, and the job that computes it."""

    def __init__(self, scene, setup, folder, program):
        self.scene, self.setup, self.folder, self.first_frame = scene, setup, folder, scene.frame_start
        path = export.write(setup, folder)
        self.job = Job(program, path, os.path.join(folder, "run"), os.path.join(folder, "result.pc2"), os.path.join(folder, "pellicle.log"))

    def poll(self):
        """Leads the job on; returns its state. When frames are there they are put on the objects."""
        state = self.job.poll()
        own = self.scene.pellicle
        own.progress = self.job.progress
        if state == RUNNING:
            return state
        messages = [self.readable(message) for message in self.job.messages]
        if state in (DONE, STOPPED):
            try:
                paths, count = cache.split(self.setup, self.job.cache, self.folder)
                for part, path in zip(self.setup.bodies, paths):
                    cache.attach(part.object, path, self.first_frame)
                messages.insert(0, f"{state}: {count} frames")
            except (cache.BadCache, OSError, ReferenceError, ValueError) as error:
                state = FAILED
                messages.append(f"error: {error}")
        own.progress = -1
        own.messages = "\n".join(messages)
        return state

    def readable(self, message):
        """A message without the path of the folder, and with the names of objects."""
        message = message.replace(self.folder + os.sep, "")
        body = re.search(r"\bbodies\[(\d+)\]|\bbodies\.(\d+)\.", message)
        number = int(body[1] or body[2]) if body else -1
        return f"{self.setup.bodies[number].object.name}: {message}" if 0 <= number < len(self.setup.bodies) else message


current = None  # the bake in progress


def prepare(context, need_program):
    """Folder, setup and program, or None after their problems are in the panel."""
    scene = context.scene
    folder, problem = export.folder_of(scene)
    setup = export.collect(scene)
    problems = setup.problems + ([problem] if problem else [])
    program = settings.program_path(context)
    if need_program and program is None:
        problems.append("The program pellicle is not found. Install it, or name it in the preferences of the add-on")
    scene.pellicle.messages = "\n".join(f"error: {text}" for text in problems)
    return None if problems else (folder, setup, program)


class PELLICLE_OT_bake(bpy.types.Operator):
    """Simulates the bodies from the first frame to the last and puts the result on the objects"""

    bl_idname = "pellicle.bake"
    bl_label = "Bake"
    wait: bpy.props.BoolProperty(name="Wait", description="Return after the end, for scripts", default=False, options={"SKIP_SAVE"})

    @classmethod
    def poll(cls, context):
        return current is None

    def execute(self, context):
        global current
        prepared = prepare(context, need_program=True)
        if prepared is None:
            self.report({"ERROR"}, context.scene.pellicle.messages)
            return {"CANCELLED"}
        folder, setup, program = prepared
        try:
            current = Bake(context.scene, setup, folder, program)
        except OSError as error:
            context.scene.pellicle.messages = f"error: cannot write into {folder}: {error.strerror}"
            self.report({"ERROR"}, context.scene.pellicle.messages)
            return {"CANCELLED"}
        if self.wait or bpy.app.background:
            return self.wait_for_end(context)
        self.timer = context.window_manager.event_timer_add(0.2, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def wait_for_end(self, context):
        while current.poll() == RUNNING:
            try:
                current.job.process.wait(0.1)
            except Exception:  # still running
                continue
        return self.end(context)

    def modal(self, context, event):
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        # a file that was loaded meanwhile ended the bake
        if current is not None and current.poll() == RUNNING:
            redraw(context)
            return {"PASS_THROUGH"}
        context.window_manager.event_timer_remove(self.timer)
        redraw(context)
        return self.end(context) if current is not None else {"CANCELLED"}

    def end(self, context):
        global current
        state, messages, current = current.job.state, current.scene.pellicle.messages, None
        if state == FAILED or "error:" in messages:
            self.report({"ERROR"}, messages)
            return {"CANCELLED"}
        if messages:
            self.report({"WARNING" if "warning:" in messages else "INFO"}, messages)
        return {"FINISHED"}


class PELLICLE_OT_cancel(bpy.types.Operator):
    """Stops the bake; the frames until then are kept"""

    bl_idname = "pellicle.cancel"
    bl_label = "Stop"

    @classmethod
    def poll(cls, context):
        return current is not None

    def execute(self, context):
        current.job.stop()
        return {"FINISHED"}


class PELLICLE_OT_clear(bpy.types.Operator):
    """Takes the results off all bodies; files stay"""

    bl_idname = "pellicle.clear"
    bl_label = "Clear"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        count = sum(cache.detach(thing) for thing in context.scene.objects)
        context.scene.pellicle.messages = ""
        self.report({"INFO"}, f"{count} objects")
        return {"FINISHED"}


class PELLICLE_OT_write(bpy.types.Operator):
    """Writes the scene and its meshes without simulating, for `pellicle run` and `pellicle live`"""

    bl_idname = "pellicle.write"
    bl_label = "Write Scene"

    def execute(self, context):
        prepared = prepare(context, need_program=False)
        try:
            path = export.write(prepared[1], prepared[0]) if prepared else None
        except OSError as error:
            path, context.scene.pellicle.messages = None, f"error: cannot write into {prepared[0]}: {error.strerror}"
        if path is None:
            self.report({"ERROR"}, context.scene.pellicle.messages)
            return {"CANCELLED"}
        context.scene.pellicle.messages = f"wrote {path}"
        self.report({"INFO"}, path)
        return {"FINISHED"}


def redraw(context):
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


@persistent
def end_bake(*_):
    """Another file is loaded: its objects are not those of the bake."""
    global current
    if current is not None:
        current.job.kill()
        current = None


classes = (PELLICLE_OT_bake, PELLICLE_OT_cancel, PELLICLE_OT_clear, PELLICLE_OT_write)


def register():
    for item in classes:
        bpy.utils.register_class(item)
    bpy.app.handlers.load_pre.append(end_bake)


def unregister():
    end_bake()
    bpy.app.handlers.load_pre.remove(end_bake)
    for item in reversed(classes):
        bpy.utils.unregister_class(item)
