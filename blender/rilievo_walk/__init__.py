# SPDX-License-Identifier: MIT
"""Bakes a scene into a walk for any browser: the panel "Bake walk" in the sidebar of the 3D view.

Surfaces are exported as glTF; Cycles renders the pictures from the .blend itself, in processes of their
own, so that Blender stays usable. No compiled module: the work is that of the program `rilievo`.
"""

import os
import pathlib
import tempfile
import webbrowser

import bpy
from bpy.props import (BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty,
                       StringProperty)
from mathutils import Vector

from . import walk_bake

bl_info = {
    "name": "Rilievo walk",
    "description": "Bakes a Cycles scene into a walk for any browser",
    "author": "The authors of Rilievo",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "3D view > sidebar > Walk",
    "category": "Render",
}

# Eyes of people who stand on a floor, metres above it.
EYES_LOW, EYES_HIGH = 1.4, 1.9
# Around a camera that does not move, metres to each side.
AROUND_CAMERA = 0.5
PERIOD_S = 0.2  # between two looks at what the processes say

# The bake or the proposal that is running, one at a time; and the server of the last walk.
running = {"work": None, "server": None}


def preferences(context):
    return context.preferences.addons[__package__].preferences


def renderer():
    """The program that renders by Cycles: beside this file in an installed add-on, else in the sources."""
    here = pathlib.Path(__file__).resolve().parent
    for place in (here / "render.py", here.parents[1] / "examples" / "blender" / "render.py"):
        if place.exists():
            # An archive loses the permission.
            if not os.access(place, os.X_OK):
                place.chmod(place.stat().st_mode | 0o100)
            return place
    raise FileNotFoundError("render.py of the add-on is missing: install it again")


def in_file(place):
    """Blender's z is up, glTF's y."""
    return place.x, place.z, -place.y


def box_around(places, margin=0.0):
    corners = [in_file(p) for p in places]
    low = [min(c[i] for c in corners) - (margin if i != 1 else 0.1 * margin) for i in range(3)]
    high = [max(c[i] for c in corners) + (margin if i != 1 else 0.1 * margin) for i in range(3)]
    # A box has an extent.
    return [low, [max(h, l + 1e-3) for l, h in zip(low, high)]]


def corners_of(thing):
    return [thing.matrix_world @ Vector(corner) for corner in thing.bound_box]


def region_of_eyes(context):
    """Two corners in the file's axes; raises ValueError with what is missing."""
    scene, settings = context.scene, context.scene.rilievo_walk
    if settings.eyes == "PATH":
        if scene.camera is None:
            raise ValueError("the scene has no camera: add one, or choose where eyes will be otherwise")
        now, places = scene.frame_current, []
        span = scene.frame_end - scene.frame_start
        for frame in range(scene.frame_start, scene.frame_end + 1, max(1, span // 100)):
            scene.frame_set(frame)
            places.append(scene.camera.matrix_world.translation.copy())
        scene.frame_set(now)
        moves = max((a - places[0]).length for a in places) > 0.1
        return box_around(places, 0.05 if moves else AROUND_CAMERA)
    if settings.eyes == "BOX":
        if settings.box is None:
            raise ValueError("no box is chosen: choose an object around the places where eyes will be")
        return box_around(corners_of(settings.box))
    floor = context.active_object
    if floor is None or floor.type != "MESH":
        raise ValueError("no floor is selected: select the mesh that people stand on")
    (x0, _, z0), (x1, _, z1) = box_around(corners_of(floor))
    top = max(corner.z for corner in corners_of(floor))
    # Not within walls.
    inset = [min(0.4, 0.25 * (b - a)) for a, b in ((x0, x1), (z0, z1))]
    return [[x0 + inset[0], top + EYES_LOW, z0 + inset[1]], [x1 - inset[0], top + EYES_HIGH, z1 - inset[1]]]


def output_folder(settings):
    path = bpy.path.abspath(settings.folder)
    if settings.folder.startswith("//") and not bpy.data.filepath:
        path = os.path.join(tempfile.gettempdir(), "rilievo-walk")
    return pathlib.Path(path)


def export_surfaces(context, folder):
    """What of the scene has surfaces, as a GLB file, with modifiers applied, without what renders hide."""
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / "surfaces.glb"
    hidden = [o for o in context.scene.objects if o.hide_render or (o == context.scene.rilievo_walk.box)]
    selected = [o for o in context.selected_objects]
    active = context.view_layer.objects.active
    for thing in context.scene.objects:
        visible = thing not in hidden and thing.visible_get()
        try:
            thing.select_set(visible)
        except RuntimeError:  # of another view layer
            continue
    try:
        import numpy
        if "bool" not in numpy.__dict__:
            numpy.bool = bool  # Debian 12's exporter is older than its numpy
        bpy.ops.export_scene.gltf(filepath=str(file), export_format="GLB", use_selection=True,
                                  export_yup=True, export_apply=True, export_animations=False)
    finally:
        for thing in context.scene.objects:
            try:
                thing.select_set(thing in selected)
            except RuntimeError:
                continue
        context.view_layer.objects.active = active
    return file


def make_job(context, render):
    """Raises ValueError with what is missing. Saves a copy of the file for Cycles if `render`."""
    settings = context.scene.rilievo_walk
    folder = output_folder(settings)
    region = region_of_eyes(context)
    surfaces = export_surfaces(context, folder)
    job = walk_bake.Job(surfaces, folder, region=region, nodes=settings.nodes, face=int(settings.face),
                        samples=settings.samples, preview=settings.preview)
    if render and settings.light == "CYCLES":
        copy = folder / "scene.blend"
        bpy.ops.wm.save_as_mainfile(filepath=str(copy), copy=True, check_existing=False)
        job.source, job.program_scene = f"exec:{renderer()}", copy
        job.environment = {"RILIEVO_BLENDER": bpy.app.binary_path}
    return job


class WalkSettings(bpy.types.PropertyGroup):
    eyes: EnumProperty(name="Eyes", description="Where the eyes of those who walk will be", items=(
        ("PATH", "Camera's path", "Where the camera goes, from the first frame to the last"),
        ("BOX", "Box", "In the bounds of an object"),
        ("FLOOR", "Selected floor", "At a person's height above the selected mesh")))
    box: PointerProperty(name="Box", type=bpy.types.Object,
                         description="An object around the places where eyes will be; is not baked itself")
    nodes: IntProperty(name="Nodes", default=4, min=1, max=256,
                       description="Points from which everything is rendered, in six pictures each")
    face: EnumProperty(name="Size", default="512", description="Texels a side of each of a node's six pictures",
                       items=tuple((n, n, "") for n in ("64", "128", "256", "512", "1024", "2048")))
    samples: IntProperty(name="Samples", default=64, min=1, max=4096, description="Samples of a texel")
    light: EnumProperty(name="Light", items=(
        ("CYCLES", "Cycles", "All that Cycles renders: soft shadows, glossy surfaces, indirect light"),
        ("RAYTRACE", "Rilievo's ray tracer", "Shadows, mirrors and glass; much faster")))
    preview: BoolProperty(name="Preview first", default=True,
                          description="A coarse walk first, which is refined")
    folder: StringProperty(name="Folder", default="//walk", subtype="DIR_PATH",
                           description="Of the walk; finished pictures are kept here, so that a bake goes on")
    # What the panel says.
    status: StringProperty(default="")
    share: FloatProperty(default=0.0)
    progress: FloatProperty(name="Done", default=0.0, min=0, max=100, subtype="PERCENTAGE")


class WalkPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__
    program: StringProperty(name="Program", default="rilievo", subtype="FILE_PATH",
                            description="Rilievo's program: a name on the PATH, or a path")

    def draw(self, context):
        self.layout.prop(self, "program")
        try:
            walk_bake.find_program(self.program)
        except walk_bake.ProgramMissing as missing:
            self.layout.label(text=str(missing), icon="ERROR")


class Work:
    """What the two operators share: work in other processes, looked at by a timer."""

    def begin(self, context):
        """Starts the work, and returns it."""
        raise NotImplementedError

    def show(self, context, work):
        raise NotImplementedError

    def end(self, context, work):
        raise NotImplementedError

    def execute(self, context):
        if running["work"] is not None:
            self.report({"ERROR"}, "a bake is running already")
            return {"CANCELLED"}
        try:
            walk_bake.find_program(preferences(context).program)
            self.work = running["work"] = self.begin(context)
        except (walk_bake.ProgramMissing, ValueError, OSError, RuntimeError) as wrong:
            context.scene.rilievo_walk.status = str(wrong)
            self.report({"ERROR"}, str(wrong))
            return {"CANCELLED"}
        if bpy.app.background:  # nobody sees it, and there are no timers
            import time
            while self.work.poll() in self.busy:
                time.sleep(PERIOD_S)
            return self.finish(context)
        self.timer = context.window_manager.event_timer_add(PERIOD_S, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC" and event.value == "PRESS":
            self.work.cancel()
        elif event.type != "TIMER":
            return {"PASS_THROUGH"}
        state = self.work.poll()
        self.show(context, self.work)
        for area in context.screen.areas if context.screen else ():
            area.tag_redraw()
        if state in self.busy:
            return {"PASS_THROUGH"}
        context.window_manager.event_timer_remove(self.timer)
        return self.finish(context)

    def finish(self, context):
        work, running["work"] = self.work, None
        self.show(context, work)
        if work.state == "failed":
            self.report({"ERROR"}, work.error)
            return {"CANCELLED"}
        if work.state == "cancelled":
            self.report({"INFO"}, "cancelled; what is finished is kept")
            return {"CANCELLED"}
        self.end(context, work)
        return {"FINISHED"}


class RILIEVO_OT_bake_walk(Work, bpy.types.Operator):
    bl_idname = "rilievo.bake_walk"
    bl_label = "Bake walk"
    bl_description = "Renders the nodes' pictures in the background, and opens the walk in the browser"
    busy = ("baking", "writing")
    open_page: BoolProperty(default=True, options={"HIDDEN", "SKIP_SAVE"})

    def begin(self, context):
        return walk_bake.WalkBake(preferences(context).program, make_job(context, render=True))

    def show(self, context, work):
        settings = context.scene.rilievo_walk
        settings.status = work.text()
        settings.progress = 100 * work.done / work.total if work.total else 0

    def end(self, context, work):
        settings = context.scene.rilievo_walk
        settings.share = 100 * (work.held or 0)
        settings.status = f"done: {work.job.page}"
        if self.open_page and not bpy.app.background:
            open_page(work.job.page)


class RILIEVO_OT_propose_nodes(Work, bpy.types.Operator):
    bl_idname = "rilievo.propose_nodes"
    bl_label = "Propose nodes"
    bl_description = "Finds how many nodes hold 99.5 % of the surface that these eyes see; renders nothing"
    busy = ("trying",)

    def begin(self, context):
        return walk_bake.Proposal(preferences(context).program, make_job(context, render=False))

    def show(self, context, work):
        settings = context.scene.rilievo_walk
        if work.tried:
            settings.share = 100 * work.tried[-1][1]
            settings.status = f"{work.tried[-1][0]} nodes hold {settings.share:.1f} %"

    def end(self, context, work):
        settings = context.scene.rilievo_walk
        settings.nodes, settings.share = work.nodes, 100 * work.share
        settings.status = f"{work.nodes} nodes hold {settings.share:.1f} % of what is seen"


class RILIEVO_OT_cancel(bpy.types.Operator):
    bl_idname = "rilievo.cancel"
    bl_label = "Cancel"
    bl_description = "Ends the bake; started again, it goes on"

    @classmethod
    def poll(cls, context):
        return running["work"] is not None

    def execute(self, context):
        running["work"].cancel()
        return {"FINISHED"}


def open_page(folder):
    if running["server"] is not None:
        running["server"].close()
    running["server"] = walk_bake.PageServer(folder)
    webbrowser.open(running["server"].address)


class RILIEVO_OT_open_walk(bpy.types.Operator):
    bl_idname = "rilievo.open_walk"
    bl_label = "Open in browser"

    def execute(self, context):
        page = output_folder(context.scene.rilievo_walk) / "walk"
        if not (page / "index.html").exists():
            self.report({"ERROR"}, f"{page}: there is no walk yet")
            return {"CANCELLED"}
        open_page(page)
        return {"FINISHED"}


class RILIEVO_PT_walk(bpy.types.Panel):
    bl_label = "Bake walk"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Walk"

    def draw(self, context):
        layout, settings = self.layout, context.scene.rilievo_walk
        layout.use_property_split = True
        busy = running["work"] is not None
        options = layout.column()
        options.enabled = not busy
        options.prop(settings, "eyes")
        if settings.eyes == "BOX":
            options.prop(settings, "box")
        options.prop(settings, "nodes")
        options.operator("rilievo.propose_nodes", icon="VIEWZOOM")
        if settings.share > 0:
            options.label(text=f"They hold {settings.share:.1f} % of what is seen")
        options.prop(settings, "light")
        options.prop(settings, "samples")
        options.prop(settings, "face")
        options.prop(settings, "preview")
        options.prop(settings, "folder")
        if busy:
            if settings.progress > 0:
                layout.prop(settings, "progress", slider=True)
            layout.operator("rilievo.cancel", icon="X")
        else:
            layout.operator("rilievo.bake_walk", icon="RENDER_STILL")
            layout.operator("rilievo.open_walk", icon="URL")
        if settings.status:
            layout.label(text=settings.status)


CLASSES = (WalkSettings, WalkPreferences, RILIEVO_OT_bake_walk, RILIEVO_OT_propose_nodes, RILIEVO_OT_cancel,
           RILIEVO_OT_open_walk, RILIEVO_PT_walk)


def register():
    for one in CLASSES:
        bpy.utils.register_class(one)
    bpy.types.Scene.rilievo_walk = PointerProperty(type=WalkSettings)


def unregister():
    if running["work"] is not None:
        running["work"].cancel()
    if running["server"] is not None:
        running["server"].close()
    del bpy.types.Scene.rilievo_walk
    for one in reversed(CLASSES):
        bpy.utils.unregister_class(one)
